//! Triangle meshes, read only for their mass properties.

use super::document::read_bytes;
use super::error::ModelError;
use crate::model::Quaternion;
use crate::model::inertia::principal;
use nalgebra::{Matrix3, Vector3};
use std::path::Path;

/// Length of a binary STL file's free text, and of one of its triangles: normal, three corners, two bytes.
const HEADER: usize = 80;
const TRIANGLE: usize = 50;

/// Volume and its moments of a mesh filled with density one.
#[derive(Debug)]
pub(super) struct Mesh {
    /// m³.
    pub volume: f64,
    /// Centre of mass in the file's frame, m.
    pub centre: Vector3<f64>,
    /// Principal axes in the file's frame.
    pub axes: Quaternion,
    /// Principal moments about the centre at density one, m⁵.
    pub moments: Vector3<f64>,
}

type Triangle = [Vector3<f64>; 3];

/// Reads a binary STL file, its coordinates multiplied by `scale`.
pub(super) fn read(path: &Path, scale: Vector3<f64>) -> Result<Mesh, ModelError> {
    let wrong = |reason: &str| ModelError::File { path: path.to_path_buf(), reason: reason.to_owned() };
    let stl = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("stl"));
    if !stl {
        return Err(wrong("inertia can only be inferred from binary STL meshes"));
    }
    let triangles = triangles(&read_bytes(path)?, scale).ok_or_else(|| wrong("not a binary STL file"))?;
    solid(&triangles).ok_or_else(|| wrong("the mesh encloses no volume"))
}

/// The triangles of a binary STL file; `None` if it is not one.
fn triangles(bytes: &[u8], scale: Vector3<f64>) -> Option<Vec<Triangle>> {
    let count: [u8; 4] = bytes.get(HEADER..HEADER + 4)?.try_into().ok()?;
    let count = usize::try_from(u32::from_le_bytes(count)).ok()?;
    let body = &bytes[HEADER + 4..];
    if count == 0 || body.len() != count.checked_mul(TRIANGLE)? {
        return None;
    }
    body.chunks_exact(TRIANGLE).map(|triangle| corners(triangle, scale)).collect()
}

fn corners(triangle: &[u8], scale: Vector3<f64>) -> Option<Triangle> {
    let number = |index: usize| {
        let start = 12 + 4 * index;
        let bytes: [u8; 4] = triangle.get(start..start + 4)?.try_into().ok()?;
        Some(f64::from(f32::from_le_bytes(bytes))).filter(|number| number.is_finite())
    };
    let corner = |index: usize| {
        let point = Vector3::new(number(3 * index)?, number(3 * index + 1)?, number(3 * index + 2)?);
        Some(point.component_mul(&scale))
    };
    Some([corner(0)?, corner(1)?, corner(2)?])
}

/// Mass properties as MuJoCo's default ("legacy") method defines them: the union of the pyramids over each triangle with
/// the centroid of the surface as apex, every pyramid counted as positive, so that badly oriented meshes work too.
fn solid(triangles: &[Triangle]) -> Option<Mesh> {
    let area_vector = |[a, b, c]: &Triangle| 0.5 * (b - a).cross(&(c - a));
    let centroid = |[a, b, c]: &Triangle| (a + b + c) / 3.0;
    let area: f64 = triangles.iter().map(|triangle| area_vector(triangle).norm()).sum();
    let weighted: Vector3<f64> = triangles.iter().map(|triangle| centroid(triangle) * area_vector(triangle).norm()).sum();
    let apex = weighted / area;
    let pyramid =
        |triangle: &Triangle, apex: &Vector3<f64>| ((centroid(triangle) - apex).dot(&area_vector(triangle)) / 3.0).abs();
    let volume: f64 = triangles.iter().map(|triangle| pyramid(triangle, &apex)).sum();
    if !(volume > 0.0 && volume.is_finite()) {
        return None;
    }
    let moment: Vector3<f64> =
        triangles.iter().map(|triangle| (0.75 * centroid(triangle) + 0.25 * apex) * pyramid(triangle, &apex)).sum();
    let centre = moment / volume;
    // Volume and second moments are those of the pyramids with that centre as apex, which on a surface that is not convex
    // differ a little from the first: V/20 (sum x xᵀ + (sum x)(sum x)ᵀ) each.
    let volume = triangles.iter().map(|triangle| pyramid(triangle, &centre)).sum();
    let mut second = Matrix3::zeros();
    for triangle in triangles {
        let about = triangle.map(|corner| corner - centre);
        let sum: Vector3<f64> = about.iter().sum();
        let squares: Matrix3<f64> = about.iter().map(|corner| corner * corner.transpose()).sum();
        second += (squares + sum * sum.transpose()) * (pyramid(triangle, &centre) / 20.0);
    }
    let (moments, axes) = principal(&(Matrix3::identity() * second.trace() - second));
    Some(Mesh { volume, centre, axes, moments })
}

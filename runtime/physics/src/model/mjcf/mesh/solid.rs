//! Mass properties of meshes.

use crate::model::Quaternion;
use crate::model::inertia::principal;
use nalgebra::{Matrix3, Vector3};

/// How a mesh counts as a solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::model::mjcf) enum Method {
    /// Pyramids over all triangles, each counted as positive.
    Legacy,
    /// Tetrahedra over all triangles with their signs: for closed, well-oriented surfaces. The hull's triangles give the
    /// convex method.
    Signed,
    /// A thin sheet.
    Shell,
}

/// Volume and its moments of a mesh filled with density one; of a sheet, area and its moments.
#[derive(Debug, Clone, Copy)]
pub(in crate::model::mjcf) struct SupportShape {
    /// m³, or m² of a sheet.
    pub volume: f64,
    /// Centre of mass in the source's frame, m.
    pub centre: Vector3<f64>,
    /// Principal axes in the source's frame.
    pub axes: Quaternion,
    /// Principal moments about the centre at density one, m⁵ (sheet: m⁴).
    pub moments: Vector3<f64>,
}

type Triangle = [Vector3<f64>; 3];

/// Measures the triangles; `None` if they enclose (or cover) nothing.
pub(in crate::model::mjcf) fn measure(triangles: &[Triangle], method: Method) -> Option<SupportShape> {
    match method {
        Method::Legacy => legacy(triangles),
        Method::Signed => signed(triangles),
        Method::Shell => shell(triangles),
    }
}

fn area_vector([a, b, c]: &Triangle) -> Vector3<f64> {
    0.5 * (b - a).cross(&(c - a))
}

fn centroid([a, b, c]: &Triangle) -> Vector3<f64> {
    (a + b + c) / 3.0
}

/// From the second moments about the centre to principal moments.
fn finish(volume: f64, centre: Vector3<f64>, second: Matrix3<f64>) -> Option<SupportShape> {
    if !(volume > 0.0 && volume.is_finite()) {
        return None;
    }
    let (moments, axes) = principal(&(Matrix3::identity() * second.trace() - second));
    Some(SupportShape { volume, centre, axes, moments })
}

/// Sum of x xᵀ over corners, and of x.
fn squares(corners: &Triangle) -> (Matrix3<f64>, Vector3<f64>) {
    (corners.iter().map(|corner| corner * corner.transpose()).sum(), corners.iter().sum())
}

/// Tetrahedra between the triangles and one apex: V/20 (sum x xᵀ + (sum x)(sum x)ᵀ) each.
fn signed(triangles: &[Triangle]) -> Option<SupportShape> {
    let apex = triangles.iter().map(centroid).sum::<Vector3<f64>>() / triangles.len().max(1) as f64;
    let volume_of = |triangle: &Triangle| (centroid(triangle) - apex).dot(&area_vector(triangle)) / 3.0;
    let volume: f64 = triangles.iter().map(volume_of).sum();
    let moment: Vector3<f64> =
        triangles.iter().map(|triangle| (0.75 * centroid(triangle) + 0.25 * apex) * volume_of(triangle)).sum();
    let centre = moment / volume;
    let second = triangles.iter().map(|triangle| {
        let (squares, sum) = squares(&triangle.map(|corner| corner - apex));
        (squares + sum * sum.transpose()) * (volume_of(triangle) / 20.0)
    });
    let offset = centre - apex;
    finish(volume, centre, second.sum::<Matrix3<f64>>() - offset * offset.transpose() * volume)
}

/// A sheet: A/12 (sum x xᵀ + (sum x)(sum x)ᵀ) for each triangle.
fn shell(triangles: &[Triangle]) -> Option<SupportShape> {
    let area: f64 = triangles.iter().map(|triangle| area_vector(triangle).norm()).sum();
    let moment: Vector3<f64> = triangles.iter().map(|triangle| centroid(triangle) * area_vector(triangle).norm()).sum();
    let centre = moment / area;
    let second = triangles.iter().map(|triangle| {
        let (squares, sum) = squares(&triangle.map(|corner| corner - centre));
        (squares + sum * sum.transpose()) * (area_vector(triangle).norm() / 12.0)
    });
    finish(area, centre, second.sum())
}

/// Mass properties as MuJoCo's default ("legacy") method defines them: the union of the pyramids over each triangle with
/// the centroid of the surface as apex, every pyramid counted as positive, so that badly oriented meshes work too.
fn legacy(triangles: &[Triangle]) -> Option<SupportShape> {
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
        let (squares, sum) = squares(&about);
        second += (squares + sum * sum.transpose()) * (pyramid(triangle, &centre) / 20.0);
    }
    finish(volume, centre, second)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of sides 2, 4, 6 around (1, 2, 3).
    fn cuboid() -> Vec<Triangle> {
        let corner = |k: usize| Vector3::new(2.0 * (k & 1) as f64, 4.0 * (k >> 1 & 1) as f64, 6.0 * (k >> 2 & 1) as f64);
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).map(|triangle| triangle.map(corner)).collect()
    }

    #[test]
    fn a_box_of_triangles_weighs_what_a_box_weighs() {
        for method in [Method::Legacy, Method::Signed] {
            let solid = measure(&cuboid(), method).unwrap();
            assert!((solid.volume - 48.0).abs() < 1e-12 && (solid.centre - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-12);
            let expected = Vector3::new(16.0 + 36.0, 4.0 + 36.0, 4.0 + 16.0) * 4.0;
            assert!((solid.moments - expected).norm() < 1e-10, "{method:?}: {}", solid.moments);
        }
        let sheet = measure(&cuboid(), Method::Shell).unwrap();
        assert!((sheet.volume - 88.0).abs() < 1e-12 && (sheet.centre - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-12);
    }
}

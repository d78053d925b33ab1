//! Mesh files: binary STL, Wavefront OBJ, MuJoCo's MSH.

use super::{ModelError, Source, wrong};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::path::Path;

/// Length of a binary STL file's free text, and of one of its triangles: normal, three corners, two bytes.
const HEADER: usize = 80;
const TRIANGLE: usize = 50;

/// Reads the bytes of a mesh file; its extension decides which kind it is.
pub(in crate::model::mjcf) fn read(path: &Path, bytes: &[u8]) -> Result<Source, ModelError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let (source, kind) = match extension.as_str() {
        "stl" => (stl(bytes), "a binary STL file"),
        "obj" => (core::str::from_utf8(bytes).ok().and_then(obj), "a readable OBJ file"),
        "msh" => (msh(bytes), "an MSH file of MuJoCo's older form"),
        _ => return Err(wrong(path, "meshes are read from binary STL, OBJ and MSH files; convert it to one of them")),
    };
    source.filter(Source::is_valid).ok_or_else(|| wrong(path, &format!("not {kind}")))
}

/// A number of a binary file; none where it is not finite.
fn float(bytes: &[u8], start: usize) -> Option<f64> {
    let bytes: [u8; 4] = bytes.get(start..start + 4)?.try_into().ok()?;
    Some(f64::from(f32::from_le_bytes(bytes))).filter(|number| number.is_finite())
}

fn count(bytes: &[u8], start: usize) -> Option<usize> {
    let bytes: [u8; 4] = bytes.get(start..start + 4)?.try_into().ok()?;
    usize::try_from(i32::from_le_bytes(bytes)).ok()
}

fn point(bytes: &[u8], start: usize) -> Option<Vector3<f64>> {
    Some(Vector3::new(float(bytes, start)?, float(bytes, start + 4)?, float(bytes, start + 8)?))
}

/// STL repeats corners; equal ones become one.
fn stl(bytes: &[u8]) -> Option<Source> {
    let triangles = count(bytes, HEADER)?;
    let body = &bytes[HEADER + 4..];
    if triangles == 0 || body.len() != triangles.checked_mul(TRIANGLE)? {
        return None;
    }
    let mut source = Source::default();
    let mut known = BTreeMap::new();
    for triangle in body.chunks_exact(TRIANGLE) {
        let mut corners = [0; 3];
        for (index, corner) in corners.iter_mut().enumerate() {
            let point = point(triangle, 12 + 12 * index)?;
            // Adding zero makes both zeros one.
            let key = [point.x + 0.0, point.y + 0.0, point.z + 0.0].map(f64::to_bits);
            *corner = *known.entry(key).or_insert_with(|| {
                source.vertices.push(point);
                source.vertices.len() - 1
            });
        }
        source.triangles.push(corners);
    }
    Some(source)
}

/// Corners (`v`) and polygons (`f`) of an OBJ file; everything else is appearance.
fn obj(text: &str) -> Option<Source> {
    let mut source = Source::default();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut number = || words.next()?.parse::<f32>().ok().map(f64::from).filter(|number| number.is_finite());
                source.vertices.push(Vector3::new(number()?, number()?, number()?));
            }
            Some("f") => {
                // Each corner is position/texture/normal, counted from one, or from the end if negative.
                let corner = |word: &str| {
                    let index = word.split('/').next()?.parse::<i64>().ok()?;
                    let index = if index < 0 { source.vertices.len() as i64 + index } else { index - 1 };
                    usize::try_from(index).ok()
                };
                let corners: Vec<usize> = words.map(corner).collect::<Option<_>>()?;
                let fan = (2..corners.len()).map(|index| [corners[0], corners[index - 1], corners[index]]);
                source.triangles.extend(fan);
            }
            _ => {}
        }
    }
    (!source.vertices.is_empty()).then_some(source)
}

/// Counts of corners, normals, texture coordinates and triangles, then the arrays.
fn msh(bytes: &[u8]) -> Option<Source> {
    let [corners, normals, textures, triangles] = [count(bytes, 0)?, count(bytes, 4)?, count(bytes, 8)?, count(bytes, 12)?];
    let indices = 16_usize.checked_add(corners.checked_add(normals)?.checked_mul(12)?)?.checked_add(textures.checked_mul(8)?)?;
    if corners < 4 || bytes.len() != indices.checked_add(triangles.checked_mul(12)?)? {
        return None;
    }
    let vertices = (0..corners).map(|index| point(bytes, 16 + 12 * index)).collect::<Option<_>>()?;
    let triangle = |index: usize| {
        let start = indices + 12 * index;
        Some([count(bytes, start)?, count(bytes, start + 4)?, count(bytes, start + 8)?])
    };
    Some(Source { vertices, triangles: (0..triangles).map(triangle).collect::<Option<_>>()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_become_triangles_and_negative_indices_count_from_the_end() {
        let source = obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n# a square\nf 1/1/1 2 3//2 -1\n").unwrap();
        assert_eq!(source.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(obj("v 0 0\n").is_none());
        assert!(!obj("v 0 0 0\nf 1 2 3\n").unwrap().is_valid());
    }

    #[test]
    fn equal_corners_of_an_stl_file_become_one() {
        let mut bytes = vec![0; HEADER];
        bytes.extend(2_u32.to_le_bytes());
        for corners in [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, -0.0]]]
        {
            bytes.extend([0; 12]);
            corners.concat().iter().for_each(|number: &f32| bytes.extend(number.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        let source = stl(&bytes).unwrap();
        assert_eq!((source.vertices.len(), source.triangles[1]), (4, [1, 3, 2]));
        assert!(stl(&bytes[..bytes.len() - 1]).is_none());
    }

    #[test]
    fn an_msh_file_has_exactly_the_length_its_counts_say() {
        let mut bytes: Vec<u8> = [4_i32, 0, 0, 1].into_iter().flat_map(i32::to_le_bytes).collect();
        bytes.extend((0..12).flat_map(|k| (k as f32).to_le_bytes()));
        bytes.extend([0_i32, 1, 3].into_iter().flat_map(i32::to_le_bytes));
        let source = msh(&bytes).unwrap();
        assert_eq!((source.vertices[3], source.triangles[0]), (Vector3::new(9.0, 10.0, 11.0), [0, 1, 3]));
        bytes.push(0);
        assert!(msh(&bytes).is_none());
    }
}

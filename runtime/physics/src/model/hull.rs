//! The convex hull of a mesh: triangles by parry's quickhull, flat neighbours joined to faces.

use super::mesh::{Face, Hull};
use nalgebra::Vector3;
use parry3d_f64::{math::Vector, transformation::try_convex_hull};
use std::collections::BTreeMap;

/// Triangles whose normals have at least this cosine are one face: the rounding of meshes to single precision tilts the parts
/// of a flat face by less.
const FLAT: f64 = 1.0 - 1e-6;
/// Points of a hull lie behind all its faces, up to this share of its size.
const CONVEX: f64 = 1e-5;
/// The thinnest hull, as a share of the cube of its size.
const THINNEST: f64 = 1e-12;

impl Hull {
    /// The hull of some points; `None` if they lie in a plane, or are too irregular to tell.
    pub(crate) fn of(points: &[Vector3<f64>]) -> Option<Self> {
        if !is_solid(points) {
            return None;
        }
        let to: Vec<Vector> = points.iter().map(|point| Vector::new(point.x, point.y, point.z)).collect();
        let (vertices, triangles) = try_convex_hull(&to).ok()?;
        let vertices: Vec<_> = vertices.iter().map(|vertex| Vector3::new(vertex.x, vertex.y, vertex.z)).collect();
        let triangles: Vec<[usize; 3]> = triangles.iter().map(|triangle| triangle.map(|corner| corner as usize)).collect();
        // Before parts that are all but flat are joined: on those, a point may lie before the mean plane.
        if !is_convex(&vertices, &triangles, points) {
            return None;
        }
        let mut hull = Self { vertices, ..Self::default() };
        let loops = flat_parts(&hull.vertices, &triangles).or_else(|| Some(triangles.iter().map(|t| t.to_vec()).collect()))?;
        for corners in loops {
            hull.push(&corners)?;
        }
        hull.close();
        Some(hull)
    }

    fn push(&mut self, corners: &[usize]) -> Option<()> {
        let area = area_vector(&self.vertices, corners);
        let start = self.corners.len();
        self.corners.extend_from_slice(corners);
        self.faces.push(Face { normal: area.try_normalize(0.0)?, corners: start..self.corners.len() });
        Some(())
    }

    /// Lists the faces around each corner.
    fn close(&mut self) {
        let mut around = vec![Vec::new(); self.vertices.len()];
        for face in 0..self.faces.len() {
            for &corner in self.corners_of(face) {
                around[corner].push(face);
            }
        }
        for faces in around {
            let start = self.incident.len();
            self.incident.extend(faces);
            self.around.push(start..self.incident.len());
        }
    }

    /// The surface as triangles, counter-clockwise from outside.
    pub(crate) fn triangles(&self) -> Vec<[usize; 3]> {
        let fan = |face: usize| {
            let corners = self.corners_of(face);
            (2..corners.len()).map(move |index| [corners[0], corners[index - 1], corners[index]])
        };
        (0..self.faces.len()).flat_map(fan).collect()
    }
}

/// Whether all points lie behind all triangles; needles without a normal hide nothing.
fn is_convex(vertices: &[Vector3<f64>], triangles: &[[usize; 3]], points: &[Vector3<f64>]) -> bool {
    let allowed = CONVEX * extent(points);
    triangles.iter().all(|triangle| {
        let Some(normal) = area_vector(vertices, triangle).try_normalize(0.0) else { return true };
        let offset = normal.dot(&vertices[triangle[0]]) + allowed;
        points.iter().all(|point| normal.dot(point) <= offset)
    })
}

/// Largest side of the box around some points.
fn extent(points: &[Vector3<f64>]) -> f64 {
    let first = points.first().copied().unwrap_or_default();
    let (low, high) = points.iter().fold((first, first), |(low, high), point| (low.inf(point), high.sup(point)));
    (high - low).amax()
}

/// Whether four of the points span a volume: each the farthest from those before.
fn is_solid(points: &[Vector3<f64>]) -> bool {
    let farthest = |measure: &dyn Fn(&Vector3<f64>) -> f64| {
        points.iter().fold((0.0, Vector3::zeros()), |best, point| {
            let found = measure(point);
            if found > best.0 { (found, *point) } else { best }
        })
    };
    let Some(&a) = points.first() else { return false };
    let (_, b) = farthest(&|point| (point - a).norm());
    let (_, c) = farthest(&|point| (point - a).cross(&(b - a)).norm());
    let normal = (b - a).cross(&(c - a));
    let (volume, _) = farthest(&|point| (point - a).dot(&normal).abs());
    let size = extent(points);
    points.iter().all(|point| point.iter().all(|x| x.is_finite())) && volume > THINNEST * size * size * size
}

/// Twice the area of a polygon along its normal.
fn area_vector(vertices: &[Vector3<f64>], corners: &[usize]) -> Vector3<f64> {
    let origin = vertices[corners[0]];
    (2..corners.len()).map(|index| (vertices[corners[index - 1]] - origin).cross(&(vertices[corners[index]] - origin))).sum()
}

/// Joins flat neighbours; each part as the loop of its corners. `None` if a part's rim is not one loop.
fn flat_parts(vertices: &[Vector3<f64>], triangles: &[[usize; 3]]) -> Option<Vec<Vec<usize>>> {
    let edges = |[a, b, c]: [usize; 3]| [[a, b], [b, c], [c, a]];
    let mut owner = BTreeMap::new();
    for (index, &triangle) in triangles.iter().enumerate() {
        edges(triangle).into_iter().for_each(|edge| {
            owner.insert(edge, index);
        });
    }
    let normals: Vec<Option<Vector3<f64>>> =
        triangles.iter().map(|triangle| area_vector(vertices, triangle).try_normalize(0.0)).collect();
    let mut part = vec![usize::MAX; triangles.len()];
    let mut loops = Vec::new();
    for start in 0..triangles.len() {
        if part[start] != usize::MAX {
            continue;
        }
        part[start] = start;
        let (mut members, mut rim) = (vec![start], BTreeMap::new());
        let mut next = 0;
        while let Some(&member) = members.get(next) {
            next += 1;
            for [from, to] in edges(triangles[member]) {
                let &neighbour = owner.get(&[to, from])?;
                // A needle without a normal joins any neighbour.
                let flat = match (normals[start], normals[neighbour]) {
                    (Some(a), Some(b)) => a.dot(&b) > FLAT,
                    _ => true,
                };
                if part[neighbour] == usize::MAX && flat {
                    part[neighbour] = start;
                    members.push(neighbour);
                }
            }
        }
        for &member in &members {
            for [from, to] in edges(triangles[member]) {
                if owner.get(&[to, from]).is_some_and(|&neighbour| part[neighbour] != start) && rim.insert(from, to).is_some() {
                    return None;
                }
            }
        }
        let (&first, _) = rim.first_key_value()?;
        let (mut corners, mut at) = (vec![first], *rim.get(&first)?);
        while at != first {
            if corners.len() > rim.len() {
                return None;
            }
            corners.push(at);
            at = *rim.get(&at)?;
        }
        if corners.len() != rim.len() {
            return None;
        }
        loops.push(corners);
    }
    Some(loops)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_with_points_on_its_faces_has_six_faces_of_four_corners() {
        let mut points = Vec::new();
        for k in 0..125 {
            points.push(Vector3::new((k % 5) as f64, (k / 5 % 5) as f64, (k / 25) as f64) - Vector3::repeat(2.0));
        }
        let hull = Hull::of(&points).unwrap();
        assert_eq!((hull.vertices.len(), hull.faces.len(), hull.corners.len()), (8, 6, 24));
        for vertex in 0..8 {
            assert_eq!(hull.faces_around(vertex).len(), 3);
        }
        let up = hull.facing(hull.support_point(Vector3::new(0.1, 0.2, 1.0)), Vector3::z()).unwrap();
        assert!((hull.faces[up].normal - Vector3::z()).norm() < 1e-14);
    }

    #[test]
    fn a_slightly_domed_plate_has_a_hull() {
        // Neighbouring facets of the dome tilt by a milliradian: they are joined, and points lie before the joined faces.
        let corners = |k: i32| {
            let (x, y) = (f64::from(k % 9 - 4) * 0.1, f64::from(k / 9 - 4) * 0.1);
            [Vector3::new(x, y, -0.1), Vector3::new(x, y, 0.1 - 0.004 * (x * x + y * y))]
        };
        let points: Vec<_> = (0..81).flat_map(corners).collect();
        let hull = Hull::of(&points).unwrap();
        let highest = hull.vertices[hull.support_point(Vector3::z())];
        assert_eq!(highest, Vector3::new(0.0, 0.0, 0.1));
        assert!(hull.faces.len() < 60, "{} faces", hull.faces.len());
    }

    #[test]
    fn a_flat_cloud_has_no_hull() {
        let points: Vec<_> = (0..9).map(|k| Vector3::new(f64::from(k % 3), f64::from(k / 3), 0.0)).collect();
        assert!(Hull::of(&points).is_none());
    }
}

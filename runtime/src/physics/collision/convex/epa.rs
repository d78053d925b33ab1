//! How deep two convex cores overlap.
//!
//! The depth is the distance from the origin to the surface of the cores' difference. A polytope inside the difference grows
//! where its surface is nearest to the origin, until the difference reaches no farther there.

use super::solid::{Solid, Vertex, farthest};
use nalgebra::Vector3;

/// Corners at most: smooth shapes reach the precision with some tens.
const MOST_VERTICES: usize = 256;
/// A face is part of the surface when the difference reaches no farther than this share of the shapes' size.
const PRECISION: f64 = 1e-14;

/// Memory of the search, kept between calls.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    vertices: Vec<Vertex>,
    faces: Vec<Face>,
    horizon: Vec<[usize; 2]>,
}

#[derive(Debug, Clone, Copy)]
struct Face {
    corners: [usize; 3],
    /// Outward unit normal.
    normal: Vector3<f64>,
    /// Of its plane from the origin.
    offset: f64,
}

/// The least translation that separates two overlapping cores.
#[derive(Debug, Clone, Copy)]
pub(super) struct Depth {
    /// Its length, m.
    pub depth: f64,
    /// Its direction for the second core.
    pub normal: Vector3<f64>,
    /// Deepest points of both cores.
    pub points: [Vector3<f64>; 2],
}

/// The depth of the overlap of two cores.
pub(super) fn depth(first: &Solid<'_>, second: &Solid<'_>, scratch: &mut Scratch) -> Depth {
    let scale = first.scale() + second.scale();
    let mut best = begin(first, second, scratch);
    while let Some(face) = best {
        let Face { normal, offset, .. } = scratch.faces[face];
        let vertex = farthest(first, second, normal);
        let gain = vertex.point.dot(&normal) - offset;
        if gain <= PRECISION * scale || scratch.vertices.len() >= MOST_VERTICES || !scratch.grow(vertex, scale) {
            return scratch.depth_at(face);
        }
        best = scratch.nearest();
    }
    // Cores without volume, such as two segments in one plane: no face to leave through.
    let points = [first.position, second.position];
    Depth { depth: 0.0, normal: (points[1] - points[0]).try_normalize(0.0).unwrap_or_else(Vector3::z), points }
}

/// Starts with a tetrahedron of farthest points; the index of its nearest face, or `None` if the difference is flat.
fn begin(first: &Solid<'_>, second: &Solid<'_>, scratch: &mut Scratch) -> Option<usize> {
    scratch.vertices.clear();
    scratch.faces.clear();
    let find = |direction: Vector3<f64>| farthest(first, second, direction);
    let a = find(Vector3::x());
    let b = find(-Vector3::x());
    let along = b.point - a.point;
    let across =
        |direction: Vector3<f64>| direction - along * (direction.dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE));
    let c = widest(a.point, [Vector3::y(), Vector3::z(), -Vector3::y(), -Vector3::z()].map(|axis| find(across(axis))), |point| {
        (point - a.point).cross(&along).norm_squared()
    });
    let normal = along.cross(&(c.point - a.point));
    let d = widest(a.point, [normal, -normal, normal, -normal].map(find), |point| (point - a.point).dot(&normal).abs());
    let volume = (d.point - a.point).dot(&normal);
    if volume == 0.0 || !volume.is_finite() {
        return None;
    }
    scratch.vertices.extend([a, b, c, d]);
    let corners =
        if volume > 0.0 { [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] } else { [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]] };
    for face in corners {
        let face = scratch.face(face)?;
        scratch.faces.push(face);
    }
    scratch.nearest()
}

/// The candidate for which `measure` is largest, the first of several.
fn widest(_from: Vector3<f64>, candidates: [Vertex; 4], measure: impl Fn(Vector3<f64>) -> f64) -> Vertex {
    candidates
        .into_iter()
        .reduce(|best, next| if measure(next.point) > measure(best.point) { next } else { best })
        .unwrap_or(candidates[0])
}

impl Scratch {
    fn face(&self, corners: [usize; 3]) -> Option<Face> {
        let [a, b, c] = corners.map(|corner| self.vertices[corner].point);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
        // The corner nearest to the origin gives the offset with the smallest rounding error.
        let nearest =
            [a, b, c].into_iter().reduce(|best, next| if next.norm_squared() < best.norm_squared() { next } else { best });
        Some(Face { corners, normal, offset: normal.dot(&nearest?) })
    }

    /// The face whose plane is nearest to the origin, on its inner side.
    fn nearest(&self) -> Option<usize> {
        let mut best: Option<usize> = None;
        for (index, face) in self.faces.iter().enumerate() {
            if best.is_none_or(|best| face.offset < self.faces[best].offset) {
                best = Some(index);
            }
        }
        best
    }

    /// Takes a corner in: the faces that see it give way to faces between it and their rim. Leaves everything as it was
    /// and returns false where rounding keeps the rim from being one closed line.
    fn grow(&mut self, vertex: Vertex, scale: f64) -> bool {
        let sees = |face: &Face| face.normal.dot(&vertex.point) - face.offset > 0.1 * PRECISION * scale;
        self.horizon.clear();
        for face in self.faces.iter().filter(|face| sees(face)) {
            let [a, b, c] = face.corners;
            for edge in [[a, b], [b, c], [c, a]] {
                match self.horizon.iter().position(|&[from, to]| [to, from] == edge) {
                    Some(twin) => {
                        self.horizon.swap_remove(twin);
                    }
                    None => self.horizon.push(edge),
                }
            }
        }
        if !closed(&self.horizon) {
            return false;
        }
        let corner = self.vertices.len();
        self.vertices.push(vertex);
        let kept = self.faces.len();
        for index in 0..self.horizon.len() {
            let [from, to] = self.horizon[index];
            match self.face([from, to, corner]) {
                Some(face) => self.faces.push(face),
                None => {
                    self.faces.truncate(kept);
                    self.vertices.pop();
                    return false;
                }
            }
        }
        let mut index = 0;
        self.faces.retain(|face| {
            index += 1;
            index > kept || !sees(face)
        });
        true
    }

    /// The depth at a face: the origin's projection on it, between its corners.
    fn depth_at(&self, face: usize) -> Depth {
        let Face { corners, normal, offset } = self.faces[face];
        let vertices = corners.map(|corner| self.vertices[corner]);
        let foot = normal * offset;
        let [a, b, c] = vertices.map(|vertex| vertex.point - foot);
        let areas = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|area| area.dot(&normal).max(0.0));
        let total: f64 = areas.iter().sum();
        let weights = if total > 0.0 { areas.map(|area| area / total) } else { [1.0, 0.0, 0.0] };
        let on = |side: usize| vertices.iter().zip(weights).map(|(vertex, weight)| vertex.on[side] * weight).sum();
        Depth { depth: offset, normal, points: [on(0), on(1)] }
    }
}

/// Whether the edges make one closed line.
fn closed(edges: &[[usize; 2]]) -> bool {
    let Some(&[start, mut at]) = edges.first() else { return false };
    let mut steps = 1;
    while at != start {
        let Some(&[_, to]) = edges.iter().find(|[from, _]| *from == at) else { return false };
        at = to;
        steps += 1;
        if steps > edges.len() {
            return false;
        }
    }
    steps == edges.len()
}

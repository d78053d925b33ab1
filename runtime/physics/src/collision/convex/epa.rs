//! How deep two convex cores overlap.
//!
//! The depth is the distance from the origin to the surface of the cores' difference. A polytope inside the difference grows
//! where its surface is nearest to the origin, until the difference reaches no farther there.
//!
//! On which side of a face a corner lies is decided by exact predicates (Shewchuk 1997): many corners of the difference share
//! planes and lines up to rounding, and decisions that contradict each other would tear the surface.

use super::support::{SupportShape, Vertex, support_point};
use crate::scalar::Real;
use nalgebra::Vector3;
use robust::{Coord3D, orient3d};

/// Corners at most: smooth shapes reach the precision with some tens.
const MOST_VERTICES: usize = 256;
/// A face is part of the surface when the difference reaches no farther than this share of the shapes' size.
const PRECISION: f64 = 1e-14;
/// Faces this close to the nearest one, as a share of the shapes' size, are level with it.
const LEVEL: f64 = 1e-11;

/// A polytope inside the difference, in memory kept between calls.
#[derive(Debug, Clone, Default)]
pub(super) struct Polytope {
    vertices: Vec<Vertex>,
    faces: Vec<Face>,
    seen: Vec<usize>,
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
pub(super) fn depth(first: &SupportShape<'_>, second: &SupportShape<'_>, polytope: &mut Polytope) -> Depth {
    let scale = first.scale() + second.scale();
    let mut best = begin(first, second, polytope);
    while let Some(face) = best {
        let Face { normal, offset, .. } = polytope.faces[face];
        let vertex = support_point(first, second, normal);
        let gain = vertex.point.dot(&normal) - offset;
        if gain <= PRECISION * scale || polytope.vertices.len() >= MOST_VERTICES {
            return deepest(first, second, polytope.depth_at(face, scale));
        }
        if !polytope.expand(face, vertex) {
            if gain <= LEVEL * scale {
                return deepest(first, second, polytope.depth_at(face, scale));
            }
            // A needle, whose normal is mere rounding: it looks where its neighbours do, or what lies there is theirs.
            let beyond = support_point(first, second, polytope.around(face));
            if !polytope.expand(face, beyond) {
                polytope.faces[face].offset = f64::INFINITY;
            }
        }
        best = polytope.nearest();
    }
    // Cores without volume, such as two segments in one plane: no face to leave through.
    let points = [first.position, second.position];
    Depth { depth: 0.0, normal: (points[1] - points[0]).try_normalize(0.0).unwrap_or_else(Vector3::z), points }
}

/// The depth with its points made exact: where only one point of a core is deepest it is known, and the other lies across.
fn deepest(first: &SupportShape<'_>, second: &SupportShape<'_>, found: Depth) -> Depth {
    let Depth { depth, normal, .. } = found;
    let points = if first.has_one_support_point(normal) {
        let point = first.support_point(normal);
        [point, point - normal * depth]
    } else if second.has_one_support_point(-normal) {
        let point = second.support_point(-normal);
        [point + normal * depth, point]
    } else {
        found.points
    };
    Depth { points, ..found }
}

/// Starts with a tetrahedron of farthest points; the index of its nearest face, or `None` if the difference is flat.
fn begin(first: &SupportShape<'_>, second: &SupportShape<'_>, polytope: &mut Polytope) -> Option<usize> {
    polytope.vertices.clear();
    polytope.faces.clear();
    let find = |direction: Vector3<f64>| support_point(first, second, direction);
    let a = find(Vector3::x());
    let b = find(-Vector3::x());
    let along = b.point - a.point;
    let across =
        |direction: Vector3<f64>| direction - along * (direction.dot(&along) / along.norm_squared().at_least(f64::MIN_POSITIVE));
    let c = widest([Vector3::y(), Vector3::z(), -Vector3::y(), -Vector3::z()].map(|axis| find(across(axis))), |point| {
        (point - a.point).cross(&along).norm_squared()
    });
    let normal = along.cross(&(c.point - a.point));
    let d = widest([normal, -normal, normal, -normal].map(find), |point| (point - a.point).dot(&normal).abs());
    let volume = (d.point - a.point).dot(&normal);
    if volume == 0.0 || !volume.is_finite() {
        return None;
    }
    polytope.vertices.extend([a, b, c, d]);
    let corners =
        if volume > 0.0 { [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] } else { [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]] };
    for face in corners {
        let face = polytope.face(face);
        polytope.faces.push(face);
    }
    polytope.nearest()
}

/// The candidate for which `measure` is largest, the first of several.
fn widest(candidates: [Vertex; 4], measure: impl Fn(Vector3<f64>) -> f64) -> Vertex {
    candidates
        .into_iter()
        .reduce(|best, next| if measure(next.point) > measure(best.point) { next } else { best })
        .unwrap_or(candidates[0])
}

impl Polytope {
    /// A face between three corners; one whose area vanishes in rounding is never the nearest.
    fn face(&self, corners: [usize; 3]) -> Face {
        let [a, b, c] = corners.map(|corner| self.vertices[corner].point);
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else {
            return Face { corners, normal: Vector3::zeros(), offset: f64::INFINITY };
        };
        // The corner nearest to the origin gives the offset with the smallest rounding error.
        let nearer = |best: Vector3<f64>, next: Vector3<f64>| if next.norm_squared() < best.norm_squared() { next } else { best };
        Face { corners, normal, offset: normal.dot(&nearer(nearer(a, b), c)) }
    }

    /// The face whose plane is nearest to the origin, on its inner side.
    fn nearest(&self) -> Option<usize> {
        let mut best: Option<usize> = None;
        for (index, face) in self.faces.iter().enumerate() {
            if face.offset < best.map_or(f64::INFINITY, |best: usize| self.faces[best].offset) {
                best = Some(index);
            }
        }
        best
    }

    /// The sum of the normals of a face's neighbours.
    fn around(&self, face: usize) -> Vector3<f64> {
        let [a, b, c] = self.faces[face].corners;
        let across = |edge: [usize; 2]| self.faces.iter().find(move |other| has_edge(other.corners, edge));
        [[b, a], [c, b], [a, c]].into_iter().filter_map(across).map(|other| other.normal).sum()
    }

    /// Whether a face looks towards a point: 1 towards it, 0 along itself, -1 away.
    fn visibility(&self, face: usize, point: &Vector3<f64>) -> i8 {
        let exact = |point: &Vector3<f64>| Coord3D { x: point.x, y: point.y, z: point.z };
        let [a, b, c] = self.faces[face].corners.map(|corner| exact(&self.vertices[corner].point));
        let side = orient3d(a, b, c, exact(point));
        i8::from(side < 0.0) - i8::from(side > 0.0)
    }

    /// Takes in a corner beyond `face`: the faces around it that see the corner, even along themselves, give way to faces
    /// between it and their rim. Leaves everything as it was and returns false where the corner is not beyond the face.
    fn expand(&mut self, face: usize, vertex: Vertex) -> bool {
        if self.visibility(face, &vertex.point) < 1 {
            return false;
        }
        self.seen.clear();
        self.seen.push(face);
        self.horizon.clear();
        let mut next = 0;
        while let Some(&member) = self.seen.get(next) {
            next += 1;
            let [a, b, c] = self.faces[member].corners;
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let across = self.faces.iter().position(|other| has_edge(other.corners, [to, from]));
                let Some(across) = across else { return false };
                if self.seen.contains(&across) {
                    continue;
                }
                if self.visibility(across, &vertex.point) >= 0 {
                    self.seen.push(across);
                } else {
                    self.horizon.push([from, to]);
                }
            }
        }
        // A face seen later may lie across an edge already on the rim.
        let Self { seen, horizon, faces, .. } = self;
        horizon.retain(|&[from, to]| {
            let across = faces.iter().position(|other| has_edge(other.corners, [to, from]));
            across.is_none_or(|across| !seen.contains(&across))
        });
        if !closed(horizon) {
            return false;
        }
        let corner = self.vertices.len();
        self.vertices.push(vertex);
        for index in 0..self.horizon.len() {
            let [from, to] = self.horizon[index];
            let face = self.face([from, to, corner]);
            self.faces.push(face);
        }
        let (mut index, seen) = (0, &self.seen);
        self.faces.retain(|_| {
            index += 1;
            !seen.contains(&(index - 1))
        });
        true
    }

    /// The depth at a face: the origin's projection on it, between its corners. A flat part of the surface is made of several
    /// faces, of which one holds the projection.
    fn depth_at(&self, face: usize, scale: f64) -> Depth {
        let Face { normal, offset, .. } = self.faces[face];
        let foot = normal * offset;
        let areas = |face: &Face| {
            let [a, b, c] = face.corners.map(|corner| self.vertices[corner].point - foot);
            [b.cross(&c), c.cross(&a), a.cross(&b)].map(|area| area.dot(&face.normal))
        };
        // How far the projection is inside a face, as a share of its area; negative outside.
        let inside = |face: &Face| {
            let areas = areas(face);
            areas.iter().fold(f64::INFINITY, |least, area| least.at_most(*area)) / areas.iter().sum::<f64>()
        };
        let mut best = (face, inside(&self.faces[face]));
        for (index, other) in self.faces.iter().enumerate() {
            if other.offset - offset <= LEVEL * scale && other.normal.dot(&normal) > 0.5 {
                let share = inside(other);
                if share > best.1 && best.1 < 0.0 {
                    best = (index, share);
                }
            }
        }
        let holder = &self.faces[best.0];
        let areas = areas(holder).map(|area| area.at_least(0.0));
        let total: f64 = areas.iter().sum();
        let weights = if total > 0.0 { areas.map(|area| area / total) } else { [1.0, 0.0, 0.0] };
        let vertices = holder.corners.map(|corner| self.vertices[corner]);
        let on = |side: usize| vertices.iter().zip(weights).map(|(vertex, weight)| vertex.on[side] * weight).sum();
        Depth { depth: offset, normal, points: [on(0), on(1)] }
    }
}

/// Whether a face has an edge in this sense.
fn has_edge([a, b, c]: [usize; 3], edge: [usize; 2]) -> bool {
    edge == [a, b] || edge == [b, c] || edge == [c, a]
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

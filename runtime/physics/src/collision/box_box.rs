//! Two boxes: the direction in which they overlap least, and the region where they touch.
//!
//! 1. Two boxes are apart along one of 15 directions or not at all: three face normals of each, and the nine directions
//!    across an edge of both (Gottschalk, Lin and Manocha 1996);
//! 2. where a face's normal decides, the facing face of the other box is cut by the sides of that face, and every corner that
//!    remains below it is a contact: up to eight;
//! 3. where two edges decide, they touch in one point. A direction across edges that nearly is a face's normal must win
//!    clearly, since one point holds a box less well than the face would.

use super::{ContactPoint, frame_of, place::Placed, polygon::Polygon};
use crate::scalar::Real;
use nalgebra::{Matrix3, Vector3};

/// A direction across edges counts as a face's normal from this cosine on, MuJoCo 4.0.0's.
const LIKE_A_FACE: f64 = 0.99;
/// It then wins if the overlap along it is less than this share of that along the normal.
const CLEARLY_LESS: f64 = 0.95;

/// Which direction decides.
#[derive(Clone, Copy)]
enum Decider {
    /// A face of the first or second box: its axis.
    Face { of_first: bool, axis: usize },
    /// An edge of each box: their axes.
    Edges(usize, usize),
}

/// Box against box.
pub(super) fn collide(first: &Placed<'_>, second: &Placed<'_>, reach: f64, polygon: &mut Polygon, found: &mut Vec<ContactPoint>) {
    let between = second.position - first.position;
    // Overlap along a unit normal, and the normal turned from the first box to the second.
    let along = |normal: Vector3<f64>| {
        let centres = normal.dot(&between);
        let normal = if centres < 0.0 { -normal } else { normal };
        (extent(first, normal) + extent(second, normal) - centres.abs(), normal)
    };
    let mut face: Option<(f64, Vector3<f64>, Decider)> = None;
    for axis in 0..3 {
        for (of_first, shape) in [(true, first), (false, second)] {
            let (overlap, normal) = along(shape.rotation.column(axis).into_owned());
            if overlap < -reach {
                return;
            }
            if face.is_none_or(|(least, ..)| overlap < least) {
                face = Some((overlap, normal, Decider::Face { of_first, axis }));
            }
        }
    }
    let mut edges: Option<(f64, Vector3<f64>, Decider)> = None;
    for i in 0..3 {
        for j in 0..3 {
            let across = first.rotation.column(i).cross(&second.rotation.column(j));
            let Some(across) = across.try_normalize(1e-15) else { continue };
            let (overlap, normal) = along(across);
            if overlap < -reach {
                return;
            }
            if edges.is_none_or(|(least, ..)| overlap < least) {
                edges = Some((overlap, normal, Decider::Edges(i, j)));
            }
        }
    }
    let Some(face) = face else { return };
    let (overlap, normal, decider) = match edges {
        Some(edges) if edges.0 < face.0 * (1.0 - 1e-12) => {
            let like_a_face = edges.1.dot(&face.1).abs() > LIKE_A_FACE;
            // Of boxes apart, whose overlap is negative, the edges' distance must be as clearly the larger.
            let bound = face.0 - (1.0 - CLEARLY_LESS) * face.0.abs();
            if like_a_face && edges.0 >= bound { face } else { edges }
        }
        _ => face,
    };
    match decider {
        Decider::Edges(i, j) => {
            let position = crossing(first, i, second, j, normal);
            found.push(ContactPoint { distance: -overlap, position, frame: frame_of(normal, None) });
        }
        Decider::Face { of_first: true, axis } => faces([first, second], axis, normal, 1.0, reach, polygon, found),
        Decider::Face { of_first: false, axis } => faces([second, first], axis, -normal, -1.0, reach, polygon, found),
    }
}

/// How far a box reaches from its centre along a unit normal.
fn extent(shape: &Placed<'_>, normal: Vector3<f64>) -> f64 {
    shape.rotation.tr_mul(&normal).abs().dot(&shape.size)
}

/// Half way between the nearest points of an edge along axis `i` of the first box and one along axis `j` of the second, each
/// the outermost along the normal between them. Of boxes apart the nearest points of the lines may lie beyond the edges' ends.
fn crossing(first: &Placed<'_>, i: usize, second: &Placed<'_>, j: usize, normal: Vector3<f64>) -> Vector3<f64> {
    let middle = |shape: &Placed<'_>, axis: usize, outward: Vector3<f64>| {
        let mut corner = shape.size.zip_map(&shape.rotation.tr_mul(&outward), f64::copysign);
        corner[axis] = 0.0;
        shape.position + shape.rotation * corner
    };
    let (p, q) = (middle(first, i, normal), middle(second, j, -normal));
    let (u, v) = (first.rotation.column(i).into_owned(), second.rotation.column(j).into_owned());
    let across = u.cross(&v);
    let square = across.norm_squared();
    let mut on_first = (q - p).cross(&v).dot(&across) / square;
    let mut on_second = (q - p).cross(&u).dot(&across) / square;
    let [half_first, half_second] = [first.size[i], second.size[j]];
    if on_first.abs() > half_first {
        on_first = on_first.clip(-half_first, half_first);
        on_second = (p + u * on_first - q).dot(&v);
    }
    if on_second.abs() > half_second {
        on_second = on_second.clip(-half_second, half_second);
        on_first = (q + v * on_second - p).dot(&u).clip(-half_first, half_first);
    }
    (p + u * on_first + q + v * on_second) * 0.5
}

/// A face of one box, with the outward `normal` along its `axis`, against the facing face of another.
fn faces(
    [one, other]: [&Placed<'_>; 2],
    axis: usize,
    normal: Vector3<f64>,
    sense: f64,
    reach: f64,
    polygon: &mut Polygon,
    found: &mut Vec<ContactPoint>,
) {
    facing(other, normal, polygon);
    let centre = one.position;
    for side in [(axis + 1) % 3, (axis + 2) % 3] {
        let across = one.rotation.column(side).into_owned();
        for outward in [across, -across] {
            polygon.clip(outward, outward.dot(&centre) + one.size[side]);
        }
    }
    let surface = normal.dot(&centre) + one.size[axis];
    let frame: Matrix3<f64> = frame_of(normal * sense, None);
    for corner in &polygon.corners {
        let distance = normal.dot(corner) - surface;
        if distance <= reach {
            found.push(ContactPoint { distance, position: corner - normal * (distance / 2.0), frame });
        }
    }
}

/// The face of a box that looks most against a normal.
fn facing(shape: &Placed<'_>, normal: Vector3<f64>, polygon: &mut Polygon) {
    let local = shape.rotation.tr_mul(&normal);
    let (axis, _) = local.abs().argmax();
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    polygon.corners.clear();
    for [x, y] in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
        let mut corner = Vector3::zeros();
        corner[axis] = -shape.size[axis].copysign(local[axis]);
        (corner[u], corner[v]) = (x * shape.size[u], y * shape.size[v]);
        polygon.corners.push(shape.position + shape.rotation * corner);
    }
}

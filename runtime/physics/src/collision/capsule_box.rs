//! Capsule against box.
//!
//! The capsule's segment is nearest to the box with one of its ends over a face (or inside), or somewhere over an edge or
//! corner. A ball there gives the first contact. Where the segment runs on along the box from there, a second ball as far along
//! as the box reaches gives the other, so that a capsule lying on a box rests on two points.

use super::{ContactPoint, place::Placed, round::ball_box, shapes::TINY};
use crate::scalar::Real;
use nalgebra::Vector3;

/// What the segment is nearest to.
#[derive(Debug, Clone, Copy)]
enum Nearest {
    /// One end (sense 1 or -1) is over a face with this axis, or inside the box.
    Face { sense: f64, axis: Option<usize> },
    /// A corner of the box, by its signs; or the inner part of an edge that the search reached over this corner, which counts
    /// the same in MuJoCo 4.0.0.
    Corner([bool; 3]),
    /// The inner part of an edge along an axis, by the signs of the others; the place on it from -1 to 1.
    Edge { axis: usize, signs: [bool; 3], place: f64 },
}

/// Capsule against box.
pub(super) fn collide(capsule: &Placed<'_>, cuboid: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let (radius, half) = (capsule.size.x, capsule.size.y);
    let centre = cuboid.local(capsule.position);
    let arm = cuboid.rotation.tr_mul(&(capsule.axis() * half));
    let size = cuboid.size;
    let Some((first, nearest)) = nearest(centre, arm, size) else { return };
    let along = |place: f64| capsule.position + capsule.axis() * (half * place);
    found.extend(ball_box(along(first), radius, cuboid, reach));
    if let Some(step) = onwards(centre, arm, size, first, nearest) {
        found.extend(ball_box(along(first + step), radius, cuboid, reach));
    }
}

/// The place on the segment, from -1 to 1, that is nearest to the box, and to what of it.
fn nearest(centre: Vector3<f64>, arm: Vector3<f64>, size: Vector3<f64>) -> Option<(f64, Nearest)> {
    let mut best: Option<(f64, f64, Nearest)> = None;
    for sense in [-1.0, 1.0] {
        let end = centre + arm * sense;
        let outside: [bool; 3] = core::array::from_fn(|axis| end[axis].abs() > size[axis]);
        if outside.iter().filter(|outside| **outside).count() > 1 {
            continue;
        }
        let square = (end - end.zip_map(&size, |x, half| x.clip(-half, half))).norm_squared();
        if best.is_none_or(|(least, ..)| square < least) {
            best = Some((square, sense, Nearest::Face { sense, axis: outside.iter().position(|outside| *outside) }));
        }
    }
    for axis in 0..3 {
        for corner in 0..8 {
            if corner >> axis & 1 == 1 {
                continue;
            }
            let mut signs: [bool; 3] = core::array::from_fn(|bit| corner >> bit & 1 == 1);
            let mut middle = size.zip_map(&Vector3::from(signs), |half, positive| if positive { half } else { -half });
            middle[axis] = 0.0;
            let Some(Closest { on_edge, on_segment, over }) = closest(middle - centre, size[axis], axis, arm) else { continue };
            let mut point = middle;
            point[axis] = on_edge * size[axis];
            let square = (centre + arm * on_segment - point).norm_squared();
            if best.is_none_or(|(least, ..)| square < least - TINY) {
                let nearest = match over {
                    Some(end) => {
                        signs[axis] = end > 0.0;
                        Nearest::Corner(signs)
                    }
                    None => Nearest::Edge { axis, signs, place: on_edge },
                };
                best = Some((square, on_segment, nearest));
            }
        }
    }
    best.map(|(_, place, nearest)| (place, nearest))
}

/// Where an edge and the segment are nearest, from -1 to 1 on each.
struct Closest {
    on_edge: f64,
    on_segment: f64,
    /// The end at which the edge was cut last, if it was; cutting the segment afterwards may lead back inwards.
    over: Option<f64>,
}

/// The nearest places of the segment and an edge of half length `half` along `axis`, `from` the segment's centre to the edge's
/// middle; `None` where they are parallel.
fn closest(from: Vector3<f64>, half: f64, axis: usize, arm: Vector3<f64>) -> Option<Closest> {
    let (a, b, c) = (half * half, -half * arm[axis], arm.norm_squared());
    let (u, v) = (-half * from[axis], arm.dot(&from));
    let determinant = a * c - b * b;
    if determinant.abs() < TINY {
        return None;
    }
    let mut edge = (c * u - b * v) / determinant;
    let mut segment = (a * v - b * u) / determinant;
    let mut over = None;
    if edge.abs() > 1.0 {
        edge = edge.signum();
        over = Some(edge);
        segment = (v - b * edge) / c;
    }
    if segment.abs() > 1.0 {
        segment = segment.signum();
        edge = (u - b * segment) / a;
        if edge.abs() > 1.0 {
            edge = edge.signum();
            over = Some(edge);
        }
    }
    Some(Closest { on_edge: edge, on_segment: segment, over })
}

/// The signed step along the segment, in half lengths, to a second contact.
fn onwards(centre: Vector3<f64>, arm: Vector3<f64>, size: Vector3<f64>, first: f64, nearest: Nearest) -> Option<f64> {
    let ahead: [bool; 3] = core::array::from_fn(|axis| arm[axis] > 0.0);
    // How long the segment takes to run along the whole box in one direction.
    let span = |axis: usize| 2.0 * size[axis] / arm[axis].abs();
    match nearest {
        Nearest::Face { axis: None, .. } => None,
        Nearest::Face { sense, axis: Some(face) } => {
            // From the end over the face back along the segment, until it leaves the face's outline.
            let (end, back) = (centre + arm * sense, -arm * sense);
            let mut step: f64 = 2.0;
            for axis in (0..3).filter(|&axis| axis != face) {
                for side in [size[axis], -size[axis]] {
                    let exit = (side - end[axis]) / back[axis];
                    if exit > 0.0 && exit < step {
                        step = exit;
                    }
                }
            }
            Some(-sense * step)
        }
        Nearest::Corner(signs) => {
            let differs: [bool; 3] = core::array::from_fn(|axis| ahead[axis] != signs[axis]);
            let count = differs.iter().filter(|differs| **differs).count();
            // Straight towards or away from the corner there is nothing to lie on.
            if count == 0 || count == 3 {
                return None;
            }
            let (odd, sense) = if count == 1 { (true, 1.0) } else { (false, -1.0) };
            let axis = differs.iter().position(|differs| *differs == odd)?;
            if arm[axis] * arm[axis] > 0.5 * arm.norm_squared() {
                // Along the edge that leads away from the corner.
                Some(sense * (1.0 - sense * first).at_most(span(axis)))
            } else {
                // Over the face that has this axis.
                let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
                Some(-sense * (1.0 + sense * first).at_most(span(a)).at_most(span(b)))
            }
        }
        Nearest::Edge { axis, signs, place } => {
            let others = [(axis + 1) % 3, (axis + 2) % 3];
            let differs = others.map(|other| ahead[other] != signs[other]);
            // Crossing the edge outside, the segment has no face to lie on.
            if differs[0] == differs[1] {
                return None;
            }
            // The face at the edge that the segment is more nearly parallel to extends along `over`.
            let over = usize::from(arm[others[1]].abs() > arm[others[0]].abs());
            let (over, sense) = (others[over], if differs[over] { 1.0 } else { -1.0 });
            let left = 1.0 - sense * first;
            let towards = if (sense > 0.0) == ahead[axis] { 1.0 - place } else { 1.0 + place };
            let along_edge = size[axis] * towards / arm[axis].abs();
            Some(sense * left.at_most(span(over)).at_most(along_edge))
        }
    }
}

//! Whether two answers to "where do these shapes touch" are the same, or which of them is right.

use msk_physics::collision::{Asset, Contact, Placed};
use msk_physics::model::GeomKind;
use nalgebra::Vector3;

/// A contact of MuJoCo: distance, position, normal.
#[derive(Debug, Clone, Copy)]
pub struct Theirs {
    pub distance: f64,
    pub position: Vector3<f64>,
    pub normal: Vector3<f64>,
}

impl Theirs {
    pub fn new(numbers: &[f64]) -> Self {
        let three = |start: usize| Vector3::from_column_slice(&numbers[start..start + 3]);
        Self { distance: numbers[0], position: three(1), normal: three(4) }
    }
}

/// How two answers stand to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// The same contacts; the worst errors of distance, position and normal.
    Same([f64; 3]),
    /// The shapes touch along a line or a face, of which one point is as good as another.
    Along,
    /// The same region of a face, of whose corners others were kept.
    Corners,
    /// Ours separates the shapes by less: the least translation is found, or more nearly.
    Closer,
    /// None of these.
    Other,
}

/// How far a shape reaches from its centre along a unit vector, from its definition; `None` for shapes without farthest points.
fn reach(shape: &Placed<'_>, direction: Vector3<f64>) -> Option<f64> {
    let (d, size) = (shape.rotation.tr_mul(&direction), shape.size);
    Some(match (shape.kind, shape.asset) {
        (GeomKind::Sphere, _) => size.x,
        (GeomKind::Capsule, _) => size.x + size.y * d.z.abs(),
        (GeomKind::Ellipsoid, _) => size.component_mul(&d).norm(),
        (GeomKind::Cylinder, _) => size.x * d.xy().norm() + size.y * d.z.abs(),
        (GeomKind::Box, _) => size.dot(&d.abs()),
        (GeomKind::Mesh, Asset::Mesh(mesh)) => mesh.vertices.iter().map(|vertex| vertex.dot(&d)).fold(f64::MIN, f64::max),
        _ => return None,
    })
}

/// The signed gap between two shapes across a direction from the first to the second. Their signed distance is its largest
/// value over all directions.
fn gap(first: &Placed<'_>, second: &Placed<'_>, direction: Vector3<f64>) -> Option<f64> {
    let between = (second.position - first.position).dot(&direction);
    Some(between - reach(first, direction)? - reach(second, -direction)?)
}

/// Compares the contacts of two shapes with MuJoCo's; positions and normals farther apart than `tolerance` are others.
pub fn judge(shapes: [&Placed<'_>; 2], ours: &[Contact], theirs: &[Theirs], tolerance: f64) -> Verdict {
    let Some(errors) = match_up(ours, theirs, false) else {
        return if is_closer(shapes, ours, theirs) { Verdict::Closer } else { Verdict::Other };
    };
    if errors[0] <= tolerance && errors[1] <= tolerance && errors[2] <= tolerance {
        return Verdict::Same(errors);
    }
    if match_up(ours, theirs, true).is_some_and(|errors| errors.iter().all(|error| *error <= 1e-6)) {
        return Verdict::Along;
    }
    if is_closer(shapes, ours, theirs) {
        return Verdict::Closer;
    }
    if same_face(ours, theirs) { Verdict::Corners } else { Verdict::Other }
}

/// The worst errors when each of MuJoCo's contacts is matched with the nearest of ours; `None` for other numbers of contacts.
/// `along` takes positions across the normal only.
fn match_up(ours: &[Contact], theirs: &[Theirs], along: bool) -> Option<[f64; 3]> {
    if ours.len() != theirs.len() {
        return None;
    }
    let mut worst = [0.0_f64; 3];
    for expected in theirs {
        let error = |contact: &Contact| {
            let offset = contact.position - expected.position;
            let position = if along { offset.dot(&expected.normal).abs() } else { offset.amax() };
            let normal = (contact.frame.row(0).transpose() - expected.normal).amax();
            [(contact.distance - expected.distance).abs(), position, normal]
        };
        let nearest = ours.iter().map(error).min_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum()))?;
        worst = core::array::from_fn(|k| worst[k].max(nearest[k]));
    }
    Some(worst)
}

/// Whether our single contact is consistent, and across a direction that leaves a larger gap than MuJoCo's.
fn is_closer([first, second]: [&Placed<'_>; 2], ours: &[Contact], theirs: &[Theirs]) -> bool {
    let ([our], [their]) = (ours, theirs) else { return false };
    let normal = our.frame.row(0).transpose();
    let [Some(own), Some(other)] = [normal, their.normal].map(|normal| gap(first, second, normal)) else { return false };
    // Half way between two points of both surfaces.
    let middle = (our.position - first.position).dot(&normal) - reach(first, normal).unwrap_or(f64::NAN) - our.distance / 2.0;
    (own - our.distance).abs() < 1e-9 && middle.abs() < 1e-9 && own >= other
}

/// Whether all contacts lie on one pair of facing planes, and span nearly the same area.
fn same_face(ours: &[Contact], theirs: &[Theirs]) -> bool {
    let [first, .., last] = ours else { return false };
    let normal = first.frame.row(0).transpose();
    // Four corners in order.
    let area = |at: &dyn Fn(usize) -> Vector3<f64>| (at(2) - at(0)).cross(&(at(3) - at(1))).norm();
    if ours.len() != 4 || theirs.len() != 4 || theirs.iter().any(|their| (their.normal - normal).amax() > 1e-6) {
        return false;
    }
    // The distance is linear over the face.
    let (p, q) = (ours[1].position - first.position, last.position - first.position);
    let (grow_p, grow_q) = (ours[1].distance - first.distance, last.distance - first.distance);
    let across = p.cross(&q);
    let slope = (q.cross(&across) * grow_p + across.cross(&p) * grow_q) / across.norm_squared();
    let on_plane = |their: &Theirs| {
        let offset = their.position - first.position;
        (offset.dot(&slope) + first.distance - their.distance).abs() < 1e-6 && offset.dot(&across).abs() < 1e-6 * across.norm()
    };
    let share = area(&|k| theirs[k].position) / area(&|k| ours[k].position);
    theirs.iter().all(on_plane) && (0.75..1.34).contains(&share)
}

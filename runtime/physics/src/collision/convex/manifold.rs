//! Several contacts where flat faces or straight edges lie on a face.
//!
//! The distance of two shapes is taken at one point, which is not enough to hold a body that lies flat. Where a face of one
//! shape nearly faces a face of the other, all corners of the region they share become contacts (four of them at most); where
//! an edge nearly lies on a face, both ends of the part over it do. The contacts then share the face's normal. Limits and
//! choices are those that MuJoCo 4.0.0 shows with its `multiccd`.

use super::super::{ContactPoint, frame_of, polygon::widest_four};
use super::{
    Scratch,
    features::Facing,
    separate,
    support::{Core, SupportShape},
};
use crate::scalar::Real;
use nalgebra::Vector3;

/// Two faces face each other if the cosine between one normal and the reverse of the other is above this.
const FACING: f64 = 0.996;
/// An edge lies on a face if the sine of the angle between them is below this.
const LYING: f64 = 0.0888;
/// Contacts of one pair at most.
const MOST_CONTACTS: usize = 4;

/// Finds the contacts of two convex shapes given relative to `origin`.
pub(in super::super) fn collide(
    [first, second]: [&SupportShape<'_>; 2],
    origin: Vector3<f64>,
    reach: f64,
    scratch: &mut Scratch,
    found: &mut Vec<ContactPoint>,
) {
    let Some(separation) = separate(first, second, reach, scratch) else { return };
    let start = found.len();
    if first.has_edges() && second.has_edges() {
        several(first, second, separation.normal, reach, scratch, found);
    }
    if found.len() == start {
        let position = (separation.points[0] + separation.points[1]) * 0.5;
        found.push(ContactPoint { distance: separation.distance, position, frame: frame_of(separation.normal, None) });
    }
    for touch in &mut found[start..] {
        touch.position += origin;
    }
}

/// Adds the contacts of faces and edges that lie on each other, if there are any. The shapes touch along `normal`.
fn several(
    first: &SupportShape<'_>,
    second: &SupportShape<'_>,
    normal: Vector3<f64>,
    reach: f64,
    scratch: &mut Scratch,
    found: &mut Vec<ContactPoint>,
) {
    let faces = [first.facings(normal), second.facings(-normal)];
    let [ones, twos] = faces.each_ref().map(|faces| faces.iter().flatten());
    for one in ones.clone() {
        if let Some(two) = twos.clone().find(|two| one.normal.dot(&two.normal) < -FACING) {
            return faces_meet([first, second], [one, two], reach, scratch, found);
        }
    }
    let shown = [ones.clone().any(|face| face.shows(normal)), twos.clone().any(|face| face.shows(-normal))];
    // A shape that shows a face lies on nothing by an edge; and in MuJoCo nothing lies by one on the cap that a first cylinder
    // shows.
    if !shown[0] {
        for face in twos {
            let lying = first.edge_across(normal, face.normal).filter(|(_, sine)| *sine < LYING);
            if let Some((edge, _)) = lying {
                return edge_meets(edge, second, face, (-1.0, shown == [false, false]), reach, scratch, found);
            }
        }
    }
    let shows_cap = shown[0] && matches!(first.core, Core::Cylinder(..));
    if !shown[1] && !shows_cap {
        for face in ones {
            let lying = second.edge_across(-normal, face.normal).filter(|(_, sine)| *sine < LYING);
            if let Some((edge, _)) = lying {
                return edge_meets(edge, first, face, (1.0, shown == [false, false]), reach, scratch, found);
            }
        }
    }
}

/// The region that two faces share, seen along the normal of the first.
fn faces_meet(
    [first, second]: [&SupportShape<'_>; 2],
    [one, two]: [&Facing; 2],
    reach: f64,
    scratch: &mut Scratch,
    found: &mut Vec<ContactPoint>,
) {
    let Scratch { polygon, outline, .. } = scratch;
    first.outline(one, &mut polygon.corners);
    second.outline(two, outline);
    for (index, &from) in outline.iter().enumerate() {
        let along = outline[(index + 1) % outline.len()] - from;
        let outward = one.normal.cross(&along);
        polygon.clip(outward, outward.dot(&from));
    }
    let normal = -two.normal;
    let Some(surface) = outline.first().map(|corner| corner.dot(&normal)) else { return };
    polygon.corners.retain(|corner| surface - corner.dot(&normal) <= reach);
    let frame = frame_of(normal, None);
    let mut add = |corner: Vector3<f64>| {
        let distance = surface - corner.dot(&normal);
        found.push(ContactPoint { distance, position: corner + normal * (distance / 2.0), frame });
    };
    let corners = &polygon.corners;
    if corners.len() <= MOST_CONTACTS {
        corners.iter().copied().for_each(&mut add);
    } else {
        widest_four(corners.len(), |index| corners[index]).into_iter().for_each(|index| add(corners[index]));
    }
}

/// The part of an edge over a face. `sense` is 1 where the face belongs to the first shape.
fn edge_meets(
    [from, to]: [Vector3<f64>; 2],
    carrier: &SupportShape<'_>,
    face: &Facing,
    (sense, corner): (f64, bool),
    reach: f64,
    scratch: &mut Scratch,
    found: &mut Vec<ContactPoint>,
) {
    let outline = &mut scratch.outline;
    carrier.outline(face, outline);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (index, &start) in outline.iter().enumerate() {
        let outward = (outline[(index + 1) % outline.len()] - start).cross(&face.normal);
        let [near, far] = [from, to].map(|end| outward.dot(&(end - start)));
        match (near > 0.0, far > 0.0) {
            (true, true) => return,
            (true, false) => enter = enter.at_least(near / (near - far)),
            (false, true) => leave = leave.at_most(near / (near - far)),
            (false, false) => {}
        }
    }
    let Some(surface) = outline.first().map(|corner| corner.dot(&face.normal)).filter(|_| enter <= leave) else { return };
    let frame = frame_of(face.normal * sense, None);
    let place = |share: f64| {
        let point = from + (to - from) * share;
        let distance = point.dot(&face.normal) - surface;
        (distance <= reach).then(|| ContactPoint { distance, position: point - face.normal * (distance / 2.0), frame })
    };
    match [place(enter), place(leave)] {
        [Some(a), Some(b)] => found.extend([a, b]),
        // MuJoCo counts one end twice where two edges touch and the other is out of reach, but not a first shape's own end.
        [Some(only), None] if corner && (sense > 0.0 || enter > 0.0) => found.extend([only, only]),
        [None, Some(only)] if corner => found.extend([only, only]),
        ends => found.extend(ends.into_iter().flatten()),
    }
}

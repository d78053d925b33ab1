//! Half spaces against everything that can lie on them.
//!
//! Each function appends what MuJoCo's collider of the same pair finds, in its order; the normal points up from the plane.

use super::{
    ContactPoint, frame_of,
    place::{Asset, Placed},
    polygon::widest_four,
    shapes::TINY,
};
use crate::scalar::Real;
use nalgebra::Vector3;

/// Contacts with a box, cylinder or mesh at most.
const MOST_CONTACTS: usize = 4;

/// A point of a surface that is `distance` above the plane.
fn touch(point: Vector3<f64>, normal: Vector3<f64>, distance: f64) -> ContactPoint {
    ContactPoint { distance, position: point - normal * (distance / 2.0), frame: frame_of(normal, None) }
}

/// Sphere of `radius` at `centre` against the plane.
fn ball(plane: &Placed<'_>, centre: Vector3<f64>, radius: f64, reach: f64) -> Option<ContactPoint> {
    let normal = plane.axis();
    let height = (centre - plane.position).dot(&normal);
    if height > reach + radius {
        return None;
    }
    let distance = height - radius;
    Some(ContactPoint { distance, position: centre - normal * (distance / 2.0 + radius), frame: frame_of(normal, None) })
}

/// Plane against sphere.
pub(super) fn sphere(plane: &Placed<'_>, sphere: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    found.extend(ball(plane, sphere.position, sphere.size.x, reach));
}

/// Plane against capsule: each end as a sphere, the first tangent along the capsule.
pub(super) fn capsule(plane: &Placed<'_>, capsule: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let axis = capsule.axis();
    for end in [capsule.size.y, -capsule.size.y] {
        if let Some(touch) = ball(plane, capsule.position + axis * end, capsule.size.x, reach) {
            found.push(ContactPoint { frame: frame_of(plane.axis(), Some(axis)), ..touch });
        }
    }
}

/// Plane against ellipsoid: the ellipsoid's lowest point.
pub(super) fn ellipsoid(plane: &Placed<'_>, ellipsoid: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let normal = plane.axis();
    let scaled = ellipsoid.rotation.tr_mul(&normal).component_mul(&ellipsoid.size);
    let lowest = ellipsoid.position - ellipsoid.rotation * ellipsoid.size.component_mul(&scaled) / scaled.norm().at_least(TINY);
    let distance = (lowest - plane.position).dot(&normal);
    if distance <= reach {
        found.push(touch(lowest, normal, distance));
    }
}

/// Plane against box: corners of the lower half, the first four of them that are near.
pub(super) fn cuboid(plane: &Placed<'_>, cuboid: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let normal = plane.axis();
    let height = (cuboid.position - plane.position).dot(&normal);
    let mut count = 0;
    for corner in 0..8 {
        let side = |bit: usize| if corner >> bit & 1 == 1 { cuboid.size[bit] } else { -cuboid.size[bit] };
        let arm = cuboid.rotation * Vector3::new(side(0), side(1), side(2));
        let below = normal.dot(&arm);
        if height + below > reach || below > 0.0 {
            continue;
        }
        found.push(touch(cuboid.position + arm, normal, height + below));
        count += 1;
        if count == MOST_CONTACTS {
            return;
        }
    }
}

/// Plane against cylinder: the lowest points of both caps, and two more on the lower cap, a third of a turn to either side.
pub(super) fn cylinder(plane: &Placed<'_>, cylinder: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let normal = plane.axis();
    let [radius, half] = [cylinder.size.x, cylinder.size.y];
    let upright = cylinder.axis();
    // From the centre to the lower cap.
    let shaft = if upright.dot(&normal) > 0.0 { -upright * half } else { upright * half };
    let across = upright * upright.dot(&normal) - normal;
    let rim = across.try_normalize(TINY).unwrap_or_else(|| cylinder.rotation.column(0).into_owned()) * radius;
    let mut add = |arm: Vector3<f64>| {
        let point = cylinder.position + arm;
        let distance = (point - plane.position).dot(&normal);
        let near = distance <= reach;
        if near {
            found.push(touch(point, normal, distance));
        }
        near
    };
    if !add(rim + shaft) {
        return;
    }
    add(rim - shaft);
    let side = rim.cross(&shaft).normalize() * (radius * 0.75_f64.sqrt());
    add(shaft + side - rim * 0.5);
    add(shaft - side - rim * 0.5);
}

/// Plane against mesh: of the face around the lowest corner that looks down most, up to four corners far apart, those not
/// above the mesh's centre.
pub(super) fn mesh(plane: &Placed<'_>, shape: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let Asset::Mesh(mesh) = shape.asset else { return };
    let (hull, normal) = (&mesh.hull, plane.axis());
    let down = shape.rotation.tr_mul(&-normal);
    let lowest = hull.support_point(down);
    let Some(face) = hull.facing(lowest, down) else { return };
    let corners = hull.corners_of(face);
    let start = corners.iter().position(|&corner| corner == lowest).unwrap_or(0);
    let place = |index: usize| hull.vertices[corners[(start + index) % corners.len()]];
    let mut add = |index: usize| {
        let arm = shape.rotation * place(index);
        let point = shape.position + arm;
        let distance = (point - plane.position).dot(&normal);
        if distance <= reach && arm.dot(&normal) <= 0.0 {
            found.push(touch(point, normal, distance));
        }
    };
    if corners.len() <= MOST_CONTACTS {
        (0..corners.len()).for_each(&mut add);
    } else {
        widest_four(corners.len(), place).into_iter().for_each(&mut add);
    }
}

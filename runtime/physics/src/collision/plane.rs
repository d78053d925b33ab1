//! Half spaces against everything that can lie on them.
//!
//! Each function appends what MuJoCo's collider of the same pair finds, in its order; the normal points up from the plane.

use super::{
    ContactPoint,
    place::{Asset, Placed},
    polygon::widest_four,
    shapes::TINY,
    touch::{Pair, Touch, choose, frame_of, unit},
};
use crate::{
    scalar::Real,
    spatial::{cross, dot, minus, norm, over, plus, rotate, rotate_back, scale},
};
use nalgebra::{Matrix3, Vector3};

/// Contacts with a box, cylinder or mesh at most.
const MOST_CONTACTS: usize = 4;

/// A point of a surface that is `distance` above the plane, with the frame of its normal.
#[inline(always)]
fn touch<T: Real>(lanes: T::Mask, point: &Vector3<T>, normal: &Vector3<T>, frame: Matrix3<T>, distance: T) -> Touch<T> {
    Touch { lanes, distance, position: minus(point, &scale(normal, distance / T::splat(2.0))), frame }
}

/// Sphere of `radius` at `centre` against the plane of the pair; the frame's first row is the plane's normal.
#[inline(always)]
fn ball<T: Real>(pair: &Pair<'_, T>, centre: &Vector3<T>, radius: T, frame: Matrix3<T>) -> Touch<T> {
    let [plane, _] = &pair.shapes;
    let normal = plane.axis();
    let height = dot(&minus(centre, &plane.position), &normal);
    let lanes = T::and(pair.lanes, T::not((pair.reach + radius).less(height)));
    let distance = height - radius;
    Touch { lanes, distance, position: minus(centre, &scale(&normal, distance / T::splat(2.0) + radius)), frame }
}

/// Plane against sphere.
#[inline(always)]
pub(super) fn sphere<T: Real>(pair: &Pair<'_, T>, found: &mut Vec<Touch<T>>) {
    let [plane, sphere] = &pair.shapes;
    ball(pair, &sphere.position, sphere.size.x, frame_of(plane.axis(), None)).note(found);
}

/// Plane against capsule: each end as a sphere, the first tangent along the capsule.
#[inline(always)]
pub(super) fn capsule<T: Real>(pair: &Pair<'_, T>, found: &mut Vec<Touch<T>>) {
    let [plane, capsule] = &pair.shapes;
    let axis = capsule.axis();
    let frame = frame_of(plane.axis(), Some(axis));
    for end in [capsule.size.y, -capsule.size.y] {
        ball(pair, &plus(&capsule.position, &scale(&axis, end)), capsule.size.x, frame).note(found);
    }
}

/// Plane against ellipsoid: the ellipsoid's lowest point.
#[inline(always)]
pub(super) fn ellipsoid<T: Real>(pair: &Pair<'_, T>, found: &mut Vec<Touch<T>>) {
    let [plane, ellipsoid] = &pair.shapes;
    let normal = plane.axis();
    let size = &ellipsoid.size;
    let scaled = times(&rotate_back(&ellipsoid.rotation, &normal), size);
    let down = over(&rotate(&ellipsoid.rotation, &times(size, &scaled)), norm(&scaled).at_least(T::splat(TINY)));
    let lowest = minus(&ellipsoid.position, &down);
    let distance = dot(&minus(&lowest, &plane.position), &normal);
    let lanes = T::and(pair.lanes, distance.is_at_most(pair.reach));
    touch(lanes, &lowest, &normal, frame_of(normal, None), distance).note(found);
}

/// a b, component by component.
#[inline(always)]
fn times<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x * b.x, a.y * b.y, a.z * b.z)
}

/// Plane against box: corners of the lower half, the first four of them that are near.
#[inline(always)]
pub(super) fn cuboid<T: Real>(pair: &Pair<'_, T>, found: &mut Vec<Touch<T>>) {
    let [plane, cuboid] = &pair.shapes;
    let (zero, one, most) = (T::splat(0.0), T::splat(1.0), T::splat(MOST_CONTACTS as f64));
    let normal = plane.axis();
    let frame = frame_of(normal, None);
    let height = dot(&minus(&cuboid.position, &plane.position), &normal);
    let size = &cuboid.size;
    let mut count = zero;
    for corner in 0..8 {
        T::apart();
        let x = if corner & 1 == 1 { size.x } else { -size.x };
        let y = if corner & 2 == 2 { size.y } else { -size.y };
        let z = if corner & 4 == 4 { size.z } else { -size.z };
        let arm = rotate(&cuboid.rotation, &Vector3::new(x, y, z));
        let below = dot(&normal, &arm);
        let distance = height + below;
        let beyond = T::or(pair.reach.less(distance), zero.less(below));
        let lanes = T::and(T::and(pair.lanes, count.less(most)), T::not(beyond));
        touch(lanes, &plus(&cuboid.position, &arm), &normal, frame, distance).note(found);
        count += T::select(lanes, one, zero);
    }
}

/// Plane against cylinder: the lowest points of both caps, and two more on the lower cap, a third of a turn to either side.
#[inline(always)]
pub(super) fn cylinder<T: Real>(pair: &Pair<'_, T>, found: &mut Vec<Touch<T>>) {
    let [plane, cylinder] = &pair.shapes;
    let normal = plane.axis();
    let frame = frame_of(normal, None);
    let (radius, half) = (cylinder.size.x, cylinder.size.y);
    let upright = cylinder.axis();
    let rise = dot(&upright, &normal);
    // From the centre to the lower cap.
    let shaft = scale(&upright, T::select(T::splat(0.0).less(rise), -half, half));
    let (down, level) = unit(&minus(&scale(&upright, rise), &normal), TINY);
    let rim = scale(&choose(level, &cylinder.rotation.column(0).into_owned(), &down), radius);
    let mut lanes = pair.lanes;
    let side = cross(&rim, &shaft);
    let side = scale(&over(&side, norm(&side)), radius * T::splat(0.75_f64.sqrt()));
    let back = scale(&rim, T::splat(0.5));
    let arms = [plus(&rim, &shaft), minus(&rim, &shaft), minus(&plus(&shaft, &side), &back), minus(&minus(&shaft, &side), &back)];
    for (index, arm) in arms.iter().enumerate() {
        let point = plus(&cylinder.position, arm);
        let distance = dot(&minus(&point, &plane.position), &normal);
        let near = T::and(lanes, distance.is_at_most(pair.reach));
        touch(near, &point, &normal, frame, distance).note(found);
        if index == 0 {
            // Where the lowest point is not near, no other is.
            lanes = near;
        }
    }
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
            found.push(ContactPoint { distance, position: point - normal * (distance / 2.0), frame: frame_of(normal, None) });
        }
    };
    if corners.len() <= MOST_CONTACTS {
        (0..corners.len()).for_each(&mut add);
    } else {
        widest_four(corners.len(), place).into_iter().for_each(&mut add);
    }
}

//! Contacts of spheres and capsules in closed form.
//!
//! Each function appends what MuJoCo's collider of the same pair finds, in its order; the normal points from the first
//! shape to the second, the position lies half way between the two surfaces.

use super::{ContactPoint, Placed, frame_of};
use crate::scalar::Real;
use nalgebra::Vector3;

/// Below this a length counts as zero, MuJoCo's `mjMINVAL`.
pub(super) const TINY: f64 = 1e-15;

/// Two spheres given by their centres; `fallback` is the normal of concentric ones.
fn points(
    first: Vector3<f64>,
    radii: [f64; 2],
    second: Vector3<f64>,
    reach: f64,
    fallback: Vector3<f64>,
) -> Option<ContactPoint> {
    let between = second - first;
    let centres = between.norm();
    let distance = centres - radii[0] - radii[1];
    if distance > reach {
        return None;
    }
    let normal = if centres < TINY { fallback } else { between / centres };
    Some(ContactPoint { distance, position: first + normal * (radii[0] + distance / 2.0), frame: frame_of(normal, None) })
}

/// Normal of two shapes whose centres coincide: across both axes.
fn concentric_normal(first: &Placed<'_>, second: &Placed<'_>) -> Vector3<f64> {
    first.axis().cross(&second.axis()).try_normalize(TINY).unwrap_or_else(Vector3::x)
}

/// Sphere against sphere.
pub(super) fn sphere_sphere(first: &Placed<'_>, second: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let radii = [first.size.x, second.size.x];
    found.extend(points(first.position, radii, second.position, reach, concentric_normal(first, second)));
}

/// Sphere against capsule: the nearest point of the capsule's segment as a sphere.
pub(super) fn sphere_capsule(sphere: &Placed<'_>, capsule: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let axis = capsule.axis();
    let along = axis.dot(&(sphere.position - capsule.position)).clip(-capsule.size.y, capsule.size.y);
    let radii = [sphere.size.x, capsule.size.x];
    let nearest = capsule.position + axis * along;
    found.extend(points(sphere.position, radii, nearest, reach, concentric_normal(sphere, capsule)));
}

/// Capsule against capsule: the nearest points of the two segments as spheres; parallel capsules touch at up to two places.
pub(super) fn capsule_capsule(first: &Placed<'_>, second: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let radii = [first.size.x, second.size.x];
    let fallback = concentric_normal(first, second);
    let (half_first, half_second) = (first.axis() * first.size.y, second.axis() * second.size.y);
    let between = first.position - second.position;
    // |between + x1 half_first - x2 half_second|² is minimal where  [ma mb; mb mc] (x1, x2) = (u, v)
    let (ma, mb, mc) = (half_first.norm_squared(), -half_first.dot(&half_second), half_second.norm_squared());
    let (u, v) = (-half_first.dot(&between), half_second.dot(&between));
    let mut touch = |x1: f64, x2: f64| {
        let found_here = points(first.position + half_first * x1, radii, second.position + half_second * x2, reach, fallback);
        found.extend(found_here);
        usize::from(found_here.is_some())
    };
    // ma mc - mb² as the square of a cross product, which does not cancel for nearly parallel axes.
    let across = half_first.cross(&half_second);
    let determinant = across.norm_squared();
    if determinant >= TINY {
        let mut x1 = -across.dot(&between.cross(&half_second)) / determinant;
        let mut x2 = -across.dot(&between.cross(&half_first)) / determinant;
        if !(-1.0..=1.0).contains(&x1) {
            x1 = x1.clip(-1.0, 1.0);
            x2 = (v - mb * x1) / mc;
        }
        if !(-1.0..=1.0).contains(&x2) {
            x2 = x2.clip(-1.0, 1.0);
            x1 = ((u - mb * x2) / ma).clip(-1.0, 1.0);
        }
        touch(x1, x2);
        return;
    }
    let on_second = |x1: f64| ((v - mb * x1) / mc.at_least(TINY)).clip(-1.0, 1.0);
    let on_first = |x2: f64| ((u - mb * x2) / ma.at_least(TINY)).clip(-1.0, 1.0);
    let mut count = touch(1.0, on_second(1.0)) + touch(-1.0, on_second(-1.0));
    for x2 in [1.0, -1.0] {
        if count < 2 {
            count += touch(on_first(x2), x2);
        }
    }
}

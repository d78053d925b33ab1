//! Spheres against boxes and cylinders, in closed form.

use super::{ContactPoint, frame_of, place::Placed, shapes::TINY};
use crate::scalar::Real;
use nalgebra::Vector3;

/// Sphere against box.
pub(super) fn sphere_box(sphere: &Placed<'_>, cuboid: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    found.extend(ball_box(sphere.position, sphere.size.x, cuboid, reach));
}

/// A ball against a box: the nearest point of the box decides, or its nearest face where the ball's centre is inside.
pub(super) fn ball_box(centre: Vector3<f64>, radius: f64, cuboid: &Placed<'_>, reach: f64) -> Option<ContactPoint> {
    let local = cuboid.local(centre);
    let nearest = local.zip_map(&cuboid.size, |x, half| x.clip(-half, half));
    let away = nearest - local;
    let length = away.norm();
    let (core, normal, middle) = if length > TINY {
        let normal = away / length;
        (length, normal, (nearest + local + normal * radius) * 0.5)
    } else {
        let mut best = (f64::INFINITY, 0, 1.0);
        for axis in 0..3 {
            for sense in [1.0, -1.0] {
                let depth = (sense * cuboid.size[axis] - local[axis]).abs();
                if depth < best.0 {
                    best = (depth, axis, sense);
                }
            }
        }
        let (depth, axis, sense) = best;
        let normal = Vector3::ith(axis, -sense);
        (-depth, normal, local + normal * ((radius - depth) * 0.5))
    };
    let distance = core - radius;
    let position = cuboid.position + cuboid.rotation * middle;
    (distance <= reach).then(|| ContactPoint { distance, position, frame: frame_of(cuboid.rotation * normal, None) })
}

/// Sphere against cylinder: its side, a cap or a rim is nearest.
pub(super) fn sphere_cylinder(sphere: &Placed<'_>, cylinder: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let (axis, radius) = (cylinder.axis(), sphere.size.x);
    let [across, half] = [cylinder.size.x, cylinder.size.y];
    let from = sphere.position - cylinder.position;
    let along = from.dot(&axis);
    let aside = from - axis * along;
    let distance_aside = aside.norm();
    let beside = along.abs() < half;
    let above = distance_aside < across;
    // Deep inside, the nearer of side and cap.
    let side = beside && (!above || across - distance_aside <= half - along.abs());
    let outward = aside.try_normalize(TINY).unwrap_or_else(|| cylinder.rotation.column(0).into_owned());
    let cap = axis * along.signum();
    let (core, normal) = if side {
        (distance_aside - across, outward)
    } else if above {
        (along.abs() - half, cap)
    } else {
        let rim = outward * (distance_aside - across) + cap * (along.abs() - half);
        let length = rim.norm();
        (length, if length > TINY { rim / length } else { cap })
    };
    let distance = core - radius;
    if distance <= reach {
        let position = sphere.position - normal * (radius + distance / 2.0);
        found.push(ContactPoint { distance, position, frame: frame_of(-normal, None) });
    }
}

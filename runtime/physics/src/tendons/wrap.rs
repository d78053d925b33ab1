//! Wrapping of a tendon around a sphere or an infinite cylinder.
//!
//! Both are wrapped in a plane, where they are a circle: the plane through the sphere's centre and the two end points, or
//! the plane across the cylinder's axis. Three rules of MuJoCo 4.0.0 decide the way:
//!
//! * without a side point the path takes the shorter way around, and only if the straight segment would cut the circle;
//! * with a side point outside the shape, the path winds around the centre as the polyline end - side point - end does
//!   (it is the shortest path homotopic to it), so it leaves the circle exactly where the straight segment winds the same
//!   way and does not cut the circle;
//! * with a side point inside the shape, the path is held inside: it touches the circle from within at one point, where it
//!   is reflected (Alhazen's problem), unless the straight segment passes through the circle.
//!
//! Choices are made by signs of cross products, so that no angle is computed for a tendon that is clear of its obstacle.

use crate::{
    rotation::MINIMUM,
    scalar::Real,
    spatial::{cross, dot, norm, rotate, rotate_back, scale},
};
use nalgebra::{Matrix3, Vector3};

/// Shape of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrapShape {
    /// Centre and radius.
    Sphere,
    /// Radius about the z axis of its frame; without end.
    Cylinder,
}

/// What a tendon wraps around.
#[derive(Debug, Clone)]
pub struct WrappingSurface<T: Real> {
    /// Its shape.
    pub shape: WrapShape,
    /// Its centre, world, m.
    pub position: Vector3<T>,
    /// Its rotation matrix.
    pub rotation: Matrix3<T>,
    /// Its radius, m.
    pub radius: T,
    /// The side point in the obstacle's own frame, m.
    pub side: Option<Vector3<T>>,
}

/// The bend of a path at an obstacle.
#[derive(Debug, Clone)]
pub struct WrapPath<T: Real> {
    /// Whether the path touches the obstacle at all; elsewhere it is straight and the other fields mean nothing.
    pub touches: T::Mask,
    /// Where it meets the obstacle, world, m.
    pub first: Vector3<T>,
    /// Where it leaves it, world, m.
    pub second: Vector3<T>,
    /// Length on the obstacle, m.
    pub arc: T,
}

/// A bend in the wrapping plane.
struct PlanarBend<T: Real> {
    touches: T::Mask,
    first: [T; 2],
    second: [T; 2],
    arc: T,
}

/// How the path from `start` to `end` (world, m) bends at `obstacle`; `None` if it is straight in every lane.
#[inline(always)]
pub fn bend<T: Real>(start: &Vector3<T>, end: &Vector3<T>, obstacle: &WrappingSurface<T>) -> Option<WrapPath<T>> {
    let start = rotate_back(&obstacle.rotation, &(start - obstacle.position));
    let end = rotate_back(&obstacle.rotation, &(end - obstacle.position));
    let [x, y] = plane(obstacle.shape, &start, &end);
    let flat = |v: &Vector3<T>| [dot(v, &x), dot(v, &y)];
    let (a, b) = (flat(&start), flat(&end));
    let planar = planar_bend(&a, &b, obstacle.side.as_ref(), flat, obstacle.radius)?;

    let mut first = scale(&x, planar.first[0]) + scale(&y, planar.first[1]);
    let mut second = scale(&x, planar.second[0]) + scale(&y, planar.second[1]);
    let mut arc = planar.arc;
    if obstacle.shape == WrapShape::Cylinder {
        // Unrolled, the path on and off the cylinder is one straight line: height grows with planar length.
        let before = distance(&a, &planar.first);
        let after = distance(&b, &planar.second);
        let slope = (end.z - start.z) / (before + arc + after).at_least(T::splat(MINIMUM));
        first.z = start.z + slope * before;
        second.z = start.z + slope * (before + arc);
        let height = second.z - first.z;
        arc = (arc * arc + height * height).sqrt();
    }
    let first = rotate(&obstacle.rotation, &first) + obstacle.position;
    let second = rotate(&obstacle.rotation, &second) + obstacle.position;
    Some(WrapPath { touches: planar.touches, first, second, arc })
}

/// Axes of the wrapping plane in the obstacle's frame.
#[inline(always)]
fn plane<T: Real>(shape: WrapShape, start: &Vector3<T>, end: &Vector3<T>) -> [Vector3<T>; 2] {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    if shape == WrapShape::Cylinder {
        return [Vector3::new(one, zero, zero), Vector3::new(zero, one, zero)];
    }
    let tiny = T::splat(MINIMUM);
    let x = scale(start, one / norm(start).at_least(tiny));
    let normal = cross(start, end);
    // End points in line with the centre leave the plane open: any normal across the start will do; it is taken across the
    // start's largest component, as MuJoCo does.
    let [u, v, w] = [x.x.abs(), x.y.abs(), x.z.abs()];
    let first = T::not(u.less(v.at_least(w)));
    let second = T::and(T::not(first), T::not(v.less(w)));
    let other =
        Vector3::new(T::select(first, zero, one), T::select(second, zero, one), T::select(T::or(first, second), one, zero));
    let fallback = cross(&x, &other);
    let aligned = norm(&normal).less(tiny);
    let normal = Vector3::new(
        T::select(aligned, fallback.x, normal.x),
        T::select(aligned, fallback.y, normal.y),
        T::select(aligned, fallback.z, normal.z),
    );
    let y = cross(&normal, &x);
    [x, scale(&y, one / norm(&y).at_least(tiny))]
}

#[inline(always)]
fn planar_bend<T: Real>(
    a: &[T; 2],
    b: &[T; 2],
    side: Option<&Vector3<T>>,
    flat: impl Fn(&Vector3<T>) -> [T; 2],
    radius: T,
) -> Option<PlanarBend<T>> {
    let Some(side) = side else { return around(a, b, None, radius) };
    let within = norm(side).less(radius);
    if T::all(within) {
        return inside(a, b, radius);
    }
    let outer = around(a, b, Some(flat(side)), radius);
    if !T::any(within) {
        return outer;
    }
    match (inside(a, b, radius), outer) {
        (Some(inner), Some(outer)) => Some(PlanarBend {
            touches: T::or(T::and(within, inner.touches), T::and(T::not(within), outer.touches)),
            first: select(within, inner.first, outer.first),
            second: select(within, inner.second, outer.second),
            arc: T::select(within, inner.arc, outer.arc),
        }),
        (Some(inner), None) => Some(PlanarBend { touches: T::and(within, inner.touches), ..inner }),
        (None, Some(outer)) => Some(PlanarBend { touches: T::and(T::not(within), outer.touches), ..outer }),
        (None, None) => None,
    }
}

/// The path around the outside of the circle.
#[inline(always)]
fn around<T: Real>(a: &[T; 2], b: &[T; 2], side: Option<[T; 2]>, radius: T) -> Option<PlanarBend<T>> {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let (square_a, square_b, square) = (dot2(a, a), dot2(b, b), radius * radius);
    let apart = T::not(T::or(square_a.less(square), square_b.less(square)));
    let possible = T::and(apart, T::not(radius.less(T::splat(MINIMUM))));
    if !T::any(possible) {
        return None;
    }
    let turn = cross2(a, b);
    let cuts = passes_within(a, b, square);
    let (mut left, mut opposed) = (T::not(turn.less(zero)), T::less(one, zero));
    if let Some(side) = side {
        let (to_side, from_side) = (cross2(a, &side), cross2(&side, b));
        let both_left = T::and(zero.less(to_side), zero.less(from_side));
        let both_right = T::and(to_side.less(zero), from_side.less(zero));
        // Winding of the polyline and of the straight segment differ by one full turn.
        opposed = T::or(T::and(both_left, turn.less(zero)), T::and(both_right, zero.less(turn)));
        left = T::or(both_left, T::and(left, T::not(both_right)));
    }
    let touches = T::and(possible, T::or(cuts, opposed));
    if !T::any(touches) {
        return None;
    }
    let direction = T::select(left, one, -one);
    let first = tangent(a, square_a, radius, direction);
    let second = tangent(b, square_b, radius, -direction);
    let angle = (direction * cross2(&first, &second)).atan2(dot2(&first, &second));
    let beyond = T::and(opposed, angle.less(zero));
    let angle = T::select(beyond, angle + T::splat(core::f64::consts::TAU), angle.at_least(zero));
    Some(PlanarBend { touches, first, second, arc: radius * angle })
}

/// Where the tangent from `point` meets the circle that it passes on the right (`direction` 1) or left (-1).
#[inline(always)]
fn tangent<T: Real>(point: &[T; 2], square_distance: T, radius: T, direction: T) -> [T; 2] {
    let square = radius * radius;
    let inverse = T::splat(1.0) / square_distance.at_least(T::splat(MINIMUM));
    let across = direction * radius * (square_distance - square).at_least(T::splat(0.0)).sqrt();
    [(point[0] * square - point[1] * across) * inverse, (point[1] * square + point[0] * across) * inverse]
}

/// The path that touches the circle from within.
#[inline(always)]
fn inside<T: Real>(a: &[T; 2], b: &[T; 2], radius: T) -> Option<PlanarBend<T>> {
    let (one, two, tiny) = (T::splat(1.0), T::splat(2.0), T::splat(MINIMUM));
    let (length_a, length_b) = (dot2(a, a).sqrt(), dot2(b, b).sqrt());
    let outside = T::and(radius.less(length_a), radius.less(length_b));
    let possible = T::and(outside, T::not(radius.less(tiny)));
    let touches = T::and(possible, T::not(passes_within(a, b, radius * radius)));
    if !T::any(touches) {
        return None;
    }
    // With t the angle of incidence, equal on both sides, the three angles at the centre, at a and at b close the figure:
    // f = asin(A sin t) + asin(B sin t) - 2 t + G = 0. Newton's method from t = pi/2 approaches the root from one side;
    // MuJoCo stops at 1e-6, where the length, stationary at the root, is good to 1e-12. Angles are summed as a product of
    // unit complex numbers, (cos, sin), which leaves one arc tangent to an iteration.
    let (ratio_a, ratio_b) = (radius / length_a.at_least(tiny), radius / length_b.at_least(tiny));
    let scale = one / (length_a * length_b).at_least(tiny);
    let turn = cross2(a, b);
    let between = [dot2(a, b) * scale, turn.abs() * scale];
    let cosine = |sin: T| (one - sin * sin).at_least(tiny).sqrt();
    let mut incidence = T::splat(core::f64::consts::FRAC_PI_2);
    let (mut sin, mut cos) = (one, T::splat(0.0));
    for _ in 0..20 {
        let (at_a, at_b) = ([cosine(ratio_a * sin), ratio_a * sin], [cosine(ratio_b * sin), ratio_b * sin]);
        let back = [cos * cos - sin * sin, -two * sin * cos];
        let sum = multiply(multiply(at_a, at_b), multiply(back, between));
        let error = sum[1].atan2(sum[0]);
        let going = T::and(touches, T::splat(1e-6).less(error.abs()));
        if !T::any(going) {
            break;
        }
        let slope = cos * (ratio_a / at_a[0] + ratio_b / at_b[0]) - two;
        incidence = T::select(going, incidence - error / slope, incidence);
        (sin, cos) = incidence.sin_cos();
    }
    // Turn from a or b, whichever lies clockwise, by t less the angle there.
    let from_a = T::splat(0.0).less(turn);
    let base = select(from_a, *a, *b);
    let (length, ratio) = (T::select(from_a, length_a, length_b), T::select(from_a, ratio_a, ratio_b));
    let angle = multiply([cos, sin], [cosine(ratio * sin), -ratio * sin]);
    let reach = radius / length.at_least(tiny);
    let point = multiply([base[0] * reach, base[1] * reach], angle);
    Some(PlanarBend { touches, first: point, second: point, arc: T::splat(0.0) })
}

/// Whether the segment from `a` to `b` comes as near to the origin as the root of `square`.
#[inline(always)]
fn passes_within<T: Real>(a: &[T; 2], b: &[T; 2], square: T) -> T::Mask {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let gap = [b[0] - a[0], b[1] - a[1]];
    let along = (-dot2(&gap, a) / dot2(&gap, &gap).at_least(T::splat(MINIMUM))).at_least(zero).at_most(one);
    let nearest = [a[0] + along * gap[0], a[1] + along * gap[1]];
    T::not(square.less(dot2(&nearest, &nearest)))
}

#[inline(always)]
fn select<T: Real>(mask: T::Mask, a: [T; 2], b: [T; 2]) -> [T; 2] {
    [T::select(mask, a[0], b[0]), T::select(mask, a[1], b[1])]
}

/// Product of two complex numbers, which adds their angles.
#[inline(always)]
fn multiply<T: Real>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

#[inline(always)]
fn dot2<T: Real>(a: &[T; 2], b: &[T; 2]) -> T {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
fn cross2<T: Real>(a: &[T; 2], b: &[T; 2]) -> T {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
fn distance<T: Real>(a: &[T; 2], b: &[T; 2]) -> T {
    let gap = [b[0] - a[0], b[1] - a[1]];
    dot2(&gap, &gap).sqrt()
}

//! Contacts of spheres and capsules in closed form.
//!
//! Each function appends what MuJoCo's collider of the same pair finds, in its order; the normal points from the first
//! shape to the second, the position lies half way between the two surfaces.

use super::touch::{Pair, Touch, choose, frame_of, unit};
use crate::{
    scalar::Real,
    spatial::{cross, dot, minus, norm, over, plus, scale},
};
use nalgebra::Vector3;

/// Below this a length counts as zero, MuJoCo's `mjMINVAL`.
pub(super) const TINY: f64 = 1e-15;

/// Two spheres given by their centres, each with the radius of a shape of the pair, in some lanes.
#[inline(always)]
fn points<T: Real>(pair: &Pair<'_, T>, lanes: T::Mask, first: &Vector3<T>, second: &Vector3<T>) -> Touch<T> {
    let [one, other] = &pair.shapes;
    let between = minus(second, first);
    let centres = norm(&between);
    let distance = centres - one.size.x - other.size.x;
    let lanes = T::and(lanes, T::not(pair.reach.less(distance)));
    let concentric = T::and(lanes, centres.less(T::splat(TINY)));
    let mut normal = over(&between, centres);
    if T::any(concentric) {
        normal = choose(concentric, &concentric_normal(pair), &normal);
    }
    let position = plus(first, &scale(&normal, one.size.x + distance / T::splat(2.0)));
    Touch { lanes, distance, position, frame: frame_of(normal, None) }
}

/// Normal of two shapes whose centres coincide: across both axes.
#[inline(always)]
fn concentric_normal<T: Real>(pair: &Pair<'_, T>) -> Vector3<T> {
    let [first, second] = &pair.shapes;
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let (across, parallel) = unit(&cross(&first.axis(), &second.axis()), TINY);
    choose(parallel, &Vector3::new(one, zero, zero), &across)
}

/// Sphere against sphere.
#[inline(always)]
pub(super) fn sphere_sphere<T: Real>(pair: &Pair<'_, T>, found: &mut Vec<Touch<T>>) {
    let [first, second] = &pair.shapes;
    points(pair, pair.lanes, &first.position, &second.position).note(found);
}

/// Sphere against capsule: the nearest point of the capsule's segment as a sphere.
#[inline(always)]
pub(super) fn sphere_capsule<T: Real>(pair: &Pair<'_, T>, found: &mut Vec<Touch<T>>) {
    let [sphere, capsule] = &pair.shapes;
    let axis = capsule.axis();
    let along = dot(&axis, &minus(&sphere.position, &capsule.position)).clip(-capsule.size.y, capsule.size.y);
    points(pair, pair.lanes, &sphere.position, &plus(&capsule.position, &scale(&axis, along))).note(found);
}

/// Two segments, and the quadratic form of the squared distance between a place on each, from -1 to 1.
struct Segments<T: Real> {
    /// Half of each.
    halves: [Vector3<T>; 2],
    /// From the centre of the second to that of the first.
    between: Vector3<T>,
    // |between + x1 half_first - x2 half_second|² is minimal where  [ma mb; mb mc] (x1, x2) = (u, v)
    ma: T,
    mb: T,
    mc: T,
    u: T,
    v: T,
}

impl<T: Real> Segments<T> {
    #[inline(always)]
    fn of(pair: &Pair<'_, T>) -> Self {
        let [first, second] = &pair.shapes;
        let halves = [scale(&first.axis(), first.size.y), scale(&second.axis(), second.size.y)];
        let between = minus(&first.position, &second.position);
        let [one, other] = &halves;
        let (ma, mb, mc) = (dot(one, one), -dot(one, other), dot(other, other));
        let (u, v) = (-dot(one, &between), dot(other, &between));
        Self { halves, between, ma, mb, mc, u, v }
    }

    /// The places where segments that are not parallel are nearest; `across` is the cross product of their halves.
    #[inline(always)]
    fn nearest(&self, across: &Vector3<T>, determinant: T) -> [T; 2] {
        let (one, between) = (T::splat(1.0), &self.between);
        let [first, second] = &self.halves;
        let x1 = -dot(across, &cross(between, second)) / determinant;
        let x2 = -dot(across, &cross(between, first)) / determinant;
        let inside = T::and((-one).is_at_most(x1), x1.is_at_most(one));
        let x1 = x1.clip(-one, one);
        let x2 = T::select(inside, x2, (self.v - self.mb * x1) / self.mc);
        let inside = T::and((-one).is_at_most(x2), x2.is_at_most(one));
        let x2 = x2.clip(-one, one);
        let x1 = T::select(inside, x1, ((self.u - self.mb * x2) / self.ma).clip(-one, one));
        [x1, x2]
    }

    /// The place on the first segment that is nearest to one on the second, of parallel ones.
    #[inline(always)]
    fn on_first(&self, x2: T) -> T {
        let one = T::splat(1.0);
        ((self.u - self.mb * x2) / self.ma.at_least(T::splat(TINY))).clip(-one, one)
    }

    /// The place on the second segment that is nearest to one on the first, of parallel ones.
    #[inline(always)]
    fn on_second(&self, x1: T) -> T {
        let one = T::splat(1.0);
        ((self.v - self.mb * x1) / self.mc.at_least(T::splat(TINY))).clip(-one, one)
    }

    /// The contact of a place on each, in some lanes.
    #[inline(always)]
    fn touch(&self, pair: &Pair<'_, T>, lanes: T::Mask, [x1, x2]: [T; 2]) -> Touch<T> {
        let [first, second] = &pair.shapes;
        let on_first = plus(&first.position, &scale(&self.halves[0], x1));
        let on_second = plus(&second.position, &scale(&self.halves[1], x2));
        points(pair, lanes, &on_first, &on_second)
    }
}

/// Capsule against capsule: the nearest points of the two segments as spheres; parallel capsules touch at up to two places.
#[inline(always)]
pub(super) fn capsule_capsule<T: Real>(pair: &Pair<'_, T>, found: &mut Vec<Touch<T>>) {
    let segments = Segments::of(pair);
    // ma mc - mb² as the square of a cross product, which does not cancel for nearly parallel axes.
    let across = cross(&segments.halves[0], &segments.halves[1]);
    let determinant = dot(&across, &across);
    let crossing = T::splat(TINY).is_at_most(determinant);
    let (crossing, parallel) = (T::and(pair.lanes, crossing), T::and(pair.lanes, T::not(crossing)));
    if T::any(crossing) {
        let places = segments.nearest(&across, determinant);
        segments.touch(pair, crossing, places).note(found);
    }
    if T::any(parallel) {
        lie_along(pair, &segments, parallel, found);
    }
}

/// Parallel capsules: the ends of the first, and those of the second as long as there are fewer than two contacts.
#[inline(always)]
fn lie_along<T: Real>(pair: &Pair<'_, T>, segments: &Segments<T>, parallel: T::Mask, found: &mut Vec<Touch<T>>) {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let mut count = zero;
    for x1 in [one, -one] {
        let touch = segments.touch(pair, parallel, [x1, segments.on_second(x1)]);
        count += T::select(touch.lanes, one, zero);
        touch.note(found);
    }
    for x2 in [one, -one] {
        let wanted = T::and(parallel, count.less(T::splat(2.0)));
        let touch = segments.touch(pair, wanted, [segments.on_first(x2), x2]);
        count += T::select(touch.lanes, one, zero);
        touch.note(found);
    }
}

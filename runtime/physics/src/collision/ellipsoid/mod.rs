//! Contacts that involve ellipsoids.
//!
//! The signed distance of two convex shapes is the largest value that
//!
//! ```text
//! g(n) = n·(c2 - c1) - h1(n) - h2(-n)
//! ```
//!
//! takes over unit vectors n, where h is a shape's support function about its centre c: positive when the shapes are
//! apart, minus the least translation that separates them when they overlap. MuJoCo finds it with GJK and EPA to its
//! `ccd_tolerance` (1e-6 m by default); the solutions here are exact to rounding:
//!
//! * against a point, g is the signed distance of a point to an ellipsoid, one root of a scalar convex function
//!   (D. Eberly, "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid");
//! * against a segment, the best normal either belongs to one of its ends or is perpendicular to it, and then the problem
//!   is that of a point and an ellipse in the plane across the segment. Inside the ellipsoid an end has several such normals,
//!   so a segment that reaches inside is left to the search for depth;
//! * two ellipsoids: Newton's method on the sphere, from several starts when they overlap.
//!
//! Points and segments are solved in all lanes at once; the search for depth and two ellipsoids take one episode at a time.

mod point;
mod two;

use super::{
    ContactPoint, Placed,
    convex::{self, Scratch, support::SupportShape},
    touch::{Pair, Touch, choose, frame_of},
};
use crate::{
    model::GeomKind,
    scalar::Real,
    spatial::{dot, minus, opposite, over, plus, product, rotate, rotate_back, scale, transposed},
};
use nalgebra::{Matrix3, Vector3};
use point::point_to_ellipsoid;
use two::separate_ellipsoids;

/// The best separating normal found so far.
#[derive(Clone, Copy)]
struct Separation<T: Real = f64> {
    /// Signed distance, m.
    distance: T,
    /// From the ellipsoid towards the other shape.
    normal: Vector3<T>,
}

/// Point relative to the ellipsoid's centre, world axes.
#[inline(always)]
fn separate_point<T: Real>(lanes: T::Mask, ellipsoid: &Placed<'_, T>, point: &Vector3<T>) -> Separation<T> {
    let local = rotate_back(&ellipsoid.rotation, point);
    let size = &ellipsoid.size;
    let (distance, [x, y, z]) = point_to_ellipsoid(lanes, &[size.x, size.y, size.z], &[local.x, local.y, local.z]);
    Separation { distance, normal: rotate(&ellipsoid.rotation, &Vector3::new(x, y, z)) }
}

/// The best normal across `axis`: the point against the ellipsoid's shadow in the plane across the axis.
#[inline(always)]
fn separate_across<T: Real>(lanes: T::Mask, shape: &Matrix3<T>, centre: &Vector3<T>, axis: &Vector3<T>) -> Separation<T> {
    let (zero, one, two) = (T::splat(0.0), T::splat(1.0), T::splat(2.0));
    let frame = frame_of(*axis, None);
    let (u, v) = (Vector3::new(frame.m21, frame.m22, frame.m23), Vector3::new(frame.m31, frame.m32, frame.m33));
    let (shape_u, shape_v) = (rotate(shape, &u), rotate(shape, &v));
    let (uu, off, vv) = (dot(&u, &shape_u), dot(&u, &shape_v), dot(&v, &shape_v));
    let (mean, half) = ((uu + vv) / two, (uu - vv) / two);
    let radius = (half * half + off * off).sqrt();
    // Principal axis of the larger eigenvalue mean + radius, from the better conditioned of two formulas.
    let wide = zero.is_at_most(half);
    let (x, y) = (T::select(wide, half + radius, off), T::select(wide, off, radius - half));
    let length = (x * x + y * y).sqrt();
    let round = length.is_at_most(T::splat(1e-300));
    let (x, y) = (T::select(round, one, x / length), T::select(round, zero, y / length));
    let p = plus(&scale(&u, x), &scale(&v, y));
    let q = minus(&scale(&v, x), &scale(&u, y));
    let larger = mean + radius;
    let smaller = ((uu * vv - off * off) / larger).at_least(zero);
    let (distance, [x, y]) = point_to_ellipsoid(lanes, &[larger.sqrt(), smaller.sqrt()], &[dot(&p, centre), dot(&q, centre)]);
    Separation { distance, normal: plus(&scale(&p, x), &scale(&q, y)) }
}

/// A with h(n) = sqrt(n'An), the square of the support function about the centre.
#[inline(always)]
fn shape_matrix<T: Real>(ellipsoid: &Placed<'_, T>) -> Matrix3<T> {
    let (size, zero) = (&ellipsoid.size, T::splat(0.0));
    let squares = Matrix3::new(size.x * size.x, zero, zero, zero, size.y * size.y, zero, zero, zero, size.z * size.z);
    product(&product(&ellipsoid.rotation, &squares), &transposed(&ellipsoid.rotation))
}

/// How a shape stands to an ellipsoid: signed distance, unit normal from the shape to the ellipsoid, and the point half way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stand<T: Real = f64> {
    pub distance: T,
    normal: Vector3<T>,
    middle: Vector3<T>,
}

impl<T: Real> Stand<T> {
    /// `separation` is that of the shape's core, `radius` around which the shape is round.
    #[inline(always)]
    fn new(ellipsoid: &Placed<'_, T>, shape: &Matrix3<T>, separation: &Separation<T>, radius: T) -> Self {
        let normal = &separation.normal;
        let support = rotate(shape, normal);
        let surface = plus(&ellipsoid.position, &over(&support, dot(normal, &support).sqrt()));
        let distance = separation.distance - radius;
        Self { distance, normal: opposite(normal), middle: plus(&surface, &scale(normal, distance / T::splat(2.0))) }
    }

    /// The contact, in the lanes of the mask where it is within reach.
    #[inline(always)]
    fn touch(&self, lanes: T::Mask, reach: T) -> Touch<T> {
        let lanes = T::and(lanes, self.distance.is_at_most(reach));
        Touch { lanes, distance: self.distance, position: self.middle, frame: frame_of(self.normal, None) }
    }
}

impl Stand {
    /// The nearest points of the shape and the ellipsoid.
    pub fn points(&self) -> [Vector3<f64>; 2] {
        let half = self.normal * (self.distance / 2.0);
        [self.middle - half, self.middle + half]
    }
}

/// A sphere, capsule or ellipsoid against an ellipsoid; `None` for other shapes.
pub(super) fn separate(shape: &Placed<'_>, ellipsoid: &Placed<'_>, scratch: &mut Scratch) -> Option<Stand> {
    match shape.kind {
        GeomKind::Sphere => Some(stand_of_sphere(true, shape, ellipsoid)),
        GeomKind::Capsule => Some(stand_of_capsule(true, shape, ellipsoid, scratch)),
        GeomKind::Ellipsoid => Some(Stand::new(ellipsoid, &shape_matrix(ellipsoid), &separate_ellipsoids(shape, ellipsoid), 0.0)),
        _ => None,
    }
}

/// Sphere against ellipsoid.
#[inline(always)]
pub(super) fn sphere<T: Real>(pair: &Pair<'_, T>, found: &mut Vec<Touch<T>>) {
    let [sphere, ellipsoid] = &pair.shapes;
    stand_of_sphere(pair.lanes, sphere, ellipsoid).touch(pair.lanes, pair.reach).note(found);
}

/// Capsule against ellipsoid.
#[inline(always)]
pub(super) fn capsule<T: Real>(pair: &Pair<'_, T>, scratch: &mut Scratch, found: &mut Vec<Touch<T>>) {
    let [capsule, ellipsoid] = &pair.shapes;
    stand_of_capsule(pair.lanes, capsule, ellipsoid, scratch).touch(pair.lanes, pair.reach).note(found);
}

/// Ellipsoid against ellipsoid.
pub(super) fn collide(first: &Placed<'_>, second: &Placed<'_>, reach: f64, found: &mut Vec<ContactPoint>) {
    let stand = Stand::new(second, &shape_matrix(second), &separate_ellipsoids(first, second), 0.0);
    found.extend(stand.touch(true, reach).in_lane(0));
}

#[inline(always)]
fn stand_of_sphere<T: Real>(lanes: T::Mask, sphere: &Placed<'_, T>, ellipsoid: &Placed<'_, T>) -> Stand<T> {
    let separation = separate_point(lanes, ellipsoid, &minus(&sphere.position, &ellipsoid.position));
    Stand::new(ellipsoid, &shape_matrix(ellipsoid), &separation, sphere.size.x)
}

#[inline(always)]
fn stand_of_capsule<T: Real>(
    lanes: T::Mask,
    capsule: &Placed<'_, T>,
    ellipsoid: &Placed<'_, T>,
    scratch: &mut Scratch,
) -> Stand<T> {
    let shape = shape_matrix(ellipsoid);
    let mut separation = separate_segment(lanes, capsule, ellipsoid, &shape);
    let inside = T::and(lanes, separation.distance.less(T::splat(0.0)));
    if T::any(inside) {
        for lane in (0..T::LANES).filter(|&lane| T::holds(inside, lane)) {
            let deeper = depth(&capsule.in_lane(lane), &ellipsoid.in_lane(lane), scratch);
            if let Some((distance, normal)) = deeper.filter(|(distance, _)| *distance > separation.distance.lane(lane)) {
                separation.distance.set_lane(lane, distance);
                separation.normal.iter_mut().zip(&normal).for_each(|(to, from)| to.set_lane(lane, *from));
            }
        }
    }
    Stand::new(ellipsoid, &shape, &separation, capsule.size.x)
}

/// How deep a capsule's segment reaches into an ellipsoid, below zero, and the normal.
#[inline(never)]
fn depth(capsule: &Placed<'_>, ellipsoid: &Placed<'_>, scratch: &mut Scratch) -> Option<(f64, Vector3<f64>)> {
    let segment = SupportShape::new(capsule, ellipsoid.position)?;
    let core = SupportShape::new(ellipsoid, ellipsoid.position)?;
    let found = convex::separate(&SupportShape { radius: 0.0, ..segment }, &core, 0.0, scratch)?;
    Some((found.distance, -found.normal))
}

/// A capsule's segment against an ellipsoid.
#[inline(always)]
fn separate_segment<T: Real>(
    lanes: T::Mask,
    capsule: &Placed<'_, T>,
    ellipsoid: &Placed<'_, T>,
    shape: &Matrix3<T>,
) -> Separation<T> {
    let centre = minus(&capsule.position, &ellipsoid.position);
    let axis = capsule.axis();
    let mut best = separate_across(lanes, shape, &centre, &axis);
    for end in [capsule.size.y, -capsule.size.y] {
        let separation = separate_point(lanes, ellipsoid, &plus(&centre, &scale(&axis, end)));
        // An end decides only where it is the nearer one along its own normal.
        let nearer = (dot(&separation.normal, &axis) * end).is_at_most(T::splat(0.0));
        let better = T::and(nearer, best.distance.less(separation.distance));
        best.distance = T::select(better, separation.distance, best.distance);
        best.normal = choose(better, &separation.normal, &best.normal);
    }
    best
}

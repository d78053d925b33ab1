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

use super::{
    ContactPoint, Placed,
    convex::{self, Scratch, support::SupportShape},
    frame_of,
};
use crate::model::GeomKind;
use crate::scalar::Real;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// Signed distance of `point` to the ellipsoid with half axes `axes` along the coordinate axes, and the outward unit normal
/// at the nearest point of its surface.
fn point_to_ellipsoid<const N: usize>(axes: [f64; N], point: [f64; N]) -> (f64, [f64; N]) {
    // The nearest point is x_i = a_i² y_i / (t + a_i²) for the largest root of  sum (a_i y_i / (t + a_i²))² = 1,
    // written in s = t + a_min² >= 0 so that points close to the smallest axis' plane keep their precision.
    let smallest = (0..N).fold(0, |best, i| if axes[i] < axes[best] { i } else { best });
    let excess: [f64; N] = core::array::from_fn(|i| (axes[i] - axes[smallest]) * (axes[i] + axes[smallest]));
    let mut s: f64 = (0..N).map(|i| axes[i] * point[i].abs() - excess[i]).fold(0.0, Real::at_least);
    for _ in 0..100 {
        let (mut value, mut slope) = (-1.0, 0.0);
        for i in (0..N).filter(|&i| point[i] != 0.0) {
            let ratio = axes[i] * point[i] / (s + excess[i]);
            value += ratio * ratio;
            slope -= 2.0 * ratio * ratio / (s + excess[i]);
        }
        // The function is convex and falling, so Newton's steps grow s monotonically up to the root.
        if value <= 0.0 || slope == 0.0 {
            break;
        }
        let next = s - value / slope;
        if next <= s {
            break;
        }
        s = next;
    }
    // x_i / a_i² is the normal's direction; where s + excess vanishes, the remaining length of the unit vector x_i / a_i.
    let mut unit: [f64; N] =
        core::array::from_fn(|i| if s + excess[i] > 0.0 { axes[i] * point[i] / (s + excess[i]) } else { 0.0 });
    if s <= 0.0 {
        let others: f64 = (0..N).filter(|&i| i != smallest).map(|i| unit[i] * unit[i]).sum();
        unit[smallest] = (1.0 - others).at_least(0.0).sqrt();
    }
    let gradient: [f64; N] = core::array::from_fn(|i| unit[i] / axes[i]);
    let length = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
    let normal: [f64; N] = gradient.map(|g| g / length);
    let distance = (0..N).map(|i| normal[i] * (point[i] - axes[i] * unit[i])).sum();
    (distance, normal)
}

/// The best separating normal found so far.
#[derive(Clone, Copy)]
struct Separation {
    /// Signed distance, m.
    distance: f64,
    /// From the ellipsoid towards the other shape.
    normal: Vector3<f64>,
}

/// Point relative to the ellipsoid's centre, world axes.
fn separate_point(ellipsoid: &Placed<'_>, point: Vector3<f64>) -> Separation {
    let local = ellipsoid.rotation.tr_mul(&point);
    let (distance, normal) = point_to_ellipsoid(ellipsoid.size.into(), local.into());
    Separation { distance, normal: ellipsoid.rotation * Vector3::from(normal) }
}

/// The best normal across `axis`: the point against the ellipsoid's shadow in the plane across the axis.
fn separate_across(ellipsoid: &Placed<'_>, centre: Vector3<f64>, axis: Vector3<f64>) -> Separation {
    let frame = frame_of(axis, None);
    let (u, v) = (frame.row(1).transpose(), frame.row(2).transpose());
    let shape = shape_matrix(ellipsoid);
    let shadow = Matrix2::new(u.dot(&(shape * u)), u.dot(&(shape * v)), u.dot(&(shape * v)), v.dot(&(shape * v)));
    let mean = (shadow.m11 + shadow.m22) / 2.0;
    let (half, off) = ((shadow.m11 - shadow.m22) / 2.0, shadow.m12);
    let radius = (half * half + off * off).sqrt();
    // Principal axis of the larger eigenvalue mean + radius, from the better conditioned of two formulas.
    let major = if half >= 0.0 { Vector2::new(half + radius, off) } else { Vector2::new(off, radius - half) };
    let major = major.try_normalize(1e-300).unwrap_or_else(Vector2::x);
    let (p, q) = (u * major.x + v * major.y, v * major.x - u * major.y);
    let larger = mean + radius;
    let smaller = (shadow.determinant() / larger).at_least(0.0);
    let (distance, normal) = point_to_ellipsoid([larger.sqrt(), smaller.sqrt()], [p.dot(&centre), q.dot(&centre)]);
    Separation { distance, normal: p * normal[0] + q * normal[1] }
}

/// A with h(n) = sqrt(n'An), the square of the support function about the centre.
fn shape_matrix(ellipsoid: &Placed<'_>) -> Matrix3<f64> {
    let squares = ellipsoid.size.component_mul(&ellipsoid.size);
    ellipsoid.rotation * Matrix3::from_diagonal(&squares) * ellipsoid.rotation.transpose()
}

/// How a shape stands to an ellipsoid: signed distance, unit normal from the shape to the ellipsoid, and the point half way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stand {
    pub distance: f64,
    normal: Vector3<f64>,
    middle: Vector3<f64>,
}

impl Stand {
    /// `separation` is that of the shape's core, `radius` around which the shape is round.
    fn new(ellipsoid: &Placed<'_>, separation: Separation, radius: f64) -> Self {
        let support = shape_matrix(ellipsoid) * separation.normal;
        let surface = ellipsoid.position + support / separation.normal.dot(&support).sqrt();
        let distance = separation.distance - radius;
        Self { distance, normal: -separation.normal, middle: surface + separation.normal * (distance / 2.0) }
    }

    /// The nearest points of the shape and the ellipsoid.
    pub fn points(&self) -> [Vector3<f64>; 2] {
        let half = self.normal * (self.distance / 2.0);
        [self.middle - half, self.middle + half]
    }
}

/// A sphere, capsule or ellipsoid against an ellipsoid; `None` for other shapes.
pub(super) fn separate(shape: &Placed<'_>, ellipsoid: &Placed<'_>, scratch: &mut Scratch) -> Option<Stand> {
    let centre = shape.position - ellipsoid.position;
    match shape.kind {
        GeomKind::Sphere => Some(Stand::new(ellipsoid, separate_point(ellipsoid, centre), shape.size.x)),
        GeomKind::Capsule => {
            let mut separation = separate_segment(shape, ellipsoid, centre);
            if separation.distance < 0.0
                && let [Some(segment), Some(core)] = [shape, ellipsoid].map(|shape| SupportShape::new(shape, ellipsoid.position))
                && let Some(found) = convex::separate(&SupportShape { radius: 0.0, ..segment }, &core, 0.0, scratch)
                && found.distance > separation.distance
            {
                separation = Separation { distance: found.distance, normal: -found.normal };
            }
            Some(Stand::new(ellipsoid, separation, shape.size.x))
        }
        GeomKind::Ellipsoid => Some(Stand::new(ellipsoid, separate_ellipsoids(shape, ellipsoid), 0.0)),
        _ => None,
    }
}

/// A sphere, capsule or ellipsoid against an ellipsoid.
pub(super) fn collide(
    shape: &Placed<'_>,
    ellipsoid: &Placed<'_>,
    reach: f64,
    scratch: &mut Scratch,
    found: &mut Vec<ContactPoint>,
) {
    let near = separate(shape, ellipsoid, scratch).filter(|stand| stand.distance <= reach);
    found.extend(near.map(|stand| ContactPoint {
        distance: stand.distance,
        position: stand.middle,
        frame: frame_of(stand.normal, None),
    }));
}

/// A capsule's segment against an ellipsoid.
fn separate_segment(capsule: &Placed<'_>, ellipsoid: &Placed<'_>, centre: Vector3<f64>) -> Separation {
    let axis = capsule.axis();
    let mut best = separate_across(ellipsoid, centre, axis);
    for end in [capsule.size.y, -capsule.size.y] {
        let separation = separate_point(ellipsoid, centre + axis * end);
        // An end decides only where it is the nearer one along its own normal.
        if separation.normal.dot(&axis) * end <= 0.0 && separation.distance > best.distance {
            best = separation;
        }
    }
    best
}

/// Two ellipsoids in the form that Newton's method works on.
struct Pair {
    /// Centre of the first relative to the second.
    between: Vector3<f64>,
    /// Squared support functions.
    shapes: [Matrix3<f64>; 2],
}

impl Pair {
    fn value(&self, normal: &Vector3<f64>) -> f64 {
        normal.dot(&self.between) - self.shapes.iter().map(|shape| normal.dot(&(shape * normal)).sqrt()).sum::<f64>()
    }

    /// Climbs g on the unit sphere from `normal`: Newton where g is locally concave, else along the gradient.
    fn climb(&self, mut normal: Vector3<f64>) -> Separation {
        let mut value = self.value(&normal);
        for _ in 0..50 {
            let mut gradient = self.between;
            let mut hessian = Matrix3::zeros();
            for shape in &self.shapes {
                let support = shape * normal;
                let height = normal.dot(&support).sqrt();
                gradient -= support / height;
                hessian -= shape / height - support * support.transpose() / (height * height * height);
            }
            let frame = frame_of(normal, None);
            let (u, v) = (frame.row(1).transpose(), frame.row(2).transpose());
            let slope = Vector2::new(u.dot(&gradient), v.dot(&gradient));
            let cross = u.dot(&(hessian * v));
            // On the sphere the second derivative of a function homogeneous of degree one loses its own value.
            let curvature = Matrix2::new(u.dot(&(hessian * u)) - value, cross, cross, v.dot(&(hessian * v)) - value);
            let concave = curvature.m11 < 0.0 && curvature.determinant() > 0.0;
            let newton = if concave { curvature.try_inverse().map(|inverse| -(inverse * slope)) } else { None };
            let mut step = newton.unwrap_or_else(|| slope / self.between.norm().at_least(1e-3));
            if step.norm() > 0.5 {
                step *= 0.5 / step.norm();
            }
            let mut improved = false;
            for _ in 0..30 {
                let candidate = (normal + u * step.x + v * step.y).normalize();
                let there = self.value(&candidate);
                if there > value {
                    improved = there - value > 1e-16;
                    (normal, value) = (candidate, there);
                    break;
                }
                step *= 0.5;
            }
            if !improved {
                break;
            }
        }
        Separation { distance: value, normal }
    }
}

/// Ellipsoid against ellipsoid.
fn separate_ellipsoids(first: &Placed<'_>, second: &Placed<'_>) -> Separation {
    let between = first.position - second.position;
    let pair = Pair { between, shapes: [shape_matrix(first), shape_matrix(second)] };
    let mut best = pair.climb(between.try_normalize(1e-12).unwrap_or_else(Vector3::z));
    if best.distance < 0.0 {
        // Overlapping shapes have several local answers; the flat directions of either shape lead to the others.
        for column in first.rotation.column_iter().chain(second.rotation.column_iter()) {
            let towards = if column.dot(&between) < 0.0 { -column.into_owned() } else { column.into_owned() };
            let other = pair.climb(towards);
            if other.distance > best.distance {
                best = other;
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_on_an_axis_lies_beyond_or_before_the_surface_by_the_difference() {
        let (outside, normal) = point_to_ellipsoid([3.0, 2.0, 1.0], [0.0, 0.0, 1.5]);
        assert!((outside - 0.5).abs() < 1e-15 && (normal[2] - 1.0).abs() < 1e-15);
        let (inside, _) = point_to_ellipsoid([3.0, 2.0, 1.0], [0.0, 0.0, 0.25]);
        assert!((inside + 0.75).abs() < 1e-15);
        let (centre, normal) = point_to_ellipsoid([3.0, 2.0, 1.0], [0.0; 3]);
        assert!((centre + 1.0).abs() < 1e-15 && (normal[2].abs() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_nearest_point_is_stationary() {
        for k in 0..500 {
            let point: [f64; 3] = core::array::from_fn(|i| 4.0 * libm::sin(1.7 * k as f64 + 2.3 * i as f64 * (k as f64 + 1.0)));
            let axes = [0.085, 1.3, 0.4];
            let (distance, normal) = point_to_ellipsoid(axes, point);
            // Moving back along the normal lands on the surface, where the surface has that normal.
            let foot: [f64; 3] = core::array::from_fn(|i| point[i] - distance * normal[i]);
            let level: f64 = (0..3).map(|i| (foot[i] / axes[i]).squared()).sum();
            assert!((level - 1.0).abs() < 1e-10, "level {level} at {point:?}");
        }
    }
}

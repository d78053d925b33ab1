//! Two ellipsoids: Newton's method on the sphere, one episode at a time.

use super::super::{Placed, touch::frame_of};
use super::{Separation, shape_matrix};
use crate::scalar::Real;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

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
pub(super) fn separate_ellipsoids(first: &Placed<'_>, second: &Placed<'_>) -> Separation {
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

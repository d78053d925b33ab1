//! Spatial tendons without Jacobians.
//!
//! The length of a path is a sum of straight segments and arcs. Only segments that join two different bodies change with the
//! configuration at first order: an arc lies on one body and its tangent points move along it at no cost. Such a segment is
//! a *line of force* l = (moment about the tree's centre of mass, unit direction), the same for both of its bodies, so that
//!
//! * the lengthening velocity of the tendon is the sum of l . (velocity of the second body - velocity of the first),
//! * its tension pulls the first body with +l and the second with -l,
//!
//! both in spatial vectors. A sweep up the tree turns the gathered pulls into generalised forces, which is J'f without J.

use crate::{model::Model, scalar::Real};

/// Lengths, velocities and lines of force of all tendons.
#[derive(Debug, Clone)]
pub struct TendonPaths<T: Real> {
    /// Length, m (`ten_length`).
    pub length: Vec<T>,
    /// Rate of lengthening, m/s (`ten_velocity`); filled once body velocities are known.
    pub velocity: Vec<T>,
}

impl<T: Real> TendonPaths<T> {
    /// Memory for `model`, and the decisions that depend on it alone.
    pub fn new(model: &Model) -> Self {
        let zeros = vec![T::splat(0.0); model.tendons.name.len()];
        Self { length: zeros.clone(), velocity: zeros }
    }
}

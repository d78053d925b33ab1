//! Generalised forces and the acceleration that they cause without constraints.

use super::spatial::{Spatial, spatial_zero};
use crate::{model::Model, scalar::Real};

/// Generalised forces, `nv` entries each: N and N m.
#[derive(Debug, Clone)]
pub struct Forces<T: Real> {
    /// Springs and dampers of joints and tendons (`qfrc_passive`).
    pub passive: Vec<T>,
    /// Coriolis, centrifugal and gravitational forces, on the left-hand side of M a + bias = force (`qfrc_bias`).
    pub bias: Vec<T>,
    /// Muscles (`qfrc_actuator`).
    pub actuator: Vec<T>,
    /// Passive - bias + actuator + applied (`qfrc_smooth`).
    pub smooth: Vec<T>,
    /// M^-1 smooth (`qacc_smooth`), m/s² and rad/s².
    pub smooth_acceleration: Vec<T>,
    /// Acceleration of every body without joint accelerations, then scratch of the sweeps.
    pub(super) body_acceleration: Vec<Spatial<T>>,
    /// Forces on bodies, scratch of the sweeps.
    pub(super) body_force: Vec<Spatial<T>>,
}

impl<T: Real> Forces<T> {
    /// Memory for `model`.
    pub fn new(model: &Model) -> Self {
        let zeros = vec![T::splat(0.0); model.nv];
        let bodies = vec![spatial_zero(); model.bodies.parent.len()];
        Self {
            passive: zeros.clone(),
            bias: zeros.clone(),
            actuator: zeros.clone(),
            smooth: zeros.clone(),
            smooth_acceleration: zeros,
            body_acceleration: bodies.clone(),
            body_force: bodies,
        }
    }
}

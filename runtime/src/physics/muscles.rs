//! Muscles: activation dynamics and force.

use crate::{model::Model, scalar::Real};

/// One entry per muscle.
#[derive(Debug, Clone)]
pub struct Muscles<T: Real> {
    /// Length of the muscle-tendon path times gear, m (`actuator_length`).
    pub length: Vec<T>,
    /// Its rate, m/s (`actuator_velocity`).
    pub velocity: Vec<T>,
    /// Rate of activation, 1/s (`act_dot`).
    pub activation_rate: Vec<T>,
    /// Force, N; negative pulls (`actuator_force`).
    pub force: Vec<T>,
}

impl<T: Real> Muscles<T> {
    /// Memory for `model`.
    pub fn new(model: &Model) -> Self {
        let zeros = vec![T::splat(0.0); model.actuators.name.len()];
        Self { length: zeros.clone(), velocity: zeros.clone(), activation_rate: zeros.clone(), force: zeros }
    }
}

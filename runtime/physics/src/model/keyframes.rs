//! Key frames: states with a name that a model file carries.

use super::{Model, Quaternion};
use crate::State;
use nalgebra::Vector3;

/// A state with a name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Keyframe {
    /// Its name; empty where the file gives none.
    pub name: String,
    /// Time, s.
    pub time: f64,
    /// Generalised positions, `nq` entries.
    pub position: Vec<f64>,
    /// Generalised velocities, `nv` entries.
    pub velocity: Vec<f64>,
    /// Activations, `na` entries.
    pub activation: Vec<f64>,
    /// Controls, one per actuator.
    pub control: Vec<f64>,
    /// Positions of the bodies that are placed from outside, m, world frame.
    pub mocap_position: Vec<Vector3<f64>>,
    /// Their orientations.
    pub mocap_orientation: Vec<Quaternion>,
}

impl Keyframe {
    /// The reference configuration at rest.
    pub fn of_reference(model: &Model) -> Self {
        let placed = (0..model.bodies.mocap.len()).filter(|&body| model.bodies.mocap[body]);
        Self {
            name: String::new(),
            time: 0.0,
            position: model.reference_position.clone(),
            velocity: vec![0.0; model.nv],
            activation: vec![0.0; model.na],
            control: vec![0.0; model.actuators.name.len()],
            mocap_position: placed.clone().map(|body| model.bodies.position[body]).collect(),
            mocap_orientation: placed.map(|body| model.bodies.orientation[body]).collect(),
        }
    }

    /// The state that it describes, with nothing applied. Where the model has grown since, the rest is at the reference.
    pub fn state(&self, model: &Model) -> State<f64> {
        fn begin<T: Clone>(values: &mut [T], with: &[T]) {
            values.iter_mut().zip(with).for_each(|(value, given)| value.clone_from(given));
        }
        let mut state = State::new(model);
        state.time = self.time;
        begin(&mut state.position, &self.position);
        begin(&mut state.velocity, &self.velocity);
        begin(&mut state.activation, &self.activation);
        begin(&mut state.control, &self.control);
        begin(&mut state.mocap_position, &self.mocap_position);
        begin(&mut state.mocap_orientation, &self.mocap_orientation);
        state
    }
}

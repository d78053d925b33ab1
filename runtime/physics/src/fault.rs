//! What can go wrong in a step.

use crate::model::Model;
use msk_text::numbers::exact;
use serde::{Deserialize, Serialize};

/// A quantity that is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Quantity {
    /// Generalised position.
    Position,
    /// Generalised velocity.
    Velocity,
    /// Generalised acceleration.
    Acceleration,
}

impl core::fmt::Display for Quantity {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.write_str(match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        })
    }
}

/// An input of an actuator that is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Input {
    /// What it is asked for.
    Excitation,
    /// Its delayed state.
    Activation,
    /// The length of its fibre, where tendons are elastic.
    FibreLength,
    /// The rate of that.
    FibreVelocity,
}

impl core::fmt::Display for Input {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.write_str(match self {
            Self::Excitation => "excitation",
            Self::Activation => "activation",
            Self::FibreLength => "fibre length",
            Self::FibreVelocity => "fibre velocity",
        })
    }
}

/// Why a step could not be taken. The state is that before the step.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
pub enum Fault {
    /// A number is not finite or too large to mean anything (MuJoCo's limit, 1e10).
    #[error("at {} s the {quantity} of joint `{joint}` (body `{body}`) is {}", exact(*time), exact(*value))]
    Diverged {
        /// Simulated time, s.
        time: f64,
        /// What diverged.
        quantity: Quantity,
        /// Its joint.
        joint: String,
        /// The body that the joint moves.
        body: String,
        /// Its value.
        value: f64,
    },
    /// The excitation (control) or activation of a muscle or other actuator is not a finite number.
    #[error("at {} s the {input} of muscle `{muscle}` is {}", exact(*time), exact(*value))]
    Input {
        /// Simulated time, s.
        time: f64,
        /// Excitation or activation.
        input: Input,
        /// The muscle.
        muscle: String,
        /// Its value.
        value: f64,
    },
    /// The pose that a body is given from outside is not finite.
    #[error("at {} s the pose given to body `{body}` is not finite", exact(*time))]
    Placed {
        /// Simulated time, s.
        time: f64,
        /// The body.
        body: String,
    },
    /// The mass matrix (with constraints) has no positive pivot at this joint.
    #[error("at {} s the inertia at joint `{joint}` (body `{body}`) is not positive: the constraint solver cannot go on", exact(*time))]
    Singular {
        /// Simulated time, s.
        time: f64,
        /// The joint.
        joint: String,
        /// The body that the joint moves.
        body: String,
    },
}

/// Values beyond this count as diverged, MuJoCo's `mjMAXVAL`.
const LARGEST: f64 = 1e10;
/// The next number.
const BEYOND: f64 = LARGEST.next_up();

/// Whether a value is finite and of a size that means something.
pub(super) fn is_valid(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// [`is_valid`] in every lane.
#[inline(always)]
pub(super) fn valid<T: crate::scalar::Real>(value: T) -> T::Mask {
    value.abs().less(T::splat(BEYOND))
}

fn names(model: &Model, joint: usize) -> (String, String) {
    (model.joints.name[joint].clone(), model.bodies.name[model.joints.body[joint]].clone())
}

impl Fault {
    /// The fault of a dof's velocity or acceleration.
    pub(super) fn of_dof(model: &Model, time: f64, quantity: Quantity, dof: usize, value: f64) -> Self {
        let (joint, body) = names(model, model.dofs.joint[dof]);
        Self::Diverged { time, quantity, joint, body, value }
    }

    /// The fault of a coordinate.
    pub(super) fn of_coordinate(model: &Model, time: f64, coordinate: usize, value: f64) -> Self {
        // Joints own consecutive coordinates: the last that starts at or before this one.
        let after = model.joints.position_address.partition_point(|&address| address <= coordinate);
        let (joint, body) = names(model, after.saturating_sub(1));
        Self::Diverged { time, quantity: Quantity::Position, joint, body, value }
    }

    /// The fault of an actuator's control or activation.
    pub(super) fn of_input(model: &Model, time: f64, input: Input, actuator: usize, value: f64) -> Self {
        Self::Input { time, input, muscle: model.actuators.name[actuator].clone(), value }
    }

    /// The fault of the body that is the `index`-th to be placed from outside.
    pub(super) fn of_mocap(model: &Model, time: f64, index: usize) -> Self {
        let mut placed = (0..model.bodies.mocap.len()).filter(|&body| model.bodies.mocap[body]);
        let body = placed.nth(index).map_or_else(String::new, |body| model.bodies.name[body].clone());
        Self::Placed { time, body }
    }

    /// The fault of a pivot.
    pub(super) fn of_pivot(model: &Model, time: f64, dof: usize) -> Self {
        let (joint, body) = names(model, model.dofs.joint[dof]);
        Self::Singular { time, joint, body }
    }
}

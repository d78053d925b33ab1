//! What a trace may hold.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A block of columns of a trace.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Excitation of each muscle, 0..1.
    Excitations,
    /// Activation of each muscle, 0..1.
    Activations,
    /// Tension of each muscle, N.
    MuscleForces,
    /// Coordinates of root and joints, m, rad, and parts of quaternions.
    Positions,
    /// Velocities of root and joints, m/s and rad/s.
    Velocities,
    /// What muscles and other actuators do about or along each degree of freedom, N m or N.
    Torques,
    /// Size of the force that each joint bears, N.
    JointReactions,
    /// Size of the force with which anything outside touches the segment of each landmark, N.
    Contacts,
    /// Of each foot: force of the ground, N, its centre of pressure, m, and free torque about the vertical, N m, in the world frame.
    GroundReactions,
    /// Place of each foot in the world frame, m.
    Feet,
    /// Place of the body's centre of mass in the world frame, m.
    CenterOfMass,
    /// Metabolic power of all muscles together, W.
    MetabolicPower,
    /// Root mean square distance, per coordinate, of the body's landmarks from where the reference motion has them, m.
    TrackingError,
    /// What each reward term adds to the reward: weight times value.
    Terms,
    /// The reward.
    Rewards,
    /// What a policy observes.
    Observations,
    /// The last action, clipped to [-1, 1].
    Actions,
}

impl Quantity {
    /// All of them, in the order of a trace.
    pub const ALL: [Self; 17] = [
        Self::Excitations,
        Self::Activations,
        Self::MuscleForces,
        Self::Positions,
        Self::Velocities,
        Self::Torques,
        Self::JointReactions,
        Self::Contacts,
        Self::GroundReactions,
        Self::Feet,
        Self::CenterOfMass,
        Self::MetabolicPower,
        Self::TrackingError,
        Self::Terms,
        Self::Rewards,
        Self::Observations,
        Self::Actions,
    ];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Excitations => "excitations",
            Self::Activations => "activations",
            Self::MuscleForces => "muscle_forces",
            Self::Positions => "positions",
            Self::Velocities => "velocities",
            Self::Torques => "torques",
            Self::JointReactions => "joint_reactions",
            Self::Contacts => "contacts",
            Self::GroundReactions => "ground_reactions",
            Self::Feet => "feet",
            Self::CenterOfMass => "center_of_mass",
            Self::MetabolicPower => "metabolic_power",
            Self::TrackingError => "tracking_error",
            Self::Terms => "terms",
            Self::Rewards => "rewards",
            Self::Observations => "observations",
            Self::Actions => "actions",
        }
    }

    /// Whether it belongs to a control step and not to a state: there is none at the reset.
    pub fn is_of_steps(self) -> bool {
        matches!(self, Self::Terms | Self::Rewards | Self::Actions)
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A word that names no quantity.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no quantity `{0}` in a trace; choose of: {names}, or `all`", names = Quantity::ALL.map(Quantity::name).join(", "))]
pub struct QuantityError(pub String);

impl FromStr for Quantity {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        Self::ALL.into_iter().find(|quantity| quantity.name() == text).ok_or_else(|| QuantityError(text.to_owned()))
    }
}

/// Quantities as a command line names them, `activations,terms` or `all`, in the order of a trace and each once.
///
/// # Errors
/// A word that names none.
pub fn quantities(text: &str) -> Result<Vec<Quantity>, QuantityError> {
    if text == "all" {
        return Ok(Quantity::ALL.to_vec());
    }
    let mut found: Vec<Quantity> = text.split(',').map(|word| word.trim().parse()).collect::<Result<_, _>>()?;
    found.sort();
    found.dedup();
    Ok(found)
}

//! The flat record of sensor values that a compiled task reads.
//!
//! A task asks for [`Sensor`]s; each gets a fixed slot in a flat `[f64]`. The runtime fills exactly these, once per control
//! step, after the physics substeps. Vectors are in world axes; indices are positions in the [`Vocabulary`]'s lists.
//!
//! [`Vocabulary`]: crate::vocabulary::Vocabulary

use serde::{Deserialize, Serialize};

/// One block of values that the runtime can measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sensor {
    /// Position of a landmark: 3, m.
    LandmarkPosition(usize),
    /// Velocity of the very point: 3, m/s.
    LandmarkVelocity(usize),
    /// Mean acceleration over the control step: 3, m/s².
    LandmarkAcceleration(usize),
    /// Anatomical axes forward, left, up in world axes: 9, column after column.
    LandmarkAxes(usize),
    /// Angular velocity: 3, rad/s.
    LandmarkAngularVelocity(usize),
    /// Height of the lowest point of the landmark's segment above walkable ground: 1, m.
    LandmarkClearance(usize),
    /// Joint coordinate: 1, rad or m.
    JointPosition(usize),
    /// Joint velocity: 1, rad/s or m/s.
    JointVelocity(usize),
    /// Joint acceleration: 1, rad/s² or m/s².
    JointAcceleration(usize),
    /// Generalised muscle force on the joint: 1, N m or N.
    JointTorque(usize),
    /// Tendon length of a muscle: 1, m.
    MuscleLength(usize),
    /// Its rate: 1, m/s.
    MuscleVelocity(usize),
    /// Actuator force as the physics has it, pulling negative: 1, N.
    MuscleForce(usize),
    /// Activation: 1, in 0..1.
    MuscleActivation(usize),
    /// Excitation: 1, in 0..1.
    MuscleExcitation(usize),
    /// The policy's raw action: 1.
    Action(usize),
    /// Position of the whole body's centre of mass: 3, m.
    ComPosition,
    /// Its velocity: 3, m/s.
    ComVelocity,
    /// Its mean acceleration over the control step: 3, m/s².
    ComAcceleration,
    /// Angular momentum about the centre of mass: 3, kg m²/s.
    AngularMomentum,
    /// Root position: 3, m.
    RootPosition,
    /// Root axes forward, left, up: 9.
    RootAxes,
    /// Root linear velocity: 3, m/s.
    RootVelocity,
    /// Root angular velocity: 3, rad/s.
    RootAngularVelocity,
    /// Force on a landmark's segment by the ground: 3, N.
    GroundForce(usize),
    /// Whether a landmark's segment touches the ground: 1, 0 or 1.
    GroundContact(usize),
    /// Time since reset: 1, s.
    Time,
}

impl Sensor {
    /// Number of values in the block.
    pub fn size(self) -> usize {
        use Sensor::*;
        match self {
            LandmarkAxes(_) | RootAxes => 9,
            LandmarkPosition(_)
            | LandmarkVelocity(_)
            | LandmarkAcceleration(_)
            | LandmarkAngularVelocity(_)
            | ComPosition
            | ComVelocity
            | ComAcceleration
            | AngularMomentum
            | RootPosition
            | RootVelocity
            | RootAngularVelocity
            | GroundForce(_) => 3,
            LandmarkClearance(_) | JointPosition(_) | JointVelocity(_) | JointAcceleration(_) | JointTorque(_)
            | MuscleLength(_) | MuscleVelocity(_) | MuscleForce(_) | MuscleActivation(_) | MuscleExcitation(_) | Action(_)
            | GroundContact(_) | Time => 1,
        }
    }
}

/// The sensors a task reads and where each stands in the flat record.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameLayout {
    entries: Vec<(Sensor, usize)>,
    size: usize,
}

impl FrameLayout {
    /// The slot of `sensor`, appended if the layout does not have it yet.
    pub fn slot(&mut self, sensor: Sensor) -> usize {
        if let Some(&(_, offset)) = self.entries.iter().find(|(known, _)| *known == sensor) {
            return offset;
        }
        self.append(sensor)
    }

    /// Appends a sensor that the layout does not have yet.
    pub(crate) fn append(&mut self, sensor: Sensor) -> usize {
        let offset = self.size;
        self.entries.push((sensor, offset));
        self.size += sensor.size();
        offset
    }

    /// Sensors with their offsets, in the order of the record.
    pub fn entries(&self) -> &[(Sensor, usize)] {
        &self.entries
    }

    /// Number of values in the record.
    pub fn size(&self) -> usize {
        self.size
    }
}

//! The flat record of sensor values that a compiled task reads.
//!
//! A task asks for [`Sensor`]s; each gets a fixed slot in a flat `[f64]`. The runtime fills exactly these, once per control
//! step, after the physics substeps. Vectors are in world axes; indices are positions in the [`Vocabulary`]'s lists.
//!
//! [`Vocabulary`]: crate::vocabulary::Vocabulary

use crate::scene::Part;
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
    /// Force of the parent segment on the segment of a joint, what the joint itself bears: 3, N.
    JointReactionForce(usize),
    /// Its torque about the joint: 3, N m.
    JointReactionTorque(usize),
    /// Tendon length of a muscle: 1, m.
    MuscleLength(usize),
    /// Its rate: 1, m/s.
    MuscleVelocity(usize),
    /// Actuator force as the physics has it, pulling negative: 1, N.
    MuscleForce(usize),
    /// Length of a muscle's fibre: 1, m. The path less the tendon's length where tendons are rigid.
    MuscleFibreLength(usize),
    /// Rate at which a muscle's fibre lengthens: 1, m/s.
    MuscleFibreVelocity(usize),
    /// Length of a muscle's tendon: 1, m. Constant where tendons are rigid; the force in it is [`Sensor::MuscleForce`].
    MuscleTendonLength(usize),
    /// Moment arm of a muscle (first) about a joint (second), positive where its pull drives the coordinate up: 1, m about
    /// hinges, a plain number along slides.
    MomentArm(usize, usize),
    /// Activation: 1, in 0..1.
    MuscleActivation(usize),
    /// Excitation: 1, in 0..1.
    MuscleExcitation(usize),
    /// Factor of a muscle's active force in this episode: 1, not negative.
    MuscleStrength(usize),
    /// Metabolic power of a muscle, after Bhargava et al. (2004): 1, W, not negative.
    MuscleMetabolicPower(usize),
    /// The action that reaches a muscle: 1.
    Action(usize),
    /// An entry of the policy's action in the task's own action space: 1. Where each entry is the action of a muscle,
    /// [`Sensor::Action`] measures it.
    ActionEntry(usize),
    /// Position of the whole body's centre of mass: 3, m.
    ComPosition,
    /// Its velocity: 3, m/s.
    ComVelocity,
    /// Its mean acceleration over the control step: 3, m/s².
    ComAcceleration,
    /// Angular momentum about the centre of mass: 3, kg m²/s.
    AngularMomentum,
    /// Where the ground's force acts: contact points weighted by the vertical force; without contact the point of the level
    /// z = 0 under the centre of mass: 3, m.
    CentreOfPressure,
    /// How far the centre of mass, seen from above, is from the edge of the hull of all ground contacts, positive within;
    /// without contact minus its height: 1, m.
    SupportMargin,
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
    /// Whether two parts touch: 1, 0 or 1.
    Touching(Part, Part),
    /// Force on the first part by the second: 3, N.
    ContactForce(Part, Part),
    /// Number of contacts between two parts: 1.
    ContactCount(Part, Part),
    /// Shortest distance between the surfaces of two parts, negative where they overlap: 1, m.
    SurfaceDistance(Part, Part),
    /// Sliding speed where the first part touches the second, weighted by the normal forces; zero without contact: 1, m/s.
    Slip(Part, Part),
    /// A query of the terrain: its place in [`FrameLayout::queries`], and the number of values of its answer.
    Query(usize, usize),
    /// Time since reset: 1, s.
    Time,
}

/// Where a query of the terrain begins.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Origin {
    /// A place of the world, m.
    World([f64; 3]),
    /// A landmark, moved by an offset in the axes of its heading (forward, left, up), m.
    Landmark(usize, [f64; 3]),
}

/// What a task asks of the terrain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Query {
    /// Height of the ground under a place: 1, m.
    GroundHeight(Origin),
    /// Upward unit normal of the ground under a place: 3.
    GroundNormal(Origin),
    /// How near the nearest member of a group is, sector by sector from left to right, seen from a landmark's heading:
    /// `1 - distance / range` in 0..1, 0 where nothing is in range: `sectors` values.
    Radar {
        /// Who looks: index of a landmark.
        from: usize,
        /// At what: index of a group of landmarks.
        group: usize,
        /// Number of sectors.
        sectors: usize,
        /// Angle that all sectors span, centred on the heading, rad.
        over: f64,
        /// Range, m.
        range: f64,
    },
    /// Distance to the first surface of the scene along a direction in the landmark's anatomical frame, at most `range`: 1, m.
    Ray {
        /// Index of a landmark.
        from: usize,
        /// Unit direction (forward, left, up).
        direction: [f64; 3],
        /// Range, m.
        range: f64,
    },
}

impl Query {
    /// Number of values of the answer.
    pub fn size(&self) -> usize {
        match self {
            Self::GroundHeight(_) | Self::Ray { .. } => 1,
            Self::GroundNormal(_) => 3,
            Self::Radar { sectors, .. } => *sectors,
        }
    }
}

impl Sensor {
    /// The word for its kind in snapshots and hashes; it stays when the variant is renamed.
    pub fn word(self) -> &'static str {
        match self {
            Self::LandmarkPosition(..) => "LandmarkPosition",
            Self::LandmarkVelocity(..) => "LandmarkVelocity",
            Self::LandmarkAcceleration(..) => "LandmarkAcceleration",
            Self::LandmarkAxes(..) => "LandmarkAxes",
            Self::LandmarkAngularVelocity(..) => "LandmarkAngularVelocity",
            Self::LandmarkClearance(..) => "LandmarkClearance",
            Self::JointPosition(..) => "JointPosition",
            Self::JointVelocity(..) => "JointVelocity",
            Self::JointAcceleration(..) => "JointAcceleration",
            Self::JointTorque(..) => "JointTorque",
            Self::JointReactionForce(..) => "JointReactionForce",
            Self::JointReactionTorque(..) => "JointReactionTorque",
            Self::MuscleLength(..) => "MuscleLength",
            Self::MuscleVelocity(..) => "MuscleVelocity",
            Self::MuscleForce(..) => "MuscleForce",
            Self::MuscleFibreLength(..) => "MuscleFibreLength",
            Self::MuscleFibreVelocity(..) => "MuscleFibreVelocity",
            Self::MuscleTendonLength(..) => "MuscleTendonLength",
            Self::MomentArm(..) => "MomentArm",
            Self::MuscleActivation(..) => "MuscleActivation",
            Self::MuscleExcitation(..) => "MuscleExcitation",
            Self::MuscleStrength(..) => "MuscleStrength",
            Self::MuscleMetabolicPower(..) => "MuscleMetabolicPower",
            Self::Action(..) => "Action",
            Self::ActionEntry(..) => "ActionEntry",
            Self::ComPosition => "ComPosition",
            Self::ComVelocity => "ComVelocity",
            Self::ComAcceleration => "ComAcceleration",
            Self::AngularMomentum => "AngularMomentum",
            Self::CentreOfPressure => "CentreOfPressure",
            Self::SupportMargin => "SupportMargin",
            Self::RootPosition => "RootPosition",
            Self::RootAxes => "RootAxes",
            Self::RootVelocity => "RootVelocity",
            Self::RootAngularVelocity => "RootAngularVelocity",
            Self::GroundForce(..) => "GroundForce",
            Self::GroundContact(..) => "GroundContact",
            Self::Touching(..) => "Touching",
            Self::ContactForce(..) => "ContactForce",
            Self::ContactCount(..) => "ContactCount",
            Self::SurfaceDistance(..) => "SurfaceDistance",
            Self::Slip(..) => "Slip",
            Self::Query(..) => "Query",
            Self::Time => "Time",
        }
    }

    /// Number of values in the block.
    pub fn size(self) -> usize {
        use Sensor::*;
        match self {
            Query(_, size) => size,
            LandmarkAxes(_) | RootAxes => 9,
            LandmarkPosition(_)
            | LandmarkVelocity(_)
            | LandmarkAcceleration(_)
            | LandmarkAngularVelocity(_)
            | ComPosition
            | ComVelocity
            | ComAcceleration
            | AngularMomentum
            | CentreOfPressure
            | RootPosition
            | RootVelocity
            | RootAngularVelocity
            | JointReactionForce(_)
            | JointReactionTorque(_)
            | GroundForce(_)
            | ContactForce(..) => 3,
            LandmarkClearance(_)
            | JointPosition(_)
            | JointVelocity(_)
            | JointAcceleration(_)
            | JointTorque(_)
            | MuscleLength(_)
            | MuscleVelocity(_)
            | MuscleForce(_)
            | MuscleFibreLength(_)
            | MuscleFibreVelocity(_)
            | MuscleTendonLength(_)
            | MomentArm(..)
            | SupportMargin
            | MuscleActivation(_)
            | MuscleExcitation(_)
            | MuscleStrength(_)
            | MuscleMetabolicPower(_)
            | Action(_)
            | ActionEntry(_)
            | GroundContact(_)
            | Touching(..)
            | ContactCount(..)
            | SurfaceDistance(..)
            | Slip(..)
            | Time => 1,
        }
    }
}

impl Sensor {
    /// Whether it measures what only the full forward pass knows: forces, accelerations of joints, paths of muscles. All others
    /// follow from positions, velocities, contacts and the excitations of the muscles.
    pub fn needs_forces(self) -> bool {
        use Sensor as S;
        matches!(
            self,
            S::JointAcceleration(_)
                | S::JointTorque(_)
                | S::JointReactionForce(_)
                | S::JointReactionTorque(_)
                | S::MuscleLength(_)
                | S::MuscleVelocity(_)
                | S::MuscleForce(_)
                | S::MuscleFibreLength(_)
                | S::MuscleFibreVelocity(_)
                | S::MuscleTendonLength(_)
                | S::MuscleMetabolicPower(_)
                | S::MomentArm(..)
                | S::CentreOfPressure
                | S::GroundForce(_)
                | S::ContactForce(..)
                | S::Slip(..)
        )
    }

    /// Whether it measures what takes the inertias of bodies.
    pub fn needs_inertia(self) -> bool {
        matches!(self, Self::JointReactionForce(_) | Self::JointReactionTorque(_))
    }

    /// Whether it measures what takes the paths of muscles, beyond their lengths. Joints bear what muscles pull along theirs.
    pub fn needs_tendons(self) -> bool {
        matches!(self, Self::MomentArm(..)) || self.needs_inertia()
    }

    /// Whether it measures of the next entity of a list what `before` measures of one, a single number.
    fn continues(self, before: Self) -> bool {
        use Sensor as S;
        match (before, self) {
            (S::MuscleLength(before), S::MuscleLength(next))
            | (S::MuscleVelocity(before), S::MuscleVelocity(next))
            | (S::MuscleForce(before), S::MuscleForce(next))
            | (S::MuscleActivation(before), S::MuscleActivation(next))
            | (S::MuscleExcitation(before), S::MuscleExcitation(next))
            | (S::MuscleStrength(before), S::MuscleStrength(next))
            | (S::Action(before), S::Action(next))
            | (S::ActionEntry(before), S::ActionEntry(next)) => next == before + 1,
            _ => false,
        }
    }
}

/// What a sensor measures, by places in the [`Vocabulary`](crate::vocabulary::Vocabulary)'s lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Subject {
    /// The whole body, or time.
    Whole,
    /// A landmark or its segment.
    Landmark(usize),
    /// A joint.
    Joint(usize),
    /// A muscle, its fibre or its tendon.
    Muscle(usize),
    /// A muscle (first) about a joint (second).
    MuscleAbout(usize, usize),
    /// What is between two parts.
    Parts(Part, Part),
    /// A query of the terrain: its place in [`FrameLayout::queries`].
    Query(usize),
}

impl Sensor {
    /// What it measures.
    pub fn subject(self) -> Subject {
        use Sensor as S;
        match self {
            S::LandmarkPosition(index)
            | S::LandmarkVelocity(index)
            | S::LandmarkAcceleration(index)
            | S::LandmarkAxes(index)
            | S::LandmarkAngularVelocity(index)
            | S::LandmarkClearance(index)
            | S::GroundForce(index)
            | S::GroundContact(index) => Subject::Landmark(index),
            S::JointPosition(index)
            | S::JointVelocity(index)
            | S::JointAcceleration(index)
            | S::JointTorque(index)
            | S::JointReactionForce(index)
            | S::JointReactionTorque(index) => Subject::Joint(index),
            S::MuscleLength(index)
            | S::MuscleVelocity(index)
            | S::MuscleForce(index)
            | S::MuscleFibreLength(index)
            | S::MuscleFibreVelocity(index)
            | S::MuscleTendonLength(index)
            | S::MuscleActivation(index)
            | S::MuscleExcitation(index)
            | S::MuscleStrength(index)
            | S::MuscleMetabolicPower(index)
            | S::Action(index) => Subject::Muscle(index),
            S::MomentArm(muscle, joint) => Subject::MuscleAbout(muscle, joint),
            S::Touching(a, b) | S::ContactForce(a, b) | S::ContactCount(a, b) | S::SurfaceDistance(a, b) | S::Slip(a, b) => {
                Subject::Parts(a, b)
            }
            S::Query(index, _) => Subject::Query(index),
            S::ActionEntry(_)
            | S::ComPosition
            | S::ComVelocity
            | S::ComAcceleration
            | S::AngularMomentum
            | S::CentreOfPressure
            | S::SupportMargin
            | S::RootPosition
            | S::RootAxes
            | S::RootVelocity
            | S::RootAngularVelocity
            | S::Time => Subject::Whole,
        }
    }
}

/// The sensors a task reads and where each stands in the flat record.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameLayout {
    entries: Vec<(Sensor, usize)>,
    queries: Vec<Query>,
    size: usize,
}

impl FrameLayout {
    /// A layout without sensors that answers these queries when they are asked.
    pub fn with_queries(queries: Vec<Query>) -> Self {
        Self { queries, ..Self::default() }
    }

    /// The slot of `sensor`, appended if the layout does not have it yet.
    pub fn slot(&mut self, sensor: Sensor) -> usize {
        if let Some(&(_, offset)) = self.entries.iter().find(|(known, _)| *known == sensor) {
            return offset;
        }
        self.append(sensor)
    }

    /// Appends a sensor that the layout does not have yet.
    pub fn append(&mut self, sensor: Sensor) -> usize {
        let offset = self.size;
        self.entries.push((sensor, offset));
        self.size += sensor.size();
        offset
    }

    /// The slot of a query of the terrain, appended if the layout does not have it yet.
    pub fn query_slot(&mut self, query: Query) -> usize {
        let size = query.size();
        let index = self.queries.iter().position(|known| *known == query).unwrap_or_else(|| {
            self.queries.push(query);
            self.queries.len() - 1
        });
        self.slot(Sensor::Query(index, size))
    }

    /// The same record in which only the sensors that `wanted` names are measured; slots of the others keep their places.
    #[must_use]
    pub fn only(&self, wanted: impl Fn(Sensor) -> bool) -> Self {
        let entries = self.entries.iter().copied().filter(|(sensor, _)| wanted(*sensor)).collect();
        Self { entries, queries: self.queries.clone(), size: self.size }
    }

    /// Queries of the terrain, to which [`Sensor::Query`] refers.
    pub fn queries(&self) -> &[Query] {
        &self.queries
    }

    /// Sensors with their offsets, in the order of the record.
    pub fn entries(&self) -> &[(Sensor, usize)] {
        &self.entries
    }

    /// The same, with sensors of single numbers that are beside each other in the record and measure one thing of entities that follow each
    /// other in their list taken together.
    pub fn runs(&self) -> impl Iterator<Item = &[(Sensor, usize)]> {
        self.entries.chunk_by(|(before, offset), (sensor, next)| sensor.continues(*before) && *next == offset + 1)
    }

    /// Number of values in the record.
    pub fn size(&self) -> usize {
        self.size
    }
}

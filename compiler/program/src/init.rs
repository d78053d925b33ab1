//! The initial state of an episode, and what disturbs it: plain data in SI units.
//!
//! Everything is known while compiling but for the numbers that a `random` of the task decides: those stand in
//! [`Init::drawn`], and [`CompiledTask::initial_state`] writes them into a copy at every reset, before the physics begins.
//!
//! [`CompiledTask::initial_state`]: crate::task::CompiledTask::initial_state

use crate::frame::Origin;
use crate::motion::RootPart;
use crate::vocabulary::{JointKind, Vocabulary};
use serde::{Deserialize, Serialize};

mod following;
mod variation;

pub use following::{Following, Parts, Path, Start};
pub use variation::{Friction, JointValue, ObjectMass, ObjectShape, Scaling, Variation};

/// How an episode begins.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Init {
    /// Joint coordinates in the order of the vocabulary's joints, those of objects last, rad or m.
    pub coordinates: Vec<f64>,
    /// Joint velocities in the same order, rad/s or m/s; empty if all are zero.
    pub velocities: Vec<f64>,
    /// Where the root starts.
    pub root: RootPlacement,
    /// Noise on the coordinates, joint by joint; only independent hinges and slides have any.
    pub coordinate_noise: Vec<Spread>,
    /// Noise on the joint velocities, joint by joint.
    pub velocity_noise: Vec<Spread>,
    /// Where each free object starts, and where each object stands that is placed for every episode, in the order of the scene.
    pub objects: Vec<ObjectStart>,
    /// What is brought to its place once the pose, the root and the objects have theirs, in this order.
    pub alignments: Vec<Alignment>,
    /// What of body and scene differs from the model.
    pub variation: Variation,
    /// Physics before the first snapshot.
    pub settle: Option<Settle>,
    /// Numbers of the above that are drawn: each is the value at that place of [`CompiledTask::drawn`].
    ///
    /// [`CompiledTask::drawn`]: crate::task::CompiledTask::drawn
    pub drawn: Vec<(Setting, usize)>,
    /// What of the above is taken from a motion at a phase that is drawn.
    pub follows: Option<Following>,
}

/// How a number of an initial state scatters.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Spread {
    /// Not at all.
    #[default]
    None,
    /// Normal, with this standard deviation about the value of the pose.
    Normal(f64),
    /// Uniform between these deviations from the value of the pose.
    Uniform(f64, f64),
}

/// Where the root starts.
#[derive(Debug, Clone, PartialEq)]
pub struct RootPlacement {
    /// Height of the root, m; `None` puts the lowest point of the body on the ground under it.
    pub height: Option<f64>,
    /// How far the lowest point is above the ground where no height is given, m.
    pub lift: f64,
    /// Horizontal position, m.
    pub position: [f64; 2],
    /// Turn about the vertical, rad; 0 faces world x.
    pub heading: f64,
    /// Turn about its own leftward axis after the heading, rad: nose down positive; 90 degrees lies on the front.
    pub pitch: f64,
    /// Turn about its own forward axis after heading and pitch, rad: right side down positive.
    pub roll: f64,
    /// Linear velocity in world axes, m/s.
    pub velocity: [f64; 3],
    /// Angular velocity in world axes, rad/s.
    pub spin: [f64; 3],
    /// The root is moved, not turned, until each landmark (index) is where it shall be; of several, until the mean distance
    /// vanishes. Height and position are then without meaning.
    pub meets: Vec<(usize, Origin)>,
}

impl Default for RootPlacement {
    fn default() -> Self {
        Self {
            height: None,
            lift: 0.0,
            position: [0.0; 2],
            heading: 0.0,
            pitch: 0.0,
            roll: 0.0,
            velocity: [0.0; 3],
            spin: [0.0; 3],
            meets: Vec::new(),
        }
    }
}

/// A place that is brought to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// The landmark that is brought there.
    pub landmark: usize,
    /// Where it shall be.
    pub target: Origin,
    /// What moves.
    pub moves: Moves,
}

/// What an [`Alignment`] moves.
#[derive(Debug, Clone, PartialEq)]
pub enum Moves {
    /// Independent joints of the body, by their places in the vocabulary: they turn and slide within their ranges, from the pose on.
    /// Those of all such alignments move together.
    Joints(Vec<usize>),
    /// A free object, by its place in the scene's list, which is moved and not turned.
    Object(usize),
}

/// Where a free object starts, or where one stands that is placed, in world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectStart {
    /// Its place in the scene's list of objects.
    pub object: usize,
    /// Position, m.
    pub position: [f64; 3],
    /// Orientation, w x y z.
    pub orientation: [f64; 4],
    /// Linear velocity, m/s.
    pub velocity: [f64; 3],
    /// Angular velocity, rad/s.
    pub spin: [f64; 3],
}

/// Physics that passes before the first snapshot, while muscles are held at one activation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settle {
    /// Number of physics steps.
    pub steps: u32,
    /// Activation and excitation of every muscle meanwhile; the time is 0 afterwards.
    pub activation: f64,
    /// Whether all velocities are zero afterwards.
    pub at_rest: bool,
}

/// A force that acts for a while.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Disturbance {
    /// On which point: index of a landmark.
    pub landmark: usize,
    /// Force in world axes, N.
    pub force: [f64; 3],
    /// Torque in world axes, N m.
    pub torque: [f64; 3],
    /// It begins after so many control steps.
    pub start: u32,
    /// It lasts so many control steps.
    pub steps: u32,
    /// It begins anew after so many control steps, again and again; 0 if it comes once.
    pub every: u32,
}

impl Disturbance {
    /// Control steps since it has begun, or begun anew, where `taken` have been taken; `None` before it begins.
    fn since(&self, taken: u32) -> Option<u32> {
        let since = taken.checked_sub(self.start)?;
        Some(if self.every > 0 { since % self.every } else { since })
    }

    /// Whether it acts in the control step after `taken` ones.
    pub fn acts(&self, taken: u32) -> bool {
        self.since(taken).is_some_and(|since| since < self.steps)
    }

    /// Whether it begins, or begins anew, in the control step after `taken` ones.
    pub fn begins(&self, taken: u32) -> bool {
        self.since(taken) == Some(0)
    }
}

/// A number of a disturbance that may be drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DisturbanceSetting {
    /// Force along an axis of the world.
    Force(usize),
    /// Torque about an axis of the world.
    Torque(usize),
    /// When it begins for the first time, in control steps; rounded, and 0 where it would be earlier.
    Start,
}

impl DisturbanceSetting {
    /// Writes a value that was drawn.
    pub fn set(self, value: f64, disturbance: &mut Disturbance) {
        match self {
            Self::Force(axis) => disturbance.force.iter_mut().skip(axis).take(1).for_each(|force| *force = value),
            Self::Torque(axis) => disturbance.torque.iter_mut().skip(axis).take(1).for_each(|torque| *torque = value),
            // A conversion of a float to an integer stops at the ends of the integer's range, and of NaN gives 0.
            Self::Start => disturbance.start = value.round() as u32,
        }
    }
}

/// A number of an initial state that may be drawn. Axes are 0, 1, 2 for x, y, z of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// Coordinate of a joint, by its place in the vocabulary.
    Coordinate(usize),
    /// Height of the root.
    RootHeight,
    /// Position of the root along x or y.
    RootPosition(usize),
    /// Heading of the root.
    RootHeading,
    /// Pitch of the root.
    RootPitch,
    /// Roll of the root.
    RootRoll,
    /// Velocity of the root along an axis.
    RootVelocity(usize),
    /// Position of an object, by its place in [`Init::objects`], along an axis.
    ObjectPosition(usize, usize),
    /// Component w, x, y or z of an object's orientation.
    ObjectOrientation(usize, usize),
    /// Velocity of an object along an axis.
    ObjectVelocity(usize, usize),
    /// Angular velocity of an object about an axis.
    ObjectSpin(usize, usize),
    /// A factor of the strength of muscles, by its place in [`Variation::strengths`].
    Strength(usize),
    /// A factor of the mass of segments, by its place in [`Variation::segments`].
    SegmentMass(usize),
    /// A factor of the damping of joints, by its place in [`Variation::dampings`].
    Damping(usize),
    /// A factor of the stiffness of joints, by its place in [`Variation::stiffnesses`].
    Stiffness(usize),
    /// Mass of an object, by its place in [`Variation::masses`].
    ObjectMass(usize),
    /// Sliding friction, by its place in [`Variation::frictions`].
    Friction(usize),
    /// Damping or stiffness of a joint of an object, by its place in [`Variation::joints`].
    ObjectJoint(usize),
    /// A number of the shape of an object, by its place in [`Variation::shapes`] and among [`Shape::number`]s.
    ///
    /// [`Shape::number`]: crate::scene::Shape::number
    ObjectShape(usize, usize),
}

impl Setting {
    /// The unit in which people read it, one of the language: empty for factors and for parameters of joints, which are in SI units;
    /// none for components of an orientation, which mean nothing by themselves.
    pub fn unit(self, vocabulary: &Vocabulary) -> Option<&'static str> {
        Some(match self {
            Self::Coordinate(joint) => match vocabulary.joints.get(joint)?.kind {
                JointKind::Hinge => "deg",
                JointKind::Slide => "m",
            },
            Self::RootHeight | Self::RootPosition(_) | Self::ObjectPosition(..) | Self::ObjectShape(..) => "m",
            Self::RootHeading | Self::RootPitch | Self::RootRoll => "deg",
            Self::RootVelocity(_) | Self::ObjectVelocity(..) => "m/s",
            Self::ObjectSpin(..) => "rad/s",
            Self::ObjectMass(_) => "kg",
            Self::ObjectOrientation(..) => return None,
            Self::Strength(_)
            | Self::SegmentMass(_)
            | Self::Damping(_)
            | Self::Stiffness(_)
            | Self::Friction(_)
            | Self::ObjectJoint(_) => "",
        })
    }
}

impl Init {
    /// Writes one number.
    pub fn set(&mut self, setting: Setting, value: f64) {
        let root = &mut self.root;
        let objects = &mut self.objects;
        let variation = &mut self.variation;
        let slot = match setting {
            Setting::Coordinate(joint) => self.coordinates.get_mut(joint),
            Setting::RootHeight => Some(root.height.get_or_insert(value)),
            Setting::RootPosition(axis) => root.position.get_mut(axis),
            Setting::RootHeading => Some(&mut root.heading),
            Setting::RootPitch => Some(&mut root.pitch),
            Setting::RootRoll => Some(&mut root.roll),
            Setting::RootVelocity(axis) => root.velocity.get_mut(axis),
            Setting::ObjectPosition(object, axis) => objects.get_mut(object).and_then(|start| start.position.get_mut(axis)),
            Setting::ObjectOrientation(object, part) => objects.get_mut(object).and_then(|start| start.orientation.get_mut(part)),
            Setting::ObjectVelocity(object, axis) => objects.get_mut(object).and_then(|start| start.velocity.get_mut(axis)),
            Setting::ObjectSpin(object, axis) => objects.get_mut(object).and_then(|start| start.spin.get_mut(axis)),
            Setting::Strength(row) => variation.strengths.get_mut(row).map(|scaling| &mut scaling.factor),
            Setting::SegmentMass(row) => variation.segments.get_mut(row).map(|scaling| &mut scaling.factor),
            Setting::Damping(row) => variation.dampings.get_mut(row).map(|scaling| &mut scaling.factor),
            Setting::Stiffness(row) => variation.stiffnesses.get_mut(row).map(|scaling| &mut scaling.factor),
            Setting::ObjectMass(row) => variation.masses.get_mut(row).map(|known| &mut known.mass),
            Setting::Friction(row) => variation.frictions.get_mut(row).map(|known| &mut known.sliding),
            Setting::ObjectJoint(row) => variation.joints.get_mut(row).map(|known| &mut known.value),
            Setting::ObjectShape(row, number) => variation.shapes.get_mut(row).and_then(|known| known.shape.number(number)),
        };
        if let Some(slot) = slot {
            *slot = value;
        }
    }

    /// Writes one number, whatever chance, an alignment, or the motion on which the task begins had decided.
    pub fn decide(&mut self, setting: Setting, value: f64) {
        self.drawn.retain(|(known, _)| *known != setting);
        self.unfollow(setting);
        self.release(setting);
        self.set(setting, value);
    }

    /// A number no longer follows from alignments: other joints go on reaching, an object stays where it is put.
    pub fn release(&mut self, setting: Setting) {
        let object = match setting {
            Setting::ObjectPosition(start, _) => self.objects.get(start).map(|start| start.object),
            _ => None,
        };
        self.alignments.retain_mut(|alignment| match &mut alignment.moves {
            Moves::Joints(joints) => {
                joints.retain(|joint| setting != Setting::Coordinate(*joint));
                !joints.is_empty()
            }
            Moves::Object(moved) => Some(*moved) != object,
        });
    }

    /// Takes a number no longer from the motion on which the task begins.
    pub fn unfollow(&mut self, setting: Setting) {
        let Some(following) = &mut self.follows else { return };
        let part = match setting {
            Setting::Coordinate(joint) => return following.parts.joints.retain(|(known, _)| *known != joint),
            Setting::RootPosition(0) => RootPart::X,
            Setting::RootPosition(_) => RootPart::Y,
            Setting::RootHeight => RootPart::Height,
            Setting::RootHeading => RootPart::Heading,
            Setting::RootPitch => RootPart::Pitch,
            Setting::RootRoll => RootPart::Roll,
            _ => return,
        };
        following.parts.root.retain(|known| *known != part);
    }

    /// Whether body, scene, or where things are, differ between episodes by more than noise.
    pub fn has_worlds(&self) -> bool {
        !self.drawn.is_empty() || self.scalings().any(|scaling| scaling.each.is_some())
    }

    fn scalings(&self) -> impl Iterator<Item = &Scaling> {
        let Variation { strengths, segments, dampings, stiffnesses, .. } = &self.variation;
        strengths.iter().chain(segments).chain(dampings).chain(stiffnesses)
    }

    /// Whether nothing scatters.
    pub fn is_exact(&self) -> bool {
        let spreads = self.coordinate_noise.iter().chain(&self.velocity_noise);
        !self.has_worlds() && self.follows.is_none() && spreads.copied().all(|spread| spread == Spread::None)
    }
}

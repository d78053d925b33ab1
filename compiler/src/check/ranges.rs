//! Between which bounds sensors stay: while an episode runs, and in the standing pose.

use super::context::Timing;
use crate::extremes::{maximum, minimum};
use crate::frame::{Query, Sensor};
use crate::graph::interval::{Bounds, Ranges};
use crate::init::{Init, Setting, Spread};
use crate::vocabulary::{Landmark, Vocabulary};

/// Any state of an episode: joint ranges, unit vectors, activations.
pub(crate) struct OperatingRange<'a> {
    pub vocabulary: &'a Vocabulary,
    pub timing: Timing,
    pub queries: &'a [Query],
}

impl Ranges for OperatingRange<'_> {
    fn sensor(&self, sensor: Sensor, _: usize) -> Bounds {
        match sensor {
            Sensor::LandmarkAxes(_) | Sensor::RootAxes | Sensor::Action(_) | Sensor::ActionEntry(_) => Bounds::new(-1.0, 1.0),
            Sensor::JointPosition(joint) => {
                let range = self.vocabulary.joints.get(joint).and_then(|joint| joint.range);
                range.map_or(Bounds::ANY, |[low, high]| Bounds::new(low, high))
            }
            Sensor::MuscleLength(_) | Sensor::MuscleStrength(_) | Sensor::MuscleMetabolicPower(_) => Bounds::POSITIVE,
            Sensor::MuscleForce(_) => Bounds::new(f64::NEG_INFINITY, 0.0),
            Sensor::MuscleActivation(_) | Sensor::MuscleExcitation(_) | Sensor::GroundContact(_) | Sensor::Touching(..) => {
                Bounds::TRUTH
            }
            Sensor::ContactCount(..) | Sensor::Slip(..) => Bounds::POSITIVE,
            Sensor::Query(index, _) => self.queries.get(index).map_or(Bounds::ANY, query_bounds),
            Sensor::Time => self.timing.episode(),
            _ => Bounds::ANY,
        }
    }

    fn step(&self) -> Bounds {
        Bounds::new(0.0, f64::from(self.timing.horizon))
    }

    fn streak(&self) -> Bounds {
        // From the first snapshot to the last, also over the phases before.
        Bounds::new(0.0, f64::from(self.timing.before) + f64::from(self.timing.horizon) + 1.0)
    }
}

fn query_bounds(query: &Query) -> Bounds {
    match query {
        Query::GroundHeight(_) => Bounds::ANY,
        Query::GroundNormal(_) => Bounds::new(-1.0, 1.0),
        Query::Radar { .. } => Bounds::TRUTH,
        Query::Ray { range, .. } => Bounds::new(0.0, *range),
    }
}

/// The standing pose at rest, as far as the vocabulary settles it.
pub(crate) struct NeutralRange<'a> {
    pub vocabulary: &'a Vocabulary,
    /// Whether it is the reset of an episode, when no muscle is active yet.
    pub reset: bool,
    /// What shakes it.
    pub shaken: Shaken,
}

/// How far the noise of an initial state takes a body from its pose.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shaken {
    /// Between which deviations each joint is, rad or m.
    joints: Vec<Bounds>,
    /// How far all joints together turn a part of the body, rad, or move it, m: a deviation is taken to act a metre away.
    whole: f64,
    /// Whether the body moves.
    moves: bool,
}

/// Normal noise is taken to stay within so many standard deviations.
const DEVIATIONS: f64 = 3.0;

impl Shaken {
    /// By the noise and the speeds of an initial state, and by what is drawn for it.
    pub(crate) fn by(init: &Init) -> Self {
        let deviation = |spread: &Spread| match *spread {
            Spread::None => Bounds::point(0.0),
            Spread::Normal(deviation) => Bounds::new(-DEVIATIONS * deviation, DEVIATIONS * deviation),
            Spread::Uniform(low, high) => Bounds::new(low, high),
        };
        let mut joints: Vec<Bounds> = init.coordinate_noise.iter().map(deviation).collect();
        let (mut anywhere, mut moves) = (init.follows.is_some(), init.follows.is_some());
        for (setting, _) in &init.drawn {
            match *setting {
                Setting::Coordinate(joint) => {
                    anywhere = true;
                    joints.get_mut(joint).into_iter().for_each(|joint| *joint = Bounds::ANY);
                }
                Setting::RootVelocity(_) => moves = true,
                Setting::RootHeight
                | Setting::RootPosition(_)
                | Setting::RootHeading
                | Setting::RootPitch
                | Setting::RootRoll => anywhere = true,
                // Objects are anywhere as it is.
                Setting::ObjectPosition(..)
                | Setting::ObjectOrientation(..)
                | Setting::ObjectVelocity(..)
                | Setting::ObjectSpin(..)
                | Setting::Strength(_)
                | Setting::SegmentMass(_)
                | Setting::ObjectMass(_)
                | Setting::Damping(_)
                | Setting::Stiffness(_)
                | Setting::Friction(_)
                | Setting::ObjectJoint(_)
                | Setting::ObjectShape(..) => {}
            }
        }
        // Joints are shaken independently of each other, so deviations add up as their squares do.
        let squares = joints.iter().map(|joint| maximum(-joint.low, joint.high)).map(|most| most * most);
        let whole = if anywhere { f64::INFINITY } else { squares.sum::<f64>().sqrt() };
        moves |= init.velocity_noise.iter().any(|spread| *spread != Spread::None) || init.velocities.iter().any(|v| *v != 0.0);
        Self { joints, whole, moves }
    }

    fn part(&self, value: f64) -> Bounds {
        Bounds::new(value - self.whole, value + self.whole)
    }

    fn axis(&self, value: f64) -> Bounds {
        Bounds::new(maximum(value - self.whole, -1.0), minimum(value + self.whole, 1.0))
    }

    fn joint(&self, joint: usize, value: f64, range: Option<[f64; 2]>) -> Bounds {
        let deviation = self.joints.get(joint).copied().unwrap_or(Bounds::point(0.0));
        let [low, high] = range.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        // The pose itself may lie a rounding beyond the range.
        Bounds::new(minimum(value, maximum(value + deviation.low, low)), maximum(value, minimum(value + deviation.high, high)))
    }
}

impl NeutralRange<'_> {
    /// Whether it is measured on an object that moves: the standing pose does not determine it.
    fn moves(&self, sensor: Sensor) -> bool {
        let (landmarks, joints) = (&self.vocabulary.landmarks, &self.vocabulary.joints);
        match sensor {
            Sensor::LandmarkPosition(index)
            | Sensor::LandmarkVelocity(index)
            | Sensor::LandmarkAcceleration(index)
            | Sensor::LandmarkAxes(index)
            | Sensor::LandmarkAngularVelocity(index) => landmarks.get(index).is_some_and(|landmark| landmark.of_scene),
            Sensor::JointPosition(index) | Sensor::JointVelocity(index) | Sensor::JointAcceleration(index) => {
                joints.get(index).is_some_and(|joint| joint.of_scene)
            }
            _ => false,
        }
    }
}

impl Ranges for NeutralRange<'_> {
    fn sensor(&self, sensor: Sensor, lane: usize) -> Bounds {
        let vocabulary = self.vocabulary;
        let landmark = |index: usize, read: fn(&Landmark) -> &[f64]| {
            let lanes = vocabulary.landmarks.get(index).map_or(&[][..], read);
            lanes.get(lane).copied()
        };
        if self.moves(sensor) {
            return Bounds::ANY;
        }
        match sensor {
            Sensor::LandmarkPosition(index) => {
                landmark(index, |landmark| &landmark.neutral_position).map_or(Bounds::ANY, |value| self.shaken.part(value))
            }
            Sensor::LandmarkAxes(index) => {
                landmark(index, |landmark| &landmark.neutral_axes).map_or(Bounds::ANY, |value| self.shaken.axis(value))
            }
            Sensor::ComPosition => self.shaken.part(vocabulary.neutral_com.get(lane).copied().unwrap_or(f64::NAN)),
            Sensor::JointPosition(index) => {
                let joint = vocabulary.joints.get(index);
                joint.map_or(Bounds::ANY, |joint| self.shaken.joint(index, joint.neutral, joint.range))
            }
            Sensor::LandmarkVelocity(_)
            | Sensor::LandmarkAcceleration(_)
            | Sensor::LandmarkAngularVelocity(_)
            | Sensor::JointVelocity(_)
            | Sensor::JointAcceleration(_)
            | Sensor::MuscleVelocity(_)
            | Sensor::ComVelocity
            | Sensor::ComAcceleration
            | Sensor::AngularMomentum
            | Sensor::RootVelocity
            | Sensor::RootAngularVelocity => {
                if self.shaken.moves {
                    Bounds::ANY
                } else {
                    Bounds::point(0.0)
                }
            }
            Sensor::Time => Bounds::point(0.0),
            Sensor::MuscleActivation(_) | Sensor::MuscleExcitation(_) if self.reset => Bounds::point(0.0),
            Sensor::MuscleActivation(_) | Sensor::MuscleExcitation(_) | Sensor::GroundContact(_) | Sensor::Touching(..) => {
                Bounds::TRUTH
            }
            Sensor::MuscleLength(_) | Sensor::MuscleStrength(_) | Sensor::MuscleMetabolicPower(_) => Bounds::POSITIVE,
            Sensor::MuscleForce(_) => Bounds::new(f64::NEG_INFINITY, 0.0),
            Sensor::RootAxes | Sensor::Action(_) | Sensor::ActionEntry(_) => Bounds::new(-1.0, 1.0),
            _ => Bounds::ANY,
        }
    }

    fn step(&self) -> Bounds {
        Bounds::point(0.0)
    }

    fn at_reset(&self) -> bool {
        true
    }
}

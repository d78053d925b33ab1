//! Between which bounds sensors stay: while an episode runs, and in the standing pose.

use super::context::Timing;
use crate::frame::{Query, Sensor};
use crate::graph::interval::{Bounds, Ranges};
use crate::vocabulary::{Landmark, Vocabulary};

/// Any state of an episode: joint ranges, unit vectors, activations.
pub(crate) struct Working<'a> {
    pub vocabulary: &'a Vocabulary,
    pub timing: Timing,
    pub queries: &'a [Query],
}

impl Ranges for Working<'_> {
    fn sensor(&self, sensor: Sensor, _: usize) -> Bounds {
        match sensor {
            Sensor::LandmarkAxes(_) | Sensor::RootAxes | Sensor::Action(_) => Bounds::new(-1.0, 1.0),
            Sensor::JointPosition(joint) => {
                let range = self.vocabulary.joints.get(joint).and_then(|joint| joint.range);
                range.map_or(Bounds::ANY, |[low, high]| Bounds::new(low, high))
            }
            Sensor::MuscleLength(_) => Bounds::POSITIVE,
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
pub(crate) struct Standing<'a> {
    pub vocabulary: &'a Vocabulary,
    /// Whether it is the beginning of an episode, when no muscle is active yet.
    pub reset: bool,
}

impl Standing<'_> {
    /// Whether it is measured on an object that moves: the standing pose says nothing of it.
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

impl Ranges for Standing<'_> {
    fn sensor(&self, sensor: Sensor, lane: usize) -> Bounds {
        let vocabulary = self.vocabulary;
        let landmark = |index: usize, read: fn(&Landmark) -> &[f64]| {
            let lanes = vocabulary.landmarks.get(index).map_or(&[][..], read);
            lanes.get(lane).map_or(Bounds::ANY, |value| Bounds::point(*value))
        };
        if self.moves(sensor) {
            return Bounds::ANY;
        }
        match sensor {
            Sensor::LandmarkPosition(index) => landmark(index, |landmark| &landmark.neutral_position),
            Sensor::LandmarkAxes(index) => landmark(index, |landmark| &landmark.neutral_axes),
            Sensor::ComPosition => Bounds::point(vocabulary.neutral_com.get(lane).copied().unwrap_or(f64::NAN)),
            Sensor::JointPosition(index) => {
                vocabulary.joints.get(index).map_or(Bounds::ANY, |joint| Bounds::point(joint.neutral))
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
            | Sensor::RootAngularVelocity
            | Sensor::Time => Bounds::point(0.0),
            Sensor::MuscleActivation(_) | Sensor::MuscleExcitation(_) if self.reset => Bounds::point(0.0),
            Sensor::MuscleActivation(_) | Sensor::MuscleExcitation(_) | Sensor::GroundContact(_) | Sensor::Touching(..) => {
                Bounds::TRUTH
            }
            Sensor::MuscleLength(_) => Bounds::POSITIVE,
            Sensor::MuscleForce(_) => Bounds::new(f64::NEG_INFINITY, 0.0),
            Sensor::RootAxes | Sensor::Action(_) => Bounds::new(-1.0, 1.0),
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

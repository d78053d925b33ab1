//! Between which bounds sensors stay: while an episode runs, and in the standing pose.

use crate::frame::Sensor;
use crate::graph::interval::{Bounds, Ranges};
use crate::vocabulary::Vocabulary;

/// Any state of an episode: joint ranges, unit vectors, activations.
pub(crate) struct Working<'a> {
    pub vocabulary: &'a Vocabulary,
    pub horizon: u32,
    /// Length of a control step, s.
    pub interval: f64,
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
            Sensor::MuscleActivation(_) | Sensor::MuscleExcitation(_) | Sensor::GroundContact(_) => Bounds::TRUTH,
            Sensor::Time => Bounds::new(0.0, f64::from(self.horizon) * self.interval),
            _ => Bounds::ANY,
        }
    }

    fn step(&self) -> Bounds {
        Bounds::new(0.0, f64::from(self.horizon))
    }
}

/// The standing pose at rest, as far as the vocabulary settles it.
pub(crate) struct Standing<'a>(pub &'a Vocabulary);

impl Ranges for Standing<'_> {
    fn sensor(&self, sensor: Sensor, lane: usize) -> Bounds {
        let Self(vocabulary) = self;
        match sensor {
            Sensor::LandmarkPosition(index) if lane == 2 => {
                vocabulary.landmarks.get(index).map_or(Bounds::ANY, |landmark| Bounds::point(landmark.neutral_height))
            }
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
            Sensor::MuscleLength(_) => Bounds::POSITIVE,
            Sensor::MuscleActivation(_) | Sensor::MuscleExcitation(_) | Sensor::GroundContact(_) => Bounds::TRUTH,
            Sensor::LandmarkAxes(_) | Sensor::RootAxes => Bounds::new(-1.0, 1.0),
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

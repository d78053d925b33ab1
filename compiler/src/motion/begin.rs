//! A beginning taken from a motion: the body where the motion is at a phase, and as fast.

use super::{Motion, RootPart};
use crate::beginning::Init;
use std::sync::Arc;

/// A beginning at a phase of a motion that is drawn for every episode.
#[derive(Debug, Clone, PartialEq)]
pub struct Following {
    /// The motion.
    pub motion: Arc<Motion>,
    /// The phase is this one of the values that the beginning takes from what is drawn.
    pub start: usize,
    /// What it sets.
    pub parts: Parts,
}

/// What a beginning takes from a motion.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Parts {
    /// Joints, by their places in the vocabulary, with their columns.
    pub joints: Vec<(usize, usize)>,
    /// Coordinates of the root.
    pub root: Vec<RootPart>,
    /// Whether the root has the motion's linear velocity.
    pub velocity: bool,
}

impl Parts {
    /// Writes the beginning at `time` (s) of the motion.
    pub fn write(&self, motion: &Motion, time: f64, init: &mut Init) {
        for &(joint, column) in &self.joints {
            if let Some(coordinate) = init.coordinates.get_mut(joint) {
                *coordinate = motion.value(column, time);
            }
            if let Some(velocity) = init.velocities.get_mut(joint) {
                *velocity = motion.rate(column, time);
            }
        }
        let value = |part: RootPart| motion.root(part).map_or(0.0, |column| motion.value(column, time));
        let rate = |part: RootPart| motion.root(part).map_or(0.0, |column| motion.rate(column, time));
        for &part in &self.root {
            match part {
                // Where an episode begins is the task's to say; a motion is followed from there.
                RootPart::X | RootPart::Y => {}
                RootPart::Height => init.root.height = motion.root(part).map(|column| motion.value(column, time)),
                RootPart::Heading => init.root.heading = value(part),
                RootPart::Pitch => init.root.pitch = value(part),
                RootPart::Roll => init.root.roll = value(part),
            }
        }
        if self.velocity {
            init.root.velocity = [RootPart::X, RootPart::Y, RootPart::Height].map(rate);
        }
        let turns = [RootPart::Heading, RootPart::Pitch, RootPart::Roll];
        init.root.spin = spin(turns.map(value), turns.map(rate));
    }
}

impl Following {
    /// Writes the beginning at `phase` of the motion.
    pub fn write(&self, phase: f64, init: &mut Init) {
        self.parts.write(&self.motion, self.motion.time_of(phase), init);
    }
}

/// Angular velocity in world axes, rad/s, of what is turned by heading, then pitch, then roll (rad), at these rates (rad/s).
fn spin([heading, pitch, _]: [f64; 3], [turning, nodding, rolling]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = libm::sincos(heading);
    let (sink, level) = libm::sincos(pitch);
    // Heading turns about the vertical, pitch about the level leftward axis, roll about the axis that points forward.
    [nodding * -sin + rolling * cos * level, nodding * cos + rolling * sin * level, turning - rolling * sink]
}

#[cfg(test)]
mod tests {
    use super::spin;

    #[test]
    fn each_turn_has_its_own_axis() {
        assert_eq!(spin([0.0; 3], [1.0, 2.0, 3.0]), [3.0, 2.0, 1.0]);
        let quarter = std::f64::consts::FRAC_PI_2;
        let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
        // Facing left, nodding turns about the axis that points backwards in the world.
        assert!(near(spin([quarter, 0.0, 0.0], [0.0, 1.0, 0.0]), [-1.0, 0.0, 0.0]));
        // Nose down, rolling turns about the axis that points down.
        assert!(near(spin([0.0, quarter, 0.0], [0.0, 0.0, 1.0]), [0.0, 0.0, -1.0]));
    }
}

//! A body taken from a motion: where the motion is at a phase, and as fast; at the beginning of an episode, or as a test plays it.

use super::Init;
use crate::motion::{Motion, RootPart};
use std::sync::Arc;

/// A body that is where a motion is.
#[derive(Debug, Clone, PartialEq)]
pub struct Following {
    /// The motion.
    pub motion: Arc<Motion>,
    /// Where it is entered.
    pub start: Start,
    /// How long ago it was entered, s; 0 where an episode begins.
    pub after: f64,
    /// What it sets.
    pub parts: Parts,
    /// How the root goes on; `None` where it only stands as the motion has it.
    pub path: Option<Path>,
}

/// The phase at which a motion is entered, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// This one.
    Phase(f64),
    /// This one of the values that the initial state takes from what is drawn.
    Drawn(usize),
}

impl Start {
    /// The phase, unless it is drawn.
    pub fn fixed(self) -> Option<f64> {
        match self {
            Self::Phase(phase) => Some(phase),
            Self::Drawn(_) => None,
        }
    }
}

/// The root's path over level ground: that of the table, laid to where it begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Path {
    /// How long after the motion was entered the path begins, s.
    pub begun: f64,
    /// Where it begins, m.
    pub origin: [f64; 2],
    /// Which way the table's x axis points, rad from that of the world to the left.
    pub heading: f64,
}

/// What an initial state takes from a motion.
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
    /// Writes the initial state at `time` (s) of the motion.
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
                // Where an episode begins is decided by the task; a motion is followed from there.
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
    /// Writes where the body is `later` (s), if the motion is entered at `phase`.
    pub fn write(&self, phase: f64, later: f64, init: &mut Init) {
        let entered = self.motion.time_of(phase);
        let now = entered + self.after + later;
        self.parts.write(&self.motion, now, init);
        let Some(path) = &self.path else { return };
        if self.parts.root.contains(&RootPart::Heading) {
            init.root.heading += path.heading;
        }
        let gone = |part: RootPart| {
            let column = self.motion.root(part).filter(|_| self.parts.root.contains(&part));
            column.map_or(0.0, |column| self.motion.value(column, now) - self.motion.value(column, entered + path.begun))
        };
        let (ahead, aside) = (gone(RootPart::X), gone(RootPart::Y));
        let (sin, cos) = libm::sincos(path.heading);
        init.root.position = [path.origin[0] + cos * ahead - sin * aside, path.origin[1] + sin * ahead + cos * aside];
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

//! Three tasks written by hand in Rust, over the same record of sensors as the compiled ones beside them: what a careful person
//! would write, slots looked up once, lists copied whole where they stand together.

mod door;
mod running;
mod standing;

use msk::compiler::frame::Sensor;
use msk::compiler::task::CompiledTask;
use std::ops::Range;

/// What a control step comes to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    pub terms: [f64; 9],
    pub reward: f64,
    pub ends: [bool; 2],
    pub truncated: bool,
    pub success: bool,
}

/// A task written by hand.
pub trait Hand {
    /// Takes the first snapshot.
    fn reset(&mut self, frame: &[f64]);
    /// Evaluates a control step.
    fn step(&mut self, frame: &[f64], weights: &[f64], outcome: &mut Outcome);
    /// Writes the observation.
    fn observe(&self, frame: &[f64], out: &mut [f64]);
}

/// How long sums are added up by hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sums {
    /// From the first number to the last, as `iter().sum()` does: each addition waits for the one before.
    Chain,
    /// In eight columns, as compiled tasks do.
    Columns,
}

/// Makes the task by hand that stands for a compiled one.
pub type ByHand = fn(&CompiledTask, Sums) -> Box<dyn Hand>;

/// The texts, and what stands for them by hand.
pub const TASKS: [(&str, ByHand); 3] = [
    ("benches/hand/standing.msk", |task, sums| Box::new(standing::Standing::new(task, sums))),
    ("benches/hand/running.msk", |task, sums| Box::new(running::Running::new(task, sums))),
    ("benches/hand/door.msk", |task, sums| Box::new(door::Door::new(task, sums))),
];

/// Where the sensors of a task stand.
pub struct Slots<'a>(&'a CompiledTask);

impl Slots<'_> {
    pub fn of(&self, sensor: Sensor) -> usize {
        let found = self.0.frame.entries().iter().find(|(known, _)| *known == sensor);
        found.unwrap_or_else(|| panic!("the task does not read {sensor:?}")).1
    }

    pub fn landmark(&self, name: &str) -> usize {
        self.0.vocabulary.landmarks.iter().position(|landmark| landmark.name == name).unwrap()
    }

    pub fn joint(&self, name: &str) -> usize {
        self.0.vocabulary.joints.iter().position(|joint| joint.name == name).unwrap()
    }

    /// The places of a list of single numbers.
    pub fn list(&self, sensors: impl Iterator<Item = Sensor>) -> List {
        let slots: Vec<usize> = sensors.map(|sensor| self.of(sensor)).collect();
        if slots.windows(2).all(|pair| pair[1] == pair[0] + 1) {
            List::Together(slots[0]..slots[0] + slots.len())
        } else {
            List::Apart(slots)
        }
    }

    fn muscles(&self, sensor: fn(usize) -> Sensor) -> List {
        self.list((0..self.0.vocabulary.muscles.len()).map(sensor))
    }

    fn joints(&self, sensor: fn(usize) -> Sensor) -> List {
        let own = self.0.vocabulary.joints.iter().enumerate().filter(|(_, joint)| !joint.of_scene);
        self.list(own.map(|(index, _)| sensor(index)))
    }
}

/// A list of numbers of the record.
pub enum List {
    Together(Range<usize>),
    Apart(Vec<usize>),
}

impl List {
    /// Copies it to the front of `out` and returns what is left.
    pub fn copy<'a>(&self, frame: &[f64], out: &'a mut [f64]) -> &'a mut [f64] {
        let (own, rest) = match self {
            Self::Together(range) => {
                let (own, rest) = out.split_at_mut(range.len());
                own.copy_from_slice(&frame[range.clone()]);
                (own, rest)
            }
            Self::Apart(slots) => {
                let (own, rest) = out.split_at_mut(slots.len());
                own.iter_mut().zip(slots).for_each(|(value, &slot)| *value = frame[slot]);
                (own, rest)
            }
        };
        let _ = own;
        rest
    }

    /// Calls `visit` with each number.
    pub fn each(&self, frame: &[f64], mut visit: impl FnMut(f64)) {
        match self {
            Self::Together(range) => frame[range.clone()].iter().for_each(|&value| visit(value)),
            Self::Apart(slots) => slots.iter().for_each(|&slot| visit(frame[slot])),
        }
    }
}

/// Three numbers of the record.
pub fn vector(frame: &[f64], slot: usize) -> [f64; 3] {
    [frame[slot], frame[slot + 1], frame[slot + 2]]
}

pub fn norm(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// A world vector along the heading (forward, left, up) of a landmark whose axes stand at `axes`.
pub fn along_heading(frame: &[f64], axes: usize, v: [f64; 3]) -> [f64; 3] {
    let (x, y) = (frame[axes], frame[axes + 1]);
    let length = (x * x + y * y).sqrt();
    let (x, y) = (x / length, y / length);
    [x * v[0] + y * v[1], x * v[1] - y * v[0], v[2]]
}

/// A world vector along a landmark's own axes.
pub fn along_axes(frame: &[f64], axes: usize, v: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|axis| (0..3).map(|k| frame[axes + 3 * axis + k] * v[k]).sum())
}

/// What the body feels of itself.
pub struct Proprioception {
    pelvis: usize,
    pelvis_axes: usize,
    drift: usize,
    turning: usize,
    com: usize,
    com_velocity: usize,
    positions: List,
    velocities: List,
    muscles: [List; 4],
    sums: Sums,
}

impl Proprioception {
    pub fn new(slots: &Slots<'_>, sums: Sums) -> Self {
        let pelvis = slots.landmark("pelvis");
        Self {
            pelvis: slots.of(Sensor::LandmarkPosition(pelvis)),
            pelvis_axes: slots.of(Sensor::LandmarkAxes(pelvis)),
            drift: slots.of(Sensor::LandmarkVelocity(pelvis)),
            turning: slots.of(Sensor::LandmarkAngularVelocity(pelvis)),
            com: slots.of(Sensor::ComPosition),
            com_velocity: slots.of(Sensor::ComVelocity),
            positions: slots.joints(Sensor::JointPosition),
            velocities: slots.joints(Sensor::JointVelocity),
            muscles: [Sensor::MuscleLength, Sensor::MuscleVelocity, Sensor::MuscleForce, Sensor::MuscleActivation]
                .map(|sensor| slots.muscles(sensor)),
            sums,
        }
    }

    /// Writes it to the front of `out` and returns what is left.
    pub fn write<'a>(&self, frame: &[f64], out: &'a mut [f64]) -> &'a mut [f64] {
        out[0] = frame[self.pelvis + 2];
        out[1..4].copy_from_slice(&along_heading(frame, self.pelvis_axes, vector(frame, self.pelvis_axes + 6)));
        let out = self.positions.copy(frame, &mut out[4..]);
        out[..3].copy_from_slice(&along_axes(frame, self.pelvis_axes, vector(frame, self.drift)));
        out[3..6].copy_from_slice(&along_axes(frame, self.pelvis_axes, vector(frame, self.turning)));
        let out = self.velocities.copy(frame, &mut out[6..]);
        out[0] = frame[self.com + 2];
        out[1..4].copy_from_slice(&along_heading(frame, self.pelvis_axes, vector(frame, self.com_velocity)));
        self.muscles.iter().fold(&mut out[4..], |out, list| list.copy(frame, out))
    }

    /// Mean of the squared activations.
    pub fn effort(&self, frame: &[f64]) -> f64 {
        let [.., activation] = &self.muscles;
        if let (Sums::Columns, List::Together(range)) = (self.sums, activation) {
            let rows = frame[range.clone()].chunks_exact(8);
            let rest: f64 = rows.remainder().iter().map(|value| value * value).sum();
            let mut columns = [0.0; 8];
            rows.for_each(|row| columns.iter_mut().zip(row).for_each(|(column, value)| *column += value * value));
            return (columns.iter().sum::<f64>() + rest) / range.len() as f64;
        }
        let (mut sum, mut count) = (0.0, 0.0);
        activation.each(frame, |value| {
            sum += value * value;
            count += 1.0;
        });
        sum / count
    }
}

/// The unit quaternion w x y z, w not negative, of axes that stand one after the other.
pub fn quaternion(axes: &[f64]) -> [f64; 4] {
    let (trace, [xx, yy, zz]) = (axes[0] + axes[4] + axes[8], [axes[0], axes[4], axes[8]]);
    let [a, b, c] = [axes[5] - axes[7], axes[6] - axes[2], axes[1] - axes[3]];
    let [d, e, f] = [axes[1] + axes[3], axes[6] + axes[2], axes[5] + axes[7]];
    let raw = if trace > xx.max(yy).max(zz) {
        [1.0 + trace, a, b, c]
    } else if xx > yy.max(zz) {
        [a, 1.0 + xx - yy - zz, d, e]
    } else if yy > zz {
        [b, d, 1.0 + yy - xx - zz, f]
    } else {
        [c, e, f, 1.0 + zz - xx - yy]
    };
    let length = raw.iter().map(|x| x * x).sum::<f64>().sqrt() * if raw[0] < 0.0 { -1.0 } else { 1.0 };
    raw.map(|x| x / length)
}

/// The reward of all terms.
pub fn weighted_sum(terms: &[f64], weights: &[f64]) -> f64 {
    terms.iter().zip(weights).map(|(term, weight)| term * weight).sum()
}

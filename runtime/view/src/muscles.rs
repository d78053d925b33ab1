//! What muscles do: excitations, activations and forces.
//!
//! The force of a muscle is its activation times its gain, which changes as slowly as its length, plus its passive force. Where that
//! holds, gains and passive forces are stored instead of forces: they take a third of the bytes.

use crate::anatomy::Anatomy;
use crate::track::{Track, quantise};
use msk_runtime::body::sensors::Snapshot;

/// Quantum of activations and of fatigued shares.
pub(crate) const ACTIVATION: f64 = 1.0 / 255.0;
/// Quantum of excitations, which policies change from step to step: finer ones would take most of a page.
pub(crate) const EXCITATION: f64 = 1.0 / 50.0;
/// Quantum of forces against the peak isometric force of the healthy muscle.
pub(crate) const FORCE: f64 = 1.0 / 100.0;
/// A force that is off by more than this share of the peak is not that of the law above.
const TOLERANCE: f64 = 1e-9;

/// Muscles over time.
pub(crate) struct Muscles {
    pub activations: Track,
    pub excitations: Track,
    forces: Track,
    gains: Track,
    passive: Track,
    lawful: bool,
}

impl Muscles {
    pub fn new(count: usize) -> Self {
        let track = || Track::new(count);
        Self { activations: track(), excitations: track(), forces: track(), gains: track(), passive: track(), lawful: true }
    }

    /// Appends a frame.
    pub fn look(&mut self, anatomy: &Anatomy, snapshot: &Snapshot<'_>) {
        let actuation = &snapshot.workspace.actuation;
        let activation = |index: usize| snapshot.state.activation.get(index).copied().unwrap_or(0.0);
        let all = 0..anatomy.muscles.len();
        // Tension is positive here, and negative in the physics.
        let share = |index: usize, force: f64| match anatomy.muscles[index].force {
            peak if peak > 0.0 => -force / peak,
            _ => 0.0,
        };
        let row = |part: fn(&Snapshot<'_>, usize) -> f64| {
            all.clone().map(move |index| quantise(share(index, part(snapshot, index)), FORCE))
        };
        self.activations.push(all.clone().map(|index| quantise(activation(index), ACTIVATION)));
        let excitation = |index: usize| snapshot.state.control.get(index).copied().unwrap_or(0.0);
        self.excitations.push(all.clone().map(|index| quantise(excitation(index), EXCITATION)));
        self.forces.push(row(|snapshot, index| snapshot.workspace.actuation.force[index]));
        self.gains.push(row(|snapshot, index| snapshot.workspace.actuation.gain[index]));
        self.passive.push(row(|snapshot, index| snapshot.workspace.actuation.bias[index]));
        self.lawful &= all.clone().all(|index| {
            let by_law = actuation.gain[index] * activation(index) + actuation.bias[index];
            share(index, by_law - actuation.force[index]).abs() <= TOLERANCE
        });
    }

    /// Tracks of forces, or of gains and passive forces; the others are empty.
    pub fn finish(&self) -> [Track; 3] {
        match self.lawful {
            true => [Track::new(0), self.gains.clone(), self.passive.clone()],
            false => [self.forces.clone(), Track::new(0), Track::new(0)],
        }
    }
}

//! Joint smoothness: log10 of the mean squared angular jerk over all hinges and balls, log10(rad²/s⁶); smaller is smoother.
//!
//! j(t) = (ω(t) - 2 ω(t - Δ) + ω(t - 2Δ)) / Δ² of the samples ω before a step, one control step Δ apart; J is the mean of j² over times
//! and degrees of freedom, and log10(max(J, 1e-12)) is reported. The root and slides do not count; coupled joints do. Mean squared jerk
//! is the criterion of Flash and Hogan (J. Neurosci. 5, 1985), here of joints and not of the hand.

use crate::trace::{Quantity, Row};
use msk_physics::scalar::Real;

/// The least jerk that is told from none, rad²/s⁶.
const LEAST: f64 = 1e-12;
/// What the columns of a root begin with.
const ROOT: &str = "root.";

/// Sums up squares of jerks.
#[derive(Debug, Clone, Default)]
pub(super) struct Smoothness {
    /// Columns that count; none before the first row.
    columns: Option<Vec<usize>>,
    /// The last samples before a step, the newest last.
    samples: Vec<Vec<f64>>,
    /// The last row, which counts once a step follows.
    last: Option<Vec<f64>>,
    sum: f64,
    count: u64,
}

impl Smoothness {
    pub fn look(&mut self, row: &Row<'_>) {
        let Some(block) = row.layout().block(Quantity::Velocities) else { return };
        let counts = |place: &usize| {
            let column = &block.columns[*place];
            column.unit == "rad/s" && !column.name.starts_with(ROOT)
        };
        let columns = self.columns.get_or_insert_with(|| (0..block.columns.len()).filter(counts).collect());
        let velocities = row.of(Quantity::Velocities);
        let present = columns.iter().map(|&column| velocities[column]).collect();
        if let Some(sample) = self.last.replace(present) {
            self.add(sample, row.layout().period);
        }
    }

    fn add(&mut self, sample: Vec<f64>, period: f64) {
        if let [second, first] = self.samples.as_slice() {
            let jerks = sample.iter().zip(first).zip(second).map(|((now, first), second)| {
                let jerk = (now - 2.0 * first + second) / (period * period);
                jerk * jerk
            });
            self.sum += jerks.sum::<f64>();
            self.count += sample.len() as u64;
            self.samples.remove(0);
        }
        self.samples.push(sample);
    }

    /// The smoothness; `None` with fewer than three samples.
    pub fn finish(&self) -> Option<f64> {
        (self.count > 0).then(|| libm::log10((self.sum / self.count as f64).at_least(LEAST)))
    }
}

//! Weights as data, kept within what their author allows.
//!
//! 1. [`CompiledTask::reweighted`](crate::task::CompiledTask::reweighted) lays other weights over a compiled task;
//! 2. [`rules`] bounds how far one change may go, and projects proposals onto a fixed sum of sizes.

mod applied;
mod change;
pub mod rules;

pub use crate::numbers::exact as written;
pub use crate::schedule::Schedule;
pub use change::{Change, Problem, Refused};

/// Largest size of a weight: the reward of a step then stays a number that sums and tables can hold.
pub const LARGEST: f64 = 1e9;

/// Whether a number may be a weight at all: finite, and not beyond [`LARGEST`].
pub fn may_be(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// What a tuner may do with a weight.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bounds {
    /// Anything that keeps the sign; nothing stays nothing.
    Free,
    /// Nothing.
    Fixed,
    /// Anything between the two.
    Range(f64, f64),
}

impl Bounds {
    /// Whether a weight that is `now` may become `next`.
    pub fn allow(self, now: f64, next: f64) -> bool {
        match self {
            Self::Free => sign(now) == sign(next),
            Self::Fixed => now == next,
            Self::Range(low, high) => low <= next && next <= high,
        }
    }

    /// In words: `fixed`, `5..30`, `above 0`.
    pub fn described(self, now: f64) -> String {
        match self {
            Self::Free => match sign(now) {
                1 => "above 0".into(),
                -1 => "below 0".into(),
                _ => "0".into(),
            },
            Self::Fixed => "fixed".into(),
            Self::Range(low, high) => format!("{}..{}", written(low), written(high)),
        }
    }
}

fn sign(value: f64) -> i8 {
    i8::from(value > 0.0) - i8::from(value < 0.0)
}

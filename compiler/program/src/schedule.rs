//! Weights that change during a training.

use crate::extremes::{maximum, minimum};
use crate::numbers::exact;
use serde::{Deserialize, Serialize};

/// How a weight comes to be its last one: `10 -> 5 over 20 % .. 50 %` stays 10 for the first fifth of a training, changes linearly, and
/// is 5 from its middle on. Without a training, that is for `run`, `eval` and `test`, a weight is its last one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Schedule {
    /// The weight at the beginning.
    pub from: f64,
    /// The share of the training until which it stays, 0 to 1.
    pub begin: f64,
    /// The share from which the weight is the last one: greater than `begin`, at most 1.
    pub end: f64,
}

impl Schedule {
    /// The weight at a share of the training, 0 to 1, of a term whose last weight is `last`.
    ///
    /// ```
    /// # use msk_program::weights::Schedule;
    /// let schedule = Schedule { from: 10.0, begin: 0.2, end: 0.6 };
    /// assert_eq!([0.0, 0.2, 0.4, 0.6, 1.0].map(|progress| schedule.at(progress, 5.0)), [10.0, 10.0, 7.5, 5.0, 5.0]);
    /// ```
    pub fn at(&self, progress: f64, last: f64) -> f64 {
        // The ends are exact, whatever the rounding between them.
        let share = maximum(minimum((progress - self.begin) / (self.end - self.begin), 1.0), 0.0);
        if share >= 1.0 { last } else { (1.0 - share) * self.from + share * last }
    }

    /// When it changes: `over 30 %`, `over 20 % .. 50 %`.
    pub fn shares(&self) -> String {
        let percent = |share: f64| format!("{} %", exact((share * 1e14).round() / 1e12));
        match self.begin {
            0.0 => format!("over {}", percent(self.end)),
            begin => format!("over {} .. {}", percent(begin), percent(self.end)),
        }
    }
}

impl core::fmt::Display for Schedule {
    /// As the language writes it, without the last weight: `from 10 over 20 % .. 50 %`.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "from {} {}", exact(self.from), self.shares())
    }
}

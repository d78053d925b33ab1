//! What each term can contribute in one step: the analysis that lints on rewards share.

use crate::check::reward::RewardTerm;
use crate::check::task::CheckedTask;
use crate::extremes::{maximum, minimum};
use crate::graph::interval::{self, Bounds};

/// Between which values a term stays, and what it contributes in one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Amount {
    /// Of the formula.
    pub value: Bounds,
    /// Multiplied by the weight.
    pub contribution: Bounds,
}

impl Amount {
    /// Of one term, whose formula stays within `value`.
    pub(super) fn new(term: &RewardTerm<'_>, value: Bounds) -> Self {
        let by = |value: f64| if term.weight == 0.0 { 0.0 } else { term.weight * value };
        let (a, b) = (by(value.low), by(value.high));
        Self { value, contribution: Bounds::new(minimum(a, b), maximum(a, b)) }
    }

    /// The largest size of its contribution.
    pub(super) fn size(&self) -> f64 {
        maximum(self.contribution.high.abs(), self.contribution.low.abs())
    }
}

/// Of every term, in the order of the task.
pub(super) fn of_terms(task: &CheckedTask<'_>, bounds: &[Vec<Bounds>]) -> Vec<Amount> {
    task.terms.iter().map(|term| Amount::new(term, interval::of_scalar(bounds, term.node))).collect()
}

//! What observations are normalised by.

use crate::{EvaluationError, Trial, play_watched};
use msk_physics::scalar::Real;
use msk_runtime::episode::{Environment, EpisodeKey};
use msk_runtime::perturbation::Normalization;
use msk_runtime::policy::PolicySource;
use std::sync::atomic::AtomicBool;

/// Unperturbed episodes from which means and deviations are taken.
pub const NORMALIZING: u64 = 5;
/// Variance of an entry that hardly changes, in its unit squared: learners' normalisers have the same.
const LEAST_VARIANCE: f64 = 1e-8;

/// Mean and deviation of every entry of the observation over the first unperturbed episodes of a trial under a policy, by Welford's
/// recurrence (Technometrics 4, 1962). `None` if `stop` became true.
///
/// # Errors
/// A policy that cannot act.
pub fn normalization(
    trial: &Trial,
    policy: &PolicySource,
    (seed, episodes): (u64, u64),
    stop: &AtomicBool,
) -> Result<Option<Normalization>, EvaluationError> {
    let mut moments = Moments::default();
    let mut environment = trial.episode()?;
    for episode in 0..episodes.min(NORMALIZING) {
        let mut policy = policy.open(stop)?;
        let mut look = |environment: &Environment| moments.add(environment.observation());
        let key = EpisodeKey { seed, episode };
        if play_watched(trial, &mut environment, key, policy.as_mut(), stop, &mut look)?.is_none() {
            return Ok(None);
        }
    }
    Ok(Some(moments.finish()))
}

/// Means and sums of squared distances from them, so far.
#[derive(Debug, Default)]
pub(super) struct Moments {
    count: f64,
    mean: Vec<f64>,
    squares: Vec<f64>,
}

impl Moments {
    pub fn add(&mut self, observation: &[f64]) {
        self.mean.resize(observation.len(), 0.0);
        self.squares.resize(observation.len(), 0.0);
        self.count += 1.0;
        for ((mean, squares), value) in self.mean.iter_mut().zip(&mut self.squares).zip(observation) {
            let before = value - *mean;
            *mean += before / self.count;
            *squares += before * (value - *mean);
        }
    }

    pub fn finish(self) -> Normalization {
        let deviation = |squares: &f64| (squares / self.count.at_least(1.0) + LEAST_VARIANCE).sqrt();
        Normalization { deviation: self.squares.iter().map(deviation).collect(), mean: self.mean }
    }
}

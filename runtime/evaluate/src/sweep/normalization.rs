//! What observations are normalised by.

use crate::statistics::Moments;
use crate::{EvaluationError, Trial, play_watched};
use msk_runtime::episode::{Environment, EpisodeKey};
use msk_runtime::perturbation::Normalization;
use msk_runtime::policy::PolicySource;
use std::sync::atomic::AtomicBool;

/// Unperturbed episodes from which means and deviations are taken.
pub const NORMALIZING: u64 = 5;
/// Variance of an entry that hardly changes, in its unit squared: learners' normalisers have the same.
const LEAST_VARIANCE: f64 = 1e-8;

/// Mean and deviation of every entry of the observation over the first unperturbed episodes of a trial under a policy, by Welford's
/// recurrence. `None` if `stop` became true.
///
/// # Errors
/// A policy that cannot act.
pub fn normalization(
    trial: &Trial,
    policy: &PolicySource,
    (seed, episodes): (u64, u64),
    stop: &AtomicBool,
) -> Result<Option<Normalization>, EvaluationError> {
    let mut entries = Vec::new();
    let mut environment = trial.episode()?;
    for episode in 0..episodes.min(NORMALIZING) {
        let mut policy = policy.open(stop)?;
        let mut look = |environment: &Environment| add(&mut entries, environment.observation());
        let key = EpisodeKey { seed, episode };
        if play_watched(trial, &mut environment, key, policy.as_mut(), stop, &mut look)?.is_none() {
            return Ok(None);
        }
    }
    Ok(Some(finish(&entries)))
}

/// Adds an observation to the moments of its entries.
pub(super) fn add(entries: &mut Vec<Moments>, observation: &[f64]) {
    entries.resize(observation.len(), Moments::default());
    entries.iter_mut().zip(observation).for_each(|(moments, value)| moments.add(*value));
}

/// The normalisation by these moments.
pub(super) fn finish(entries: &[Moments]) -> Normalization {
    let deviation = |moments: &Moments| (moments.variance() + LEAST_VARIANCE).sqrt();
    Normalization { mean: entries.iter().map(Moments::mean).collect(), deviation: entries.iter().map(deviation).collect() }
}

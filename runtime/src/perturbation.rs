//! Perturbations of an evaluation: noise, forces and parameters that a policy has to stand, beside what its task draws itself.
//!
//! Chance depends on seed, episode and control step alone, so that a perturbed episode has the same bits on any number of threads, and
//! an episode that goes on from a snapshot goes on as it would have. Episodes that a policy imagines are not perturbed.

use msk_physics::scalar::Real;
use msk_program::numbers::exact;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// What observations are normalised by: mean and deviation of every entry.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Normalization {
    /// Means, in the units of the entries.
    pub mean: Vec<f64>,
    /// Standard deviations, likewise; all above 0.
    pub deviation: Vec<f64>,
}

/// Bounds of a normalised observation that noise was added to.
pub const OBSERVATION_BOUND: f64 = 20.0;

/// Perturbations of all episodes of an evaluation. The default is none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Perturbation {
    /// Standard deviation of what is added to every entry of an action at every control step; the sum is clipped to [-1, 1].
    #[serde(skip_serializing_if = "is_zero")]
    pub action: f64,
    /// Standard deviation of what is added to every entry of the normalised observation at the reset and every control step; the sum is
    /// clipped to [-20, 20].
    #[serde(skip_serializing_if = "is_zero")]
    pub observation: f64,
    /// Every muscle's active force is multiplied by a factor of its own, uniform in 1 - g to 1 + g, drawn for every episode.
    #[serde(skip_serializing_if = "is_zero")]
    pub gain: f64,
    /// Size of horizontal pushes against the root, in weights of the body: 0.2 s each two seconds from the first second on, all of an
    /// episode in one direction, which is drawn for it.
    #[serde(skip_serializing_if = "is_zero")]
    pub push: f64,
    /// The sliding friction of the ground is multiplied by a factor, uniform in 1 - f to 1 + f, drawn for every episode.
    #[serde(skip_serializing_if = "is_zero")]
    pub friction: f64,
    /// The mass of every segment of the body is multiplied by a factor of its own, uniform in 1 - m to 1 + m, drawn for every episode.
    #[serde(skip_serializing_if = "is_zero")]
    pub mass: f64,
    /// Control steps by which actions take effect late.
    #[serde(skip_serializing_if = "is_none")]
    pub latency: u32,
    /// What observations are normalised by; without it noise is added to them as they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normalization: Option<Arc<Normalization>>,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn is_none(value: &u32) -> bool {
    *value == 0
}

/// A perturbation that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the perturbation `{what}` is {}, expected {expected}", exact(*.value))]
pub struct PerturbationError {
    /// Which.
    pub what: &'static str,
    /// As given.
    pub value: f64,
    /// What it may be.
    pub expected: &'static str,
}

/// Most control steps of latency.
pub const MOST_LATENCY: u32 = 1000;

impl Perturbation {
    /// Whether nothing is perturbed.
    pub fn is_none(&self) -> bool {
        *self == Self { normalization: self.normalization.clone(), ..Self::default() }
    }

    /// Whether all is within its bounds.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), PerturbationError> {
        let Self { action, observation, gain, push, friction, mass, .. } = *self;
        for (what, value) in [("action", action), ("observation", observation), ("push", push)] {
            if !(0.0..=1e3).contains(&value) {
                return Err(PerturbationError { what, value, expected: "a number from 0 to 1000" });
            }
        }
        for (what, value) in [("gain", gain), ("friction", friction), ("mass", mass)] {
            if !(0.0..1.0).contains(&value) {
                return Err(PerturbationError { what, value, expected: "a number from 0 to below 1" });
            }
        }
        let value = f64::from(self.latency);
        let late = PerturbationError { what: "latency", value, expected: "at most 1000 control steps" };
        if self.latency <= MOST_LATENCY { Ok(()) } else { Err(late) }
    }

    /// Adds noise to an observation; `normal` draws from the standard normal distribution.
    pub(crate) fn disturb(&self, observation: &mut [f64], mut normal: impl FnMut() -> f64) {
        let none = Normalization::default();
        let normalization = self.normalization.as_deref().unwrap_or(&none);
        let scales = normalization.mean.iter().copied().zip(normalization.deviation.iter().copied());
        // Entries beyond the known ones, if any, are taken as they are.
        for (entry, (mean, deviation)) in observation.iter_mut().zip(scales.chain(std::iter::repeat((0.0, 1.0)))) {
            let noisy = (*entry - mean) / deviation + self.observation * normal();
            *entry = mean + deviation * noisy.clip(-OBSERVATION_BOUND, OBSERVATION_BOUND);
        }
    }
}

/// As results name it: `action 0.05, latency 3`; `none` if there is none.
impl fmt::Display for Perturbation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { action, observation, gain, push, friction, mass, latency, .. } = *self;
        let parts = [
            ("action", action),
            ("observation", observation),
            ("gain", gain),
            ("push", push),
            ("friction", friction),
            ("mass", mass),
            ("latency", f64::from(latency)),
        ];
        let words: Vec<String> =
            parts.iter().filter(|(_, value)| *value != 0.0).map(|(name, value)| format!("{name} {}", exact(*value))).collect();
        f.write_str(if words.is_empty() { "none" } else { "" })?;
        f.write_str(&words.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_added_to_the_normalised_observation_and_bounded() {
        let normalization = Normalization { mean: vec![10.0, 0.0], deviation: vec![2.0, 0.5] };
        let perturbation =
            Perturbation { observation: 0.1, normalization: Some(Arc::new(normalization)), ..Perturbation::default() };
        let mut observation = [12.0, -100.0, 3.0];
        perturbation.disturb(&mut observation, || 1.0);
        // (12 - 10) / 2 + 0.1 = 1.1; -200 is beyond the bound; the third is taken as it is.
        assert_eq!(observation, [12.2, -10.0, 3.1]);
    }

    #[test]
    fn perturbations_are_named_and_bounded() {
        let some = Perturbation { gain: 0.2, latency: 3, ..Perturbation::default() };
        assert_eq!((some.to_string(), Perturbation::default().to_string()), ("gain 0.2, latency 3".into(), "none".into()));
        assert!(some.check().is_ok() && !some.is_none() && Perturbation::default().is_none());
        let message = |perturbation: Perturbation| perturbation.check().unwrap_err().to_string();
        let too_much = message(Perturbation { gain: 1.0, ..some.clone() });
        assert_eq!(too_much, "the perturbation `gain` is 1, expected a number from 0 to below 1");
        assert!(message(Perturbation { action: f64::NAN, ..some.clone() }).contains("`action` is NaN"));
        assert!(message(Perturbation { latency: 1001, ..some }).contains("at most 1000 control steps"));
    }
}

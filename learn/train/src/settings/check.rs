//! What settings may hold.

use super::{Algorithm, Settings};
use msk_settings::{Checked, SettingsError};
use std::ops::RangeInclusive;

impl Settings {
    /// Whether every number lies where it makes sense; NaN does not.
    pub(crate) fn check(&self, text: &str) -> Result<(), SettingsError> {
        let checked = Checked::of(text);
        let Self { ppo, sac, dynsyn, mpo, dep, clone, .. } = self;
        let numbers: [(&'static str, f64, RangeInclusive<f64>); 38] = [
            ("discount", self.discount, 0.0..=1.0),
            ("noise_correlation", self.noise_correlation, 0.0..=0.9999),
            ("learning_rate", ppo.learning_rate, 1e-8..=1.0),
            ("lambda", ppo.lambda, 0.0..=1.0),
            ("clip", ppo.clip, 1e-3..=10.0),
            ("entropy", ppo.entropy, 0.0..=10.0),
            ("value_weight", ppo.value_weight, 0.0..=100.0),
            ("gradient_norm", ppo.gradient_norm, 1e-6..=1e6),
            ("log_std", ppo.log_std, -10.0..=2.0),
            ("actor_rate", sac.actor_rate, 1e-8..=1.0),
            ("critic_rate", sac.critic_rate, 1e-8..=1.0),
            ("updates", sac.updates, 1e-4..=64.0),
            ("follow", sac.follow, 1e-6..=1.0),
            ("temperature", sac.temperature, 1e-8..=100.0),
            ("target_entropy", sac.target_entropy, -100.0..=100.0),
            ("anneal", sac.anneal, 0.0..=1.0),
            ("weight_decay", sac.weight_decay, 0.0..=1.0),
            ("amplitude", dynsyn.amplitude, 0.0..=1.0),
            ("release", dynsyn.release, 0.0..=0.999),
            ("speed", dynsyn.speed, 1e-3..=1000.0),
            ("actor_rate", mpo.actor_rate, 1e-8..=1.0),
            ("critic_rate", mpo.critic_rate, 1e-8..=1.0),
            ("dual_rate", mpo.dual_rate, 1e-8..=1.0),
            ("updates", mpo.updates, 1e-4..=64.0),
            ("follow", mpo.follow, 1e-6..=1.0),
            ("epsilon", mpo.epsilon, 1e-6..=10.0),
            ("epsilon_penalty", mpo.epsilon_penalty, 1e-9..=10.0),
            ("epsilon_mean", mpo.epsilon_mean, 1e-9..=10.0),
            ("epsilon_std", mpo.epsilon_std, 1e-12..=10.0),
            ("gain", dep.gain, 1e-3..=1e9),
            ("bias_rate", dep.bias_rate, 0.0..=1.0),
            ("probability", dep.probability, 0.0..=1.0),
            ("learning_rate", clone.learning_rate, 1e-8..=1.0),
            ("updates", clone.updates, 1e-4..=64.0),
            ("guided", clone.guided, 0.0..=1.0),
            ("critics_first", self.critics_first as f64, 0.0..=1e12),
            ("replay_memory", self.replay_memory, 1e-3..=1024.0),
            ("evaluate_every", self.evaluate_every as f64, 1.0..=1e12),
        ];
        for (key, found, range) in numbers {
            checked.number(key, found, range, "")?;
        }
        let counts: [(&'static str, usize, RangeInclusive<usize>); 25] = [
            ("episodes", self.episodes, 1..=4096),
            ("action_repeat", self.action_repeat, 1..=1000),
            ("evaluation_episodes", self.evaluation_episodes, 1..=1000),
            ("checkpoint_every", usize::try_from(self.checkpoint_every).unwrap_or(usize::MAX), 1..=1_000_000_000_000),
            ("horizon", ppo.horizon, 1..=1_000_000),
            ("minibatch", ppo.minibatch, 1..=1_000_000),
            ("epochs", ppo.epochs, 1..=1000),
            ("replay", sac.replay, 1..=100_000_000),
            ("start", sac.start, 1..=100_000_000),
            ("batch", sac.batch, 1..=1_000_000),
            ("groups", dynsyn.groups, 1..=1_000_000),
            ("rollout", dynsyn.rollout, 100..=100_000_000),
            ("replay", mpo.replay, 1..=100_000_000),
            ("start", mpo.start, 1..=100_000_000),
            ("batch", mpo.batch, 1..=1_000_000),
            ("block", mpo.block, 1..=100_000),
            ("steps", mpo.steps, 1..=1000),
            ("samples", mpo.samples, 1..=10_000),
            ("horizon", dep.horizon, 3..=10_000),
            ("delay", dep.delay, 0..=1000),
            ("smoothing", dep.smoothing, 1..=1000),
            ("length", dep.length, 1..=100_000),
            ("batch", clone.batch, 1..=1_000_000),
            ("memory", clone.memory, 1..=100_000_000),
            ("actor_delay", sac.actor_delay, 1..=1000),
        ];
        for (key, found, range) in counts {
            checked.count(key, found, range)?;
        }
        for (key, sizes, least) in [("hidden", &self.hidden, 1), ("critic_hidden", &self.critic_hidden, 0)] {
            if !(least..=16).contains(&sizes.len()) {
                return checked.refuse(key, format!("{sizes:?}"), format!("{least} to 16 sizes of layers"));
            }
            if let Some(size) = sizes.iter().find(|size| !(1..=16384).contains(*size)) {
                return checked.refuse(key, size.to_string(), "sizes from 1 to 16384".into());
            }
            if self.residual && sizes.iter().any(|size| *size != sizes[0]) {
                return checked.refuse(key, format!("{sizes:?}"), "blocks of one size, because `residual` adds them up".into());
            }
        }
        if self.algorithm == Algorithm::Clone && self.action_repeat > 1 {
            let expected = "1, because a teacher answers every control step".into();
            return checked.refuse("action_repeat", self.action_repeat.to_string(), expected);
        }
        if self.algorithm == Algorithm::Ppo && ppo.minibatch > ppo.horizon * self.episodes {
            let all = ppo.horizon * self.episodes;
            return checked.refuse(
                "minibatch",
                ppo.minibatch.to_string(),
                format!("at most `horizon` x `episodes`, which is {all}"),
            );
        }
        Ok(())
    }
}

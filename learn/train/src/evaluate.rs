//! How an agent does without chance: episodes that no learner has seen, played with the mean of the actions.

use crate::agent::Agent;
use crate::error::TrainError;
use msk_network::Tape;
use msk_program::numbers::exact;
use msk_runtime::episode::{AutoresetMode, Engine, EpisodeKey, VectorEnvironment};
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the seed of a training is combined with for evaluations, so that they play other episodes.
const SEED: u64 = 0x6576_616C;
/// Most episodes side by side.
const SLOTS: usize = 16;

/// Means over the episodes of an evaluation, by the last weights of the task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evaluation {
    /// How many episodes were played.
    pub episodes: usize,
    /// Share that ended in success.
    pub success: f64,
    /// Mean return.
    #[serde(rename = "return")]
    pub total: f64,
    /// Mean length in control steps.
    pub steps: f64,
}

impl Evaluation {
    /// Why no evaluation comes to this, in words that continue "an evaluation"; files may hold any numbers.
    pub(crate) fn wrong(&self) -> Option<String> {
        let Self { success, total, steps, .. } = *self;
        if !(0.0..=1.0).contains(&success) {
            return Some(format!("whose success is {}: expected a number from 0 to 1", exact(success)));
        }
        let sound = total.is_finite() && steps >= 0.0 && steps.is_finite();
        (!sound).then(|| format!("of return {} in {} steps: expected finite numbers", exact(total), exact(steps)))
    }
}

/// Plays evaluations of one training.
pub(crate) struct Evaluator {
    environment: VectorEnvironment,
    seed: u64,
    episodes: usize,
}

impl Evaluator {
    pub fn new(engine: &Engine, seed: u64, episodes: usize, threads: NonZeroUsize) -> Result<Self, TrainError> {
        let slots = NonZeroUsize::new(episodes.min(SLOTS)).unwrap_or(NonZeroUsize::MIN);
        let environment = VectorEnvironment::new(engine.clone(), slots, threads)?.with_autoreset(AutoresetMode::Disabled);
        Ok(Self { environment, seed: seed ^ SEED, episodes })
    }

    /// Plays the episodes, the same ones every time; `None` if `stop` became true meanwhile.
    pub fn play(&mut self, agent: &Agent, tape: &mut Tape, stop: &AtomicBool) -> Result<Option<Evaluation>, TrainError> {
        let slots = self.environment.episodes().len();
        let mut actions = vec![0.0; slots * self.environment.engine().action_size()];
        let (mut successes, mut total, mut steps) = (0_usize, 0.0, 0.0);
        for first in (0..self.episodes).step_by(slots) {
            let count = slots.min(self.episodes - first);
            let key = |slot: usize| EpisodeKey { seed: self.seed, episode: (first + slot) as u64 };
            let keys: Vec<Option<EpisodeKey>> = (0..count).map(|slot| Some(key(slot))).collect();
            self.environment.reset_to(&keys);
            for step in 0.. {
                let left = self.environment.episodes().take(count).any(|episode| episode.ending().is_none());
                if !left {
                    break;
                }
                if stop.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                if agent.acts_at(step) {
                    agent.actor().act(tape, &self.environment.last().observations, &mut actions);
                }
                self.environment.step(&actions)?;
            }
            for episode in self.environment.episodes().take(count) {
                successes += usize::from(episode.report().success);
                total += episode.total();
                steps += f64::from(episode.steps());
            }
        }
        let count = self.episodes as f64;
        let success = successes as f64 / count;
        Ok(Some(Evaluation { episodes: self.episodes, success, total: total / count, steps: steps / count }))
    }
}

//! The episodes that a learner plays: what networks see of them, how rewards are scaled, and how they end.

use crate::agent::Actor;
use crate::error::TrainError;
use crate::settings::Settings;
use msk_network::{Moments, Normaliser};
use msk_runtime::episode::{Ending, Engine, Episode, EpisodeEnd, EpisodeKey, VectorEnvironment, VectorStep};
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;

/// Bound of normalised observations and rewards, in standard deviations.
pub(crate) const CLIP: f64 = 10.0;

/// Episodes side by side, with what is measured of them. A row of what a critic sees begins with what the policy sees.
pub(crate) struct Play {
    environment: VectorEnvironment,
    pub normaliser: Normaliser,
    returns: Returns,
    normalizes: [bool; 2],
    /// Present rows, slot after slot: as measured.
    rows: Vec<f64>,
    /// The last rows of the episodes that ended, in their slots, when one last did.
    pub final_rows: Vec<f64>,
    actions: Vec<f64>,
    /// Control steps that an action lasts for.
    repeat: usize,
    outcome: Outcome,
    /// Episodes that ended since they were last taken.
    pub ends: Vec<EpisodeEnd>,
}

/// What came of the last actions, slot by slot.
#[derive(Debug)]
pub(crate) struct Outcome {
    /// Sum of the rewards.
    pub rewards: Vec<f64>,
    /// Sum of the values of each term before its weight; a step that met a fault adds nothing.
    pub values: Vec<f64>,
    /// Whether the episode ended. The next one has begun then.
    pub ended: Vec<bool>,
    /// Whether it ended so that what would have followed has no value.
    pub terminated: Vec<bool>,
    /// Whether it ended so that its last row tells the value of what would have followed.
    pub truncated: Vec<bool>,
}

/// The discounted return of each slot and the deviation of all: what rewards are divided by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Returns {
    discount: f64,
    running: Vec<f64>,
    moments: Moments,
}

/// What of it a checkpoint keeps.
#[derive(Serialize, Deserialize)]
pub(crate) struct PlayState {
    /// None where episodes begin anew at every checkpoint.
    episodes: Option<Vec<Episode>>,
    next: Vec<EpisodeKey>,
    normaliser: Normaliser,
    returns: Returns,
    rows: Vec<f64>,
}

impl Play {
    pub fn new(engine: &Engine, settings: &Settings, seed: u64, threads: NonZeroUsize) -> Result<Self, TrainError> {
        let slots = NonZeroUsize::new(settings.episodes).unwrap_or(NonZeroUsize::MIN);
        let mut environment = VectorEnvironment::new(engine.clone(), slots, threads)?;
        environment.reset(seed);
        let (task, count) = (engine.task(), slots.get());
        let width = task.observation_size() + task.critic_size();
        let mut play = Self {
            environment,
            // Before anything was seen it only clips, and what is measured is finite.
            normaliser: Normaliser::new(width, if settings.normalize_observations { CLIP } else { f64::from(f32::MAX) }),
            returns: Returns { discount: settings.action_discount(), running: vec![0.0; count], moments: Moments::default() },
            normalizes: [settings.normalize_observations, settings.normalize_rewards],
            rows: Vec::new(),
            final_rows: Vec::new(),
            actions: vec![0.0; count * engine.action_size()],
            repeat: settings.action_repeat,
            outcome: Outcome {
                rewards: vec![0.0; count],
                values: vec![0.0; count * task.terms.len()],
                ended: vec![false; count],
                terminated: vec![false; count],
                truncated: vec![false; count],
            },
            ends: Vec::new(),
        };
        play.look();
        Ok(play)
    }

    pub fn slots(&self) -> usize {
        self.returns.running.len()
    }

    /// Numbers of a row, and how many of them the policy sees.
    pub fn widths(&self) -> [usize; 2] {
        [self.normaliser.width(), self.environment.engine().task().observation_size()]
    }

    pub fn entries(&self) -> usize {
        self.environment.engine().action_size()
    }

    /// Present rows as measured.
    pub fn rows(&self) -> &[f64] {
        &self.rows
    }

    /// Present rows as networks see them.
    pub fn seen(&self) -> Vec<f32> {
        let mut seen = vec![0.0; self.rows.len()];
        self.normalize(&self.rows, &mut seen);
        seen
    }

    /// Writes rows as networks see them.
    pub fn normalize(&self, rows: &[f64], out: &mut [f32]) {
        self.normaliser.apply(rows, out);
    }

    /// Writes rows without critic channels as networks see them.
    pub fn normalize_seen(&self, rows: &[f64], out: &mut [f32]) {
        self.normaliser.apply_first(self.widths()[1], rows, out);
    }

    /// Takes in a row that was seen elsewhere.
    pub fn saw(&mut self, row: &[f64]) {
        if self.normalizes[0] {
            self.normaliser.update(row);
        }
    }

    /// Takes in a row without critic channels.
    pub fn saw_first(&mut self, row: &[f32]) {
        if self.normalizes[0] {
            self.normaliser.update_first(row);
        }
    }

    /// Begins with the moments by which an agent normalises what it sees, as if it had seen so many rows.
    pub fn begin_as(&mut self, actor: &Actor, rows: f64) {
        self.normaliser.begin_with(actor.moments(rows));
    }

    /// Terms of the task.
    pub fn terms(&self) -> usize {
        self.environment.engine().task().terms.len()
    }

    /// Rewards, as learners see them, by the weights in force now: of values of the terms, for so many transitions.
    pub fn rewards(&self, values: &[f32], count: usize) -> Vec<f32> {
        let (terms, weights) = (self.terms(), self.environment.weights(0).unwrap_or_default());
        let of = |values: &[f32]| weights.iter().zip(values).map(|(weight, value)| weight * f64::from(*value)).sum();
        (0..count).map(|index| self.scaled(of(&values[index * terms..(index + 1) * terms]))).collect()
    }

    /// A reward as learners see it.
    pub fn scaled(&self, reward: f64) -> f32 {
        if !self.normalizes[1] {
            return reward as f32;
        }
        let scaled = reward / self.returns.moments.deviation();
        let low = if scaled < -CLIP { -CLIP } else { scaled };
        (if low > CLIP { CLIP } else { low }) as f32
    }

    pub fn set_progress(&mut self, progress: f64) -> Result<(), TrainError> {
        Ok(self.environment.set_progress(progress)?)
    }

    /// Rewards by these last weights from the next step on.
    pub fn set_weights(&mut self, weights: &[f64]) {
        for slot in 0..self.slots() {
            weights.iter().enumerate().for_each(|(term, weight)| self.environment.set_weight(slot, term, *weight));
        }
    }

    /// Control steps of [`step`](Self::step), in all slots together.
    pub fn span(&self) -> u64 {
        (self.repeat * self.slots()) as u64
    }

    /// Takes the control steps of an action in every slot, up to the end of its episode; [`outcome`](Self::outcome) has what came of it.
    pub fn step(&mut self, actions: &[f32]) -> Result<(), TrainError> {
        self.actions.iter_mut().zip(actions).for_each(|(entry, action)| *entry = f64::from(*action));
        let (terms, widths) = (self.terms(), self.widths());
        let Self { environment, outcome, ends, .. } = self;
        outcome.rewards.fill(0.0);
        outcome.values.fill(0.0);
        for _ in 0..self.repeat {
            let step = environment.step(&self.actions)?;
            ends.extend_from_slice(&step.ends);
            outcome.rewards.iter_mut().zip(&step.rewards).for_each(|(sum, reward)| *sum += reward);
            for (slot, episode) in environment.episodes().enumerate() {
                // One that had ended before stays as it was, with the report of its last step.
                let counts = match episode.ending() {
                    None => true,
                    Some(Ending::Fault(_)) => false,
                    Some(_) => environment.last().ended[slot],
                };
                if counts {
                    let sums = outcome.values[slot * terms..].iter_mut();
                    sums.zip(&episode.report().terms).for_each(|(sum, value)| *sum += value);
                }
            }
        }
        let step = environment.last();
        outcome.terminated.clone_from(&step.terminated);
        outcome.truncated.clone_from(&step.truncated);
        let flags = step.terminated.iter().zip(&step.truncated);
        outcome.ended.iter_mut().zip(flags).for_each(|(ended, (terminated, truncated))| *ended = *terminated || *truncated);
        if outcome.ended.contains(&true) {
            rows(step, widths, &mut self.final_rows);
            environment.reset_where(&outcome.ended);
        }
        let Returns { discount, running, moments } = &mut self.returns;
        for ((running, reward), ended) in running.iter_mut().zip(&outcome.rewards).zip(&outcome.ended) {
            *running = *discount * *running + reward;
            moments.add(*running);
            if *ended {
                *running = 0.0;
            }
        }
        self.look();
        Ok(())
    }

    /// The present episodes, slot by slot.
    pub fn episodes(&self) -> impl Iterator<Item = &Episode> {
        self.environment.episodes()
    }

    /// What came of the last actions.
    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    /// Takes in what the environments show.
    fn look(&mut self) {
        let widths = self.widths();
        rows(self.environment.last(), widths, &mut self.rows);
        if self.normalizes[0] {
            self.normaliser.update(&self.rows);
        }
    }

    /// Whether an episode can be continued from a checkpoint: the controller of an action space cannot be written.
    pub fn continues(&self) -> bool {
        !self.environment.episodes().any(Episode::has_controller)
    }

    /// Begins the next episodes, where those of a checkpoint could not be continued: a training goes on from it as one that was
    /// interrupted. Gives whether it did.
    pub fn at_checkpoint(&mut self) -> bool {
        if self.continues() {
            return false;
        }
        let every = vec![true; self.slots()];
        self.environment.reset_where(&every);
        self.returns.running.fill(0.0);
        self.look();
        true
    }

    pub fn state(&self) -> PlayState {
        PlayState {
            episodes: self.continues().then(|| self.environment.episodes().cloned().collect()),
            next: self.environment.next_keys().collect(),
            normaliser: self.normaliser.clone(),
            returns: self.returns.clone(),
            rows: self.rows.clone(),
        }
    }

    /// Goes on from a state.
    ///
    /// # Errors
    /// One of another task.
    pub fn restore(&mut self, state: PlayState) -> Result<(), String> {
        let slots = self.slots();
        if state.next.len() != slots || state.returns.running.len() != slots || state.rows.len() != self.rows.len() {
            return Err(format!("it has {} episodes side by side, expected {slots}", state.next.len()));
        }
        if state.normaliser.width() != self.normaliser.width() {
            return Err("it has observations of another length".into());
        }
        match state.episodes {
            Some(episodes) => {
                if episodes.len() != slots || !episodes.iter().all(|episode| self.environment.engine().accepts(episode)) {
                    return Err("its episodes are of another task".into());
                }
                episodes.iter().enumerate().for_each(|(slot, episode)| self.environment.restore(slot, episode));
            }
            None => {
                // Those that had just begun.
                let before = |key: &EpisodeKey| EpisodeKey { episode: key.episode.wrapping_sub(slots as u64), ..*key };
                let keys: Vec<Option<EpisodeKey>> = state.next.iter().map(|key| Some(before(key))).collect();
                self.environment.reset_to(&keys);
            }
        }
        state.next.iter().enumerate().for_each(|(slot, key)| self.environment.set_next_key(slot, *key));
        (self.normaliser, self.returns, self.rows) = (state.normaliser, state.returns, state.rows);
        Ok(())
    }
}

/// Observations with those of the critic beside them, whole rows and what of them the policy sees being so long.
fn rows(step: &VectorStep, [whole, width]: [usize; 2], out: &mut Vec<f64>) {
    let (seen, more) = (&step.observations, &step.critic_observations);
    out.clear();
    if whole == width {
        out.extend_from_slice(seen);
        return;
    }
    for (seen, more) in seen.chunks_exact(width.max(1)).zip(more.chunks_exact(whole - width)) {
        out.extend_from_slice(seen);
        out.extend_from_slice(more);
    }
}

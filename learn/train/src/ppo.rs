//! Proximal policy optimisation (Schulman et al. 2017, arXiv 1707.06347) with generalised advantages (Schulman et al. 2016,
//! arXiv 1506.02438), and the details by which implementations reach its published returns (Huang et al. 2022).

use crate::agent::{Actor, Output};
use crate::error::TrainError;
use crate::learner::{Losses, Means, Networks, Optimizer};
use crate::noise::Noise;
use crate::numbers::Numbers;
use crate::play::Play;
use crate::settings::{PpoSettings, Settings};
use msk_network::heads::{gaussian_entropy, gaussian_log_density};
use msk_network::{Kernel, Mlp, Variable};
use msk_runtime::episode::{EpisodeKey, Stream};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;

/// The learner.
pub(crate) struct Ppo {
    settings: PpoSettings,
    discount: f64,
    networks: Networks,
    policy: Mlp,
    value: Mlp,
    log_std: Range<usize>,
    optimizer: Optimizer,
    chance: Stream,
    noise: Noise,
    rollout: Rollout,
    means: Means,
    /// Control steps before which the policy stays as it is.
    critics_first: u64,
}

/// What is remembered between two updates: a row per action and slot, in the order of time.
#[derive(Default)]
struct Rollout {
    seen: Vec<f32>,
    actions: Vec<f32>,
    densities: Vec<f32>,
    rewards: Vec<f32>,
    values: Vec<f32>,
    ended: Vec<bool>,
    advantages: Vec<f32>,
    returns: Vec<f32>,
}

/// What of it a checkpoint keeps.
#[derive(Serialize, Deserialize)]
pub(crate) struct PpoState {
    parameters: Numbers,
    optimizer: Optimizer,
    chance: Stream,
    noise: Numbers,
}

impl Ppo {
    pub fn new(settings: &Settings, play: &Play, seed: u64, kernel: Arc<dyn Kernel>) -> Self {
        let [whole, width] = play.widths();
        let shape = |inputs: usize, outputs: usize| settings.shape(inputs, outputs);
        let mut networks = Networks::new(kernel);
        let mut draw = Stream::new(EpisodeKey { seed, episode: 0 }, "train/initial");
        let policy = networks.orthogonal("policy", &shape(width, play.entries()), 0.01, &mut draw);
        let value = networks.orthogonal("value", &shape(whole, 1), 1.0, &mut draw);
        let log_std = networks.parameters.add("policy.log_std", &[play.entries()]);
        networks.parameters.values_mut()[log_std.clone()].fill(settings.ppo.log_std as f32);
        let optimizer = Optimizer::new(0..networks.parameters.len(), settings.ppo.gradient_norm as f32, 1e-5);
        Self {
            settings: settings.ppo.clone(),
            discount: settings.action_discount(),
            networks,
            policy,
            value,
            log_std,
            optimizer,
            chance: Stream::new(EpisodeKey { seed, episode: 0 }, "train/chance"),
            noise: Noise::new(settings.noise_correlation),
            rollout: Rollout::default(),
            means: Means::default(),
            critics_first: 0,
        }
    }

    /// Begins as an agent, which stays as it is until the values have learned what it is worth.
    pub fn begin_as(&mut self, actor: &Actor, critics_first: u64) {
        actor.copy_to(&self.policy, &mut self.networks.parameters);
        self.critics_first = critics_first;
    }

    /// Control steps of a round, in all slots together.
    pub fn round_steps(&self, play: &Play) -> u64 {
        self.settings.horizon as u64 * play.span()
    }

    /// Plays, and learns from what was played. `progress` is the share of the training that has passed.
    pub fn round(&mut self, play: &mut Play, progress: f64, step: u64) -> Result<Losses, TrainError> {
        self.play(play)?;
        self.estimate_advantages(play);
        let share = if self.settings.anneal { 1.0 - progress } else { 1.0 };
        self.learn(play, self.settings.learning_rate * share, step)?;
        Ok(self.means.take())
    }

    /// Values of rows as networks see them.
    fn values_of(&mut self, rows: &[f32], width: usize) -> Vec<f32> {
        let Networks { tape, parameters, .. } = &mut self.networks;
        tape.clear();
        let seen = tape.constant(rows.len() / width.max(1), width, rows.iter().copied());
        let values = self.value.forward(tape, parameters, seen);
        tape.values(values).to_vec()
    }

    /// Plays `horizon` actions of the present policy in every slot.
    fn play(&mut self, play: &mut Play) -> Result<(), TrainError> {
        let ([whole, width], slots, entries) = (play.widths(), play.slots(), play.entries());
        let mut rows = vec![0.0; slots * whole];
        self.rollout.clear();
        for _ in 0..self.settings.horizon {
            play.normalize(play.rows(), &mut rows);
            let Networks { tape, parameters, .. } = &mut self.networks;
            tape.clear();
            let seen = tape.constant(slots, whole, rows.iter().copied());
            let values = self.value.forward(tape, parameters, seen);
            let observed = tape.columns(seen, 0..width);
            let mean = self.policy.forward(tape, parameters, observed);
            let log_std = tape.parameter(slots, self.log_std.clone(), parameters);
            let noise = self.noise.next(slots * entries, &mut self.chance);
            let drawn: Vec<f32> = tape
                .values(mean)
                .iter()
                .zip(tape.values(log_std))
                .zip(noise)
                .map(|((mean, log_std), noise)| mean + libm::expf(*log_std) * noise)
                .collect();
            let action = tape.constant(slots, entries, drawn.iter().copied());
            let density = gaussian_log_density(tape, mean, log_std, action);
            self.rollout.seen.extend_from_slice(&rows);
            self.rollout.densities.extend_from_slice(tape.values(density));
            self.rollout.values.extend_from_slice(tape.values(values));
            play.step(&drawn)?;
            self.rollout.actions.extend(drawn);
            let outcome = play.outcome();
            self.rollout.ended.extend_from_slice(&outcome.ended);
            let mut rewards: Vec<f32> = outcome.rewards.iter().map(|reward| play.scaled(*reward)).collect();
            // A truncated episode would have gone on: its last state has a value (Pardo et al. 2018).
            if outcome.truncated.contains(&true) {
                let truncated = outcome.truncated.clone();
                play.normalize(&play.final_rows, &mut rows);
                let finals = self.values_of(&rows, whole);
                for ((reward, value), _) in rewards.iter_mut().zip(finals).zip(truncated).filter(|(_, truncated)| *truncated) {
                    *reward += (self.discount as f32) * value;
                }
            }
            self.rollout.rewards.extend(rewards);
        }
        Ok(())
    }

    /// Generalised advantages, equations 11 and 16 of Schulman et al. 2016: A = delta + gamma lambda A', delta = r + gamma V' - V, where
    /// nothing follows the end of an episode.
    fn estimate_advantages(&mut self, play: &Play) {
        let ([whole, _], slots) = (play.widths(), play.slots());
        let mut next = self.values_of(&play.seen(), whole);
        let Rollout { rewards, values, ended, advantages, returns, .. } = &mut self.rollout;
        let (discount, decay) = (self.discount as f32, (self.discount * self.settings.lambda) as f32);
        advantages.resize(rewards.len(), 0.0);
        let mut later = vec![0.0; slots];
        for index in (0..rewards.len()).rev() {
            let slot = index % slots;
            let goes_on = if ended[index] { 0.0 } else { 1.0 };
            let error = rewards[index] + discount * goes_on * next[slot] - values[index];
            later[slot] = error + decay * goes_on * later[slot];
            next[slot] = values[index];
            advantages[index] = later[slot];
        }
        returns.extend(advantages.iter().zip(values.iter()).map(|(advantage, value)| advantage + value));
    }

    /// Gradient steps on minibatches, each transition `epochs` times.
    fn learn(&mut self, play: &Play, rate: f64, step: u64) -> Result<(), TrainError> {
        let mut order: Vec<usize> = (0..self.rollout.rewards.len()).collect();
        for _ in 0..self.settings.epochs {
            shuffle(&mut order, &mut self.chance);
            // A rest that is smaller than the others would weigh as much: it is left out, another one in every epoch.
            for batch in order.chunks_exact(self.settings.minibatch) {
                let loss = self.loss(batch, play, step >= self.critics_first);
                self.networks.descend(loss, ("the loss of PPO", step), rate, &mut self.optimizer)?;
            }
        }
        Ok(())
    }

    /// The negative of equation 9 of Schulman et al. 2017 on some transitions; of its error of the values alone unless the policy improves.
    fn loss(&mut self, batch: &[usize], play: &Play, improves: bool) -> Variable {
        let ([whole, width], entries, rows) = (play.widths(), play.entries(), batch.len());
        let (rollout, settings) = (&self.rollout, &self.settings);
        let Networks { tape, parameters, .. } = &mut self.networks;
        tape.clear();
        let seen = tape.constant(rows, whole, gather(&rollout.seen, whole, batch));
        let actions = tape.constant(rows, entries, gather(&rollout.actions, entries, batch));
        let before = tape.constant(rows, 1, gather(&rollout.densities, 1, batch));
        let old = tape.constant(rows, 1, gather(&rollout.values, 1, batch));
        let returns = tape.constant(rows, 1, gather(&rollout.returns, 1, batch));
        let [center, spread] = center(gather(&rollout.advantages, 1, batch), rows);
        let normal = gather(&rollout.advantages, 1, batch).map(|advantage| (advantage - center) / (spread + 1e-8));
        let advantages = tape.constant(rows, 1, normal);

        // The clipped surrogate, equation 7: min(r A, clip(r, 1 - epsilon, 1 + epsilon) A).
        let observed = tape.columns(seen, 0..width);
        let mean = self.policy.forward(tape, parameters, observed);
        let log_std = tape.parameter(rows, self.log_std.clone(), parameters);
        let density = gaussian_log_density(tape, mean, log_std, actions);
        let change = tape.subtract(density, before);
        let ratio = tape.exp(change);
        let plain = tape.multiply(ratio, advantages);
        let bounded = tape.clip(ratio, 1.0 - settings.clip as f32, 1.0 + settings.clip as f32);
        let bounded = tape.multiply(bounded, advantages);
        let surrogate = tape.minimum(plain, bounded);
        let surrogate = tape.mean(surrogate);

        // Half the squared error of the values, the greater of that of the present and of a clipped value.
        let found = self.value.forward(tape, parameters, seen);
        let error = tape.subtract(found, returns);
        let square = tape.square(error);
        let mut gain = tape.affine(square, -0.5, 0.0);
        if settings.clip_values {
            let change = tape.subtract(found, old);
            let change = tape.clip(change, -settings.clip as f32, settings.clip as f32);
            let near = tape.add(old, change);
            let error = tape.subtract(near, returns);
            let square = tape.square(error);
            let other = tape.affine(square, -0.5, 0.0);
            gain = tape.minimum(gain, other);
        }
        let gain = tape.mean(gain);

        let entropy = gaussian_entropy(tape, log_std);
        let entropy = tape.mean(entropy);

        // Equation 9: surrogate - c1 error + c2 entropy.
        let share = if improves { 1.0 } else { 0.0 };
        let objective = [(gain, settings.value_weight), (entropy, share * settings.entropy)];
        let policy = tape.affine(surrogate, share as f32, 0.0);
        let objective = objective.into_iter().fold(policy, |sum, (part, weight)| {
            let part = tape.affine(part, weight as f32, 0.0);
            tape.add(sum, part)
        });
        let loss = tape.affine(objective, -1.0, 0.0);

        let value = |variable: Variable| f64::from(tape.values(variable)[0]);
        let parts = [("policy", -value(surrogate)), ("value", -value(gain)), ("entropy", value(entropy))];
        // (r - 1) - ln r, an estimate of the divergence that is never negative (Schulman 2020).
        let pairs = tape.values(ratio).iter().zip(tape.values(change));
        let divergence = pairs.map(|(ratio, change)| f64::from(ratio - 1.0 - change)).sum::<f64>() / rows as f64;
        parts.into_iter().for_each(|(name, value)| self.means.add(name, value));
        self.means.add("divergence", divergence);
        loss
    }

    /// What acts: the mean.
    pub fn actor(&self, play: &Play) -> Actor {
        Actor::new(&self.policy, &self.networks.parameters, play, Output::Clipped)
    }

    pub fn state(&self) -> PpoState {
        PpoState {
            parameters: self.networks.state(),
            optimizer: self.optimizer.clone(),
            chance: self.chance.clone(),
            noise: self.noise.state(),
        }
    }

    /// # Errors
    /// Other sizes.
    pub fn restore(&mut self, state: PpoState) -> Result<(), String> {
        self.networks.restore(&state.parameters)?;
        self.noise.restore(state.noise);
        (self.optimizer, self.chance) = (state.optimizer, state.chance);
        Ok(())
    }
}

impl Rollout {
    fn clear(&mut self) {
        let Self { seen, actions, densities, rewards, values, ended, advantages, returns } = self;
        [seen, actions, densities, rewards, values, advantages, returns].into_iter().for_each(Vec::clear);
        ended.clear();
    }
}

/// Rows of `width` numbers, in the order of `batch`.
fn gather<'a>(values: &'a [f32], width: usize, batch: &'a [usize]) -> impl Iterator<Item = f32> + 'a {
    batch.iter().flat_map(move |index| &values[index * width..(index + 1) * width]).copied()
}

/// Mean and standard deviation.
fn center(values: impl Iterator<Item = f32>, count: usize) -> [f32; 2] {
    let (mut sum, mut squares) = (0.0, 0.0);
    for value in values.map(f64::from) {
        sum += value;
        squares += value * value;
    }
    let mean = sum / count as f64;
    let variance = squares / count as f64 - mean * mean;
    [mean as f32, if variance > 0.0 { variance.sqrt() as f32 } else { 0.0 }]
}

/// Fisher and Yates.
fn shuffle(order: &mut [usize], chance: &mut Stream) {
    for last in (1..order.len()).rev() {
        let other = (chance.uniform() * (last + 1) as f64) as usize;
        order.swap(last, other.min(last));
    }
}

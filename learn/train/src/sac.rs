//! Soft actor-critic (Haarnoja et al. 2018, arXiv 1801.01290; with the tuned temperature of arXiv 1812.05905): twin critics, target
//! critics that follow, an actor whose actions are squashed Gaussians.
//!
//! Two further algorithms are this one with another part: [`dynsyn`](crate::dynsyn) has another [`Head`] of the actor, and `simba` (Lee et
//! al. 2025, arXiv 2410.09754) residual networks with norms ([`Mlp`]) and a decay of their weights.

use crate::agent::Actor;
use crate::error::TrainError;
use crate::head::Head;
use crate::learner::{Losses, Means, Networks, Optimizer, ROUND};
use crate::noise::{Noise, normal, uniform};
use crate::numbers::Numbers;
use crate::play::Play;
use crate::replay::Replay;
use crate::settings::{SacSettings, Settings};
use msk_network::{Kernel, Mlp, Parameters, Tape, Variable};
use msk_runtime::episode::{EpisodeKey, Stream};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Logarithm of the standard deviation, before squashing, of one that begins as an agent or with actions near 0.
const STARTING_LOG_STD: f32 = -2.0;

/// The learner.
pub(crate) struct Sac {
    settings: SacSettings,
    discount: f64,
    head: Head,
    networks: Networks,
    actor: Mlp,
    critics: [Mlp; 2],
    targets: [Mlp; 2],
    /// Of the logarithm of the temperature: one number.
    temperature: Range<usize>,
    /// Of actor, critics and temperature.
    optimizers: [Optimizer; 3],
    replay: Replay,
    /// Recorded transitions, of which half of every batch is.
    recorded: Option<Replay>,
    chance: Stream,
    noise: Noise,
    /// Gradient steps that are due, and those that were taken.
    due: f64,
    updates: u64,
    means: Means,
    /// Factor of the rates at present.
    rate: f64,
    /// Control steps before which it does not learn.
    start: u64,
    /// Control steps before which the actor stays as it is, where it begins as an agent or with actions near 0.
    critics_first: Option<u64>,
}

/// What of it a checkpoint keeps.
#[derive(Serialize, Deserialize)]
pub(crate) struct SacState<'a> {
    parameters: Numbers,
    optimizers: [Optimizer; 3],
    replay: Cow<'a, Replay>,
    chance: Stream,
    noise: Numbers,
    due: f64,
    updates: u64,
}

/// A batch on the tape.
struct Batch {
    rows: usize,
    seen: Variable,
    action: Variable,
    next: Variable,
    reward: Vec<f32>,
    discounts: Vec<f32>,
}

impl Sac {
    pub fn new(settings: &Settings, play: &Play, head: Head, seed: u64, kernel: Arc<dyn Kernel>) -> Self {
        let ([whole, width], entries) = (play.widths(), play.entries());
        let value = settings.critic_shape(whole + entries, 1);
        let mut networks = Networks::new(kernel);
        let mut draw = Stream::new(EpisodeKey { seed, episode: 0 }, "train/initial");
        let actor = networks.uniform("actor", &settings.shape(width, head.outputs()), &mut draw);
        if settings.sac.zero_init {
            actor.fill_outputs(0..head.draws(), 0.0, &mut networks.parameters);
            actor.fill_outputs(head.draws()..head.outputs(), STARTING_LOG_STD, &mut networks.parameters);
        }
        let critics = ["critic1", "critic2"].map(|name| networks.uniform(name, &value, &mut draw));
        let targets = ["target1", "target2"].map(|name| networks.uniform(name, &value, &mut draw));
        for (target, critic) in targets.iter().zip(&critics) {
            networks.parameters.follow(target.range(), critic.range(), 1.0);
        }
        let temperature = networks.parameters.add("temperature", &[1]);
        networks.parameters.values_mut()[temperature.clone()].fill(libm::log(settings.sac.temperature) as f32);
        let both = critics[0].range().start..critics[1].range().end;
        let optimizer = |range: Range<usize>, decay: f64| Optimizer::new(range, f32::INFINITY, 1e-8).with_decay(decay as f32);
        let decay = settings.sac.weight_decay;
        let optimizers = [optimizer(actor.range(), decay), optimizer(both, decay), optimizer(temperature.clone(), 0.0)];
        Self {
            discount: settings.action_discount(),
            head,
            networks,
            actor,
            critics,
            targets,
            temperature,
            optimizers,
            replay: Replay::new(settings, settings.sac.replay, [whole, entries, play.terms()]),
            recorded: None,
            chance: Stream::new(EpisodeKey { seed, episode: 0 }, "train/chance"),
            noise: Noise::new(settings.noise_correlation),
            due: 0.0,
            updates: 0,
            means: Means::default(),
            rate: 1.0,
            start: settings.control_steps(settings.sac.start),
            settings: settings.sac.clone(),
            critics_first: settings.sac.zero_init.then_some(settings.critics_first),
        }
    }

    /// Begins as an agent, with small deviations: it acts from the first step on, and stays as it is until the critics have learned what
    /// it is worth.
    pub fn begin_as(&mut self, actor: &Actor, critics_first: u64) {
        actor.begin_in(&self.actor, &mut self.networks.parameters, STARTING_LOG_STD);
        self.critics_first = Some(critics_first);
    }

    /// Learns from recorded transitions, too.
    pub fn remember_recorded(&mut self, recorded: Option<Replay>) {
        self.recorded = recorded;
    }

    /// Control steps of a round, in all slots together.
    pub fn round_steps(&self, play: &Play) -> u64 {
        ROUND * play.span()
    }

    /// Plays, and learns after every action.
    pub fn round(&mut self, play: &mut Play, progress: f64, step: u64) -> Result<Losses, TrainError> {
        self.head.set_progress(progress);
        let left = 1.0 - progress;
        self.rate = if left > self.settings.anneal { left } else { self.settings.anneal };
        let mut before = Vec::new();
        for round in 0..ROUND {
            let step = step + round * play.span();
            let actions = self.act(play, step);
            before.clear();
            before.extend_from_slice(play.rows());
            play.step(&actions)?;
            self.remember(play, &before, &actions);
            if step >= self.start {
                self.due += self.settings.updates * play.slots() as f64;
                while self.due >= 1.0 {
                    self.due -= 1.0;
                    self.update(play, step)?;
                }
            }
        }
        Ok(self.means.take())
    }

    /// Actions of the present policy; uniform ones before it learns.
    fn act(&mut self, play: &Play, step: u64) -> Vec<f32> {
        let ([whole, width], slots, entries) = (play.widths(), play.slots(), play.entries());
        let chance = &mut self.chance;
        if step < self.start && self.critics_first.is_none() {
            return uniform(chance).take(slots * entries).collect();
        }
        let Networks { tape, parameters, .. } = &mut self.networks;
        tape.clear();
        let seen = tape.constant(slots, whole, play.seen());
        let mut noise = self.noise.next(slots * self.head.draws(), chance).iter().copied();
        let [action, _] = sample(tape, (&self.head, &self.actor), parameters, (seen, width), &mut noise);
        tape.values(action).to_vec()
    }

    /// Keeps the transitions of an action.
    fn remember(&mut self, play: &Play, before: &[f64], actions: &[f32]) {
        let ([whole, _], entries, terms) = (play.widths(), play.entries(), play.terms());
        let outcome = play.outcome();
        for slot in 0..play.slots() {
            let part = slot * whole..(slot + 1) * whole;
            let next = if outcome.ended[slot] { &play.final_rows } else { play.rows() };
            let action = &actions[slot * entries..(slot + 1) * entries];
            let discount = if outcome.terminated[slot] { 0.0 } else { self.discount as f32 };
            let values = &outcome.values[slot * terms..(slot + 1) * terms];
            self.replay.push(&before[part.clone()], action, &next[part], values, discount);
        }
    }

    /// A gradient step of the critics and, as often as `actor_delay` has it, of actor and temperature.
    fn update(&mut self, play: &Play, step: u64) -> Result<(), TrainError> {
        self.update_critics(play, step)?;
        self.updates += 1;
        let improves = self.critics_first.is_none_or(|first| step >= self.start + first);
        if improves && self.updates.is_multiple_of(self.settings.actor_delay as u64) {
            for _ in 0..self.settings.actor_delay {
                self.update_actor(play, step)?;
            }
        }
        for (target, critic) in self.targets.iter().zip(&self.critics) {
            self.networks.parameters.follow(target.range(), critic.range(), self.settings.follow as f32);
        }
        Ok(())
    }

    fn temperature(&self) -> f32 {
        libm::expf(self.networks.parameters.values()[self.temperature.start])
    }

    /// Draws transitions onto an empty tape: with recorded ones, half of them from those.
    fn batch(&mut self, play: &Play) -> Batch {
        let ([whole, _], entries, rows) = (play.widths(), play.entries(), self.settings.batch);
        let drawn = match &self.recorded {
            None => self.replay.draw(rows, &mut self.chance),
            Some(recorded) => {
                let mut drawn = self.replay.draw(rows - rows / 2, &mut self.chance);
                drawn.append(recorded.draw(rows / 2, &mut self.chance));
                drawn
            }
        };
        let reward = play.rewards(&drawn.values, rows);
        let tape = &mut self.networks.tape;
        tape.clear();
        let mut normal = vec![0.0; rows * whole];
        play.normalize(&drawn.rows, &mut normal);
        let seen = tape.constant(rows, whole, normal.iter().copied());
        play.normalize(&drawn.next, &mut normal);
        let next = tape.constant(rows, whole, normal.iter().copied());
        let action = tape.constant(rows, entries, drawn.actions);
        Batch { rows, seen, action, next, reward, discounts: drawn.discounts }
    }

    /// Equations 5 and 6 of arXiv 1812.05905, with the lesser of the target critics: half the squared distance of Q from
    /// r + gamma (min Q'(s', a') - alpha ln pi(a' | s')).
    fn update_critics(&mut self, play: &Play, step: u64) -> Result<(), TrainError> {
        let [_, width] = play.widths();
        let alpha = self.temperature();
        let Batch { rows, seen, action, next, reward, discounts } = self.batch(play);
        let Networks { tape, parameters, .. } = &mut self.networks;
        tape.set_training(false);
        let mut noise = normal(&mut self.chance);
        let [next_action, density] = sample(tape, (&self.head, &self.actor), parameters, (next, width), &mut noise);
        let after = tape.join(next, next_action);
        let [first, second] = [0, 1].map(|index: usize| self.targets[index].forward(tape, parameters, after));
        let lesser = tape.minimum(first, second);
        let soft = tape.affine(density, -alpha, 0.0);
        let value = tape.add(lesser, soft);
        let wanted: Vec<f32> = tape
            .values(value)
            .iter()
            .zip(reward)
            .zip(discounts)
            .map(|((value, reward), discount)| reward + discount * value)
            .collect();
        let wanted = tape.constant(rows, 1, wanted);
        tape.set_training(true);
        let before = tape.join(seen, action);
        let errors = [0, 1].map(|index: usize| {
            let found = self.critics[index].forward(tape, parameters, before);
            let error = tape.subtract(found, wanted);
            let square = tape.square(error);
            let mean = tape.mean(square);
            tape.affine(mean, 0.5, 0.0)
        });
        let loss = tape.add(errors[0], errors[1]);
        let found = self.networks.descend(
            loss,
            ("the error of the critics", step),
            self.rate * self.settings.critic_rate,
            &mut self.optimizers[1],
        )?;
        self.means.add("critics", found);
        Ok(())
    }

    /// Equation 9: E[alpha ln pi(a | s) - min Q(s, a)]; then equation 18, the temperature.
    fn update_actor(&mut self, play: &Play, step: u64) -> Result<(), TrainError> {
        let [_, width] = play.widths();
        let alpha = self.temperature();
        let Batch { rows, seen, .. } = self.batch(play);
        let Networks { tape, parameters, .. } = &mut self.networks;
        let mut noise = normal(&mut self.chance);
        let [action, density] = sample(tape, (&self.head, &self.actor), parameters, (seen, width), &mut noise);
        tape.set_training(false);
        let chosen = tape.join(seen, action);
        let [first, second] = [0, 1].map(|index: usize| self.critics[index].forward(tape, parameters, chosen));
        let lesser = tape.minimum(first, second);
        let entropy = tape.affine(density, alpha, 0.0);
        let loss = tape.subtract(entropy, lesser);
        let loss = tape.mean(loss);
        let mean_density = tape.values(density).iter().map(|density| f64::from(*density)).sum::<f64>() / rows as f64;
        let rate = self.rate * self.settings.actor_rate;
        let found = self.networks.descend(loss, ("the objective of the actor", step), rate, &mut self.optimizers[0])?;
        self.means.add("actor", found);
        self.means.add("entropy", -mean_density);
        if self.settings.automatic {
            // alpha times (entropy - target), whose derivative moves the temperature towards the target entropy.
            let excess = -mean_density + self.settings.target_entropy * self.head.degrees() as f64;
            let Networks { tape, parameters, .. } = &mut self.networks;
            tape.clear();
            let logarithm = tape.parameter(1, self.temperature.clone(), parameters);
            let alpha = tape.exp(logarithm);
            let loss = tape.affine(alpha, excess as f32, 0.0);
            let rate = self.rate * self.settings.critic_rate;
            self.networks.descend(loss, ("the temperature", step), rate, &mut self.optimizers[2])?;
        }
        self.means.add("temperature", f64::from(alpha));
        Ok(())
    }

    pub fn replay(&self) -> &Replay {
        &self.replay
    }

    /// What acts: the mean.
    pub fn actor(&self, play: &Play) -> Actor {
        self.head.actor(&self.actor, &self.networks.parameters, play)
    }

    pub fn state(&self) -> SacState<'_> {
        SacState {
            parameters: self.networks.state(),
            optimizers: self.optimizers.clone(),
            replay: Cow::Borrowed(&self.replay),
            chance: self.chance.clone(),
            noise: self.noise.state(),
            due: self.due,
            updates: self.updates,
        }
    }

    /// # Errors
    /// Other sizes.
    pub fn restore(&mut self, state: SacState<'_>) -> Result<(), String> {
        self.networks.restore(&state.parameters)?;
        self.replay.restore(state.replay.into_owned())?;
        self.noise.restore(state.noise);
        (self.optimizers, self.chance) = (state.optimizers, state.chance);
        (self.due, self.updates) = (state.due, state.updates);
        Ok(())
    }
}

/// An action of the actor for each row, drawn by standard normal numbers, and the logarithm of its density.
fn sample(
    tape: &mut Tape,
    (head, actor): (&Head, &Mlp),
    parameters: &Parameters,
    (seen, width): (Variable, usize),
    noise: &mut dyn Iterator<Item = f32>,
) -> [Variable; 2] {
    let observed = tape.columns(seen, 0..width);
    let output = actor.forward(tape, parameters, observed);
    head.sample(tape, output, noise)
}

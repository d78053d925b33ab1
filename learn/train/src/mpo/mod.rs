//! Maximum a posteriori policy optimisation (Abdolmaleki et al. 2018, arXiv 1806.06920; with the decoupled bounds of arXiv 1812.02256 and
//! the penalty of actions out of bounds of Acme, arXiv 2006.00979), and the exploration of DepRL.

mod duals;
mod steps;

use crate::agent::{Actor, Output};
use crate::dep::Dep;
use crate::error::TrainError;
use crate::learner::{Losses, Means, Networks, Optimizer, ROUND};
use crate::noise::{Noise, uniform};
use crate::numbers::Numbers;
use crate::play::Play;
use crate::replay::{Drawn, Replay};
use crate::sensors::Sensors;
use crate::settings::{MpoSettings, Settings};
use duals::Duals;
use msk_network::{Kernel, Mlp, Parameters, Tape, Variable};
use msk_runtime::episode::{Engine, EpisodeKey, Stream};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::VecDeque;
use std::sync::Arc;
use steps::{Fit, Samples, cost, objective, weights};

/// Bounds of a standard deviation.
const STD: [f32; 2] = [1e-4, 1.0];
/// Deviation, before it is made positive, of one that begins as an agent: about 0.13.
const STARTING_STD: f32 = -2.0;

/// The learner.
pub(crate) struct Mpo {
    settings: MpoSettings,
    discount: f64,
    networks: Networks,
    actor: Mlp,
    critic: Mlp,
    /// What follows actor and critic.
    targets: [Mlp; 2],
    duals: Duals,
    /// Of actor, critic and duals.
    optimizers: [Optimizer; 3],
    replay: Replay,
    /// Transitions of each slot whose returns are not yet known over all steps.
    pending: Vec<VecDeque<Pending>>,
    exploration: Option<(Dep, Sensors)>,
    chance: Stream,
    noise: Noise,
    due: f64,
    means: Means,
    /// Control steps before which it does not learn.
    start: u64,
    /// Control steps before which the actor stays as it is, where it begins as an agent.
    critics_first: Option<u64>,
}

/// A transition that waits for later rewards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Pending {
    row: Vec<f64>,
    action: Vec<f32>,
    /// Of each term before its weight.
    values: Vec<f64>,
}

/// What of it a checkpoint keeps.
#[derive(Serialize, Deserialize)]
pub(crate) struct MpoState<'a> {
    parameters: Numbers,
    optimizers: [Optimizer; 3],
    replay: Cow<'a, Replay>,
    pending: Vec<VecDeque<Pending>>,
    exploration: Option<Dep>,
    chance: Stream,
    noise: Numbers,
    due: f64,
}

/// Rows that were drawn, as networks see them.
struct Batch {
    seen: Vec<f32>,
    actions: Vec<f32>,
    next: Vec<f32>,
    rewards: Vec<f32>,
    discounts: Vec<f32>,
}

impl Mpo {
    /// # Errors
    /// An action space without sensors, where plasticity explores.
    pub fn new(
        engine: &Engine,
        settings: &Settings,
        play: &Play,
        seed: u64,
        kernel: Arc<dyn Kernel>,
    ) -> Result<Self, TrainError> {
        let ([whole, width], entries) = (play.widths(), play.entries());
        let mut networks = Networks::new(kernel);
        let mut draw = Stream::new(EpisodeKey { seed, episode: 0 }, "train/initial");
        let [policy, value] = [settings.shape(width, 2 * entries), settings.shape(whole + entries, 1)];
        let actor = networks.uniform("actor", &policy, &mut draw);
        let critic = networks.uniform("critic", &value, &mut draw);
        let targets = [("target_actor", &policy), ("target_critic", &value)];
        let targets = targets.map(|(name, shape)| networks.uniform(name, shape, &mut draw));
        for (target, network) in targets.iter().zip([&actor, &critic]) {
            networks.parameters.follow(target.range(), network.range(), 1.0);
        }
        let duals = Duals::new(entries, &mut networks.parameters);
        let ranges = [actor.range(), critic.range(), duals.range()];
        let exploration = match settings.dep.explores {
            true => {
                let refuse = |reason: String| TrainError::Exploration { reason };
                Some((Dep::new(&settings.dep, play.slots(), seed), Sensors::of(engine).map_err(refuse)?))
            }
            false => None,
        };
        Ok(Self {
            discount: settings.action_discount(),
            networks,
            actor,
            critic,
            targets,
            duals,
            optimizers: ranges.map(|range| Optimizer::new(range, f32::INFINITY, 1e-8)),
            replay: Replay::new(settings, settings.mpo.replay, [whole, entries, play.terms()]),
            pending: vec![VecDeque::new(); play.slots()],
            exploration,
            chance: Stream::new(EpisodeKey { seed, episode: 0 }, "train/chance"),
            noise: Noise::new(settings.noise_correlation),
            due: 0.0,
            means: Means::default(),
            start: settings.control_steps(settings.mpo.start),
            settings: settings.mpo.clone(),
            critics_first: None,
        })
    }

    /// Begins as an agent, with small deviations: it acts from the first step on, and stays as it is until the critic has learned what it
    /// is worth.
    pub fn begin_as(&mut self, actor: &Actor, critics_first: u64) {
        for network in [&self.actor, &self.targets[0]] {
            actor.begin_in(network, &mut self.networks.parameters, STARTING_STD);
        }
        self.critics_first = Some(critics_first);
    }

    /// Control steps of a round, in all slots together.
    pub fn round_steps(&self, play: &Play) -> u64 {
        ROUND * play.span()
    }

    /// Plays, and learns in blocks of gradient steps.
    pub fn round(&mut self, play: &mut Play, settings: &Settings, step: u64) -> Result<Losses, TrainError> {
        let mut before = Vec::new();
        for round in 0..ROUND {
            let step = step + round * play.span();
            let actions = self.act(play, settings, step);
            before.clear();
            before.extend_from_slice(play.rows());
            play.step(&actions)?;
            if let Some((dep, _)) = &mut self.exploration {
                dep.count(play.outcome().ended.iter().filter(|ended| **ended).count());
            }
            self.remember(play, &before, &actions);
            if step >= self.start {
                self.due += self.settings.updates * play.slots() as f64;
                // A block at a time, as the reference has it.
                if self.due >= self.settings.block as f64 {
                    while self.due >= 1.0 {
                        self.due -= 1.0;
                        self.update(play, step)?;
                    }
                }
            }
        }
        Ok(self.means.take())
    }

    /// Actions of the present policy, or of what explores; uniform ones before it learns if nothing does.
    fn act(&mut self, play: &Play, settings: &Settings, step: u64) -> Vec<f32> {
        let ([whole, width], slots, entries) = (play.widths(), play.slots(), play.entries());
        let collecting = step < self.start && self.critics_first.is_none();
        if let Some((dep, sensors)) = &mut self.exploration {
            if let Some(actions) = dep.act(&settings.dep, sensors, play.episodes(), collecting) {
                return actions;
            }
        } else if collecting {
            return uniform(&mut self.chance).take(slots * entries).collect();
        }
        let Networks { tape, parameters, .. } = &mut self.networks;
        tape.clear();
        let seen = tape.constant(slots, whole, play.seen());
        let [mean, std] = policy(tape, &self.actor, parameters, (seen, width));
        let noise = self.noise.next(slots * entries, &mut self.chance);
        let drawn = tape.values(mean).iter().zip(tape.values(std)).zip(noise);
        drawn.map(|((mean, std), noise)| mean + std * noise).collect()
    }

    /// Keeps the transitions of an action whose rewards are now known over `steps`, or to the end of their episode.
    fn remember(&mut self, play: &Play, before: &[f64], actions: &[f32]) {
        let ([whole, _], entries, terms) = (play.widths(), play.entries(), play.terms());
        let outcome = play.outcome();
        for (slot, pending) in self.pending.iter_mut().enumerate() {
            let part = slot * whole..(slot + 1) * whole;
            let action = actions[slot * entries..(slot + 1) * entries].to_vec();
            let values = outcome.values[slot * terms..(slot + 1) * terms].to_vec();
            pending.push_back(Pending { row: before[part.clone()].to_vec(), action, values });
            let ended = outcome.ended[slot];
            let next = if ended { &play.final_rows } else { play.rows() };
            while !pending.is_empty() && (ended || pending.len() >= self.settings.steps) {
                // r + gamma r' + ..., term by term, and gamma to the power of their number before the value of what follows.
                let sum = |term: usize| {
                    let later = pending.iter().rev().map(|transition| transition.values[term]);
                    later.fold(0.0, |sum, value| value + self.discount * sum)
                };
                let totals: Vec<f64> = (0..terms).map(sum).collect();
                let discount = pending.iter().fold(1.0, |product, _| product * self.discount);
                let Some(first) = pending.pop_front() else { break };
                let discount = if outcome.terminated[slot] { 0.0 } else { discount as f32 };
                self.replay.push(&first.row, &first.action, &next[part.clone()], &totals, discount);
            }
        }
    }

    fn draw(&mut self, play: &Play) -> Batch {
        let ([whole, _], rows) = (play.widths(), self.settings.batch);
        let Drawn { rows: row, next, actions, values, discounts } = self.replay.draw(rows, &mut self.chance);
        let rewards = play.rewards(&values, rows);
        let normal = |rows_of: &[f64]| {
            let mut out = vec![0.0; rows * whole];
            play.normalize(rows_of, &mut out);
            out
        };
        Batch { seen: normal(&row), actions, next: normal(&next), rewards, discounts }
    }

    /// Samples of the target policy at rows as networks see them.
    fn sample(&mut self, play: &Play, rows: &[f32]) -> Samples {
        let ([whole, width], entries, count) = (play.widths(), play.entries(), self.settings.samples);
        let states = rows.len() / whole;
        let Networks { tape, parameters, .. } = &mut self.networks;
        tape.clear();
        tape.set_training(false);
        let seen = tape.constant(states, whole, rows.iter().copied());
        let [mean, std] = policy(tape, &self.targets[0], parameters, (seen, width));
        let (mean, std) = (tape.values(mean).to_vec(), tape.values(std).to_vec());
        let mut actions = Vec::with_capacity(states * count * entries);
        let chance = &mut self.chance;
        for (mean, std) in mean.chunks_exact(entries).zip(std.chunks_exact(entries)) {
            for _ in 0..count {
                actions.extend(mean.iter().zip(std).map(|(mean, std)| mean + std * chance.normal() as f32));
            }
        }
        let repeated = rows.chunks_exact(whole).flat_map(|row| std::iter::repeat_n(row, count)).flatten().copied();
        let repeated = tape.constant(states * count, whole, repeated);
        let drawn = tape.constant(states * count, entries, actions.iter().copied());
        let chosen = tape.join(repeated, drawn);
        let values = self.targets[1].forward(tape, parameters, chosen);
        Samples { values: tape.values(values).to_vec(), actions, mean, std }
    }

    /// A gradient step of critic, actor and duals.
    fn update(&mut self, play: &Play, step: u64) -> Result<(), TrainError> {
        let batch = self.draw(play);
        self.update_critic(play, &batch, step)?;
        if self.critics_first.is_none_or(|first| step >= self.start + first) {
            self.update_actor(play, &batch, step)?;
        }
        for (target, network) in self.targets.iter().zip([&self.actor, &self.critic]) {
            self.networks.parameters.follow(target.range(), network.range(), self.settings.follow as f32);
        }
        Ok(())
    }

    /// The squared distance of Q from the rewards of some steps and the mean of the target critic over samples of the target policy.
    fn update_critic(&mut self, play: &Play, batch: &Batch, step: u64) -> Result<(), TrainError> {
        let ([whole, _], entries, rows) = (play.widths(), play.entries(), self.settings.batch);
        let after = self.sample(play, &batch.next);
        let count = self.settings.samples as f32;
        let means = after.values.chunks_exact(self.settings.samples).map(|values| values.iter().sum::<f32>() / count);
        let wanted = means.zip(&batch.rewards).zip(&batch.discounts).map(|((value, reward), discount)| reward + discount * value);
        let wanted: Vec<f32> = wanted.collect();
        let Networks { tape, parameters, .. } = &mut self.networks;
        tape.clear();
        let seen = tape.constant(rows, whole, batch.seen.iter().copied());
        let action = tape.constant(rows, entries, batch.actions.iter().copied());
        let chosen = tape.join(seen, action);
        let found = self.critic.forward(tape, parameters, chosen);
        let wanted = tape.constant(rows, 1, wanted);
        let error = tape.subtract(found, wanted);
        let square = tape.square(error);
        let loss = tape.mean(square);
        let rate = self.settings.critic_rate;
        let value = self.networks.descend(loss, ("the error of the critic", step), rate, &mut self.optimizers[1])?;
        self.means.add("critic", value);
        Ok(())
    }

    /// The steps E and M of the paper, and the duals.
    fn update_actor(&mut self, play: &Play, batch: &Batch, step: u64) -> Result<(), TrainError> {
        let ([whole, width], entries, rows) = (play.widths(), play.entries(), self.settings.batch);
        let samples = self.sample(play, &batch.seen);
        let costs: Vec<f32> = samples.actions.chunks_exact(entries).map(cost).collect();
        // Step E: how much each sample counts, by value and by what lies out of bounds.
        let values = self.duals.values(&self.networks.parameters);
        let [temperature, penalty] = values.temperatures;
        let (by_value, slope) = weights(&samples.values, self.settings.samples, temperature, self.settings.epsilon);
        let (by_cost, other) = weights(&costs, self.settings.samples, penalty, self.settings.epsilon_penalty);
        let counts: Vec<f64> = by_value.iter().zip(&by_cost).map(|(a, b)| a + b).collect();
        let fit = Fit::of(&samples, &counts, [entries, self.settings.samples]);

        // Step M.
        let Networks { tape, parameters, .. } = &mut self.networks;
        tape.clear();
        let seen = tape.constant(rows, whole, batch.seen.iter().copied());
        let [mean, std] = policy(tape, &self.actor, parameters, (seen, width));
        let (loss, [moved, widened]) = objective(tape, [mean, std], &samples, &fit, &values.bounds);
        let excess = [(moved, self.settings.epsilon_mean), (widened, self.settings.epsilon_std)].map(|(divergence, allowed)| {
            let column =
                |entry: usize| tape.values(divergence).iter().skip(entry).step_by(entries).map(|value| f64::from(*value));
            (0..entries).map(|entry| (allowed - column(entry).sum::<f64>() / rows as f64) as f32).collect::<Vec<f32>>()
        });
        let divergence = |excess: &[f32], allowed: f64| allowed - f64::from(excess.iter().sum::<f32>()) / entries as f64;
        self.means.add("divergence_mean", divergence(&excess[0], self.settings.epsilon_mean));
        self.means.add("divergence_std", divergence(&excess[1], self.settings.epsilon_std));
        let rate = self.settings.actor_rate;
        let value = self.networks.descend(loss, ("the objective of the actor", step), rate, &mut self.optimizers[0])?;
        self.means.add("actor", value);
        self.means.add("temperature", f64::from(temperature));
        self.update_duals([slope, other], &excess, step)
    }

    /// Descends along derivatives that are known: of temperatures, and of the bounds of mean and deviation.
    fn update_duals(&mut self, slopes: [f32; 2], excess: &[Vec<f32>; 2], step: u64) -> Result<(), TrainError> {
        let Networks { tape, parameters, .. } = &mut self.networks;
        tape.clear();
        let Duals { temperatures, bounds } = &self.duals;
        let ranges = temperatures.iter().chain(bounds);
        let all = slopes.iter().map(std::slice::from_ref).chain(excess.iter().map(Vec::as_slice));
        let mut sum = tape.constant(1, 1, [0.0]);
        for (range, slopes) in ranges.zip(all) {
            let raw = tape.parameter(1, range.clone(), parameters);
            let dual = tape.softplus(raw);
            let slopes = tape.constant(1, range.len(), slopes.iter().copied());
            let part = tape.multiply(dual, slopes);
            let part = tape.sum_columns(part);
            sum = tape.add(sum, part);
        }
        let rate = self.settings.dual_rate;
        self.networks.descend(sum, ("the duals", step), rate, &mut self.optimizers[2])?;
        self.duals.bound(&mut self.networks.parameters);
        Ok(())
    }

    pub fn replay(&self) -> &Replay {
        &self.replay
    }

    /// What acts: the mean.
    pub fn actor(&self, play: &Play) -> Actor {
        Actor::new(&self.actor, &self.networks.parameters, play, Output::Squashed)
    }

    pub fn state(&self) -> MpoState<'_> {
        MpoState {
            parameters: self.networks.state(),
            optimizers: self.optimizers.clone(),
            replay: Cow::Borrowed(&self.replay),
            pending: self.pending.clone(),
            exploration: self.exploration.as_ref().map(|(dep, _)| dep.clone()),
            chance: self.chance.clone(),
            noise: self.noise.state(),
            due: self.due,
        }
    }

    /// # Errors
    /// Other sizes.
    pub fn restore(&mut self, state: MpoState<'_>) -> Result<(), String> {
        self.networks.restore(&state.parameters)?;
        self.replay.restore(state.replay.into_owned())?;
        match (&mut self.exploration, state.exploration) {
            (Some((dep, _)), Some(known)) if dep.fits(&known) => *dep = known,
            (None, None) => {}
            _ => return Err("it explores otherwise".into()),
        }
        let [width, entries, terms] = self.replay.widths();
        let fits = |known: &Pending| [known.row.len(), known.action.len(), known.values.len()] == [width, entries, terms];
        if state.pending.len() != self.pending.len() || !state.pending.iter().flatten().all(fits) {
            return Err("its transitions are of another number of episodes".into());
        }
        self.noise.restore(state.noise);
        (self.pending, self.optimizers, self.chance) = (state.pending, state.optimizers, state.chance);
        self.due = state.due;
        Ok(())
    }

    /// Forgets transitions whose episodes do not go on.
    pub fn forget_pending(&mut self) {
        self.pending.iter_mut().for_each(VecDeque::clear);
    }
}

/// Mean and deviation of the policy at each row: Gaussians whose means lie within -1 and 1.
fn policy(tape: &mut Tape, actor: &Mlp, parameters: &Parameters, (seen, width): (Variable, usize)) -> [Variable; 2] {
    let entries = actor.shape().outputs / 2;
    let observed = tape.columns(seen, 0..width);
    let head = actor.forward(tape, parameters, observed);
    let (mean, raw) = (tape.columns(head, 0..entries), tape.columns(head, entries..2 * entries));
    let soft = tape.softplus(raw);
    [tape.tanh(mean), tape.clip(soft, STD[0], STD[1])]
}

//! Many episodes of one task side by side.

mod mix;
mod slot;
mod step;
mod workers;

pub use mix::MixError;
pub use step::{EpisodeEnd, VectorStep, single_precision};

use super::{Ending, Engine, Episode, EpisodeError, EpisodeKey, Member};
use crate::action::Action;
use msk_physics::lanes::WIDTH;
use msk_program::task::{CompiledTask, ParameterError};
use rayon::ThreadPoolBuildError;
use slot::{Outcome, Slot};
use std::num::NonZeroUsize;
use workers::Workers;

/// When an episode that has ended gives way to the next one in its slot: Gymnasium's `AutoresetMode`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AutoresetMode {
    /// In the step after its end, whose action is ignored and whose reward is 0.
    NextStep,
    /// In the step of its end: the observation is that of the next episode, the last one stands in the final observations.
    SameStep,
    /// When [`VectorEnvironment::reset_where`] chooses its slot. Until then steps leave it as it is.
    #[default]
    Disabled,
}

/// Many episodes of one task, or of several, stepped together by a few workers.
///
/// An episode costs its own data only; scratch belongs to the workers, and each worker steps up to eight episodes at once in the lanes of
/// the simulator. Each episode depends on its seed, its index and its actions alone, so results have the same bits on any number of threads.
///
/// ```
/// use msk_runtime::episode::{Engine, VectorEnvironment};
/// use msk_runtime::library::{BodyLibrary, FileLoader};
/// use std::num::NonZeroUsize;
///
/// let bodies = BodyLibrary::default();
/// let compilation = msk_compiler::compile("../examples/crouch.msk".as_ref(), &FileLoader, &bodies)?;
/// let task = compilation.tasks[0].clone();
/// let stage = bodies.stage(&task.body, &task.scene)?;
/// let engine = Engine::new(stage.model, stage.body, task)?;
/// let (episodes, threads) = (NonZeroUsize::new(4).unwrap(), NonZeroUsize::MIN);
/// let mut environment = VectorEnvironment::new(engine, episodes, threads)?;
/// environment.reset(7);
/// let actions = vec![-1.0; 4 * environment.engine().action_size()];
/// let step = environment.step(&actions)?;
/// assert_eq!(step.rewards.len(), 4);
/// assert!(!step.ended.contains(&true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct VectorEnvironment {
    /// One per task, never none.
    engines: Vec<Engine>,
    slots: Vec<Slot>,
    workers: Workers,
    autoreset: AutoresetMode,
    /// How far apart the indices of successive episodes of a slot are.
    stride: u64,
    step: VectorStep,
}

impl VectorEnvironment {
    /// `count` episodes on `threads` workers, reset with seed 0. A single worker runs on the thread of the caller.
    ///
    /// # Errors
    /// The operating system gives no threads.
    pub fn new(engine: Engine, count: NonZeroUsize, threads: NonZeroUsize) -> Result<Self, ThreadPoolBuildError> {
        Self::of(vec![engine], &[count], threads)
    }

    /// Episodes of several tasks: for each in turn as many slots as are given, one after the other. All have actions, observations and
    /// critic observations of the same length, which are the rows of the arrays.
    ///
    /// # Errors
    /// No task, tasks with rows of different lengths, or no threads.
    pub fn mixed(parts: Vec<(Engine, NonZeroUsize)>, threads: NonZeroUsize) -> Result<Self, MixError> {
        let (engines, counts): (Vec<Engine>, Vec<NonZeroUsize>) = parts.into_iter().unzip();
        mix::check_sizes(&engines)?;
        Ok(Self::of(engines, &counts, threads)?)
    }

    /// Slots for each of the engines, of which there is at least one, with rows of the same lengths.
    fn of(engines: Vec<Engine>, counts: &[NonZeroUsize], threads: NonZeroUsize) -> Result<Self, ThreadPoolBuildError> {
        let parts = engines.iter().zip(counts).enumerate();
        let slots: Vec<Slot> = parts.flat_map(|(place, (engine, count))| vec![Slot::of(place, engine); count.get()]).collect();
        let workers = Workers::of(&engines, &slots, threads)?;
        let task = engines[0].task();
        let step = VectorStep::new(slots.len(), [task.observation_size(), task.critic_size()]);
        let stride = slots.len() as u64;
        let mut environment = Self { engines, slots, workers, autoreset: AutoresetMode::default(), stride, step };
        environment.reset(0);
        Ok(environment)
    }

    /// The same with another mode of resetting: [`AutoresetMode::Disabled`] unless it is set.
    #[must_use]
    pub fn with_autoreset(self, autoreset: AutoresetMode) -> Self {
        Self { autoreset, ..self }
    }

    /// The same with another distance between the indices of successive episodes of a slot: the number of slots unless it is set,
    /// so that no two slots play the same episode of a seed. Where every slot has a seed of its own, 1 gives the episodes of as
    /// many single environments.
    #[must_use]
    pub fn with_stride(self, stride: u64) -> Self {
        Self { stride, ..self }
    }

    /// Starts the workers anew, in a process that was forked: threads do not live on there.
    ///
    /// # Errors
    /// The operating system gives no threads.
    pub fn restart_workers(&mut self) -> Result<(), ThreadPoolBuildError> {
        self.workers.restart()
    }

    /// Begins in slot i episode i of `seed`; the n-th episode after it will have the index i + n times the
    /// [stride](Self::with_stride).
    pub fn reset(&mut self, seed: u64) -> &VectorStep {
        for (index, slot) in self.slots.iter_mut().enumerate() {
            slot.next = EpisodeKey { seed, episode: index as u64 };
        }
        let every = vec![true; self.slots.len()];
        self.reset_where(&every)
    }

    /// Begins the episodes `keys`, one per slot, as those that are to be played again; `None` leaves a slot as it is, and so does the
    /// end of the list. The episodes after them follow as after [`reset`](Self::reset).
    pub fn reset_to(&mut self, keys: &[Option<EpisodeKey>]) -> &VectorStep {
        for (slot, key) in self.slots.iter_mut().zip(keys) {
            slot.next = key.unwrap_or(slot.next);
        }
        let chosen: Vec<bool> = keys.iter().map(Option::is_some).collect();
        self.reset_where(&chosen)
    }

    /// Begins the next episode in the slots for which `chosen` holds; slots beyond its end stay as they are.
    pub fn reset_where(&mut self, chosen: &[bool]) -> &VectorStep {
        let Self { engines, slots, workers, stride, .. } = self;
        workers.each(engines, slots, |first, slots, scratch| {
            for (lane, slot) in slots.iter_mut().enumerate() {
                slot.outcome = Outcome::default();
                if chosen.get(first + lane) == Some(&true) {
                    slot.begin(*stride, engines, scratch, lane);
                }
            }
        });
        self.gather()
    }

    /// Takes one control step in every slot. `actions` holds one action after the other, entries in [-1, 1] as in
    /// [`Environment::step`](super::Environment::step). What
    /// happens to episodes that have ended is a matter of the [`AutoresetMode`].
    ///
    /// # Errors
    /// Actions of the wrong length: nothing has been stepped then.
    pub fn step(&mut self, actions: &[f64]) -> Result<&VectorStep, EpisodeError> {
        let width = self.engine().action_size();
        let expected = width * self.slots.len();
        if actions.len() != expected {
            return Err(EpisodeError::ActionSize { expected, found: actions.len() });
        }
        let Self { engines, slots, workers, stride, autoreset, .. } = self;
        workers.each(engines, slots, |first, slots, scratch| {
            let mut goes_on = [false; WIDTH];
            for (lane, slot) in slots.iter_mut().enumerate() {
                slot.outcome = Outcome::default();
                goes_on[lane] = slot.episode.ending.is_none();
                // With `SameStep` only an episode that could not begin is found ended; it gives way to the next one now.
                if !goes_on[lane] && *autoreset != AutoresetMode::Disabled {
                    slot.begin(*stride, engines, scratch, lane);
                }
            }
            scratch.step(slots.iter_mut().enumerate().map(|(lane, slot)| {
                let place = first + lane;
                let Slot { engine, episode, rates, weights, .. } = slot;
                let engine = &engines[*engine];
                let action = Action::from(&actions[width * place..width * (place + 1)]);
                // An episode of another task that was restored here stays as it is.
                let takes_part = goes_on[lane] && engine.made(episode);
                takes_part.then_some(Member { engine, episode, rates, weights: weights.in_force(), action })
            }));
            for (lane, slot) in slots.iter_mut().enumerate().filter(|(lane, _)| goes_on[*lane]) {
                slot.outcome.reward = slot.episode.report.reward;
                if let Some(end) = EpisodeEnd::of(first + lane, &slot.episode) {
                    slot.outcome.end = Some((end, [slot.episode.observation.clone(), slot.episode.critic.clone()]));
                    if *autoreset == AutoresetMode::SameStep {
                        slot.begin(*stride, engines, scratch, lane);
                    }
                }
            }
        });
        Ok(self.gather())
    }

    /// Writes what has happened in the slots into the arrays of the step.
    fn gather(&mut self) -> &VectorStep {
        let task = &self.engines[0].task;
        let [width, critic] = [task.observation_size(), task.critic_size()];
        let disabled = self.autoreset == AutoresetMode::Disabled;
        let step = &mut self.step;
        step.ends.clear();
        for (index, slot) in self.slots.iter_mut().enumerate() {
            let [row, own] = [width, critic].map(|width| width * index..width * (index + 1));
            step.observations[row.clone()].copy_from_slice(&slot.episode.observation);
            step.critic_observations[own.clone()].copy_from_slice(&slot.episode.critic);
            let task = &self.engines[slot.engine].task;
            step.rewards[index] = slot.outcome.reward;
            step.ended[index] = slot.outcome.end.is_some();
            if let Some((end, [observation, critic])) = slot.outcome.end.take() {
                step.final_observations[row].copy_from_slice(&observation);
                step.final_critic_observations[own].copy_from_slice(&critic);
                (step.terminated[index], step.truncated[index]) = flags(task, Some(&end.ending));
                step.ends.push(end);
            } else {
                // One that waits for its reset is still over.
                let ending = slot.episode.ending.as_ref().filter(|_| disabled);
                (step.terminated[index], step.truncated[index]) = flags(task, ending);
            }
        }
        step
    }

    /// What the episodes are played with, of a mix those of the first slot: all have actions and observations of the same length.
    pub fn engine(&self) -> &Engine {
        // There is always one.
        &self.engines[0]
    }

    /// What the episodes in a slot are played with; `None` for a slot that does not exist.
    pub fn engine_of(&self, slot: usize) -> Option<&Engine> {
        self.slots.get(slot).map(|slot| &self.engines[slot.engine])
    }

    /// What the last step or reset gave.
    pub fn last(&self) -> &VectorStep {
        &self.step
    }

    /// The episodes, slot by slot.
    pub fn episodes(&self) -> impl ExactSizeIterator<Item = &Episode> {
        self.slots.iter().map(|slot| &slot.episode)
    }

    /// The keys of the episodes that will be next, slot by slot.
    pub fn next_keys(&self) -> impl ExactSizeIterator<Item = EpisodeKey> {
        self.slots.iter().map(|slot| slot.next)
    }

    /// Chooses the episode that will be next in a slot, without beginning it; a slot that does not exist is left out.
    pub fn set_next_key(&mut self, slot: usize, key: EpisodeKey) {
        if let Some(slot) = self.slots.get_mut(slot) {
            slot.next = key;
        }
    }

    /// The weights that reward the episode in a slot, one per term: at the present [progress](Self::set_progress) of a training; `None`
    /// for a slot that does not exist.
    pub fn weights(&self, slot: usize) -> Option<&[f64]> {
        self.slots.get(slot).map(|slot| slot.weights.in_force())
    }

    /// The same at the end of a training.
    pub fn last_weights(&self, slot: usize) -> Option<&[f64]> {
        self.slots.get(slot).map(|slot| slot.weights.last())
    }

    /// Sets the weight of a term in a slot, of a scheduled one the last weight, from the next step on; a slot or term that does not exist
    /// is left out.
    pub fn set_weight(&mut self, slot: usize, term: usize, weight: f64) {
        if let Some(slot) = self.slots.get_mut(slot) {
            slot.weights.set(&self.engines[slot.engine].task, term, weight);
        }
    }

    /// Sets a parameter that the task declares `per episode`, in SI units, for the episodes that begin in a slot from now on; a slot that
    /// does not exist is left out.
    ///
    /// # Errors
    /// No such parameter, one that is a constant of the compiled task, or a value outside of its range.
    pub fn set_parameter(&mut self, slot: usize, name: &str, value: f64) -> Result<(), ParameterError> {
        let engines = &self.engines;
        let set = |slot: &mut Slot| engines[slot.engine].task.set_parameter(&mut slot.parameters, name, value);
        self.slots.get_mut(slot).map_or(Ok(()), set)
    }

    /// The parameters of the episodes to come in a slot, in SI units and the task's order; `None` for a slot that does not exist.
    pub fn parameters(&self, slot: usize) -> Option<Vec<f64>> {
        self.slots.get(slot).map(|slot| self.engines[slot.engine].task.complete_parameters(&slot.parameters))
    }

    /// The share of a training that has passed, 0 to 1: 1 unless it is set.
    pub fn progress(&self) -> f64 {
        // There is always a slot, and all have the same.
        self.slots.first().map_or(1.0, |slot| slot.weights.progress())
    }

    /// Gives every scheduled weight, in all slots, the value that it has at a share of the training, 0 to 1, from the next step on.
    ///
    /// # Errors
    /// What is no number from 0 to 1.
    pub fn set_progress(&mut self, progress: f64) -> Result<(), EpisodeError> {
        let engines = &self.engines;
        self.slots.iter_mut().try_for_each(|slot| slot.weights.set_progress(&engines[slot.engine].task, progress))
    }

    /// Puts an episode of the same task into a slot; a slot that does not exist is left out. The arrays of the last step stay as they
    /// are; the next step goes on from the episode bit for bit.
    pub fn restore(&mut self, slot: usize, episode: &Episode) {
        if let Some(slot) = self.slots.get_mut(slot) {
            slot.episode.clone_from(episode);
            slot.rates = None;
        }
    }
}

/// Whether an episode was terminated, and whether it was truncated, as learners use the words: they value what would have followed a
/// truncation, and nothing after a termination.
fn flags(task: &CompiledTask, ending: Option<&Ending>) -> (bool, bool) {
    let bootstraps = ending.map(|ending| ending.bootstraps(task));
    (bootstraps == Some(false), bootstraps == Some(true))
}

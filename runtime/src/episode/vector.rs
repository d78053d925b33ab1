//! Many episodes of one task side by side.

use super::{Engine, Episode, EpisodeError, EpisodeKey, Scratch};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::num::NonZeroUsize;

/// Many episodes of one task, stepped together by a few workers.
///
/// An episode costs its own data only; scratch belongs to the workers. Each episode depends on its seed, its index and its actions alone,
/// so results have the same bits on any number of threads.
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
/// environment.step(&vec![-1.0; 4 * environment.engine().body().muscles.len()])?;
/// let rewards: Vec<f64> = environment.episodes().map(|episode| episode.report().reward).collect();
/// assert_eq!(rewards.len(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct VectorEnvironment {
    engine: Engine,
    slots: Vec<Slot>,
    /// One per worker.
    scratch: Vec<Scratch>,
    pool: ThreadPool,
}

/// A place for one episode after the other.
struct Slot {
    episode: Episode,
    weights: Vec<f64>,
    /// The key of the next episode.
    next: EpisodeKey,
}

impl VectorEnvironment {
    /// `count` episodes on `threads` workers, reset with seed 0.
    ///
    /// # Errors
    /// The operating system gives no threads.
    pub fn new(engine: Engine, count: NonZeroUsize, threads: NonZeroUsize) -> Result<Self, ThreadPoolBuildError> {
        let pool = ThreadPoolBuilder::new().num_threads(threads.get()).build()?;
        let slot = Slot { episode: engine.episode(), weights: engine.task().weights(), next: EpisodeKey::default() };
        let scratch = vec![engine.scratch(); threads.min(count).get()];
        let slots = (0..count.get()).map(|_| slot.duplicate()).collect();
        let mut environment = Self { engine, slots, scratch, pool };
        environment.reset(0);
        Ok(environment)
    }

    /// Begins in slot i episode i of `seed`; the n-th episode after it will have the index i + n times the number of slots.
    pub fn reset(&mut self, seed: u64) {
        for (index, slot) in self.slots.iter_mut().enumerate() {
            slot.next = EpisodeKey { seed, episode: index as u64 };
        }
        let every = vec![true; self.slots.len()];
        self.reset_where(&every);
    }

    /// Begins the next episode in the slots for which `chosen` holds; slots beyond its end stay as they are.
    pub fn reset_where(&mut self, chosen: &[bool]) {
        let count = self.slots.len() as u64;
        self.each(|index, engine, slot, scratch| {
            if chosen.get(index) == Some(&true) {
                engine.reset(slot.next, &mut slot.episode, scratch);
                slot.next.episode = slot.next.episode.wrapping_add(count);
            }
        });
    }

    /// Takes one control step in every episode that has not ended. `actions` holds one action after the other, one entry in
    /// [-1, 1] per muscle.
    ///
    /// # Errors
    /// Actions of the wrong length: nothing has been stepped then.
    pub fn step(&mut self, actions: &[f64]) -> Result<(), EpisodeError> {
        let width = self.engine.body().muscles.len();
        let expected = width * self.slots.len();
        if actions.len() != expected {
            return Err(EpisodeError::ActionSize { expected, found: actions.len() });
        }
        self.each(|index, engine, slot, scratch| {
            let action = &actions[width * index..width * (index + 1)];
            // The lengths are right, so an error says that the episode has ended: it stays as it is.
            let _ = engine.step(&mut slot.episode, action, &slot.weights, scratch);
        });
        Ok(())
    }

    /// Does something with every slot, on all workers.
    fn each(&mut self, act: impl Fn(usize, &Engine, &mut Slot, &mut Scratch) + Sync) {
        let Self { engine, slots, scratch, pool } = self;
        let share = slots.len().div_ceil(scratch.len().max(1)).max(1);
        pool.install(|| {
            slots.par_chunks_mut(share).zip(scratch).enumerate().for_each(|(worker, (slots, scratch))| {
                for (place, slot) in slots.iter_mut().enumerate() {
                    act(worker * share + place, engine, slot, scratch);
                }
            });
        });
    }

    /// What all episodes are played with.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// The episodes, slot by slot.
    pub fn episodes(&self) -> impl ExactSizeIterator<Item = &Episode> {
        self.slots.iter().map(|slot| &slot.episode)
    }

    /// The weights that reward the episode in a slot, one per term; `None` for a slot that does not exist.
    pub fn weights_mut(&mut self, slot: usize) -> Option<&mut [f64]> {
        self.slots.get_mut(slot).map(|slot| slot.weights.as_mut_slice())
    }

    /// Puts an episode of the same task into a slot; a slot that does not exist is left out.
    pub fn restore(&mut self, slot: usize, episode: &Episode) {
        if let Some(slot) = self.slots.get_mut(slot) {
            slot.episode.clone_from(episode);
        }
    }
}

impl Slot {
    fn duplicate(&self) -> Self {
        Self { episode: self.episode.clone(), weights: self.weights.clone(), next: self.next }
    }
}

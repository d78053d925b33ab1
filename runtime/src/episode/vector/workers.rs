//! The workers that play the slots of a vector, a contiguous share of them each.

use super::super::{Engine, GroupScratch};
use super::slot::Slot;
use msk_physics::lanes::WIDTH;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::num::NonZeroUsize;

/// Workers with their scratch.
pub(super) struct Workers {
    /// For each worker that of every model that its slots need.
    scratch: Vec<Vec<GroupScratch>>,
    /// None for a single worker, which is the caller's thread: where there are no threads, as in a browser, it is the only one.
    pool: Option<ThreadPool>,
}

impl Workers {
    /// For these slots. A single worker runs on the thread of the caller.
    ///
    /// # Errors
    /// The operating system gives no threads.
    pub fn of(engines: &[Engine], slots: &[Slot], threads: NonZeroUsize) -> Result<Self, ThreadPoolBuildError> {
        let pool = (threads.get() > 1).then(|| pool_of(threads.get())).transpose()?;
        let workers = threads.get().min(slots.len()).max(1);
        let scratch = slots.chunks(share(slots.len(), workers)).map(|slots| scratch_of(engines, slots)).collect();
        Ok(Self { scratch, pool })
    }

    /// Starts them anew, in a process that was forked: threads do not live on there.
    ///
    /// # Errors
    /// The operating system gives no threads.
    pub fn restart(&mut self) -> Result<(), ThreadPoolBuildError> {
        if let Some(pool) = &mut self.pool {
            let new = pool_of(pool.current_num_threads())?;
            // The old pool is not dropped: it would lock what one of its threads may have held when the process was forked.
            std::mem::forget(std::mem::replace(pool, new));
        }
        Ok(())
    }

    /// Does something with all slots, on all workers: with as many neighbours at once as a worker has lanes and as
    /// [go with each other](Engine::goes_with), from the given index on.
    pub fn each(&mut self, engines: &[Engine], slots: &mut [Slot], act: impl Fn(usize, &mut [Slot], &mut GroupScratch) + Sync) {
        let share = share(slots.len(), self.scratch.len());
        let work = |(worker, (slots, scratch)): (usize, (&mut [Slot], &mut Vec<GroupScratch>))| {
            let mut first = worker * share;
            for together in slots.chunk_by_mut(|a, b| engines[a.engine].goes_with(&engines[b.engine])) {
                // Groups of one size: nine slots are five and four.
                let size = together.len().div_ceil(together.len().div_ceil(WIDTH));
                // There is scratch for every model of the share.
                let Some(scratch) = scratch.iter_mut().find(|known| known.serves(&engines[together[0].engine])) else { continue };
                for group in together.chunks_mut(size) {
                    act(first, group, scratch);
                    first += group.len();
                }
            }
        };
        match &self.pool {
            Some(pool) => {
                pool.install(|| slots.par_chunks_mut(share).zip(&mut self.scratch).enumerate().for_each(work));
            }
            None => slots.chunks_mut(share).zip(&mut self.scratch).enumerate().for_each(work),
        }
    }
}

/// Slots of a worker.
fn share(slots: usize, workers: usize) -> usize {
    slots.div_ceil(workers.max(1)).max(1)
}

/// Scratch for every model of a share, with lanes for the largest group of neighbours that play on it.
fn scratch_of(engines: &[Engine], slots: &[Slot]) -> Vec<GroupScratch> {
    let mut models: Vec<(&Engine, usize)> = Vec::new();
    for together in slots.chunk_by(|a, b| engines[a.engine].goes_with(&engines[b.engine])) {
        let engine = &engines[together[0].engine];
        match models.iter_mut().find(|(known, _)| known.shares_model(engine)) {
            Some((_, largest)) => *largest = together.len().max(*largest),
            None => models.push((engine, together.len())),
        }
    }
    models.into_iter().map(|(engine, largest)| engine.group_scratch(largest).unseen()).collect()
}

fn pool_of(threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    ThreadPoolBuilder::new().num_threads(threads).build()
}

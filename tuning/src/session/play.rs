//! The episodes of a round, on several workers, counted in the order of their index.

use super::Watcher;
use crate::live::Live;
use msk_evaluate::{EpisodeRecord, EvaluationError, Feed, Journal, Trial, play};
use msk_runtime::episode::EpisodeKey;
use msk_runtime::policy::{PolicyError, PolicySource};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Where a round is played.
pub(super) struct Hall<'a> {
    pub trial: &'a Trial,
    pub policy: &'a PolicySource,
    pub seed: u64,
    /// Control steps of all workers together.
    pub interval: u64,
    pub feed: &'a Live,
    pub journal: &'a Journal,
    pub stop: &'a AtomicBool,
    pub watcher: &'a dyn Watcher,
}

/// What the workers share.
struct Count {
    /// The next episode to be begun.
    next: u64,
    /// The next episode to be counted.
    due: u64,
    /// Ended before one that comes before them.
    early: BTreeMap<u64, EpisodeRecord>,
    steps: u64,
    records: Vec<EpisodeRecord>,
}

/// Control steps as a round counts them: nothing is so short that a round could go on for ever.
pub(super) fn counted(record: &EpisodeRecord) -> u64 {
    u64::from(record.steps).max(1)
}

impl Hall<'_> {
    /// Plays on from `records`, which begin at episode `first`, until the interval is reached or `stop` is true.
    ///
    /// # Errors
    /// A policy or task that cannot run, or a journal that cannot be written.
    pub fn play(
        &self,
        first: u64,
        records: Vec<EpisodeRecord>,
        threads: NonZeroUsize,
    ) -> Result<Vec<EpisodeRecord>, EvaluationError> {
        let due = first + records.len() as u64;
        let steps = records.iter().map(counted).sum();
        let over = AtomicBool::new(steps >= self.interval || self.stop.load(Ordering::Relaxed));
        let count = Mutex::new(Count { next: due, due, early: BTreeMap::new(), steps, records });
        let results: Vec<Result<(), EvaluationError>> = std::thread::scope(|scope| {
            let workers: Vec<_> = (0..threads.get()).map(|_| scope.spawn(|| self.work(&count, &over))).collect();
            // A worker that panicked has reported it on standard error; the others have gone on.
            workers.into_iter().filter_map(|worker| worker.join().ok()).collect()
        });
        results.into_iter().collect::<Result<(), _>>()?;
        Ok(count.into_inner().unwrap_or_else(PoisonError::into_inner).records)
    }

    fn work(&self, count: &Mutex<Count>, over: &AtomicBool) -> Result<(), EvaluationError> {
        let result = self.play_on(count, over);
        if result.is_err() {
            over.store(true, Ordering::Relaxed);
        }
        result
    }

    fn play_on(&self, count: &Mutex<Count>, over: &AtomicBool) -> Result<(), EvaluationError> {
        let mut policy = self.policy.open(self.stop)?;
        let mut episode = self.trial.episode()?;
        let lock = || count.lock().unwrap_or_else(PoisonError::into_inner);
        let stepped = || {
            self.watcher.stepped();
            if self.stop.load(Ordering::Relaxed) {
                over.store(true, Ordering::Relaxed);
            }
        };
        while !over.load(Ordering::Relaxed) && !self.stop.load(Ordering::Relaxed) {
            let index = {
                let mut count = lock();
                count.next += 1;
                count.next - 1
            };
            let fed = self.feed.weights(&self.trial.task);
            fed.apply(&mut episode);
            let key = EpisodeKey { seed: self.seed, episode: index };
            let mut record = match play(self.trial, &mut episode, key, policy.as_mut(), over, stepped) {
                Ok(Some(record)) => record,
                Ok(None) | Err(EvaluationError::Policy(PolicyError::Interrupted)) => break,
                Err(error) => return Err(error),
            };
            fed.note(self.trial, &mut record);
            let mut count = lock();
            count.early.insert(index, record);
            self.take(&mut count, over)?;
        }
        Ok(())
    }

    /// Counts what is due. What ends after the round is full belongs to no round, and will be played again in the next.
    fn take(&self, count: &mut Count, over: &AtomicBool) -> Result<(), EvaluationError> {
        while count.steps < self.interval {
            let due = count.due;
            let Some(record) = count.early.remove(&due) else { return Ok(()) };
            self.journal.append(&record)?;
            self.watcher.ended(&record);
            count.steps += counted(&record);
            count.due += 1;
            count.records.push(record);
        }
        over.store(true, Ordering::Relaxed);
        Ok(())
    }
}

//! Where episodes are handed out to workers and taken back into the journal.

use super::episode_set::Job;
use super::order::{Order, Turn};
use super::shard::Shard;
use super::{EpisodeRecord, Journal, JournalError, Kept, Outcome, Summarizer};

/// What the workers of a run share, one of them at a time.
pub(super) struct Desk<'a> {
    journal: &'a Journal,
    order: Order,
    /// Of the episodes that have entered.
    summarizer: Summarizer,
}

impl<'a> Desk<'a> {
    /// Of a shard of so many tasks with so many episodes each.
    pub fn new(journal: &'a Journal, size: (usize, u64), shard: Shard, kept: Kept, summarizer: Summarizer) -> Self {
        Self { journal, order: Order::new(size, shard, kept.done, kept.early), summarizer }
    }

    /// The order of the episodes.
    pub fn order(&self) -> &Order {
        &self.order
    }

    /// Hands out an episode.
    pub fn claim(&mut self) -> Turn {
        self.order.claim()
    }

    /// Hands out the first episode of a task that `fits`, if there is one within reach.
    pub fn claim_of(&mut self, fits: &dyn Fn(usize) -> bool) -> Option<Job> {
        self.order.claim_of(fits)
    }

    /// Keeps an episode that has ended. Gives whether somebody wants to know.
    ///
    /// # Errors
    /// A journal that cannot be written.
    pub fn keep(&mut self, job: Job, record: EpisodeRecord) -> Result<bool, JournalError> {
        if self.order.is_given_up(job) {
            return Ok(false);
        }
        if !self.order.is_due(job) {
            self.journal.hold(&record)?;
        }
        self.order.end(job, record);
        self.enter()?;
        Ok(true)
    }

    /// Skips a task from an episode on, whose policy cannot act. Gives whether it was not skipped before.
    ///
    /// # Errors
    /// A journal that cannot be written.
    pub fn skip(&mut self, job: Job, reason: String) -> Result<bool, JournalError> {
        let is_new = self.order.skip(job, reason);
        self.enter()?;
        Ok(is_new)
    }

    /// Appends the episodes whose turn has come.
    ///
    /// # Errors
    /// A journal that cannot be written.
    pub fn enter(&mut self) -> Result<(), JournalError> {
        let ready = self.order.ready();
        if !ready.is_empty() {
            self.journal.append_all(&ready)?;
            ready.iter().for_each(|record| self.summarizer.add(record));
        }
        Ok(())
    }

    /// What has come of the run.
    pub fn outcome(self) -> Outcome {
        let interrupted = !self.order.is_complete();
        Outcome { summary: self.summarizer.summary().with_skipped(&self.order.into_skipped()), interrupted }
    }
}

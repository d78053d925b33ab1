//! What is there of a run when it is continued.

use super::{EpisodeRecord, Journal, JournalError, Kept, Plan, RunSettings, Summarizer, Summary};
use msk_storage::Folder;
use std::path::Path;

/// The episodes of a run that need not be played: nothing of one that begins.
#[derive(Debug)]
pub struct Resumed {
    pub(super) kept: Kept,
    pub(super) summarizer: Summarizer,
}

impl Resumed {
    /// Opens the journal of a plan in the folder `path`, which is made if need be, and sums up the episodes that it has.
    ///
    /// # Errors
    /// A folder that cannot be written, holds another run, is damaged, or is in use.
    pub fn open(path: &Path, plan: &Plan, settings: &RunSettings) -> Result<(Journal, Self), JournalError> {
        let folder = Folder::create(path).map_err(|source| JournalError::Unusable { folder: path.into(), source })?;
        let mut summarizer = Summarizer::new(plan);
        let (journal, kept) = Journal::open_with(folder, settings, &mut |record| summarizer.add(&record))?;
        Ok((journal, Self { kept, summarizer }))
    }

    /// How many there are, with those that ended before their turn.
    pub fn episodes(&self) -> u64 {
        self.kept.done.len() + self.kept.early.len() as u64
    }

    /// Those that have had their turn, summed up.
    pub fn summary(&self) -> Summary {
        self.summarizer.summary()
    }

    /// The episodes that ended before their turn, with the places of their tasks.
    pub fn early(&self) -> impl Iterator<Item = (usize, &EpisodeRecord)> {
        self.kept.early.iter().map(|((place, _), record)| (*place, record))
    }
}

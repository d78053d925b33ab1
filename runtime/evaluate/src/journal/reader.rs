//! The lines of a journal, one after the other.

use super::line::Line;
use super::{EPISODES, EpisodeRecord, EpisodeSet, Job, JournalError, LARGEST_LINE, RunSettings, claimed};
use msk_storage::{Folder, Lines};
use std::path::{Path, PathBuf};

/// Reads the episodes of a journal, which may still be growing, with their places in the plan. A last line that is not yet whole is left
/// out. An error is the last item.
pub(crate) struct Reader {
    folder: PathBuf,
    settings: RunSettings,
    /// Identity of the run.
    run: String,
    lines: Option<Lines>,
    /// Lines so far.
    number: usize,
    done: EpisodeSet,
}

impl Reader {
    /// Of the journal in a folder.
    ///
    /// # Errors
    /// A folder that holds no journal.
    pub fn open(path: &Path) -> Result<Self, JournalError> {
        let folder = Folder::open(path).map_err(|source| JournalError::Unusable { folder: path.into(), source })?;
        Self::in_folder(&folder)
    }

    /// [`open`](Self::open) of an opened folder.
    ///
    /// # Errors
    /// As there.
    pub fn in_folder(folder: &Folder) -> Result<Self, JournalError> {
        let settings = claimed(folder)?.ok_or_else(|| JournalError::Empty { folder: folder.path().into() })?;
        Self::of(folder, settings)
    }

    /// Of the episodes in a folder, all of which must be of the run `settings`.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn of(folder: &Folder, settings: RunSettings) -> Result<Self, JournalError> {
        let lines = folder.lines(Path::new(EPISODES), LARGEST_LINE);
        let lines = lines.map_err(|source| JournalError::Unusable { folder: folder.path().into(), source })?;
        let run = settings.identity();
        Ok(Self { folder: folder.path().into(), settings, run, lines, number: 0, done: EpisodeSet::default() })
    }

    /// What is run.
    pub fn settings(&self) -> &RunSettings {
        &self.settings
    }

    /// The episodes that were read.
    pub fn into_episodes(self) -> EpisodeSet {
        self.done
    }

    fn episode(&mut self, line: &[u8]) -> Result<(Job, EpisodeRecord), JournalError> {
        let (path, line_number) = (self.folder.join(EPISODES), self.number);
        let damaged = |reason: String| JournalError::Damaged { path: path.clone(), line: line_number, reason };
        let line = Line::read(line).map_err(|error| damaged(error.to_string()))?;
        let job = self.settings.job(&line, &self.run);
        let job = job.map_err(|reason| JournalError::Foreign { path: path.clone(), line: line_number, reason })?;
        if !self.done.insert(job) {
            return Err(damaged(format!("episode {} of `{}` already exists", job.1, line.record.task)));
        }
        Ok((job, line.record))
    }
}

impl Iterator for Reader {
    type Item = Result<(Job, EpisodeRecord), JournalError>;

    fn next(&mut self) -> Option<Self::Item> {
        let line = self.lines.as_mut()?.next()?;
        self.number += 1;
        let line = line.map_err(|source| JournalError::Unusable { folder: self.folder.clone(), source });
        let episode = line.and_then(|line| self.episode(&line));
        if episode.is_err() {
            self.lines = None;
        }
        Some(episode)
    }
}

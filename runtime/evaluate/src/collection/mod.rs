//! Data sets: episodes of a task under a policy, of which every control step is kept for learners.
//!
//! A data set is the folder of a [`Journal`] with an archive of arrays for each episode ([`archive_name`]) and [`LAYOUT`], which names their
//! columns. An episode depends on its seed and index alone, so the [shards](Shard) of a data set can be collected on several machines, and
//! [`merge_data`] joins them to the bytes of one.

mod merge;
mod recorder;
mod recording;

pub use merge::{is_data, merge_data};
pub use recorder::ActionRecorder;
pub use recording::LAYOUT;

use super::{
    EpisodeRecord, EpisodeSet, EvaluationError, Journal, JournalError, Moments, NoRoom, Plan, Protocol, RunSettings, Shard,
    Trial, play_watched,
};
use msk_runtime::episode::{Environment, EpisodeError, EpisodeKey};
use msk_runtime::policy::{Policy, PolicyError, PolicySource};
use msk_storage::Folder;
use recording::{Recording, layout};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// The file with the arrays of an episode.
pub fn archive_name(episode: u64) -> String {
    format!("{episode:04}.npz")
}

/// A data set that is being collected, in its folder.
pub struct Collection {
    trial: Trial,
    policy: PolicySource,
    protocol: Protocol,
    shard: Shard,
    journal: Journal,
    done: EpisodeSet,
    totals: Totals,
}

/// Sums over the episodes of a data set.
#[derive(Debug, Clone, Default)]
pub struct Totals {
    /// Control steps.
    pub steps: u64,
    /// Episodes whose success holds at their last step.
    pub successes: u64,
    /// Of each episode, with their number.
    pub returns: Moments,
}

/// What happens while a data set is collected.
pub enum Event<'a> {
    /// So many control steps of the present episode have been taken.
    Step(u32),
    /// An episode has ended and is kept.
    End(&'a EpisodeRecord),
}

/// Why a data set cannot be collected.
#[derive(Debug, thiserror::Error)]
pub enum CollectionError {
    /// A folder that cannot be written, holds another run, is damaged, or is in use.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The policy cannot act, or the task does not fit its body.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
    /// Episodes that have a line in the journal, and no arrays.
    #[error("`{}` has lost the arrays of {count} episodes, such as `{first}`", folder.display())]
    Lost {
        /// Of the data set.
        folder: PathBuf,
        /// How many.
        count: usize,
        /// The file of the first of them.
        first: String,
    },
    /// More than an archive holds.
    #[error("the arrays of an episode cannot be kept")]
    Archive(#[from] io::Error),
    /// Numbers that JSON does not have.
    #[error("the columns cannot be described")]
    Layout(#[from] serde_json::Error),
}

impl From<NoRoom> for CollectionError {
    fn from(error: NoRoom) -> Self {
        Self::Evaluation(error.into())
    }
}

impl From<PolicyError> for CollectionError {
    fn from(error: PolicyError) -> Self {
        Self::Evaluation(error.into())
    }
}

impl From<EpisodeError> for CollectionError {
    fn from(error: EpisodeError) -> Self {
        Self::Evaluation(error.into())
    }
}

impl Totals {
    fn add(&mut self, record: &EpisodeRecord) {
        self.steps += u64::from(record.steps);
        self.successes += u64::from(record.success);
        self.returns.add(record.total);
    }
}

impl Collection {
    /// The data set in the folder `path`, which is made if need be; what it has of the same run is kept. Of a shard, `protocol` is that of
    /// the whole.
    ///
    /// # Errors
    /// A folder that cannot be written, holds another run, is damaged or in use, or has lost arrays.
    pub fn open(
        path: &Path,
        trial: Trial,
        policy: PolicySource,
        (protocol, shard): (Protocol, Shard),
    ) -> Result<Self, CollectionError> {
        let plan = Plan { trials: vec![trial.clone()], policy: policy.clone(), protocol, shard };
        let folder = Folder::create(path).map_err(|source| JournalError::Unusable { folder: path.into(), source })?;
        let mut totals = Totals::default();
        let (journal, kept) = Journal::open_with(folder, &RunSettings::of(&plan), &mut |record| totals.add(&record))?;
        let done = kept.done;
        let gone = |episode: &u64| done.contains((0, *episode)) && !journal.has(&archive_name(*episode));
        let lost: Vec<u64> = (0..protocol.episodes).filter(gone).collect();
        if let Some(first) = lost.first() {
            return Err(CollectionError::Lost { folder: path.into(), count: lost.len(), first: archive_name(*first) });
        }
        Ok(Self { trial, policy, protocol, shard, journal, done, totals })
    }

    /// Of the episodes that are there.
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// Plays the episodes that are missing, in their order; gives whether all are there, which they are not if `stop` became true.
    ///
    /// # Errors
    /// The policy cannot act, or an episode cannot be kept: that does not fit into memory is known before the first begins.
    pub fn complete(&mut self, stop: &AtomicBool, watch: &mut dyn FnMut(Event<'_>)) -> Result<bool, CollectionError> {
        let source = self.policy.clone();
        let mut policy = ActionRecorder::new(source.open(stop)?);
        let mut environment = self.trial.episode()?;
        Recording::ensure_room(&environment, policy.acts_on())?;
        for episode in 0..self.protocol.episodes {
            if self.done.contains((0, episode)) || !self.shard.has((0, episode), self.protocol.episodes) {
                continue;
            }
            let key = EpisodeKey { seed: self.protocol.seed, episode };
            let mut recording = Recording::default();
            let mut look = |environment: &Environment| {
                watch(Event::Step(environment.steps()));
                recording.look(environment);
            };
            let record = match play_watched(&self.trial, &mut environment, key, &mut policy, stop, &mut look) {
                Ok(Some(record)) => record,
                Ok(None) | Err(EvaluationError::Policy(PolicyError::Interrupted)) => return Ok(false),
                Err(error) => return Err(error.into()),
            };
            let archive = recording.archive(policy.actions(), &record)?;
            self.journal.write(LAYOUT, layout(&environment, &policy)?)?;
            // The arrays first, then the line that says that they are whole.
            self.journal.write(&archive_name(episode), archive)?;
            self.journal.append(&record)?;
            self.done.insert((0, episode));
            self.totals.add(&record);
            watch(Event::End(&record));
        }
        Ok(true)
    }
}

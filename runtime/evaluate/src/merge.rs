//! The shards of a run as one run: the folder that one machine would have written.

use super::journal::{Journal, JournalError, Reader, SUMMARY, pretty};
use super::summary::{self, BesideJournal};
use super::{EpisodeRecord, EpisodeSet, Job, RunSettings, Summarizer, Summary};
use msk_storage::{Folder, StorageError};
use std::iter::Peekable;
use std::path::{Path, PathBuf};

/// Episodes that are written at once.
const AT_ONCE: usize = 256;

/// What [`merge`] has written.
#[derive(Debug, Clone, PartialEq)]
pub struct Merged {
    /// Of all episodes.
    pub summary: Summary,
    /// How many there are.
    pub episodes: u64,
}

/// Why shards are not one run.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A folder that holds no journal, or a damaged one, or one that cannot be written.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The folder for the whole run exists.
    #[error("cannot make the folder `{}`", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// The reason.
        source: StorageError,
    },
    /// Two folders of different runs.
    #[error("`{}` contains another run than `{}`: {difference}", folder.display(), first.display())]
    OtherRun {
        /// The first folder.
        first: PathBuf,
        /// Another one.
        folder: PathBuf,
        /// What is different.
        difference: String,
    },
    /// A shard whose evaluation has written no summary.
    #[error("`{}` has no `summary.json` that can be read: {reason}", folder.display())]
    Summary {
        /// The folder.
        folder: PathBuf,
        /// Why not.
        reason: String,
    },
    /// A journal with episodes in another order than that of the plan.
    #[error("`{}` contains episode {episode} of `{task}` behind later ones", folder.display())]
    Order {
        /// The folder.
        folder: PathBuf,
        /// Task of the episode.
        task: String,
        /// Its index.
        episode: u64,
    },
    /// One episode with two results.
    #[error("episode {episode} of `{task}` differs between `{}` and `{}`", one.display(), other.display())]
    Differ {
        /// The first folder.
        one: PathBuf,
        /// The second.
        other: PathBuf,
        /// Task of the episode.
        task: String,
        /// Its index.
        episode: u64,
    },
    /// Episodes that no shard has.
    #[error("{count} of {all} episodes are missing, such as episode {episode} of `{task}`")]
    Missing {
        /// How many.
        count: u64,
        /// Episodes of the run.
        all: u64,
        /// Task of the first of them.
        task: String,
        /// Its index.
        episode: u64,
    },
}

/// Writes the run whose shards are in folders into a new folder `out`: `run.json`, `episodes.jsonl`, `summary.json` and `report.md` have the
/// bytes that one machine would have written; wall times and traces are taken over. Shards may overlap. Nothing is written unless every
/// episode is there. Memory does not grow with the number of episodes.
///
/// # Errors
/// Folders that are not the shards of one run, are incomplete or damaged, or a folder that cannot be written.
pub fn merge(shards: &[PathBuf], out: &Path) -> Result<Merged, MergeError> {
    let settings = settings(shards)?;
    let summaries = shards.iter().map(|shard| summary(shard)).collect::<Result<Vec<_>, _>>()?;
    // Tasks that the policy cannot act on, and units of metrics, which journals do not have.
    let BesideJournal { mut skipped, units } = BesideJournal::of(&summaries, &settings);

    let mut summarizer = Summarizer::of(settings.clone(), units);
    let mut done = EpisodeSet::default();
    for episode in InOrder::open(shards)? {
        let (job, record) = episode?;
        done.insert(job);
        summarizer.add(&record);
    }
    // A task that has episodes was not skipped, whatever a summary says.
    skipped.retain(|(place, _)| done.count(*place) == 0);
    must_be_whole(&settings, &done, &skipped)?;
    let summary = summarizer.summary().with_skipped(&skipped);

    Folder::create_new(out).map_err(|source| MergeError::Folder { folder: out.into(), source })?;
    let (journal, _) = Journal::open(out, &settings)?;
    let mut batch = Vec::new();
    for episode in InOrder::open(shards)? {
        batch.push(episode?.1);
        if batch.len() == AT_ONCE {
            journal.adopt(&batch)?;
            batch.clear();
        }
    }
    journal.adopt(&batch)?;
    for shard in shards {
        journal.adopt_rest(shard)?;
    }
    journal.write_summary(&summary)?;
    Ok(Merged { summary, episodes: done.len() })
}

/// The whole run of which all folders hold shards.
pub(crate) fn settings(shards: &[PathBuf]) -> Result<RunSettings, MergeError> {
    let mut whole: Option<(RunSettings, &Path)> = None;
    for folder in shards {
        let own = Reader::open(folder)?.settings().whole();
        match &whole {
            None => whole = Some((own, folder)),
            Some((known, first)) => {
                if let Some(difference) = own.difference(known) {
                    return Err(MergeError::OtherRun { first: first.to_path_buf(), folder: folder.clone(), difference });
                }
            }
        }
    }
    whole.map(|(settings, _)| settings).ok_or_else(|| JournalError::Empty { folder: PathBuf::new() }.into())
}

/// What a shard's evaluation has summed up.
fn summary(shard: &Path) -> Result<Summary, MergeError> {
    let cannot = |reason: String| MergeError::Summary { folder: shard.into(), reason };
    let text = Folder::open(shard).and_then(|folder| folder.read_text(Path::new(SUMMARY), summary::LARGEST));
    let text = text.map_err(|error| cannot(error.reason()))?.ok_or_else(|| cannot("there is no such file".into()))?;
    serde_json::from_str(&text).map_err(|error| cannot(error.to_string()))
}

pub(crate) fn must_be_whole(settings: &RunSettings, done: &EpisodeSet, skipped: &[(usize, String)]) -> Result<(), MergeError> {
    let episodes = settings.protocol.episodes;
    let places = 0..settings.tasks.len();
    let played: Vec<usize> = places.filter(|place| !skipped.iter().any(|(known, _)| known == place)).collect();
    let all = episodes.saturating_mul(played.len() as u64);
    let there: u64 = played.iter().map(|place| done.count(*place)).sum();
    let first = played.iter().find(|place| done.count(**place) < episodes);
    let Some(place) = first else { return Ok(()) };
    let episode = (0..episodes).find(|episode| !done.contains((*place, *episode))).unwrap_or_default();
    let task = settings.tasks[*place].name.clone();
    Err(MergeError::Missing { count: all.saturating_sub(there), all, task, episode })
}

/// The episodes of all shards in the order of the plan, each once.
pub(crate) struct InOrder {
    parts: Vec<Part>,
    /// Where the last episode was found.
    found: PathBuf,
    /// After an error there is nothing more.
    over: bool,
}

/// The episodes of one shard.
struct Part {
    folder: PathBuf,
    episodes: Peekable<Reader>,
    /// The episode that was taken last.
    last: Option<Job>,
}

impl InOrder {
    pub fn open(shards: &[PathBuf]) -> Result<Self, MergeError> {
        let open = |folder: &PathBuf| -> Result<Part, MergeError> {
            Ok(Part { folder: folder.clone(), episodes: Reader::open(folder)?.peekable(), last: None })
        };
        let parts = shards.iter().map(open).collect::<Result<_, _>>()?;
        Ok(Self { parts, found: PathBuf::new(), over: false })
    }

    /// The folder of the last episode, the first one of those that have it.
    pub fn last_folder(&self) -> &Path {
        &self.found
    }

    /// The next episode, of all shards that have it.
    fn earliest(&mut self) -> Result<Option<(Job, EpisodeRecord)>, MergeError> {
        let mut earliest: Option<Job> = None;
        for part in &mut self.parts {
            match part.episodes.peek() {
                Some(Ok((job, _))) if earliest.is_none_or(|known| *job < known) => earliest = Some(*job),
                Some(Err(_)) => return part.take().map(Some),
                _ => {}
            }
        }
        let Some(job) = earliest else { return Ok(None) };
        let mut found: Option<(PathBuf, EpisodeRecord)> = None;
        for part in &mut self.parts {
            if !matches!(part.episodes.peek(), Some(Ok((own, _))) if *own == job) {
                continue;
            }
            let (_, record) = part.take()?;
            match &found {
                None => found = Some((part.folder.clone(), record)),
                Some((one, known)) if pretty(known) != pretty(&record) => {
                    let (one, other, task) = (one.clone(), part.folder.clone(), record.task);
                    return Err(MergeError::Differ { one, other, task, episode: job.1 });
                }
                Some(_) => {}
            }
        }
        Ok(found.map(|(folder, record)| {
            self.found = folder;
            (job, record)
        }))
    }
}

impl Part {
    /// Takes the next episode, which there is.
    fn take(&mut self) -> Result<(Job, EpisodeRecord), MergeError> {
        let empty = || Err(JournalError::Empty { folder: self.folder.clone() });
        let (job, record) = self.episodes.next().unwrap_or_else(empty)?;
        if self.last.is_some_and(|last| job < last) {
            return Err(MergeError::Order { folder: self.folder.clone(), task: record.task, episode: job.1 });
        }
        self.last = Some(job);
        Ok((job, record))
    }
}

impl Iterator for InOrder {
    type Item = Result<(Job, EpisodeRecord), MergeError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.over {
            return None;
        }
        let next = self.earliest().transpose();
        self.over = !matches!(next, Some(Ok(_)));
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::tests::{record, settings};
    use std::fs;

    /// A shard with these episodes and returns.
    fn shard(folder: &Path, name: &str, episodes: &[(u64, f64)]) -> PathBuf {
        let path = folder.join(name);
        let (journal, _) = Journal::open(&path, &settings(0)).unwrap();
        for (episode, total) in episodes {
            journal.append(&EpisodeRecord { total: *total, ..record(*episode) }).unwrap();
        }
        let summary = Summarizer::of(settings(0), vec![vec![]]).summary();
        journal.write(SUMMARY, summary.json()).unwrap();
        path
    }

    #[test]
    fn an_episode_with_two_results_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let shard = |name: &str, episodes: &[(u64, f64)]| shard(folder.path(), name, episodes);
        let (one, same, other) =
            (shard("one", &[(0, 1.5), (1, 1.5)]), shard("same", &[(1, 1.5), (2, 1.5)]), shard("other", &[(1, 1.25), (2, 1.5)]));
        let out = folder.path().join("out");
        let error = merge(&[one.clone(), other], &out).unwrap_err().to_string();
        assert!(error.starts_with("episode 1 of `stand` differs between `") && error.contains("one` and `"), "{error}");
        assert!(!out.exists());
        let merged = merge(&[same, one], &out).unwrap();
        assert_eq!((merged.episodes, merged.summary.tasks[0].successes), (3, 3));
        assert_eq!(fs::read_to_string(out.join("episodes.jsonl")).unwrap().lines().count(), 3);
    }

    #[test]
    fn a_summary_that_calls_a_played_task_skipped_is_not_believed() {
        let folder = tempfile::tempdir().unwrap();
        let path = shard(folder.path(), "one", &[(0, 1.5), (2, 1.5)]);
        let summary = fs::read_to_string(path.join(SUMMARY)).unwrap();
        let edited = summary.replacen("\"family\"", "\"skipped\": \"it cannot act\", \"family\"", 1);
        assert_ne!(summary, edited);
        fs::write(path.join(SUMMARY), edited).unwrap();
        let error = merge(&[path], &folder.path().join("out")).unwrap_err().to_string();
        assert!(error.starts_with("1 of 3 episodes are missing, such as episode 1"), "{error}");
    }
}

//! The journal of a run: a folder with `run.json` (what is run), `episodes.jsonl` (one line per ended episode) and `wall_times.jsonl` (how
//! long each took).
//!
//! A line is on the disk, whole, when [`Journal::append`] returns, or it is not there: whatever ends the program leaves a
//! journal that can be continued. A folder holds one run for good: the same run is continued in it, any other is refused.
//! Every line names its run and carries a checksum (see [`line`]), so that lines of another run, and
//! lines that were edited, are not counted.
//!
//! Everything but the wall times has the same bytes however often a run was interrupted: episodes enter in the order of the plan. One
//! that ended before its turn is kept in `early.jsonl` until then; the file is removed when the run is complete.

mod error;
pub(crate) mod line;
mod reader;

pub use error::JournalError;
pub(crate) use reader::Reader;

use super::episode_set::{EpisodeSet, Job};
use super::{EpisodeRecord, RunSettings, Summary, TRACES, report};
use line::Line;
use msk_storage::{Folder, Kind, Lock, Log, StorageError};
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

const SETTINGS: &str = "run.json";
const EPISODES: &str = "episodes.jsonl";
const EARLY: &str = "early.jsonl";
/// The sums over all episodes, as numbers and as tables.
pub(crate) const SUMMARY: &str = "summary.json";
const REPORT: &str = "report.md";
const WALL_TIMES: &str = "wall_times.jsonl";
/// Holds nothing: it is locked while a process writes to the journal.
const LOCK: &str = ".lock";
/// Most bytes that are read of `run.json`.
const LARGEST_SETTINGS: u64 = 64 << 20;
/// Most bytes of a line that is read: a record with tens of thousands of terms, metrics and parameters.
const LARGEST_LINE: u64 = 16 << 20;
/// Most bytes of an archive that is taken over.
const LARGEST_ARCHIVE: u64 = 1 << 32;

/// An open journal. It may be shared between threads; the folder is locked against other processes while it lives.
#[derive(Debug)]
pub struct Journal {
    folder: Folder,
    /// Identity of the run.
    run: String,
    files: Mutex<Files>,
    _lock: Lock,
}

/// The files that grow. Those that are not needed are not made.
#[derive(Debug)]
struct Files {
    episodes: Log,
    early: Option<Log>,
    wall_times: Option<Log>,
}

/// Which episodes a journal has when it is opened.
#[derive(Debug, Clone, Default)]
pub struct Kept {
    /// Those that have a line.
    pub done: EpisodeSet,
    /// Those that ended before their turn.
    pub early: BTreeMap<Job, EpisodeRecord>,
}

impl Journal {
    /// Opens the journal of `settings` in the folder `path`, which is made if need be, and reads the episodes that it already
    /// has.
    ///
    /// # Errors
    /// A folder that cannot be written, holds another run, is damaged, or is in use.
    pub fn open(path: &Path, settings: &RunSettings) -> Result<(Self, Vec<EpisodeRecord>), JournalError> {
        let folder = Folder::create(path).map_err(|source| JournalError::Unusable { folder: path.into(), source })?;
        Self::open_in(folder, settings)
    }

    /// [`Journal::open`] in an opened folder.
    ///
    /// # Errors
    /// As there.
    pub fn open_in(folder: Folder, settings: &RunSettings) -> Result<(Self, Vec<EpisodeRecord>), JournalError> {
        let mut records = Vec::new();
        let (journal, _) = Self::open_with(folder, settings, &mut |record| records.push(record))?;
        Ok((journal, records))
    }

    /// [`Journal::open`] in an opened folder, where the episodes that have a line are shown one after the other, and not kept in memory.
    ///
    /// # Errors
    /// As there.
    pub fn open_with(
        folder: Folder,
        settings: &RunSettings,
        visit: &mut dyn FnMut(EpisodeRecord),
    ) -> Result<(Self, Kept), JournalError> {
        let unusable = |source| JournalError::Unusable { folder: folder.path().into(), source };
        let lock = folder.try_lock(Path::new(LOCK)).map_err(unusable)?;
        let lock = lock.ok_or_else(|| JournalError::Busy { folder: folder.path().into() })?;
        let episodes = folder.log(EPISODES).map_err(unusable)?;
        match claimed(&folder)? {
            Some(before) => {
                if let Some(difference) = before.difference(settings) {
                    return Err(JournalError::OtherRun { folder: folder.path().into(), difference });
                }
            }
            // The settings are on the disk before the first episode is, so these have lost theirs.
            None if folder
                .lines(Path::new(EPISODES), LARGEST_LINE)
                .map_err(unusable)?
                .is_some_and(|mut lines| lines.next().is_some()) =>
            {
                return Err(JournalError::Unclaimed { folder: folder.path().into() });
            }
            None => {
                let text = pretty(settings) + "\n";
                folder.replace(Path::new(SETTINGS), text.as_bytes()).map_err(unusable)?;
            }
        }
        let done = read::<JournalError>(&folder, settings, &mut |record| {
            visit(record);
            Ok(())
        })?;
        let early = early(&folder, settings, &done).map_err(unusable)?;
        let files = Mutex::new(Files { episodes, early: None, wall_times: None });
        Ok((Self { run: settings.identity(), files, _lock: lock, folder }, Kept { done, early }))
    }

    /// Shows the episodes of the journal in the folder `path`, which may still be growing, one after the other. A last line that is not
    /// yet whole is left out.
    ///
    /// # Errors
    /// A folder that holds no journal, or a damaged one.
    pub fn each(path: &Path, mut visit: impl FnMut(EpisodeRecord)) -> Result<(), JournalError> {
        Self::try_each(path, |record| {
            visit(record);
            Ok(())
        })
    }

    /// [`each`](Self::each) up to the first error of `visit`.
    ///
    /// # Errors
    /// Those of [`each`](Self::each), and that of `visit`.
    pub fn try_each<E: From<JournalError>>(path: &Path, mut visit: impl FnMut(EpisodeRecord) -> Result<(), E>) -> Result<(), E> {
        for episode in Reader::open(path)? {
            visit(episode?.1)?;
        }
        Ok(())
    }

    /// All episodes of the journal in the folder `path`: for those that are few.
    ///
    /// # Errors
    /// Those of [`Journal::each`].
    pub fn records(path: &Path) -> Result<Vec<EpisodeRecord>, JournalError> {
        let mut records = Vec::new();
        Self::each(path, |record| records.push(record))?;
        Ok(records)
    }

    /// Appends one episode: it is on the disk, whole, when this returns.
    ///
    /// # Errors
    /// The operating system refuses, for instance because the disk is full. The journal is then what it was before; where not
    /// even that can be achieved it takes no further episodes until it is opened again.
    pub fn append(&self, record: &EpisodeRecord) -> Result<(), JournalError> {
        self.append_all(std::slice::from_ref(record))
    }

    /// [`append`](Self::append) of several episodes.
    ///
    /// # Errors
    /// As there; none of them has then been appended.
    pub fn append_all(&self, records: &[EpisodeRecord]) -> Result<(), JournalError> {
        let mut files = self.files();
        for record in records {
            let time = wall_time(record);
            let log = opened(&mut files.wall_times, &self.folder, WALL_TIMES);
            log.and_then(|log| log.append_unsynced(time.as_bytes())).map_err(|source| self.unusable(source))?;
        }
        self.append_lines(&mut files, records)
    }

    fn append_lines(&self, files: &mut Files, records: &[EpisodeRecord]) -> Result<(), JournalError> {
        let lines: Vec<String> = records.iter().map(|record| Line::written(record, &self.run)).collect();
        let lines: Vec<&[u8]> = lines.iter().map(String::as_bytes).collect();
        files.episodes.append_lines(&lines).map_err(|source| self.unusable(source))
    }

    /// Appends episodes of another journal of the run; the [rest](Self::adopt_rest) of it is taken over once.
    ///
    /// # Errors
    /// Those of [`append`](Self::append).
    pub(crate) fn adopt(&self, records: &[EpisodeRecord]) -> Result<(), JournalError> {
        self.append_lines(&mut self.files(), records)
    }

    /// Takes over the wall times and traces of another journal.
    ///
    /// # Errors
    /// Files that cannot be read or written.
    pub(crate) fn adopt_rest(&self, other: &Path) -> Result<(), JournalError> {
        let unusable = |source| JournalError::Unusable { folder: other.into(), source };
        let folder = Folder::open(other).map_err(unusable)?;
        let mut files = self.files();
        for line in folder.lines(Path::new(WALL_TIMES), LARGEST_LINE).map_err(unusable)?.into_iter().flatten() {
            let log = opened(&mut files.wall_times, &self.folder, WALL_TIMES);
            log.and_then(|log| log.append_unsynced(&line?)).map_err(|source| self.unusable(source))?;
        }
        let traces = match folder.subfolder(Path::new(TRACES)) {
            Err(error) if error.kind() == Some(ErrorKind::NotFound) => return Ok(()),
            traces => traces.map_err(unusable)?,
        };
        // What is no file, such as a link out of the folder, is an error of reading it: no trace is left out silently.
        for entry in traces.entries(Path::new("")).map_err(unusable)?.iter().filter(|entry| entry.kind != Kind::Folder) {
            let bytes = adopted(&traces, &entry.name).map_err(unusable)?;
            self.write_below(&format!("{TRACES}/{}", entry.name.display()), bytes)?;
        }
        Ok(())
    }

    /// Takes over a file of another journal's folder.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub(crate) fn adopt_file(&self, other: &Path, name: &str) -> Result<(), JournalError> {
        let bytes = Folder::open(other).and_then(|folder| adopted(&folder, Path::new(name)));
        self.write(name, bytes.map_err(|source| JournalError::Unusable { folder: other.into(), source })?)
    }

    /// Keeps an episode whose turn has not come, so that it need not be played again if the program ends before.
    ///
    /// # Errors
    /// Those of [`append`](Self::append).
    pub fn hold(&self, record: &EpisodeRecord) -> Result<(), JournalError> {
        let line = Line::written(record, &self.run);
        let mut files = self.files();
        let log = opened(&mut files.early, &self.folder, EARLY);
        log.and_then(|log| log.append_unsynced(line.as_bytes())).map_err(|source| self.unusable(source))
    }

    /// Removes what was held: every episode has had its turn.
    ///
    /// # Errors
    /// The operating system refuses.
    pub fn complete(&self) -> Result<(), JournalError> {
        self.files().early = None;
        self.folder.remove(Path::new(EARLY)).map_err(|source| self.unusable(source))
    }

    /// A thread that panicked while it appended left the logs as a failed append does.
    fn files(&self) -> MutexGuard<'_, Files> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes a further file of the run, such as its summary, replacing an earlier version in one move.
    ///
    /// # Errors
    /// The operating system refuses, or the file is read-only.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), JournalError> {
        self.folder.replace(Path::new(name), content.as_ref()).map_err(|source| self.unusable(source))
    }

    /// Writes `summary.json` and `report.md`.
    ///
    /// # Errors
    /// Those of [`write`](Self::write).
    pub fn write_summary(&self, summary: &Summary) -> Result<(), JournalError> {
        self.write(SUMMARY, summary.json())?;
        self.write(REPORT, report::markdown(summary))
    }

    /// [`write`](Self::write) of a file in a folder of the run's folder, which is made if need be.
    ///
    /// # Errors
    /// As there.
    pub fn write_below(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), JournalError> {
        if let Some(parent) = Path::new(name).parent() {
            self.folder.create_subfolder(parent).map_err(|source| self.unusable(source))?;
        }
        self.write(name, content)
    }

    /// Whether the run has a further file of that name.
    pub fn has(&self, name: &str) -> bool {
        self.folder.path().join(name).is_file()
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    fn unusable(&self, source: StorageError) -> JournalError {
        JournalError::Unusable { folder: self.folder.path().into(), source }
    }
}

/// The settings of the run that a folder holds, if it holds one.
fn claimed(folder: &Folder) -> Result<Option<RunSettings>, JournalError> {
    let text = folder.read_text(Path::new(SETTINGS), LARGEST_SETTINGS);
    let text = text.map_err(|source| JournalError::Unusable { folder: folder.path().into(), source })?;
    let settings = text.map(|text| {
        serde_json::from_str(&text).map_err(|error| JournalError::Damaged {
            path: folder.path().join(SETTINGS),
            line: error.line(),
            reason: error.to_string(),
        })
    });
    settings.transpose()
}

/// Shows the episodes in the lines of a journal, all of which must be of the run `settings`.
fn read<E: From<JournalError>>(
    folder: &Folder,
    settings: &RunSettings,
    visit: &mut dyn FnMut(EpisodeRecord) -> Result<(), E>,
) -> Result<EpisodeSet, E> {
    let mut reader = Reader::of(folder, settings.clone())?;
    for episode in reader.by_ref() {
        visit(episode?.1)?;
    }
    Ok(reader.into_episodes())
}

/// The episodes that ended before their turn. They were not promised to be there, so what is damaged is left out.
fn early(folder: &Folder, settings: &RunSettings, done: &EpisodeSet) -> Result<BTreeMap<Job, EpisodeRecord>, StorageError> {
    let run = settings.identity();
    let mut early = BTreeMap::new();
    for line in folder.lines(Path::new(EARLY), LARGEST_LINE)?.into_iter().flatten() {
        let Ok(line) = Line::read(&line?) else { continue };
        let job = settings.job(&line, &run);
        if let Some(job) = job.ok().filter(|job| !done.contains(*job)) {
            early.insert(job, line.record);
        }
    }
    Ok(early)
}

impl RunSettings {
    /// Which of its episodes a line is, or why it is none.
    fn job(&self, line: &Line, identity: &str) -> Result<Job, String> {
        if let Some(reason) = self.stranger(&line.record) {
            return Err(reason);
        }
        if line.run != identity {
            return Err(format!("it belongs to run {}, not {identity}", line.run));
        }
        // What is no stranger has its place.
        Ok((self.place(&line.record).unwrap_or_default(), line.record.episode))
    }
}

/// A file of another journal, which must be there.
fn adopted(folder: &Folder, name: &Path) -> Result<Vec<u8>, StorageError> {
    let gone = || StorageError::System { action: "read", path: folder.path().join(name), source: ErrorKind::NotFound.into() };
    folder.read(name, LARGEST_ARCHIVE)?.ok_or_else(gone)
}

/// The log of that name, opened when it is first needed.
fn opened<'a>(log: &'a mut Option<Log>, folder: &Folder, name: &str) -> Result<&'a mut Log, StorageError> {
    Ok(match log {
        Some(log) => log,
        None => log.insert(folder.log(name)?),
    })
}

/// The line of an episode in `wall_times.jsonl`.
fn wall_time(record: &EpisodeRecord) -> String {
    let EpisodeRecord { task, episode, wall_time, .. } = record;
    json(&serde_json::json!({ "task": task, "episode": episode, "wall_time": wall_time }))
}

/// Plain data of strings and numbers always has a JSON form.
pub(super) fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// The same for people's eyes.
pub(super) fn pretty(value: &impl serde::Serialize) -> String {
    serde_json::to_string_pretty(value).unwrap_or_default()
}

#[cfg(test)]
pub(crate) mod tests;

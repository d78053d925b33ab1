//! The journal of a run: a folder with `run.json` (what is run) and `episodes.jsonl` (one line per ended episode).
//!
//! Lines are written whole and at once, so whatever ends the program leaves a journal that can be continued. A folder holds
//! one run for good: the same run is continued in it, any other is refused.

use super::{EpisodeRecord, RunSettings};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

const SETTINGS: &str = "run.json";
const EPISODES: &str = "episodes.jsonl";

/// Why a folder cannot serve as journal.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The operating system refused.
    #[error("cannot write results to `{}`", path.display())]
    Unwritable {
        /// What was being written.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// A file of the folder cannot be read.
    #[error("cannot read `{}`", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// The folder holds the results of another run.
    #[error("`{}` holds another run: {difference}", folder.display())]
    OtherRun {
        /// The folder.
        folder: PathBuf,
        /// What is different.
        difference: String,
    },
    /// A file of the folder is damaged.
    #[error("`{}`, line {line}, is not what was written there: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What the parser says.
        reason: String,
    },
    /// Another process is writing there.
    #[error("another process is writing results to `{}`", folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
}

/// An open journal. It may be shared between threads; the folder is locked against other processes while it lives.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    episodes: Mutex<File>,
}

impl Journal {
    /// Opens the journal of `settings` in `folder`, which is made if need be, and reads the episodes that it already has.
    ///
    /// # Errors
    /// A folder that cannot be written, holds another run, is damaged, or is in use.
    pub fn open(folder: &Path, settings: &RunSettings) -> Result<(Self, Vec<EpisodeRecord>), JournalError> {
        let unwritable = |path: &Path| {
            let path = path.to_path_buf();
            move |source| JournalError::Unwritable { path, source }
        };
        fs::create_dir_all(folder).map_err(unwritable(folder))?;
        let path = folder.join(EPISODES);
        let file = OpenOptions::new().append(true).create(true).open(&path).map_err(unwritable(&path))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(JournalError::Busy { folder: folder.into() }),
            Err(TryLockError::Error(source)) => return Err(unwritable(&path)(source)),
        }
        claim(folder, settings)?;
        let (records, valid) = read(&path)?;
        // What follows the last line end is a line whose writing was cut short.
        file.set_len(valid).map_err(unwritable(&path))?;
        Ok((Self { folder: folder.into(), episodes: Mutex::new(file) }, records))
    }

    /// The episodes of the journal in `folder`, which may still be growing. A last line that is not yet whole is left out.
    ///
    /// # Errors
    /// A folder that holds no journal, or a damaged one.
    pub fn records(folder: &Path) -> Result<Vec<EpisodeRecord>, JournalError> {
        Ok(read(&folder.join(EPISODES))?.0)
    }

    /// Appends one episode, whole and at once.
    ///
    /// # Errors
    /// The operating system refuses, for instance because the disk is full.
    pub fn append(&self, record: &EpisodeRecord) -> Result<(), JournalError> {
        let mut line = json(record);
        line.push('\n');
        // A thread that panicked while holding the lock had its line written or not: either way the file is whole.
        let mut file = self.episodes.lock().unwrap_or_else(PoisonError::into_inner);
        let written = file.write_all(line.as_bytes()).and_then(|()| file.flush());
        written.map_err(|source| JournalError::Unwritable { path: self.folder.join(EPISODES), source })
    }

    /// Writes a further file of the run, such as its summary, replacing an earlier version in one move.
    ///
    /// # Errors
    /// The operating system refuses.
    pub fn write(&self, name: &str, text: &str) -> Result<(), JournalError> {
        replace(&self.folder.join(name), text)
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

/// Makes `folder` the place of the run, or checks that it already is.
fn claim(folder: &Path, settings: &RunSettings) -> Result<(), JournalError> {
    let path = folder.join(SETTINGS);
    let text = match fs::read_to_string(&path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return replace(&path, &(pretty(settings) + "\n"));
        }
        text => text.map_err(|source| JournalError::Unreadable { path: path.clone(), source })?,
    };
    let before: RunSettings = serde_json::from_str(&text).map_err(|error| JournalError::Damaged {
        path,
        line: error.line(),
        reason: error.to_string(),
    })?;
    match before.difference(settings) {
        Some(difference) => Err(JournalError::OtherRun { folder: folder.into(), difference }),
        None => Ok(()),
    }
}

/// The episodes of a journal and the number of bytes that they take.
fn read(path: &Path) -> Result<(Vec<EpisodeRecord>, u64), JournalError> {
    let bytes = fs::read(path).map_err(|source| JournalError::Unreadable { path: path.into(), source })?;
    let valid = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let mut records = Vec::new();
    for (index, line) in bytes[..valid].split_inclusive(|&byte| byte == b'\n').enumerate() {
        let record = serde_json::from_slice(line).map_err(|error| JournalError::Damaged {
            path: path.into(),
            line: index + 1,
            reason: error.to_string(),
        })?;
        records.push(record);
    }
    Ok((records, valid as u64))
}

/// Writes beside the file, then moves into place: readers see the old text or the new one, never half of it.
fn replace(path: &Path, text: &str) -> Result<(), JournalError> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".new");
    let beside = path.with_file_name(name);
    let written = fs::write(&beside, text).and_then(|()| fs::rename(&beside, path));
    written.map_err(|source| JournalError::Unwritable { path: path.into(), source })
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
mod tests {
    use super::super::{Protocol, TaskSettings};
    use super::*;

    fn settings(seed: u64) -> RunSettings {
        let task = TaskSettings {
            name: "stand".into(),
            family: String::new(),
            hash: "a".into(),
            model_hash: "b".into(),
            condition: Default::default(),
            horizon: 10,
            weights: vec![],
            overlaid: vec![],
        };
        RunSettings {
            version: "1".into(),
            policy: "zero".into(),
            protocol: Protocol { episodes: 3, seed },
            tasks: vec![task],
            live: None,
        }
    }

    fn record(episode: u64) -> EpisodeRecord {
        let line = format!(
            r#"{{"task":"stand","policy":"zero","seed":0,"episode":{episode},"success":true,"terminated_by":[],"truncated":true,
            "fault":null,"steps":10,"return":1.5,"terms":{{}},"values":{{}},"task_hash":"a","model_hash":"b","wall_time":0.1}}"#
        );
        serde_json::from_str(&line).unwrap()
    }

    #[test]
    fn the_same_run_is_continued() {
        let folder = tempfile::tempdir().unwrap();
        let (journal, before) = Journal::open(folder.path(), &settings(0)).unwrap();
        assert!(before.is_empty());
        journal.append(&record(2)).unwrap();
        drop(journal);
        let (journal, before) = Journal::open(folder.path(), &settings(0)).unwrap();
        assert_eq!(before, [record(2)]);
        journal.append(&record(0)).unwrap();
        drop(journal);
        assert_eq!(Journal::open(folder.path(), &settings(0)).unwrap().1, [record(2), record(0)]);
    }

    #[test]
    fn another_run_is_refused_and_nothing_is_lost() {
        let folder = tempfile::tempdir().unwrap();
        Journal::open(folder.path(), &settings(0)).unwrap().0.append(&record(0)).unwrap();
        let error = Journal::open(folder.path(), &settings(1)).unwrap_err().to_string();
        assert!(error.ends_with("holds another run: its seed is 0, not 1"), "{error}");
        assert_eq!(Journal::open(folder.path(), &settings(0)).unwrap().1, [record(0)]);
    }

    #[test]
    fn a_line_that_was_cut_short_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        Journal::open(folder.path(), &settings(0)).unwrap().0.append(&record(0)).unwrap();
        let path = folder.path().join(EPISODES);
        let whole = fs::read_to_string(&path).unwrap();
        fs::write(&path, whole.clone() + &whole[..40]).unwrap();
        let (journal, before) = Journal::open(folder.path(), &settings(0)).unwrap();
        assert_eq!(before, [record(0)]);
        journal.append(&record(1)).unwrap();
        drop(journal);
        assert_eq!(Journal::open(folder.path(), &settings(0)).unwrap().1, [record(0), record(1)]);
    }

    #[test]
    fn damage_is_reported_with_its_line_and_left_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        Journal::open(folder.path(), &settings(0)).unwrap().0.append(&record(0)).unwrap();
        let path = folder.path().join(EPISODES);
        let damaged = fs::read_to_string(&path).unwrap() + "{\"task\":\n";
        fs::write(&path, &damaged).unwrap();
        let error = Journal::open(folder.path(), &settings(0)).unwrap_err();
        assert!(matches!(error, JournalError::Damaged { line: 2, .. }), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), damaged);
    }

    #[test]
    fn one_process_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let first = Journal::open(folder.path(), &settings(0)).unwrap();
        assert!(matches!(Journal::open(folder.path(), &settings(0)), Err(JournalError::Busy { .. })));
        drop(first);
        assert!(Journal::open(folder.path(), &settings(0)).is_ok());
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        let error = Journal::open(&file.join("results"), &settings(0)).unwrap_err();
        assert!(matches!(error, JournalError::Unwritable { .. }), "{error}");
    }
}

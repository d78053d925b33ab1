//! The journal of a run: a folder with `run.json` (what is run) and `episodes.jsonl` (one line per ended episode).
//!
//! A line is on the disk, whole, when [`Journal::append`] returns, or it is not there: whatever ends the program leaves a
//! journal that can be continued. A folder holds one run for good: the same run is continued in it, any other is refused.
//! Every line names its run and carries a checksum (see [`line`](super::line)), so that lines of another run, and
//! lines that were edited, are not counted.

use super::line::{Line, LineError};
use super::{EpisodeRecord, RunSettings};
use msk_storage::{Folder, Lock, Log, StorageError};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

const SETTINGS: &str = "run.json";
const EPISODES: &str = "episodes.jsonl";
/// Holds nothing: it is locked while a process writes to the journal.
const LOCK: &str = ".lock";
/// Most bytes that are read of `run.json`.
const LARGEST_SETTINGS: u64 = 64 << 20;
/// Most bytes that are read of `episodes.jsonl`: some million episodes.
const LARGEST_EPISODES: u64 = 8 << 30;

/// Why a folder cannot serve as journal.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// A file of the folder cannot be read or written.
    #[error("cannot keep results in `{}`", folder.display())]
    Unusable {
        /// The folder.
        folder: PathBuf,
        /// Which file, and the reason.
        source: StorageError,
    },
    /// The folder holds the results of another run.
    #[error("`{}` contains another run: {difference}", folder.display())]
    OtherRun {
        /// The folder.
        folder: PathBuf,
        /// What is different.
        difference: String,
    },
    /// The folder holds episodes and nothing that names their run.
    #[error("`{}` contains episodes but no `run.json` that identifies their run", folder.display())]
    Unclaimed {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds no journal.
    #[error("`{}` contains no results: it has no `run.json`", folder.display())]
    Empty {
        /// The folder.
        folder: PathBuf,
    },
    /// A file of the folder is damaged, or somebody has changed it.
    #[error("`{}`, line {line}, was modified: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A line of the journal is of another run than the folder.
    #[error("`{}`, line {line}, belongs to another run than `run.json` beside it: {reason}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is different.
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
    folder: Folder,
    /// Identity of the run.
    run: String,
    episodes: Mutex<Log>,
    _lock: Lock,
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
        let unusable = |source| JournalError::Unusable { folder: folder.path().into(), source };
        let lock = folder.try_lock(Path::new(LOCK)).map_err(unusable)?;
        let lock = lock.ok_or_else(|| JournalError::Busy { folder: folder.path().into() })?;
        let mut log = folder.log(EPISODES).map_err(unusable)?;
        let lines = log.read(LARGEST_EPISODES).map_err(unusable)?;
        match claimed(&folder)? {
            Some(before) => {
                if let Some(difference) = before.difference(settings) {
                    return Err(JournalError::OtherRun { folder: folder.path().into(), difference });
                }
            }
            // The settings are on the disk before the first episode is, so these have lost theirs.
            None if !lines.is_empty() => return Err(JournalError::Unclaimed { folder: folder.path().into() }),
            None => {
                let text = pretty(settings) + "\n";
                folder.replace(Path::new(SETTINGS), text.as_bytes()).map_err(unusable)?;
            }
        }
        let records = read(&folder, &lines, settings)?;
        let run = settings.identity();
        Ok((Self { run, episodes: Mutex::new(log), _lock: lock, folder }, records))
    }

    /// The episodes of the journal in the folder `path`, which may still be growing. A last line that is not yet whole is left
    /// out.
    ///
    /// # Errors
    /// A folder that holds no journal, or a damaged one.
    pub fn records(path: &Path) -> Result<Vec<EpisodeRecord>, JournalError> {
        let unusable = |source| JournalError::Unusable { folder: path.into(), source };
        let folder = Folder::open(path).map_err(unusable)?;
        let settings = claimed(&folder)?.ok_or_else(|| JournalError::Empty { folder: path.into() })?;
        let bytes = folder.read(Path::new(EPISODES), LARGEST_EPISODES).map_err(unusable)?.unwrap_or_default();
        read(&folder, Log::whole_lines(&bytes), &settings)
    }

    /// Appends one episode: it is on the disk, whole, when this returns.
    ///
    /// # Errors
    /// The operating system refuses, for instance because the disk is full. The journal is then what it was before; where not
    /// even that can be achieved it takes no further episodes until it is opened again.
    pub fn append(&self, record: &EpisodeRecord) -> Result<(), JournalError> {
        let line = Line::written(record, &self.run);
        // A thread that panicked while it appended left the log as a failed append does.
        let mut log = self.episodes.lock().unwrap_or_else(PoisonError::into_inner);
        log.append(line.as_bytes()).map_err(|source| self.unusable(source))
    }

    /// Writes a further file of the run, such as its summary, replacing an earlier version in one move.
    ///
    /// # Errors
    /// The operating system refuses, or the file is read-only.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), JournalError> {
        self.folder.replace(Path::new(name), content.as_ref()).map_err(|source| self.unusable(source))
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

/// The episodes in the lines of a journal, all of which must be of the run `settings`.
fn read(folder: &Folder, lines: &[u8], settings: &RunSettings) -> Result<Vec<EpisodeRecord>, JournalError> {
    let path = folder.path().join(EPISODES);
    let damaged = |line, reason: String| JournalError::Damaged { path: path.clone(), line, reason };
    let run = settings.identity();
    let (mut records, mut seen) = (Vec::new(), BTreeSet::new());
    for (number, line) in (1..).zip(lines.split_inclusive(|&byte| byte == b'\n')) {
        let Line { record, run: of } = Line::read(line).map_err(|error: LineError| damaged(number, error.to_string()))?;
        let foreign = |reason| Err(JournalError::Foreign { path: path.clone(), line: number, reason });
        if let Some(reason) = settings.stranger(&record) {
            return foreign(reason);
        }
        if of != run {
            return foreign(format!("it belongs to run {of}, not {run}"));
        }
        if !seen.insert((settings.place(&record), record.episode)) {
            return Err(damaged(number, format!("episode {} of `{}` already exists", record.episode, record.task)));
        }
        records.push(record);
    }
    Ok(records)
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
    use msk_runtime::condition::{Fatigue, MuscleCondition};
    use msk_storage::{FailAt, Failure};
    use std::fs;
    use std::sync::Arc;

    fn settings(seed: u64) -> RunSettings {
        let task = TaskSettings {
            name: "stand".into(),
            family: String::new(),
            hash: "a".into(),
            model_hash: "b".into(),
            condition: Default::default(),
            perturbation: String::new(),
            horizon: 10,
            weights: vec![],
            overlaid: vec![],
        };
        RunSettings {
            version: "1".into(),
            build: "2".into(),
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
        assert!(error.ends_with("contains another run: its seed is 0, not 1"), "{error}");
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
        assert!(matches!(error, JournalError::Unusable { .. }), "{error}");
    }

    /// The journal of a run of three episodes, and its lines.
    fn three_episodes() -> (tempfile::TempDir, String) {
        let folder = tempfile::tempdir().unwrap();
        let (journal, _) = Journal::open(folder.path(), &settings(0)).unwrap();
        (0..3).for_each(|episode| journal.append(&record(episode)).unwrap());
        let lines = fs::read_to_string(folder.path().join(EPISODES)).unwrap();
        (folder, lines)
    }

    /// The error of a journal whose lines are replaced.
    fn refusal(folder: &Path, lines: &str) -> String {
        fs::write(folder.join(EPISODES), lines).unwrap();
        let error = Journal::open(folder, &settings(0)).unwrap_err().to_string();
        assert_eq!(fs::read_to_string(folder.join(EPISODES)).unwrap(), lines, "what is refused stays as it is");
        assert_eq!(Journal::records(folder).unwrap_err().to_string(), error);
        error
    }

    #[test]
    fn an_edited_line_is_noticed() {
        let (folder, lines) = three_episodes();
        for (before, after) in
            [("\"return\":1.5", "\"return\":9.5"), ("\"success\":true", "\"success\":false"), ("\"steps\":10", "\"steps\":11")]
        {
            assert!(lines.contains(before), "{lines}");
            let error = refusal(folder.path(), &lines.replacen(before, after, 1));
            assert!(error.contains("line 1") && error.contains("its checksum does not match its content"), "{error}");
        }
        let bare = lines.replacen(",\"checksum\"", ",\"other\"", 1);
        assert!(refusal(folder.path(), &bare).contains("it has no checksum"));
    }

    #[test]
    fn a_journal_without_its_settings_is_not_taken_over() {
        let (folder, lines) = three_episodes();
        fs::remove_file(folder.path().join(SETTINGS)).unwrap();
        for seed in [0, 7] {
            let error = Journal::open(folder.path(), &settings(seed)).unwrap_err();
            assert!(matches!(error, JournalError::Unclaimed { .. }), "{error}");
        }
        assert!(!folder.path().join(SETTINGS).exists());
        assert_eq!(fs::read_to_string(folder.path().join(EPISODES)).unwrap(), lines);
    }

    #[test]
    fn episodes_of_another_run_do_not_count_whatever_the_settings_say() {
        let (folder, lines) = three_episodes();
        type Change<'a> = &'a dyn Fn(&mut RunSettings);
        let others: [(Change<'_>, &str); 6] = [
            (&|s| s.protocol.seed = 7, "its seed is 0, not 7"),
            (&|s| s.policy = "random".into(), "its policy is zero, not random"),
            (&|s| s.tasks[0].hash = "c".into(), "no task of the run is its `stand`"),
            (&|s| s.tasks[0].model_hash = "c".into(), "no task of the run is its `stand`"),
            (&|s| s.protocol.episodes = 2, "it belongs to run"),
            (&|s| s.build = "3".into(), "it belongs to run"),
        ];
        for (change, reason) in others {
            let mut other = settings(0);
            change(&mut other);
            // As somebody would who wants the episodes to be of another run.
            fs::write(folder.path().join(SETTINGS), pretty(&other)).unwrap();
            let error = Journal::open(folder.path(), &other).unwrap_err();
            assert!(matches!(error, JournalError::Foreign { line: 1, .. }) && error.to_string().contains(reason), "{error}");
            let error = Journal::records(folder.path()).unwrap_err();
            assert!(matches!(error, JournalError::Foreign { line: 1, .. }), "{error}");
        }
        assert_eq!(fs::read_to_string(folder.path().join(EPISODES)).unwrap(), lines);
    }

    #[test]
    fn lines_that_a_run_cannot_have_are_refused() {
        let (folder, lines) = three_episodes();
        let run = settings(0).identity();
        let more = |record: EpisodeRecord| refusal(folder.path(), &format!("{lines}{}\n", Line::written(&record, &run)));
        assert!(
            more(record(3)).contains("line 4, belongs to another run than `run.json` beside it: it is episode 3 of a run of 3")
        );
        assert!(more(record(1)).contains("line 4, was modified: episode 1 of `stand` already exists"));
        let fatigue = MuscleCondition { fatigue: Some(Fatigue::default()), ..MuscleCondition::default() };
        let error = more(EpisodeRecord { condition: fatigue, ..record(0) });
        assert!(error.contains("no task of the run is its `stand` with muscles in the condition `fatigue`"), "{error}");
    }

    #[test]
    fn one_task_under_two_conditions_keeps_both() {
        let fatigue = MuscleCondition { fatigue: Some(Fatigue::default()), ..MuscleCondition::default() };
        let mut both = settings(0);
        both.tasks.push(TaskSettings { condition: fatigue.clone(), model_hash: "d".into(), ..both.tasks[0].clone() });
        let tired = EpisodeRecord { condition: fatigue, model_hash: "d".into(), ..record(0) };
        let folder = tempfile::tempdir().unwrap();
        let (journal, _) = Journal::open(folder.path(), &both).unwrap();
        journal.append(&tired).unwrap();
        journal.append(&record(0)).unwrap();
        drop(journal);
        let mut kept = Journal::open(folder.path(), &both).unwrap().1;
        assert_eq!(kept, [tired.clone(), record(0)]);
        both.sort(&mut kept);
        assert_eq!(kept, [record(0), tired]);
        assert_eq!(both.missing(&kept), [(0, 1), (0, 2), (1, 1), (1, 2)]);
    }

    /// Plays three episodes, as far as they are not there already, and sums up.
    fn attempt(folder: Folder) -> Result<(), JournalError> {
        let (journal, done) = Journal::open_in(folder, &settings(0))?;
        for episode in (0..3).filter(|episode| done.iter().all(|record| record.episode != *episode)) {
            journal.append(&record(episode))?;
        }
        journal.write("summary.json", "{}")
    }

    #[test]
    fn whichever_call_fails_the_run_is_continued_to_the_same_bytes() {
        let contents = |folder: &Path| [SETTINGS, EPISODES, "summary.json"].map(|name| fs::read(folder.join(name)).unwrap());
        let (undisturbed, calls) = {
            let place = tempfile::tempdir().unwrap();
            let faults = Arc::new(FailAt::never());
            attempt(Folder::open(place.path()).unwrap().with_faults(faults.clone())).unwrap();
            (contents(place.path()), faults.calls())
        };
        assert!(calls > 12, "only {calls} calls are made");
        for failure in [Failure::StorageFull, Failure::Device, Failure::Crash] {
            for call in 0..calls {
                let place = tempfile::tempdir().unwrap();
                let folder = Folder::open(place.path()).unwrap();
                let faults = Arc::new(FailAt::new(call, failure));
                let error = attempt(folder.clone().with_faults(faults)).unwrap_err();
                assert!(matches!(error, JournalError::Unusable { .. }), "{failure:?} at call {call}: {error}");
                attempt(folder).unwrap_or_else(|error| panic!("{failure:?} at call {call}: {error}"));
                assert_eq!(contents(place.path()), undisturbed, "{failure:?} at call {call}");
            }
        }
    }

    #[test]
    fn an_episode_that_could_not_be_kept_leaves_no_trace() {
        // Each append makes some calls; wherever they fail and can be repaired, the next episode is kept.
        for call in 0..12 {
            let place = tempfile::tempdir().unwrap();
            let folder = Folder::open(place.path()).unwrap();
            drop(Journal::open_in(folder.clone(), &settings(0)).unwrap());
            let faults = Arc::new(FailAt::new(call, Failure::StorageFull));
            let Ok((journal, _)) = Journal::open_in(folder.clone().with_faults(faults), &settings(0)) else { continue };
            let kept: Vec<u64> = (0..3).filter(|episode| journal.append(&record(*episode)).is_ok()).collect();
            drop(journal);
            let found: Vec<u64> = Journal::records(place.path()).unwrap().iter().map(|record| record.episode).collect();
            assert_eq!(found, kept, "call {call}");
            assert!(kept.len() >= 2, "call {call}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_read_only_file_of_results_is_not_replaced() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (journal, _) = Journal::open(folder.path(), &settings(0)).unwrap();
        let path = folder.path().join("summary.json");
        journal.write("summary.json", "mine").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        journal.write("summary.json", "yours").unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        assert!(journal.write("summary.json", "theirs").is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "yours");
    }
}

//! The history of edits of a source: `.msk/weights.jsonl` beside the file, one line a transaction, from which edits are taken back.

use crate::store::{Held, Store, StoreError};
use msk_compiler::weights::{Change, written};
use serde_json::{Value, json};
use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Why a history cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum HistoryError {
    /// The operating system refused.
    #[error("cannot use the history `{}`", path.display())]
    System {
        /// The history.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// A line of it is something else.
    #[error("line {line} of `{}` is not a change: {reason}", path.display())]
    Damaged {
        /// The history.
        path: PathBuf,
        /// From 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// The source cannot be replaced.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Replaces a source by its edited text, with its lock held, and adds the transaction to the history. Without changes nothing
/// happens.
///
/// # Errors
/// A history or a source that cannot be written.
pub fn commit(store: &Store, held: &Held, by: &str, text: &str, changes: &[Change]) -> Result<(), HistoryError> {
    if changes.is_empty() {
        return Ok(());
    }
    // First the history: a change that is not in it could not be taken back.
    append(store.path(), by, changes)?;
    Ok(store.replace(held, text)?)
}

fn append(file: &Path, by: &str, changes: &[Change]) -> Result<(), HistoryError> {
    let path = place(file);
    let system = |source| HistoryError::System { path: path.clone(), source };
    fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).map_err(system)?;
    let time = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let line = json!({ "time": time, "file": name(file), "by": by, "changes": changes });
    let mut history = OpenOptions::new().create(true).append(true).read(true).open(&path).map_err(system)?;
    // A line that was cut short stands for a change that was not made: the text is replaced after its line is whole.
    let mut before = Vec::new();
    history.read_to_end(&mut before).map_err(system)?;
    history.set_len(whole(&before) as u64).map_err(system)?;
    // One write a line, so that two programs do not mix theirs.
    history.write_all(format!("{line}\n").as_bytes()).and_then(|()| history.sync_data()).map_err(system)
}

/// The first change of every weight of `file`.
///
/// # Errors
/// A history that cannot be read, or a line of it that is none.
pub fn first(file: &Path) -> Result<Vec<Change>, HistoryError> {
    // A link is followed, as it is when the file is changed.
    let file = fs::canonicalize(file).unwrap_or_else(|_| file.to_path_buf());
    let path = place(&file);
    let bytes = match fs::read(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        bytes => bytes.map_err(|source| HistoryError::System { path: path.clone(), source })?,
    };
    let mut first: Vec<Change> = Vec::new();
    for (number, line) in bytes[..whole(&bytes)].split_inclusive(|&byte| byte == b'\n').enumerate() {
        let broken = |reason: String| HistoryError::Damaged { path: path.clone(), line: number + 1, reason };
        let entry: Value = serde_json::from_slice(line).map_err(|error| broken(error.to_string()))?;
        if entry["file"] != name(&file).as_str() {
            continue;
        }
        for change in entry["changes"].as_array().ok_or_else(|| broken("it has no list of changes".into()))? {
            let change = read(change).ok_or_else(|| broken(format!("`{change}` is none")))?;
            if !first.iter().any(|known| known.task == change.task && known.term == change.term) {
                first.push(change);
            }
        }
    }
    Ok(first)
}

fn read(change: &Value) -> Option<Change> {
    let text = |key: &str| change[key].as_str().map(str::to_owned);
    let (from, to) = (change["from"].as_f64()?, change["to"].as_f64()?);
    // Histories of earlier versions have values only.
    let was = text("was").unwrap_or_else(|| written(from));
    Some(Change { task: text("task")?, term: text("term")?, from, to, was })
}

fn place(file: &Path) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(".msk").join("weights.jsonl")
}

fn name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// How many bytes are whole lines.
fn whole(bytes: &[u8]) -> usize {
    bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1)
}

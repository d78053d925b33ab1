//! The history of changes: `.msk/weights.jsonl` beside the file, one line a transaction.

use crate::error::{Context, Error};
use msk::compiler::weights::{Change, written};
use serde_json::{Value, json};
use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

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

/// Adds a transaction.
///
/// # Errors
/// The history cannot be written.
pub fn append(file: &Path, by: &str, changes: &[Change]) -> Result<(), Error> {
    let place = place(file);
    let cannot = || format!("cannot write the history `{}`", place.display());
    fs::create_dir_all(place.parent().unwrap_or(Path::new("."))).context(cannot)?;
    let time = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let line = json!({ "time": time, "file": name(file), "by": by, "changes": changes });
    let mut history = OpenOptions::new().create(true).append(true).read(true).open(&place).context(cannot)?;
    // A line that was cut short stands for a change that was not made: the text is replaced after its line is whole.
    let mut before = Vec::new();
    history.read_to_end(&mut before).context(cannot)?;
    history.set_len(whole(&before) as u64).context(cannot)?;
    // One write a line, so that two programs do not mix theirs.
    history.write_all(format!("{line}\n").as_bytes()).context(cannot)
}

/// The first change of every weight of `file`.
///
/// # Errors
/// A history that cannot be read, or a line of it that is none.
pub fn first(file: &Path) -> Result<Vec<Change>, Error> {
    let place = place(file);
    let text = match fs::read(&place) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        text => text.context(|| format!("cannot read the history `{}`", place.display()))?,
    };
    let mut first: Vec<Change> = Vec::new();
    for (number, line) in text[..whole(&text)].split_inclusive(|&byte| byte == b'\n').enumerate() {
        let broken = || format!("line {} of `{}` is not a change", number + 1, place.display());
        let entry: Value = serde_json::from_slice(line).context(broken)?;
        if entry["file"] != name(file).as_str() {
            continue;
        }
        for change in entry["changes"].as_array().ok_or_else(|| Error::new(broken()))? {
            let text = |key: &str| change[key].as_str().map(str::to_owned).ok_or_else(|| Error::new(broken()));
            let number = |key: &str| change[key].as_f64().ok_or_else(|| Error::new(broken()));
            let (from, to) = (number("from")?, number("to")?);
            // Histories of earlier versions have values only.
            let was = change["was"].as_str().map_or_else(|| written(from), str::to_owned);
            let change = Change { task: text("task")?, term: text("term")?, from, to, was };
            if !first.iter().any(|known| known.task == change.task && known.term == change.term) {
                first.push(change);
            }
        }
    }
    Ok(first)
}

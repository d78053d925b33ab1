//! The history of a file: a line of JSON for each version, in order, each with the whole text.

use super::{StoreError, Version};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Who made a change that did not go through the store: an editor, for example.
pub const OUTSIDE: &str = "outside";

/// A change.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Seconds since 1970.
    pub time: u64,
    /// What made it.
    pub by: String,
    /// The version before it; none if there was no file.
    pub before: Option<String>,
    /// The version that it made.
    pub version: String,
    /// That version, whole: any may be gone back to.
    pub text: String,
}

impl Entry {
    pub(super) fn now(by: &str, before: Option<&Version>, next: &Version) -> Self {
        let time = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        let before = before.map(|version| version.hash.clone());
        Self { time, by: by.into(), before, version: next.hash.clone(), text: next.text.clone() }
    }

    /// Strings and a number always have a JSON form.
    pub(super) fn line(&self) -> String {
        serde_json::to_string(self).unwrap_or_default() + "\n"
    }
}

/// The last whole line of a history; and, if a line after it was cut short, how many bytes are whole. Only the end is read.
pub(super) fn last(path: &Path) -> Result<(Option<Entry>, Option<u64>), StoreError> {
    let cannot = |source| StoreError::System { action: "read", path: path.into(), source };
    let mut file = match File::open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok((None, None)),
        file => file.map_err(cannot)?,
    };
    let size = file.metadata().map_err(cannot)?.len();
    let mut tail: u64 = 4096;
    loop {
        let begin = size.saturating_sub(tail);
        file.seek(SeekFrom::Start(begin)).map_err(cannot)?;
        let mut bytes = Vec::new();
        file.by_ref().take(size - begin).read_to_end(&mut bytes).map_err(cannot)?;
        let ends: Vec<usize> =
            bytes.iter().enumerate().rev().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at).take(2).collect();
        let line = match ends.as_slice() {
            [end, before] => &bytes[before + 1..=*end],
            [end] if begin == 0 => &bytes[..=*end],
            [] if begin == 0 => return Ok((None, (size > 0).then_some(0))),
            _ => {
                tail = tail.saturating_mul(4);
                continue;
            }
        };
        let whole = begin + ends[0] as u64 + 1;
        let entry = serde_json::from_slice(line).map_err(|error| StoreError::History {
            path: path.into(),
            line: "its last line".into(),
            reason: error.to_string(),
        })?;
        return Ok((Some(entry), (whole < size).then_some(whole)));
    }
}

/// The lines of a history; and, if the last one was cut short, how many bytes are whole.
pub(super) fn read(path: &Path) -> Result<(Vec<Entry>, Option<u64>), StoreError> {
    let bytes = match fs::read(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok((Vec::new(), None)),
        bytes => bytes.map_err(|source| StoreError::System { action: "read", path: path.into(), source })?,
    };
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let mut entries = Vec::new();
    for (index, line) in bytes[..whole].split_inclusive(|&byte| byte == b'\n').enumerate() {
        let entry = serde_json::from_slice(line).map_err(|error| StoreError::History {
            path: path.into(),
            line: format!("line {}", index + 1),
            reason: error.to_string(),
        })?;
        entries.push(entry);
    }
    Ok((entries, (whole < bytes.len()).then_some(whole as u64)))
}

//! The history of a file: lines of JSON, for each change one that begins it, with the whole text, and one that records what
//! became of it.

use super::{StoreError, Version};
use msk_compiler::weights::Change;
use msk_storage::Log;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Who made a change that did not go through the store: an editor, for example.
pub const OUTSIDE: &str = "outside";

/// Largest history that is read whole, bytes.
pub(super) const LARGEST: u64 = 1 << 30;
/// Longest end of a history that is read for its last two lines, bytes: two texts of the largest size, escaped.
const LONGEST_END: u64 = 1 << 24;

/// A change that was made.
#[derive(Debug, Clone, PartialEq)]
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
    /// The weights of the source that it changed, if they are known.
    pub changes: Vec<Change>,
}

/// The line that begins a change.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Begun {
    time: u64,
    by: String,
    /// The version that the changes before came to; none if there was no file.
    before: Option<String>,
    /// What the file held instead, if somebody had changed it past the store.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    found: Option<String>,
    pub version: String,
    text: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    changes: Vec<Change>,
}

/// The line that records what became of the change before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum End {
    /// The file was replaced.
    Made,
    /// The file stayed as it was.
    Undone,
}

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Line {
    Begun(Begun),
    End { end: End, version: String },
}

/// The end of a history: its last change, and what became of it if that is written down.
#[derive(Debug)]
pub(super) struct Last {
    begun: Begun,
    end: Option<End>,
}

impl Begun {
    /// The beginning of a change from the `present` file, after `last`, to `next`.
    pub fn now(by: &str, last: Option<&Last>, present: Option<&Version>, next: &Version, changes: &[Change]) -> Self {
        let known = last.and_then(Last::known);
        let hash = present.map(|version| &version.hash);
        let found = present.filter(|_| known.as_ref() != hash).map(|version| version.text.clone());
        Self {
            time: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()),
            by: by.into(),
            // A file that was removed is not what the changes before came to.
            before: known.filter(|_| present.is_some()),
            found,
            version: next.hash.clone(),
            text: next.text.clone(),
            changes: changes.to_vec(),
        }
    }

    /// The version of the file when the change was begun.
    fn base(&self) -> Option<String> {
        self.found.as_ref().map(|found| Version::of(found.as_str()).hash).or_else(|| self.before.clone())
    }

    /// Whether a change of which nothing more is written down was made. Its program died, so no caller was promised that it was:
    /// a file that still is what it was before has not been replaced.
    fn was_made(&self, present: Option<&Version>) -> bool {
        self.base().as_ref() != present.map(|version| &version.hash)
    }

    /// The changes that it stands for: what was found, and its own.
    fn entries(self) -> impl Iterator<Item = Entry> {
        let base = self.base();
        let (time, before) = (self.time, self.before);
        let outside = self.found.zip(base.clone()).map(|(text, version)| Entry {
            time,
            by: OUTSIDE.into(),
            before,
            version,
            text,
            changes: Vec::new(),
        });
        let own = Entry { time, by: self.by, before: base, version: self.version, text: self.text, changes: self.changes };
        outside.into_iter().chain([own])
    }
}

impl Last {
    /// Writes down what became of the last change, if its program did not live to do so.
    pub fn settle(&mut self, log: &mut Log, present: Option<&Version>) -> Result<(), StoreError> {
        if self.end.is_none() {
            let end = if self.begun.was_made(present) { End::Made } else { End::Undone };
            self::end(log, &self.begun.version, end)?;
            self.end = Some(end);
        }
        Ok(())
    }

    /// The version that all changes together came to.
    fn known(&self) -> Option<String> {
        if self.end == Some(End::Undone) { self.begun.before.clone() } else { Some(self.begun.version.clone()) }
    }
}

/// Begins a change.
pub(super) fn begin(log: &mut Log, begun: Begun) -> Result<(), StoreError> {
    append(log, &Line::Begun(begun))
}

/// Writes down what became of a change.
pub(super) fn end(log: &mut Log, version: &str, end: End) -> Result<(), StoreError> {
    append(log, &Line::End { end, version: version.into() })
}

fn append(log: &mut Log, line: &Line) -> Result<(), StoreError> {
    // Strings and numbers always have a JSON form.
    Ok(log.append(serde_json::to_string(line).unwrap_or_default().as_bytes())?)
}

/// The end of a history.
pub(super) fn last(log: &mut Log) -> Result<Option<Last>, StoreError> {
    let path = log.path();
    let damaged = |reason: String| StoreError::History { path: path.clone(), line: "its end".into(), reason };
    let bytes = log.last_lines(2, LONGEST_END)?;
    let mut lines = bytes.split_inclusive(|&byte| byte == b'\n').rev().map(|line| parse(line).map_err(damaged));
    let end = match lines.next().transpose()? {
        None => return Ok(None),
        Some(Line::Begun(begun)) => return Ok(Some(Last { begun, end: None })),
        Some(Line::End { end, version }) => (end, version),
    };
    match lines.next().transpose()? {
        Some(Line::Begun(begun)) if begun.version == end.1 => Ok(Some(Last { begun, end: Some(end.0) })),
        _ => Err(damaged(STRAY.into())),
    }
}

/// All changes of a history that were made, in order.
pub(super) fn read(bytes: &[u8], path: &Path, present: Option<&Version>) -> Result<Vec<Entry>, StoreError> {
    let mut entries = Vec::new();
    let mut open: Option<Begun> = None;
    for (index, line) in Log::whole_lines(bytes).split_inclusive(|&byte| byte == b'\n').enumerate() {
        let damaged = |reason| StoreError::History { path: path.into(), line: format!("line {}", index + 1), reason };
        let made = match (parse(line).map_err(damaged)?, open.take()) {
            (Line::Begun(next), before) => {
                open = Some(next);
                before
            }
            (Line::End { end, version }, Some(begun)) if begun.version == version => Some(begun).filter(|_| end == End::Made),
            (Line::End { .. }, _) => return Err(damaged(STRAY.into())),
        };
        entries.extend(made.into_iter().flat_map(Begun::entries));
    }
    let made = open.filter(|begun| begun.was_made(present));
    entries.extend(made.into_iter().flat_map(Begun::entries));
    Ok(entries)
}

const STRAY: &str = "the end of a change that was not started";

fn parse(line: &[u8]) -> Result<Line, String> {
    let line = serde_json::from_slice(line).map_err(|error| error.to_string())?;
    match &line {
        Line::Begun(begun) if Version::of(begun.text.as_str()).hash != begun.version => {
            Err(format!("its text is not version {}", begun.version))
        }
        _ => Ok(line),
    }
}

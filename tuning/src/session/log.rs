//! The log of a session: a line of JSON for each round.

use crate::reasoner::Proposal;
use crate::statistics::Statistics;
use serde::{Deserialize, Serialize};
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

const ROUNDS: &str = "rounds.jsonl";

/// A round that is over.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Round {
    /// Which, from 1.
    pub round: u64,
    /// When it ended, seconds since 1970.
    pub time: u64,
    /// Its first episode, and the one after its last.
    pub episodes: [u64; 2],
    /// Who was asked.
    pub reasoner: String,
    /// What it came to; larger is better.
    pub score: f64,
    /// The weights in force at its end, of all terms.
    pub weights: Vec<(String, f64)>,
    /// The version of the weights file that they are of.
    pub version: String,
    /// What its episodes said.
    pub statistics: Statistics,
    /// What was asked, in words; empty if nothing was asked.
    pub prompt: String,
    /// What was proposed.
    pub proposal: Option<Proposal>,
    /// What the rules of change made of it: the weights of all terms.
    pub applied: Option<Vec<(String, f64)>>,
    /// The weights file with them, if they differ from those before.
    pub next: Option<Applied>,
    /// Why nothing was applied, if nothing could be.
    pub rejected: Option<String>,
}

/// A weights file that is to follow a version.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Applied {
    /// The version.
    pub before: String,
    /// The text.
    pub text: String,
}

/// Why the log cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The operating system refused.
    #[error("cannot use the log `{}`", path.display())]
    System {
        /// The log.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// A line of it is damaged.
    #[error("line {line} of the log `{}` is damaged: {reason}", path.display())]
    Damaged {
        /// The log.
        path: PathBuf,
        /// From 1.
        line: usize,
        /// What the parser says.
        reason: String,
    },
}

/// An open log.
pub(super) struct Log {
    path: PathBuf,
    file: File,
    rounds: Vec<Round>,
}

/// Seconds since 1970.
pub(super) fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

impl Log {
    /// The log in `folder` with the rounds that it holds. A last line that was cut short is dropped: its round is judged again.
    pub fn open(folder: &Path) -> Result<(Self, Vec<Round>), LogError> {
        let path = folder.join(ROUNDS);
        let system = |source| LogError::System { path: path.clone(), source };
        let bytes = match fs::read(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            bytes => bytes.map_err(system)?,
        };
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        let mut rounds = Vec::new();
        for (index, line) in bytes[..whole].split_inclusive(|&byte| byte == b'\n').enumerate() {
            let round = serde_json::from_slice(line).map_err(|error| LogError::Damaged {
                path: path.clone(),
                line: index + 1,
                reason: error.to_string(),
            })?;
            rounds.push(round);
        }
        let file = OpenOptions::new().create(true).append(true).open(&path).map_err(system)?;
        file.set_len(whole as u64).map_err(system)?;
        Ok((Self { path, file, rounds: rounds.clone() }, rounds))
    }

    pub fn rounds(&self) -> &[Round] {
        &self.rounds
    }

    /// Adds a round, and waits until it is on the disk.
    pub fn append(&mut self, round: &Round) -> Result<(), LogError> {
        // Strings and finite numbers always have a JSON form.
        let line = serde_json::to_string(round).unwrap_or_default() + "\n";
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|source| LogError::System { path: self.path.clone(), source })?;
        self.rounds.push(round.clone());
        Ok(())
    }
}

//! The log of a session: a line of JSON for each round.

use crate::reasoner::Proposal;
use crate::statistics::Statistics;
use msk_storage::{Folder, StorageError};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

const ROUNDS: &str = "rounds.jsonl";
/// Largest log that is read, bytes.
const LARGEST: u64 = 1 << 30;

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
    /// The statistics of its episodes.
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
    /// It cannot be read or written.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// A line of it is damaged.
    #[error("line {line} of the log `{}` is damaged: {reason}", path.display())]
    Damaged {
        /// The log.
        path: PathBuf,
        /// From 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
}

/// An open log.
pub(super) struct Log {
    log: msk_storage::Log,
    rounds: Vec<Round>,
}

/// Seconds since 1970.
pub(super) fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

impl Log {
    /// The log in `folder` with the rounds that it holds. The journal's lock keeps other sessions out. A last line that was cut
    /// short is none: its round is judged again.
    pub fn open(folder: &Folder) -> Result<Self, LogError> {
        let mut log = folder.log(ROUNDS)?;
        let bytes = log.read(LARGEST)?;
        let mut rounds: Vec<Round> = Vec::new();
        for (index, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
            let damaged = |reason: String| LogError::Damaged { path: log.path(), line: index + 1, reason };
            let round: Round = serde_json::from_slice(line).map_err(|error| damaged(error.to_string()))?;
            let [first, end] = round.episodes;
            let begins_at = rounds.last().map_or(0, |before| before.episodes[1]);
            if round.round != index as u64 + 1 || first != begins_at || end < first {
                let found = format!("round {} of the episodes {first}..{end}", round.round);
                return Err(damaged(format!("expected round {} from episode {begins_at}, found {found}", index + 1)));
            }
            rounds.push(round);
        }
        Ok(Self { log, rounds })
    }

    pub fn rounds(&self) -> &[Round] {
        &self.rounds
    }

    /// Adds a round, and waits until it is on the disk. If it fails the log is what it was.
    pub fn append(&mut self, round: &Round) -> Result<(), LogError> {
        // Strings and finite numbers always have a JSON form.
        self.log.append(serde_json::to_string(round).unwrap_or_default().as_bytes())?;
        self.rounds.push(round.clone());
        Ok(())
    }
}

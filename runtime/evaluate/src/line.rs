//! A line of the journal.
//!
//! It is the record of an episode as a JSON object that ends with three further entries:
//!
//! ```text
//! {"task":"stand", ..., "run":"0123456789abcdef","checksum":"fedcba9876543210","wall_time":0.25}
//! ```
//!
//! * `run`: the [identity](super::RunSettings::identity) of the run that the episode belongs to.
//! * `checksum`: the first 16 hexadecimal digits of the SHA-256 of all bytes of the line before `,"checksum"`.
//! * `wall_time`: outside of the checksum, so that all before it has the same bytes whenever the episode is played.
//!
//! The checksum notices damage and edits. It is no signature: who wants to deceive can compute it.

use super::EpisodeRecord;
use super::journal::json;
use msk_program::digest::hexadecimal;
use sha2::{Digest, Sha256};

const RUN: &str = ",\"run\":\"";
const CHECKSUM: &str = ",\"checksum\":\"";
const WALL_TIME: &str = ",\"wall_time\":";

/// What a line holds.
pub(super) struct Line {
    pub record: EpisodeRecord,
    /// Identity of the run.
    pub run: String,
}

/// Why a line is not one of a journal.
#[derive(Debug, thiserror::Error)]
pub(super) enum LineError {
    #[error("it has no checksum")]
    Bare,
    #[error("its checksum does not match its content")]
    Changed,
    #[error("it is not UTF-8 text")]
    Text(#[from] core::str::Utf8Error),
    #[error("{0}")]
    Json(#[from] serde_json::Error),
}

#[derive(serde::Deserialize)]
struct Origin {
    run: String,
}

impl Line {
    /// The line of an episode of the run with identity `run`, without the line end.
    pub fn written(record: &EpisodeRecord, run: &str) -> String {
        let text = json(record);
        // The wall time is the last entry of a record, and its number holds no quotes.
        let (content, time) = text.rsplit_once(WALL_TIME).unwrap_or((&text, "0.0}"));
        let content = format!("{content}{RUN}{run}\"");
        let checksum = hex(content.as_bytes());
        format!("{content}{CHECKSUM}{checksum}\"{WALL_TIME}{time}")
    }

    /// Reads a line, with or without its end.
    ///
    /// # Errors
    /// A line that was not written by [`Line::written`].
    pub fn read(line: &[u8]) -> Result<Self, LineError> {
        let text = core::str::from_utf8(line)?;
        // The error of invalid JSON is more informative than a missing checksum.
        let record = serde_json::from_str(text)?;
        let (content, _) = text.rsplit_once(WALL_TIME).ok_or(LineError::Bare)?;
        let (content, checksum) = content.rsplit_once(CHECKSUM).ok_or(LineError::Bare)?;
        if checksum.strip_suffix('"') != Some(hex(content.as_bytes()).as_str()) {
            return Err(LineError::Changed);
        }
        let Origin { run } = serde_json::from_str(text)?;
        Ok(Self { record, run })
    }
}

/// The first 64 bits of the SHA-256 of `bytes`, in hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes)[..8])
}

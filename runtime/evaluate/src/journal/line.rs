//! A line of the journal.
//!
//! It is the record of an episode as a JSON object that ends with two further entries:
//!
//! ```text
//! {"task":"stand", ..., "run":"0123456789abcdef","checksum":"fedcba9876543210"}
//! ```
//!
//! * `run`: the [identity](crate::RunSettings::identity) of the run that the episode belongs to.
//! * `checksum`: the first 16 hexadecimal digits of the SHA-256 of all bytes of the line before `,"checksum"`.
//!
//! The checksum notices damage and edits. It is no signature: who wants to deceive can compute it. Earlier programs wrote a number,
//! `wall_time`, behind the checksum; such lines are read, and nothing else may stand there.

use super::json;
use crate::EpisodeRecord;
use msk_program::digest::hexadecimal;
use sha2::{Digest, Sha256};

const RUN: &str = ",\"run\":\"";
const CHECKSUM: &str = ",\"checksum\":\"";
const WALL_TIME: &str = "\",\"wall_time\":";

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

impl Line {
    /// The line of an episode of the run with identity `run`, without the line end.
    pub fn written(record: &EpisodeRecord, run: &str) -> String {
        let text = json(record);
        let content = format!("{}{RUN}{run}\"", text.strip_suffix('}').unwrap_or(&text));
        let checksum = hex(content.as_bytes());
        format!("{content}{CHECKSUM}{checksum}\"}}")
    }

    /// Reads a line without its end.
    ///
    /// # Errors
    /// A line that was not written by [`Line::written`].
    pub fn read(line: &[u8]) -> Result<Self, LineError> {
        let text = core::str::from_utf8(line)?;
        // The error of invalid JSON is more informative than a missing checksum.
        let record = serde_json::from_str(text)?;
        let (content, rest) = text.rsplit_once(CHECKSUM).ok_or(LineError::Bare)?;
        let checksum = match rest.split_once(WALL_TIME) {
            Some((checksum, time)) if time.strip_suffix('}').is_some_and(|time| time.parse::<f64>().is_ok()) => checksum,
            Some(_) => return Err(LineError::Changed),
            None => rest.strip_suffix("\"}").unwrap_or(rest),
        };
        if checksum != hex(content.as_bytes()) {
            return Err(LineError::Changed);
        }
        let run = content.rsplit_once(RUN).and_then(|(_, run)| run.strip_suffix('"'));
        Ok(Self { record, run: run.unwrap_or_default().to_owned() })
    }
}

/// The first 64 bits of the SHA-256 of `bytes`, in hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes)[..8])
}

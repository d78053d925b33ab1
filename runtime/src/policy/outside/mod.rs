//! Policies from outside: a program that answers message by message, recorded actions, and networks.

mod message;
mod network;
mod pipes;
mod process;
mod replay;

pub(super) use message::Encoding;
pub(crate) use network::{Evaluation, NetworkContent};
pub(super) use network::{Network, Weights};
pub(super) use process::Process;
pub(super) use replay::Replay;

use super::PolicyError;
use msk_storage::read_file;
use sha2::{Digest, Sha256};
use std::path::Path;

/// Largest file of actions or of weights, bytes.
const LARGEST: u64 = 1 << 32;

/// The bytes of a file, and eight hexadecimal digits that tell it from others of its name.
fn source_file(path: &str) -> Result<(Vec<u8>, String), PolicyError> {
    let bytes = read_file(Path::new(path), LARGEST)
        .map_err(|error| PolicyError::Unreadable { path: path.to_owned(), reason: error.to_string() })?;
    let digest = Sha256::digest(&bytes).iter().take(4).map(|byte| format!("{byte:02x}")).collect();
    Ok((bytes, digest))
}

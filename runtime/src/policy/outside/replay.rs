//! Recorded actions, played again: the rows of a NumPy array.

use crate::inspect::Excitations;
use crate::policy::{Policy, PolicyContext, PolicyError};
use msk_storage::read_file;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest file of actions, bytes.
const LARGEST: u64 = 1 << 32;

/// Row i of an array is the action of step i, in every episode.
pub(crate) struct Replay {
    name: String,
    path: PathBuf,
    bytes: Arc<[u8]>,
    rows: Option<Excitations>,
}

impl Replay {
    /// Reads a file: its path, its bytes, and what tells them from those of other files.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(path: &str) -> Result<(PathBuf, Arc<[u8]>, String), PolicyError> {
        let bytes = read_file(Path::new(path), LARGEST)
            .map_err(|error| PolicyError::Unreadable { path: path.to_owned(), reason: error.to_string() })?;
        let digest: String = Sha256::digest(&bytes).iter().take(4).map(|byte| format!("{byte:02x}")).collect();
        Ok((path.into(), bytes.into(), digest))
    }

    pub fn new(name: &str, path: &Path, bytes: Arc<[u8]>) -> Self {
        Self { name: name.to_owned(), path: path.into(), bytes, rows: None }
    }

    fn unable(&self, reason: impl Into<String>) -> PolicyError {
        PolicyError::Unable { policy: self.name.clone(), reason: format!("`{}` {}", self.path.display(), reason.into()) }
    }
}

impl Policy for Replay {
    fn name(&self) -> &str {
        &self.name
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        let width = context.body.muscles.len();
        let rows = Excitations::from_npy(&self.bytes, width).map_err(|error| self.unable(error.to_string()))?;
        self.rows = Some(rows);
        Ok(())
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        let rows = self.rows.as_ref().ok_or_else(|| self.unable("has not been reset"))?;
        let row = usize::try_from(context.step).unwrap_or(usize::MAX);
        if row >= rows.rows() {
            return Err(self.unable(format!("holds {} actions, and the episode goes on", rows.rows())));
        }
        action.copy_from_slice(rows.row(row));
        Ok(())
    }
}

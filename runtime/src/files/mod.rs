//! Texts and models: from the machine or from the caller, and what they were when they were read.

#[cfg(feature = "system")]
mod disk;
mod fingerprints;

#[cfg(feature = "system")]
pub use disk::{FileLoader, load_error};
pub(crate) use fingerprints::{Fingerprints, Recorder};

use msk_program::files::{LoadError, Loader, Piece};
use std::path::{Path, PathBuf};

/// Another text in place of that of one file, which need not exist; all others are read as they are.
pub struct WithText<'a> {
    /// The file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Reads the others.
    pub others: &'a dyn Loader,
}

impl Loader for WithText<'_> {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        if path == self.path { Ok(self.text.clone()) } else { self.others.load(path) }
    }

    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        self.others.load_bytes(path, limit)
    }

    fn side_by_side(&self, work: Vec<Piece<'_>>) {
        self.others.side_by_side(work);
    }
}

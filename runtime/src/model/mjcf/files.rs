//! The files that a model is read from: each is bounded, and is remembered, so that a change on disk can be noticed.

use super::error::ModelError;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime};

/// One file may hold this many bytes.
const LONGEST_FILE: u64 = 64 << 20;

/// A file that was changed this shortly before it was read may change again without another time of change.
const CLOCK_TICK: Duration = Duration::from_secs(2);

/// The files that a model was read from, with what each was.
#[derive(Debug, Default)]
pub struct ModelFiles(Mutex<BTreeMap<PathBuf, Fingerprint>>);

/// What a file was when it was read.
#[derive(Debug, Clone, PartialEq)]
struct Fingerprint {
    /// Length in bytes and time of the last change; `None` of a file that could not be looked at.
    stamp: Option<(u64, SystemTime)>,
    /// Hash of the content; `None` of a file that could not be read.
    digest: Option<[u8; 32]>,
    /// Whether a later change must show in the stamp.
    is_settled: bool,
}

impl ModelFiles {
    /// Reads a whole file of bounded size; devices and pipes are refused, because they may never end.
    pub(super) fn read(&self, path: &Path) -> Result<Vec<u8>, ModelError> {
        // Before the content: a change while it is read shows as a difference.
        let stamp = stamp(path);
        let bytes = read_bytes(path);
        let is_settled = stamp.is_some_and(|(_, modified)| modified + CLOCK_TICK < SystemTime::now());
        let digest = bytes.as_ref().ok().map(|bytes| Sha256::digest(bytes).into());
        // A thread that panicked here left the map whole.
        let mut files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        files.insert(path.to_path_buf(), Fingerprint { stamp, digest, is_settled });
        bytes
    }

    /// Whether every file still has the content that was read, or can still not be read.
    pub fn are_unchanged(&self) -> bool {
        let files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        files.iter().all(|(path, known)| {
            let stamp = stamp(path);
            if stamp != known.stamp {
                return false;
            }
            known.is_settled || read_bytes(path).ok().map(|bytes| Sha256::digest(bytes).into()) == known.digest
        })
    }
}

fn stamp(path: &Path) -> Option<(u64, SystemTime)> {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.len(), metadata.modified().ok()?))
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, ModelError> {
    let failed = |source| ModelError::Read { path: path.to_path_buf(), source };
    let wrong = |reason: &str| ModelError::File { path: path.to_path_buf(), reason: reason.to_owned() };
    let metadata = std::fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(wrong("not a regular file"));
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(failed)?;
    file.take(LONGEST_FILE + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LONGEST_FILE {
        return Err(wrong("larger than 64 MiB"));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_noticed_whatever_its_time_and_length() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        std::fs::write(&path, "one").unwrap();
        let files = ModelFiles::default();
        assert_eq!(files.read(&path).unwrap(), b"one");
        assert!(files.are_unchanged());
        // Of the same length, within one tick of the file system's clock.
        let modified = std::fs::metadata(&path).unwrap().modified().unwrap();
        std::fs::write(&path, "two").unwrap();
        std::fs::File::options().write(true).open(&path).unwrap().set_modified(modified).unwrap();
        assert!(!files.are_unchanged());
        files.read(&path).unwrap();
        assert!(files.are_unchanged());
        std::fs::remove_file(&path).unwrap();
        assert!(!files.are_unchanged());
    }

    #[test]
    fn a_file_that_appears_is_a_change() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        let files = ModelFiles::default();
        assert!(files.read(&path).is_err());
        assert!(files.are_unchanged());
        std::fs::write(&path, "one").unwrap();
        assert!(!files.are_unchanged());
    }
}

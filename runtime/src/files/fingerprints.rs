//! What files were when they were read, so that a change can be noticed.

use msk_physics::model::ModelFiles;
use sha2::{Digest, Sha256};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// A file that was changed this shortly before it was read may change again without another time of change.
const CLOCK_TICK: Duration = Duration::from_secs(2);

/// What a file was when it was read.
#[derive(Debug, Clone, PartialEq)]
struct Fingerprint {
    /// Length in bytes and time of the last change; `None` of a file that could not be looked at.
    stamp: Option<(u64, SystemTime)>,
    /// Hash of the content; `None` of a file that could not be read.
    digest: Option<[u8; 32]>,
    /// The most bytes that were read of it.
    limit: u64,
    /// Whether a later change must show in the stamp.
    is_settled: bool,
}

/// The files that a model was read from, with what each was.
#[derive(Debug, Default)]
pub(crate) struct Fingerprints(BTreeMap<PathBuf, Fingerprint>);

impl Fingerprints {
    /// Whether every file still has the content that was read, or can still not be read.
    pub fn are_unchanged(&self, files: &dyn ModelFiles) -> bool {
        self.0.iter().all(|(path, known)| {
            files.stamp(path) == known.stamp && (known.is_settled || digest(&files.read(path, known.limit)) == known.digest)
        })
    }
}

/// Reads files and takes their fingerprints.
#[derive(Debug)]
pub(crate) struct Recorder<'a> {
    files: &'a dyn ModelFiles,
    read: RefCell<Fingerprints>,
}

impl<'a> Recorder<'a> {
    /// Reads `files`.
    pub fn new(files: &'a dyn ModelFiles) -> Self {
        Self { files, read: RefCell::default() }
    }

    /// What was read, or could not be read.
    pub fn into_fingerprints(self) -> Fingerprints {
        self.read.into_inner()
    }
}

impl ModelFiles for Recorder<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Option<Vec<u8>>, String> {
        // Before the content: a change while it is read shows as a difference.
        let stamp = self.files.stamp(path);
        let bytes = self.files.read(path, limit);
        let is_settled = stamp.is_some_and(|(_, modified)| modified + CLOCK_TICK < SystemTime::now());
        let fingerprint = Fingerprint { stamp, digest: digest(&bytes), limit, is_settled };
        self.read.borrow_mut().0.insert(path.to_path_buf(), fingerprint);
        bytes
    }

    fn stamp(&self, path: &Path) -> Option<(u64, SystemTime)> {
        self.files.stamp(path)
    }
}

fn digest(bytes: &Result<Option<Vec<u8>>, String>) -> Option<[u8; 32]> {
    let bytes = bytes.as_ref().ok()?.as_ref()?;
    Some(Sha256::digest(bytes).into())
}

#[cfg(test)]
#[cfg(feature = "system")]
mod tests {
    use super::*;
    use msk_physics::model::DiskFiles;

    fn read(path: &Path) -> (Option<Vec<u8>>, Fingerprints) {
        let recorder = Recorder::new(&DiskFiles);
        let bytes = recorder.read(path, 100).unwrap();
        (bytes, recorder.into_fingerprints())
    }

    #[test]
    fn a_change_is_noticed_whatever_its_time_and_length() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        std::fs::write(&path, "one").unwrap();
        let (bytes, files) = read(&path);
        assert_eq!(bytes.unwrap(), b"one");
        assert!(files.are_unchanged(&DiskFiles));
        // Of the same length, within one tick of the file system's clock.
        let modified = std::fs::metadata(&path).unwrap().modified().unwrap();
        std::fs::write(&path, "two").unwrap();
        std::fs::File::options().write(true).open(&path).unwrap().set_modified(modified).unwrap();
        assert!(!files.are_unchanged(&DiskFiles));
        let (_, files) = read(&path);
        assert!(files.are_unchanged(&DiskFiles));
        std::fs::remove_file(&path).unwrap();
        assert!(!files.are_unchanged(&DiskFiles));
    }

    #[test]
    fn a_file_that_appears_is_a_change() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        let (bytes, files) = read(&path);
        assert_eq!(bytes, None);
        assert!(files.are_unchanged(&DiskFiles));
        std::fs::write(&path, "one").unwrap();
        assert!(!files.are_unchanged(&DiskFiles));
    }

    /// Files that tell nothing but their content.
    #[derive(Debug)]
    struct Contents(&'static str);

    impl ModelFiles for Contents {
        fn read(&self, _: &Path, _: u64) -> Result<Option<Vec<u8>>, String> {
            Ok(Some(self.0.as_bytes().to_vec()))
        }
    }

    #[test]
    fn without_stamps_contents_are_compared() {
        let (one, two) = (Contents("one"), Contents("two"));
        let recorder = Recorder::new(&one);
        recorder.read(Path::new("a.xml"), 100).unwrap();
        let files = recorder.into_fingerprints();
        assert!(files.are_unchanged(&one));
        assert!(!files.are_unchanged(&two));
    }
}

//! Texts from the file system.

use crate::bodies;
use msk_program::files::{LARGEST_FILE, LoadError, Loader, Piece};
use msk_storage::{StorageError, read_file, read_text_file};
use rayon::prelude::*;
use std::io::ErrorKind;
use std::path::Path;

/// Reads texts from the file system, and those embedded in the program.
#[derive(Debug, Clone, Copy, Default)]
pub struct FileLoader;

impl Loader for FileLoader {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        match bodies::text(path) {
            Some(text) => Ok(text),
            None => read_text_file(path, LARGEST_FILE).map_err(|error| load_error(path, LARGEST_FILE, &error)),
        }
    }

    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        read_file(path, limit).map_err(|error| load_error(path, limit, &error))
    }

    fn side_by_side(&self, work: Vec<Piece<'_>>) {
        work.into_par_iter().for_each(|piece| piece());
    }
}

/// Why a text cannot be had, in the words of the compiler.
pub fn load_error(path: &Path, limit: u64, error: &StorageError) -> LoadError {
    match error {
        StorageError::TooLarge { .. } => LoadError::TooLarge { path: path.into(), limit },
        StorageError::NotText { .. } => LoadError::NotText(path.into()),
        other if other.kind() == Some(ErrorKind::NotFound) => LoadError::Missing(path.into()),
        other => LoadError::Unreadable { path: path.into(), reason: other.reason() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_cannot_be_read_are_distinguished() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, content: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            FileLoader.load(&path)
        };
        assert_eq!(file("good.msk", b"task"), Ok("task".into()));
        assert!(matches!(file("binary.msk", &[0xff, 0xfe]), Err(LoadError::NotText(_))));
        let limit = usize::try_from(LARGEST_FILE).unwrap();
        assert!(matches!(file("large.msk", &vec![b' '; limit + 1]), Err(LoadError::TooLarge { .. })));
        assert!(file("largest.msk", &vec![b' '; limit]).is_ok());
        assert!(matches!(FileLoader.load(&folder.path().join("none.msk")), Err(LoadError::Missing(_))));
        assert!(matches!(FileLoader.load(folder.path()), Err(LoadError::Unreadable { .. })));
    }
}

//! Files of lines, read one line after the other.

use crate::{Folder, StorageError, regular};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// The whole lines of a file, which may be growing: bytes after the last line end are left out, as [`Log::whole_lines`](crate::Log)
/// does. Memory is that of one line.
#[derive(Debug)]
pub struct Lines {
    path: PathBuf,
    file: BufReader<cap_std::fs::File>,
    /// Most bytes of a line.
    limit: u64,
    /// After an error there is nothing more.
    over: bool,
}

impl Folder {
    /// The lines of a regular file, each of at most `limit` bytes; `None` if there is no file.
    ///
    /// # Errors
    /// A path that leads out, something other than a regular file, or a refusal of the operating system.
    pub fn lines(&self, path: &Path, limit: u64) -> Result<Option<Lines>, StorageError> {
        let file = self.open_for_reading(path)?;
        let lines = |file| Lines { path: self.path().join(path), file: BufReader::new(file), limit, over: false };
        file.map(|file| {
            let metadata = file.metadata().map_err(|source| self.cannot("read", path, source))?;
            regular::regular(&metadata, &self.path().join(path))?;
            Ok(lines(file))
        })
        .transpose()
    }
}

impl Iterator for Lines {
    type Item = Result<Vec<u8>, StorageError>;

    /// The next line, without its end.
    fn next(&mut self) -> Option<Self::Item> {
        if self.over {
            return None;
        }
        let mut line = Vec::new();
        // One byte more than the limit is a line end, or shows that there is more.
        let read = Read::by_ref(&mut self.file).take(self.limit.saturating_add(1)).read_until(b'\n', &mut line);
        let found = match read {
            Err(source) => Some(Err(StorageError::new("read", &self.path, source))),
            Ok(_) if line.last() == Some(&b'\n') => {
                line.pop();
                Some(Ok(line))
            }
            Ok(count) if count as u64 > self.limit => {
                Some(Err(StorageError::TooLarge { path: self.path.clone(), limit: self.limit }))
            }
            Ok(_) => None,
        };
        self.over = !matches!(found, Some(Ok(_)));
        found
    }
}

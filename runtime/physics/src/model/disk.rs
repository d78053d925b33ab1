//! The files of this machine.

use super::ModelFiles;
use msk_storage::read_file;
use std::io::ErrorKind;
use std::path::Path;
use std::time::SystemTime;

/// All regular files of the machine: what a program reads whose user chose whose files to read.
#[derive(Debug, Clone, Copy, Default)]
pub struct DiskFiles;

impl ModelFiles for DiskFiles {
    fn read(&self, path: &Path, limit: u64) -> Result<Option<Vec<u8>>, String> {
        match read_file(path, limit) {
            Err(error) if error.kind() == Some(ErrorKind::NotFound) => Ok(None),
            bytes => bytes.map(Some).map_err(|error| error.reason()),
        }
    }

    fn stamp(&self, path: &Path) -> Option<(u64, SystemTime)> {
        let metadata = std::fs::metadata(path).ok()?;
        Some((metadata.len(), metadata.modified().ok()?))
    }
}

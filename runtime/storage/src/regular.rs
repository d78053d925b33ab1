//! Reading of regular files, and of nothing else.

use crate::StorageError;
use cap_fs_ext::OpenOptionsSyncExt;
use cap_std::ambient_authority;
use cap_std::fs::{File, FileType, FileTypeExt, Metadata, OpenOptions};
use std::io::Read;
use std::path::Path;

/// The bytes of the regular file at `path`, which the user named and which may lie anywhere.
///
/// # Errors
/// No such file, something other than a regular file, more than `limit` bytes, or a refusal of the operating system.
pub fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, StorageError> {
    let file = File::open_ambient_with(path, &for_reading(), ambient_authority());
    read(file.map_err(|source| StorageError::new("read", path, source))?, path, limit)
}

/// [`read_file`] as text.
///
/// # Errors
/// Those of [`read_file`], and bytes that are not UTF-8.
pub fn read_text_file(path: &Path, limit: u64) -> Result<String, StorageError> {
    text(read_file(path, limit)?, path)
}

/// Opening a pipe for reading would wait for its writer; asking not to wait lets its kind be looked at first.
pub(crate) fn for_reading() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.read(true).nonblock(true);
    options
}

pub(crate) fn text(bytes: Vec<u8>, path: &Path) -> Result<String, StorageError> {
    String::from_utf8(bytes).map_err(|_| StorageError::NotText { path: path.into() })
}

/// Reads an open file whole.
///
/// The files of `/proc` and `/sys` call themselves regular but hold another number of bytes than they state. A file that
/// somebody is just writing does so once; one that does so repeatedly is none.
pub(crate) fn read(mut file: File, path: &Path, limit: u64) -> Result<Vec<u8>, StorageError> {
    const ATTEMPTS: usize = 8;
    let cannot = |source| StorageError::new("read", path, source);
    for _ in 0..ATTEMPTS {
        let size = regular(&file.metadata().map_err(cannot)?, path)?.len();
        if size > limit {
            return Err(StorageError::TooLarge { path: path.into(), limit });
        }
        let mut bytes = Vec::new();
        std::io::Seek::rewind(&mut file).map_err(cannot)?;
        // One byte more shows that there is more.
        Read::by_ref(&mut file).take(size.saturating_add(1)).read_to_end(&mut bytes).map_err(cannot)?;
        if bytes.len() as u64 == size {
            return Ok(bytes);
        }
    }
    Err(StorageError::NotRegular { path: path.into(), found: "a file whose size differs from its metadata" })
}

/// Passes the metadata of regular files on.
pub(crate) fn regular<'a>(metadata: &'a Metadata, path: &Path) -> Result<&'a Metadata, StorageError> {
    if metadata.is_file() {
        return Ok(metadata);
    }
    Err(StorageError::NotRegular { path: path.into(), found: kind(metadata.file_type()) })
}

fn kind(kind: FileType) -> &'static str {
    match () {
        () if kind.is_dir() => "a folder",
        () if kind.is_symlink() => "a symbolic link",
        () if kind.is_fifo() => "a named pipe",
        () if kind.is_socket() => "a socket",
        () if kind.is_char_device() || kind.is_block_device() => "a device",
        () => "not a file of a known kind",
    }
}

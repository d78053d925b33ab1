//! Texts on disk: which there are, and how one is replaced so that no reader ever sees half of it.

use crate::error::{Context, Error};
use msk_storage::{Folder, read_text_file};
use std::fs;
use std::path::{Path, PathBuf};

/// Files as they are; folders are looked through for `.msk` files, in order, hidden ones and build outputs left out.
///
/// # Errors
/// A path that does not exist, a folder that cannot be read, or no text at all.
pub fn find(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    let mut found = Vec::new();
    for path in paths {
        let meta = fs::metadata(path).context(|| format!("cannot read `{}`", path.display()))?;
        if meta.is_dir() { look_through(path, &mut found)? } else { found.push(path.clone()) }
    }
    if found.is_empty() {
        let places: Vec<String> = paths.iter().map(|path| format!("`{}`", path.display())).collect();
        return Err(Error::new(format!("there is no `.msk` file in {}", places.join(", ")))
            .hint("give a file, or a folder with .msk files"));
    }
    Ok(found)
}

fn look_through(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), Error> {
    let cannot = || format!("cannot read the folder `{}`", folder.display());
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder).context(cannot)? {
        entries.push(entry.context(cannot)?.path());
    }
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // A link to a folder could lead back to where we are.
        if path.is_dir() && !path.is_symlink() && !name.starts_with('.') && name != "target" {
            look_through(&path, found)?;
        } else if path.is_file() && name.ends_with(".msk") {
            found.push(path.strip_prefix(".").map_or_else(|_| path.clone(), Path::to_path_buf));
        }
    }
    Ok(())
}

/// Most bytes that are read of a text.
const LARGEST: u64 = 64 << 20;

/// The text of a regular file of at most 64 MiB.
///
/// # Errors
/// There is no such file, it is a folder, pipe or device, it is too large or not UTF-8, or it cannot be read.
pub fn read(path: &Path) -> Result<String, Error> {
    read_text_file(path, LARGEST).map_err(|error| Error::new(format!("cannot read {}: {}", path.display(), error.reason())))
}

/// Replaces a file in one step: readers see the old text or the new one. A link stays a link: what it leads to is replaced.
///
/// # Errors
/// The folder or the file cannot be written, or the file is read-only; it is then what it was.
pub fn replace(path: &Path, text: &str) -> Result<(), Error> {
    let (folder, name) = Folder::of_file(path)?;
    Ok(folder.replace(&name, text.as_bytes())?)
}

/// Replaces a file whose text is still `before`, and returns whether it did: what another program wrote meanwhile is not lost.
///
/// # Errors
/// The file cannot be read or written.
pub fn replace_if(path: &Path, before: &str, text: &str) -> Result<bool, Error> {
    let now = read(path)?;
    if now != before || now == text {
        return Ok(false);
    }
    replace(path, text).map(|()| true)
}

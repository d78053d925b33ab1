//! Files that commands write: those that the user names, and those in folders that somebody else may have made.

use crate::error::{Context, Error};
use msk_storage::{Folder, StorageError, write_file};
use std::path::{Path, PathBuf};

/// Writes a file that the user named, wherever it lies.
///
/// # Errors
/// It cannot be written, or it is a pipe that nobody reads.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Error> {
    write_file(path, content.as_ref()).context(|| format!("cannot write `{}`", path.display()))
}

/// Writes a file of a folder, never through a link.
///
/// # Errors
/// It cannot be written, or something other than a regular file has its name.
pub fn write_in(folder: &Folder, name: &str, content: impl AsRef<[u8]>) -> Result<(), Error> {
    let cannot = || format!("cannot write `{}`", folder.path().join(name).display());
    folder.replace(Path::new(name), content.as_ref()).context(cannot)
}

/// Opens the folder of `--out`, created where it is missing. The user may name any; the name that the option has by itself must not be
/// that of a link, since that one may have come with somebody else's project.
///
/// # Errors
/// It cannot be created or opened, or the default is a link.
pub fn folder(path: &Path, default: &str) -> Result<Folder, Error> {
    let cannot = || format!("cannot make the folder `{}`", path.display());
    if path != Path::new(default) {
        return Folder::create(path).context(cannot);
    }
    own_folder(default)
        .context(cannot)
        .map_err(|error| error.hint(format!("name another folder with `--out DIR`; `--out ./{default}` follows a link")))
}

/// The folder of that name in the present one, created where it is missing; never through a link. It is on the disk when this returns.
///
/// # Errors
/// It cannot be created or opened, or is a link.
pub fn own_folder(name: &str) -> Result<Folder, StorageError> {
    let known = Folder::open(Path::new(""))?.existing_private_subfolder(name)?;
    known.map_or_else(|| Folder::create(Path::new(name)), Ok)
}

/// Makes a folder in a folder of results, and gives its path. What is there under its name must not be a link.
///
/// # Errors
/// It cannot be made, or is a link.
pub fn subfolder(folder: &Path, name: &str) -> Result<PathBuf, Error> {
    let made = Folder::create(folder).and_then(|folder| folder.private_subfolder(name));
    made.context(|| format!("cannot make the folder `{}`", folder.join(name).display()))?;
    Ok(folder.join(name))
}

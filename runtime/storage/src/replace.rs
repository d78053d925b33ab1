//! Whole files, exchanged in one move.

use crate::faults::Call;
use crate::{Folder, StorageError, regular};
use cap_fs_ext::OpenOptionsSyncExt;
use cap_std::ambient_authority;
use cap_std::fs::{File, Metadata, OpenOptions};
use cap_tempfile::TempFile;
use std::io;
use std::path::Path;

impl Folder {
    /// Writes a whole file. Readers see the former bytes or the new ones, never a part; when this returns, the new ones are on
    /// the disk. A file that was there keeps its owner and mode.
    ///
    /// The bytes are prepared in a file without a name, or where the system has none, under a random one.
    ///
    /// # Errors
    /// A path that leads out or names a link or anything else that is no regular file, a read-only file, or a refusal of the
    /// operating system. The former file then stands as it was; only where the last step fails, which forces the move to the
    /// disk, the new one does, and either may be found after a power cut.
    pub fn replace(&self, path: &Path, bytes: &[u8]) -> Result<(), StorageError> {
        self.put(path, |folder, name, whole| {
            let before = folder.metadata(name).map_err(|source| folder.cannot("read", name, source))?;
            if let Some(before) = &before {
                replaceable(before, whole)?;
            }
            folder.exchange(name, bytes, before.as_ref()).map_err(|source| folder.cannot("write", name, source))
        })
    }

    /// Writes a whole file that must not exist yet, with the promises of [`Folder::replace`].
    ///
    /// # Errors
    /// A file that exists ([`StorageError::kind`] is `AlreadyExists`), and the errors of [`Folder::replace`].
    pub fn create_file(&self, path: &Path, bytes: &[u8]) -> Result<(), StorageError> {
        self.put(path, |folder, name, _| {
            let create = || {
                let mut options = regular::for_reading();
                options.write(true).create_new(true);
                folder.gate(Call::Create, name)?;
                let mut file = folder.directory().open_with(name, &options)?;
                let written = folder.fill(&mut file, name, bytes).and_then(|()| folder.sync());
                // Half a file is worse than none; who died in between leaves it to be seen.
                written.inspect_err(|_| drop(folder.directory().remove_file(name)))
            };
            create().map_err(|source| folder.cannot("create", name, source))
        })
    }

    /// Removes a file; where there is none, nothing happens. That it is gone is on the disk when this returns.
    ///
    /// # Errors
    /// A path that leads out, a folder, or a refusal of the operating system.
    pub fn remove(&self, path: &Path) -> Result<(), StorageError> {
        self.put(path, |folder, name, _| {
            let remove = || {
                folder.gate(Call::Remove, name)?;
                match folder.directory().remove_file(name) {
                    Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
                    removed => removed.and_then(|()| folder.sync()),
                }
            };
            remove().map_err(|source| folder.cannot("remove", name, source))
        })
    }

    /// Finds the folder in which a path's last name lies, so that all that follows happens in one place.
    fn put(&self, path: &Path, put: impl FnOnce(&Self, &Path, &Path) -> Result<(), StorageError>) -> Result<(), StorageError> {
        let whole = self.path().join(path);
        let name = path.file_name().ok_or_else(|| StorageError::NoName { path: whole.clone() })?;
        let folder = self.subfolder(path.parent().unwrap_or(Path::new("")))?;
        put(&folder, Path::new(name), &whole)
    }

    fn exchange(&self, name: &Path, bytes: &[u8], before: Option<&Metadata>) -> io::Result<()> {
        self.gate(Call::Create, name)?;
        let mut fresh = TempFile::new(self.directory())?;
        if let Some(before) = before {
            self.gate(Call::SetOwner, name)?;
            keep_owner_and_mode(fresh.as_file(), before)?;
        }
        self.fill(fresh.as_file_mut(), name, bytes)?;
        self.gate(Call::Rename, name)?;
        fresh.replace(name)?;
        self.sync()
    }

    fn fill(&self, file: &mut File, name: &Path, bytes: &[u8]) -> io::Result<()> {
        self.write(file, name, bytes)?;
        self.gate(Call::Sync, name)?;
        file.sync_all()
    }
}

/// Writes the file that the user named and that may lie anywhere. A link is followed, and the file that it leads to is replaced as
/// [`Folder::replace`] does it; a pipe or a device, such as `/dev/stdout`, gets the bytes.
///
/// # Errors
/// Those of [`Folder::of_file`] and [`Folder::replace`], and a pipe that nobody reads: a reader is not waited for.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), StorageError> {
    if std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
        return stream(path, bytes).map_err(|source| StorageError::new("write", path, source));
    }
    let (folder, name) = Folder::of_file(path)?;
    folder.replace(&name, bytes)
}

fn stream(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut options = OpenOptions::new();
    options.write(true).nonblock(true);
    // Opened so, a pipe without a reader is an error; while this is open there is a reader, and to open it once more does not wait.
    let ready = File::open_ambient_with(path, &options, ambient_authority())?;
    let mut file = std::fs::OpenOptions::new().write(true).open(path)?;
    drop(ready);
    io::Write::write_all(&mut file, bytes)
}

fn replaceable(before: &Metadata, path: &Path) -> Result<(), StorageError> {
    if before.is_symlink() {
        return Err(StorageError::Link { path: path.into() });
    }
    regular::regular(before, path)?;
    // The move would succeed, because it is the folder that it changes; the owner of the file forbids it.
    if before.permissions().readonly() {
        return Err(StorageError::ReadOnly { path: path.into() });
    }
    Ok(())
}

#[cfg(unix)]
fn keep_owner_and_mode(file: &File, before: &Metadata) -> io::Result<()> {
    use cap_std::fs::MetadataExt;
    let fresh = file.metadata()?;
    if (fresh.uid(), fresh.gid()) != (before.uid(), before.gid()) {
        std::os::unix::fs::fchown(file, Some(before.uid()), Some(before.gid()))?;
    }
    file.set_permissions(before.permissions())
}

#[cfg(not(unix))]
fn keep_owner_and_mode(file: &File, before: &Metadata) -> io::Result<()> {
    file.set_permissions(before.permissions())
}

//! Locks between processes.

use crate::faults::Call;
use crate::{Folder, StorageError, regular};
use cap_fs_ext::{FollowSymlinks, OpenOptionsFollowExt};
use std::fs::{File, TryLockError};
use std::io;
use std::path::Path;

/// A lock, held until it is dropped. The operating system takes it back when the program ends in whatever way.
#[derive(Debug)]
pub struct Lock {
    file: File,
}

impl Drop for Lock {
    /// Unlocks explicitly: closing would not do it as long as a program that is just being started has a copy of the descriptor,
    /// from `fork` until its `exec`.
    fn drop(&mut self) {
        // Where unlocking fails, closing the file is all that is left.
        let _ = self.file.unlock();
    }
}

impl Folder {
    /// Waits until the lock of that name is free, and takes it. The file of the lock is created and stays.
    ///
    /// # Errors
    /// The name of a link, or a file that cannot be created or locked.
    pub fn lock(&self, name: &Path) -> Result<Lock, StorageError> {
        let file = self.open_private(name)?;
        file.lock().map_err(|source| self.cannot("lock", name, source))?;
        Ok(Lock { file })
    }

    /// Takes the lock of that name, or gives `None` if somebody else holds it.
    ///
    /// # Errors
    /// Those of [`Folder::lock`].
    pub fn try_lock(&self, name: &Path) -> Result<Option<Lock>, StorageError> {
        let file = self.open_private(name)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Lock { file })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(source)) => Err(self.cannot("lock", name, source)),
        }
    }

    /// Opens a file of the program's own for reading and writing, created where it is missing; never through a link.
    pub(crate) fn open_private(&self, name: &Path) -> Result<File, StorageError> {
        let mut options = regular::for_reading();
        options.write(true).create(true).follow(FollowSymlinks::No);
        let opened = || -> io::Result<_> {
            self.gate(Call::Create, name)?;
            self.directory().open_with(name, &options)
        };
        let file = match opened() {
            Err(_) if self.is_link(name) => return Err(StorageError::Link { path: self.path().join(name) }),
            file => file.map_err(|source| self.cannot("open", name, source))?,
        };
        let metadata = file.metadata().map_err(|source| self.cannot("open", name, source))?;
        regular::regular(&metadata, &self.path().join(name))?;
        Ok(file.into_std())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_of_the_descriptor_does_not_keep_the_lock() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        let lock = folder.lock(Path::new("lock")).unwrap();
        let copy = lock.file.try_clone().unwrap();
        assert!(folder.try_lock(Path::new("lock")).unwrap().is_none());
        drop(lock);
        assert!(folder.try_lock(Path::new("lock")).unwrap().is_some());
        drop(copy);
    }
}

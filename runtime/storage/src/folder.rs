//! An opened folder, beneath which everything happens.

use crate::faults::{Call, Faults};
use crate::{StorageError, regular};
use cap_fs_ext::{DirExt, FollowSymlinks, OpenOptionsFollowExt};
use cap_std::ambient_authority;
use cap_std::fs::{Dir, Metadata};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An opened folder. Paths given to its methods are relative to it and cannot leave it.
///
/// The folder stays the same one when it is renamed, or when its path comes to name another.
#[derive(Debug, Clone)]
pub struct Folder {
    directory: Arc<Dir>,
    /// Where the folder was when it was opened: for messages, never for access.
    path: PathBuf,
    faults: Option<Arc<dyn Faults>>,
}

/// What a folder holds under a name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Entry {
    /// The name, within the folder.
    pub name: PathBuf,
    /// What it names; a link is not followed.
    pub kind: Kind,
}

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// A link, pipe, device or socket.
    Other,
}

impl Folder {
    /// Opens a folder that the user named; it may lie anywhere.
    ///
    /// # Errors
    /// There is no such folder, or it cannot be opened.
    pub fn open(path: &Path) -> Result<Self, StorageError> {
        // The empty path is the parent of a bare file name.
        let named = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        let directory = Dir::open_ambient_dir(named, ambient_authority());
        let directory = directory.map_err(|source| StorageError::new("open the folder", named, source))?;
        Ok(Self { directory: Arc::new(directory), path: path.into(), faults: None })
    }

    /// Opens a folder that the user named, after creating it and its parents where they are missing. Created ones are on the
    /// disk when this returns.
    ///
    /// # Errors
    /// It cannot be created or opened.
    pub fn create(path: &Path) -> Result<Self, StorageError> {
        let cannot = |source| StorageError::new("create the folder", path, source);
        let missing: Vec<&Path> = path.ancestors().take_while(|folder| !folder.exists()).collect();
        std::fs::create_dir_all(path).map_err(cannot)?;
        // The name of a new folder lasts only once the folder around it is on the disk.
        for around in missing.into_iter().filter_map(Path::parent) {
            Self::open(around)?.sync().map_err(cannot)?;
        }
        Self::open(path)
    }

    /// Opens a folder that the user named, after creating it; the folder around it must exist. It is on the disk when this returns.
    ///
    /// # Errors
    /// Something of the name exists (the kind of the error is [`ErrorKind::AlreadyExists`]), or it cannot be created or opened.
    pub fn create_new(path: &Path) -> Result<Self, StorageError> {
        let cannot = |source| StorageError::new("create the folder", path, source);
        std::fs::create_dir(path).map_err(cannot)?;
        Self::open(path.parent().unwrap_or(Path::new("")))?.sync().map_err(cannot)?;
        Self::open(path)
    }

    /// The folder of a file that the user named, and the file's name in it. A link at the end of the path is followed, so that
    /// the file it leads to is meant.
    ///
    /// # Errors
    /// A path without a file name, or a folder that cannot be opened.
    pub fn of_file(path: &Path) -> Result<(Self, PathBuf), StorageError> {
        let resolved = match std::fs::canonicalize(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => path.to_path_buf(),
            resolved => resolved.map_err(|source| StorageError::new("open", path, source))?,
        };
        let name = resolved.file_name().ok_or_else(|| StorageError::NoName { path: path.into() })?;
        Ok((Self::open(resolved.parent().unwrap_or(Path::new("")))?, name.into()))
    }

    /// The same folder with faults before every call that changes something: for tests.
    #[must_use]
    pub fn with_faults(self, faults: Arc<dyn Faults>) -> Self {
        Self { faults: Some(faults), ..self }
    }

    /// Where the folder was when it was opened, for messages.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A folder inside this one.
    ///
    /// # Errors
    /// There is none, it leads out, or it cannot be opened.
    pub fn subfolder(&self, path: &Path) -> Result<Self, StorageError> {
        let directory = if path.as_os_str().is_empty() { self.directory.try_clone() } else { self.directory.open_dir(path) };
        self.beneath(path, directory.map_err(|source| self.cannot("open the folder", path, source))?)
    }

    /// A folder inside this one, created with its parents where they are missing.
    ///
    /// # Errors
    /// It leads out, or it cannot be created or opened.
    pub fn create_subfolder(&self, path: &Path) -> Result<Self, StorageError> {
        self.gate(Call::CreateFolder, path)
            .and_then(|()| self.directory.create_dir_all(path))
            .map_err(|source| self.cannot("create the folder", path, source))?;
        self.subfolder(path)
    }

    /// A folder directly inside this one that belongs to the program, such as `.msk`; created where it is missing.
    ///
    /// # Errors
    /// The name is that of a link, wherever it leads, or of a file; or the folder cannot be created or opened.
    pub fn private_subfolder(&self, name: &str) -> Result<Self, StorageError> {
        let path = Path::new(name);
        match self.gate(Call::CreateFolder, path).and_then(|()| self.directory.create_dir(path)) {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => {
                return Err(self.cannot("create the folder", path, error));
            }
            _ => {}
        }
        self.existing_private_subfolder(name)?.ok_or_else(|| self.cannot("open the folder", path, ErrorKind::NotFound.into()))
    }

    /// [`Folder::private_subfolder`] where it exists.
    ///
    /// # Errors
    /// As there.
    pub fn existing_private_subfolder(&self, name: &str) -> Result<Option<Self>, StorageError> {
        let path = Path::new(name);
        match self.directory.open_dir_nofollow(path) {
            Ok(directory) => self.beneath(path, directory).map(Some),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(_) if self.is_link(path) => Err(StorageError::Link { path: self.path.join(path) }),
            Err(source) => Err(self.cannot("open the folder", path, source)),
        }
    }

    /// The bytes of a regular file, or `None` if there is no file.
    ///
    /// # Errors
    /// A path that leads out, something other than a regular file, more than `limit` bytes, or a refusal of the system.
    pub fn read(&self, path: &Path, limit: u64) -> Result<Option<Vec<u8>>, StorageError> {
        self.read_with(path, FollowSymlinks::Yes, limit)
    }

    /// [`Folder::read`] of a file that must not be a link.
    ///
    /// # Errors
    /// Those of [`Folder::read`], and a link.
    pub fn read_private(&self, path: &Path, limit: u64) -> Result<Option<Vec<u8>>, StorageError> {
        self.read_with(path, FollowSymlinks::No, limit)
    }

    /// [`Folder::read`] as text.
    ///
    /// # Errors
    /// Those of [`Folder::read`], and bytes that are not UTF-8.
    pub fn read_text(&self, path: &Path, limit: u64) -> Result<Option<String>, StorageError> {
        let bytes = self.read(path, limit)?;
        bytes.map(|bytes| regular::text(bytes, &self.path.join(path))).transpose()
    }

    /// What lies in a folder beneath this one (the empty path is this folder), sorted by name.
    ///
    /// # Errors
    /// A path that leads out, or a folder that cannot be read.
    pub fn entries(&self, path: &Path) -> Result<Vec<Entry>, StorageError> {
        let cannot = |source| self.cannot("list", path, source);
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        let mut entries = Vec::new();
        for entry in self.directory.read_dir(path).map_err(cannot)? {
            let entry = entry.map_err(cannot)?;
            let kind = entry.file_type().map_err(cannot)?;
            let kind = match () {
                () if kind.is_file() => Kind::File,
                () if kind.is_dir() => Kind::Folder,
                () => Kind::Other,
            };
            entries.push(Entry { name: entry.file_name().into(), kind });
        }
        entries.sort();
        Ok(entries)
    }

    /// Whether the path names a link, wherever it leads.
    pub fn is_link(&self, path: &Path) -> bool {
        self.directory.symlink_metadata(path).is_ok_and(|metadata| metadata.is_symlink())
    }

    /// Metadata of what a path names, without following a link; `None` if it names nothing.
    pub(crate) fn metadata(&self, path: &Path) -> io::Result<Option<Metadata>> {
        match self.directory.symlink_metadata(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            metadata => metadata.map(Some),
        }
    }

    pub(crate) fn directory(&self) -> &Dir {
        &self.directory
    }

    /// Lets faults decide about a call.
    pub(crate) fn gate(&self, call: Call, path: &Path) -> io::Result<()> {
        self.faults.as_ref().map_or(Ok(()), |faults| faults.before(call, &self.path.join(path)))
    }

    /// Writes bytes to an open file; a fault leaves half of them written, as a full disk does.
    pub(crate) fn write(&self, file: &mut impl io::Write, path: &Path, bytes: &[u8]) -> io::Result<()> {
        if let Err(fault) = self.gate(Call::Write, path) {
            file.write_all(&bytes[..bytes.len() / 2])?;
            return Err(fault);
        }
        file.write_all(bytes)
    }

    /// Forces the folder's names to the disk. Where the system cannot open folders as files it does so by itself.
    pub(crate) fn sync(&self) -> io::Result<()> {
        self.gate(Call::SyncFolder, Path::new(""))?;
        #[cfg(unix)]
        {
            // The handle that paths are resolved from cannot be synchronised itself.
            self.directory.open(".")?.sync_all()
        }
        #[cfg(not(unix))]
        {
            Ok(())
        }
    }

    pub(crate) fn cannot(&self, action: &'static str, path: &Path, source: io::Error) -> StorageError {
        StorageError::new(action, &self.path.join(path), source)
    }

    fn beneath(&self, path: &Path, directory: Dir) -> Result<Self, StorageError> {
        Ok(Self { directory: Arc::new(directory), path: self.path.join(path), faults: self.faults.clone() })
    }

    /// Opens a file for reading; `None` if there is none.
    pub(crate) fn open_for_reading(&self, path: &Path) -> Result<Option<cap_std::fs::File>, StorageError> {
        self.open_with(path, FollowSymlinks::Yes)
    }

    fn open_with(&self, path: &Path, follow: FollowSymlinks) -> Result<Option<cap_std::fs::File>, StorageError> {
        let mut options = regular::for_reading();
        options.follow(follow);
        let source = match self.directory.open_with(path, &options) {
            Ok(file) => return Ok(Some(file)),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => error,
        };
        // The codes by which systems refuse links and sockets differ; what is there can be looked at everywhere.
        if follow == FollowSymlinks::No && self.is_link(path) {
            return Err(StorageError::Link { path: self.path.join(path) });
        }
        if let Ok(metadata) = self.directory.metadata(path) {
            regular::regular(&metadata, &self.path.join(path))?;
        }
        Err(self.cannot("read", path, source))
    }

    fn read_with(&self, path: &Path, follow: FollowSymlinks, limit: u64) -> Result<Option<Vec<u8>>, StorageError> {
        let file = self.open_with(path, follow)?;
        file.map(|file| regular::read(file, &self.path.join(path), limit)).transpose()
    }
}

//! One folder that nothing leads out of.

use msk_compiler::files::{LARGEST_FILE, LoadError, Loader, plain};
use msk_physics::model::ModelFiles;
use msk_runtime::bodies;
use msk_runtime::files::load_error;
use msk_storage::{Folder, StorageError};
use std::path::{Path, PathBuf};

/// The project's folder, opened once. All that the server reads and writes is found beneath it by the operating system, so that no
/// path, link or exchange of folders leads elsewhere; and the answer for a path that leads out is the same whether anything is there.
#[derive(Debug, Clone)]
pub struct Confined {
    folder: Folder,
    /// Where the folder is, without links: absolute paths beneath it mean what the relative ones do.
    root: PathBuf,
}

/// Why a path is refused.
#[derive(Debug, thiserror::Error)]
pub enum Outside {
    /// It leads out of the project.
    #[error("`{}` {LEADS_OUT}", .0.display())]
    Escapes(PathBuf),
    /// It cannot be followed.
    #[error("`{}` cannot be used: {reason}", path.display())]
    Unusable {
        /// The path.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
}

const LEADS_OUT: &str = "leads out of the project: paths are relative to it and must stay in it";

impl Outside {
    /// Puts a refusal of the storage into words, with the path as it was asked for.
    pub fn of(path: &Path, error: &StorageError) -> Self {
        match error {
            StorageError::Outside { .. } => Self::Escapes(path.into()),
            other => Self::Unusable { path: path.into(), reason: other.reason() },
        }
    }
}

impl Confined {
    /// The folder `root`, which must exist.
    ///
    /// # Errors
    /// No folder.
    pub fn new(root: &Path) -> Result<Self, Outside> {
        let folder = Folder::open(root).map_err(|error| Outside::of(root, &error))?;
        let absolute = std::fs::canonicalize(root);
        let root = absolute.map_err(|error| Outside::Unusable { path: root.into(), reason: error.to_string() })?;
        Ok(Self { folder, root })
    }

    /// The folder.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    /// The one spelling of a path, relative to the folder: two paths to a file without links between them have the same.
    pub fn spelled(&self, path: &Path) -> PathBuf {
        let path = plain(path);
        path.strip_prefix(&self.root).map(Path::to_path_buf).unwrap_or(path)
    }

    /// The text of a file of at most `limit` bytes; `None` if there is none.
    ///
    /// # Errors
    /// A path that leads out, or what is no regular file of text within the limit.
    pub fn text(&self, path: &Path, limit: u64) -> Result<Option<String>, Outside> {
        self.folder.read_text(&self.spelled(path), limit).map_err(|error| Outside::of(path, &error))
    }
}

/// Reads texts beneath the folder; a task may use a file that lies beside its own folder, but none outside of the project.
impl Loader for Confined {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        if let Some(text) = bodies::text(path) {
            return Ok(text);
        }
        found(path, LARGEST_FILE, self.folder.read_text(&self.spelled(path), LARGEST_FILE))
    }

    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        found(path, limit, self.folder.read(&self.spelled(path), limit))
    }
}

/// What was read, or why not, in the words of the compiler.
fn found<T>(path: &Path, limit: u64, read: Result<Option<T>, StorageError>) -> Result<T, LoadError> {
    match read {
        Ok(content) => content.ok_or_else(|| LoadError::Missing(path.into())),
        Err(StorageError::Outside { .. }) => Err(LoadError::Unreadable { path: path.into(), reason: format!("it {LEADS_OUT}") }),
        Err(error) => Err(load_error(path, limit, &error)),
    }
}

/// Reads models, what they include, their meshes and height fields beneath the folder.
impl ModelFiles for Confined {
    fn read(&self, path: &Path, limit: u64) -> Result<Option<Vec<u8>>, String> {
        self.folder.read(&self.spelled(path), limit).map_err(|error| match error {
            StorageError::Outside { .. } => format!("it {LEADS_OUT}"),
            other => other.reason(),
        })
    }
}

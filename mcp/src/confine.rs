//! Paths inside one folder.

use msk_compiler::body::BodyDescription;
use msk_compiler::files::{BodySource, LoadError, Loader};
use msk_compiler::vocabulary::Vocabulary;
use msk_runtime::library::{BodyLibrary, FileLoader};
use std::path::{Component, Path, PathBuf};

/// A folder that nothing leads out of.
#[derive(Debug, Clone)]
pub struct Confined {
    root: PathBuf,
}

/// Why a path is refused.
#[derive(Debug, thiserror::Error)]
pub enum Outside {
    /// It leads out of the project.
    #[error("`{}` leads out of the project: paths are relative to it and stay in it", .0.display())]
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

impl Confined {
    /// The folder `root`, which must exist.
    ///
    /// # Errors
    /// No folder.
    pub fn new(root: &Path) -> Result<Self, Outside> {
        let unusable = |reason: String| Outside::Unusable { path: root.into(), reason };
        let root = std::fs::canonicalize(root).map_err(|error| unusable(error.to_string()))?;
        if root.is_dir() { Ok(Self { root }) } else { Err(unusable("it is no folder".into())) }
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Where a file or folder that exists lies: all links are followed before it is judged.
    ///
    /// # Errors
    /// A path that does not exist or leads out.
    pub fn existing(&self, path: &Path) -> Result<PathBuf, Outside> {
        self.plain(path)?;
        let whole = self.root.join(path);
        match std::fs::canonicalize(&whole) {
            Ok(found) => self.inside(path, found),
            // What does not exist is told only of places inside: nobody learns here what lies elsewhere.
            Err(error) => {
                let nearest = whole.ancestors().skip(1).find_map(|folder| std::fs::canonicalize(folder).ok());
                self.inside(path, nearest.unwrap_or_default())?;
                Err(Outside::Unusable { path: path.into(), reason: error.to_string() })
            }
        }
    }

    /// Where a file may be written: it, or the folder that it shall lie in, exists inside.
    ///
    /// # Errors
    /// A path that leads out, ends in no name, or whose folder does not exist.
    pub fn writable(&self, path: &Path) -> Result<PathBuf, Outside> {
        self.plain(path)?;
        let whole = self.root.join(path);
        // A link that leads nowhere yet would be followed when it is written to.
        if std::fs::symlink_metadata(&whole).is_ok() {
            return self.existing(path);
        }
        let name = whole.file_name().ok_or_else(|| Outside::Escapes(path.into()))?.to_owned();
        let folder = path.parent().unwrap_or(Path::new(""));
        Ok(self.existing(folder)?.join(name))
    }

    /// A path without detours, so that what is judged is what is meant.
    fn plain(&self, path: &Path) -> Result<(), Outside> {
        let climbs = path.components().any(|part| matches!(part, Component::ParentDir | Component::Prefix(_)));
        // An absolute path is as good as a relative one if it lies inside.
        if climbs || (path.is_absolute() && !path.starts_with(&self.root)) { Err(Outside::Escapes(path.into())) } else { Ok(()) }
    }

    fn inside(&self, path: &Path, found: PathBuf) -> Result<PathBuf, Outside> {
        if found.starts_with(&self.root) { Ok(found) } else { Err(Outside::Escapes(path.into())) }
    }
}

/// Reads texts inside the folder; a task may use a file that lies beside its own folder, but none outside of the project.
impl Loader for Confined {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        let whole = self.root.join(path);
        let Ok(found) = std::fs::canonicalize(&whole) else { return Err(LoadError::Missing(path.into())) };
        match self.inside(path, found) {
            Ok(found) => FileLoader.load(&found),
            Err(outside) => Err(LoadError::Unreadable { path: path.into(), reason: outside.to_string() }),
        }
    }
}

/// Bodies of the project and those that are built in.
pub struct Bodies<'a> {
    pub confined: &'a Confined,
    pub library: &'a BodyLibrary,
}

impl BodySource for Bodies<'_> {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        self.library.find(name)
    }

    fn vocabulary(&self, description: &BodyDescription) -> Result<Vocabulary, String> {
        // A model that is a file on disk must be one of the project's.
        if let Ok(found) = std::fs::canonicalize(&description.model)
            && !found.starts_with(self.confined.root())
        {
            return Err(Outside::Escapes(PathBuf::from(&description.model)).to_string());
        }
        self.library.vocabulary(description)
    }
}

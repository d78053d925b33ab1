//! Where texts and bodies come from: what the compiler asks of its surroundings. It opens no file itself.

use crate::body::BodyDescription;
use crate::motion::Motion;
use crate::vocabulary::Vocabulary;
use std::path::{Component, Path, PathBuf};

/// Size from which on a file is refused, bytes.
pub const LARGEST_FILE: u64 = 256 * 1024;

/// Size from which on a network is refused, bytes.
pub const LARGEST_NETWORK: u64 = 64 << 20;

/// Reads the files that a text names with `use`, and those that it takes something else from.
pub trait Loader {
    /// The text at `path`.
    ///
    /// # Errors
    /// There is no such file, it is too large, it is not UTF-8, or it cannot be read.
    fn load(&self, path: &Path) -> Result<String, LoadError>;

    /// The bytes at `path`, of a file that is no text, at most `limit`.
    ///
    /// # Errors
    /// There is no such file, it is too large, or it cannot be read; where only texts are at hand, always.
    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        let _ = limit;
        Err(LoadError::Unreadable { path: path.into(), reason: "only texts are at hand here".to_owned() })
    }

    /// Does pieces of work that need nothing of one another, such as parsing several texts: here one after the other. A loader
    /// with threads at hand does them side by side.
    fn side_by_side(&self, work: Vec<Piece<'_>>) {
        work.into_iter().for_each(|piece| piece());
    }
}

/// Work that any thread may do.
pub type Piece<'w> = Box<dyn FnOnce() + Send + 'w>;

/// Knows the bodies that tasks may name.
pub trait BodySource {
    /// Path and text of the built-in body file of that name.
    ///
    /// A file `bodies/NAME.msk` beside or above the task file wins over it.
    fn find(&self, name: &str) -> Option<(PathBuf, String)>;

    /// What exists on a body. In `description` the model's path has been joined to the folder of the body file.
    ///
    /// # Errors
    /// The model cannot be read, or the body file names what the model does not have: in words, one problem a line.
    fn vocabulary(&self, description: &BodyDescription) -> Result<Vocabulary, String>;

    /// A number that changes whenever the answers of [`vocabulary`](Self::vocabulary) and [`trace`](Self::trace) may have changed,
    /// because a file behind the body has. Bodies that never change have revision 0.
    fn revision(&self, description: &BodyDescription) -> u64 {
        let _ = description;
        0
    }

    /// Where the body's landmarks are at each row of a motion, in the order of its vocabulary: world axes, m.
    ///
    /// # Errors
    /// The body is not at hand: in words. A source without kinematics always returns it.
    fn trace(&self, description: &BodyDescription, motion: &Motion) -> Result<Vec<Vec<[f64; 3]>>, String> {
        let _ = motion;
        Err(format!("the positions of the landmarks of `{}` cannot be computed here", description.name))
    }
}

/// Why a text cannot be had.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LoadError {
    /// There is no such file.
    #[error("there is no file `{}`", .0.display())]
    Missing(PathBuf),
    /// Larger than its limit.
    #[error("`{}` is larger than the limit of {limit} bytes", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// [`LARGEST_FILE`] or [`LARGEST_NETWORK`].
        limit: u64,
    },
    /// Not UTF-8.
    #[error("`{}` is not UTF-8 text", .0.display())]
    NotText(PathBuf),
    /// The operating system refuses.
    #[error("cannot read `{}`: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Its reason.
        reason: String,
    },
}

/// A path without `.` and, where that is possible, without `..`.
pub fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        let climbs = component == Component::ParentDir;
        if climbs && matches!(plain.components().next_back(), Some(Component::Normal(_))) {
            plain.pop();
        } else if component != Component::CurDir {
            plain.push(component);
        }
    }
    plain
}

//! Where the files of a model come from.

use std::fmt::Debug;
use std::path::Path;
use std::time::SystemTime;

/// The files that a model is made of: the model file, what it includes, meshes and height fields.
///
/// The reader of models opens no file itself. Names in a model come from its author, so the caller decides what they may
/// lead to: any file of the machine, the files of one folder, or what lies in memory where there are no files.
pub trait ModelFiles: Debug {
    /// The bytes of a file; `None` if there is none. The path is the one that the caller gave to
    /// [`Model::from_files`](super::Model::from_files), or a name in the model joined to its folder.
    ///
    /// # Errors
    /// The file cannot be read, is longer than `limit` bytes or must not be read: the reason, in words that follow a colon.
    fn read(&self, path: &Path, limit: u64) -> Result<Option<Vec<u8>>, String>;

    /// Length in bytes and time of the last change of a file; `None` where they cannot be known without reading it.
    fn stamp(&self, path: &Path) -> Option<(u64, SystemTime)> {
        let _ = path;
        None
    }
}

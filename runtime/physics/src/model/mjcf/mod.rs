//! Reading and writing MJCF, MuJoCo's model format.
//!
//! 1. `document` reads the XML files, splices includes, and keeps where every element stood;
//! 2. `schema` knows every element and attribute that is read, skipped or refused, and lists all that are refused at once;
//! 3. `defaults` merges the attributes of default classes into each element;
//! 4. `replicate` writes repeated parts of the tree out;
//! 5. `compile` turns elements into the arrays of a [`Model`], in MuJoCo's orders;
//! 6. `write` prints a model as one flat file.
//!
//! Files come from strangers: sizes, nesting and numbers are bounded, and every failure is one [`ModelError`].

mod advice;
mod compile;
mod defaults;
mod document;
mod error;
mod lenient;
mod mesh;
mod references;
mod replicate;
mod schema;
mod shortcut;
mod values;
mod write;

pub use error::{ModelError, Place, Unsupported};

#[cfg(feature = "disk")]
use super::DiskFiles;
use super::{Model, ModelFiles};
use std::path::Path;

impl Model {
    /// Reads and compiles an MJCF file with everything it includes, from the files of the machine.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or is not well formed, a value that makes no sense, a name that is not defined, or
    /// physical features that the simulator does not have (all of them, each with its line).
    #[cfg(feature = "disk")]
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, ModelError> {
        Self::from_files(path, &DiskFiles)
    }

    /// Reads and compiles an MJCF file with everything it includes, all of it from `files`.
    ///
    /// # Errors
    ///
    /// As for [`Model::from_file`].
    pub fn from_files(path: impl AsRef<Path>, files: &dyn ModelFiles) -> Result<Self, ModelError> {
        let document = document::read_file(path.as_ref(), files)?;
        compile::compile(document)
    }

    /// Compiles MJCF text that stands alone: it may not include files or load meshes.
    ///
    /// # Errors
    ///
    /// As for [`Model::from_file`].
    pub fn from_mjcf(text: &str) -> Result<Self, ModelError> {
        let document = document::read_text(text)?;
        compile::compile(document)
    }

    /// Prints the model as flat MJCF; reading it back gives an equal model.
    pub fn to_mjcf(&self) -> String {
        write::write(self)
    }
}

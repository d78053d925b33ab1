//! The tasks and motions that come with the package.

use msk_program::files::{LoadError, Loader};
use msk_runtime::bodies::ROOT;
use msk_runtime::library::FileLoader;
use pyo3::prelude::*;
use std::path::Path;

/// (path below the repository, text), sorted by path.
const TEXTS: &[(&str, &str)] = &include!(concat!(env!("OUT_DIR"), "/texts.rs"));

/// Reads texts from the file system, and those of the package under [`ROOT`], where the embedded bodies are, too.
pub struct PackageLoader;

impl Loader for PackageLoader {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        match find(path) {
            Some(text) => Ok(text.to_owned()),
            None => FileLoader.load(path),
        }
    }

    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        FileLoader.load_bytes(path, limit)
    }
}

fn find(path: &Path) -> Option<&'static str> {
    let path = path.strip_prefix(ROOT).ok()?;
    TEXTS.iter().find(|(known, _)| Path::new(known) == path).map(|(_, text)| *text)
}

/// The paths of all texts that come with the package, sorted.
#[pyfunction]
pub fn texts() -> Vec<String> {
    TEXTS.iter().map(|(path, _)| format!("{ROOT}/{path}")).collect()
}

/// A text that comes with the package; None if there is none at that path.
#[pyfunction]
pub fn text(path: &str) -> Option<&'static str> {
    find(Path::new(path))
}

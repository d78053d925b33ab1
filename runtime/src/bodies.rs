//! The bodies that come with the program: body files and models embedded in it, compressed.
//!
//! Their paths start with [`ROOT`], which no file on disk has, so that the model named in a built-in body file is looked
//! for here too: [`model_from`] reads a path of either kind.

use flate2::read::GzDecoder;
#[cfg(feature = "system")]
use msk_physics::model::DiskFiles;
use msk_physics::model::{Model, ModelError, ModelFiles};
use std::io::Read;
use std::path::{Path, PathBuf};

/// First component of the paths of embedded files.
pub const ROOT: &str = "<built-in>";

/// (path below the repository, gzip of the text), sorted by path.
const FILES: &[(&str, &[u8])] = &include!(concat!(env!("OUT_DIR"), "/bodies.rs"));

/// A body file that comes with the program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BodyFile {
    /// Its path, under [`ROOT`].
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

/// The body file `bodies/NAME.msk`.
pub fn builtin(name: &str) -> Option<BodyFile> {
    let path = Path::new(ROOT).join("bodies").join(format!("{name}.msk"));
    let text = text(&path)?;
    Some(BodyFile { path, text })
}

/// The names of all built-in bodies, sorted.
pub fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().filter_map(|(path, _)| path.strip_prefix("bodies/")?.strip_suffix(".msk"))
}

/// The text of an embedded file; `None` if the path is not under [`ROOT`] or there is no such file.
pub fn text(path: &Path) -> Option<String> {
    let path = path.strip_prefix(ROOT).ok()?;
    let (_, compressed) = FILES.iter().find(|(known, _)| Path::new(known) == path)?;
    let mut text = String::new();
    GzDecoder::new(*compressed).read_to_string(&mut text).ok()?;
    Some(text)
}

/// Reads a model, embedded or on disk.
///
/// # Errors
///
/// Those of [`Model::from_file`].
#[cfg(feature = "system")]
pub fn model(path: &Path) -> Result<Model, ModelError> {
    model_from(path, &DiskFiles)
}

/// Reads a model, embedded or from `files`.
///
/// # Errors
///
/// Those of [`Model::from_files`].
pub fn model_from(path: &Path, files: &dyn ModelFiles) -> Result<Model, ModelError> {
    match text(path) {
        Some(text) => Model::from_mjcf(&text),
        None => Model::from_files(path, files),
    }
}

#[cfg(test)]
#[cfg(feature = "system")]
mod tests {
    use super::*;

    #[test]
    fn the_human_comes_with_its_model() {
        let body = builtin("human").unwrap();
        assert!(body.text.contains("body human"));
        let model = model(&body.path.with_file_name("models/human416.xml")).unwrap();
        assert_eq!((model.nq, model.nv, model.actuators.name.len()), (129, 128, 416));
        assert!(names().any(|name| name == "human"));
    }

    #[test]
    fn other_paths_are_not_embedded() {
        assert_eq!(builtin("nobody"), None);
        assert_eq!(text(Path::new("bodies/human.msk")), None);
    }
}

//! What was read to understand a text: what was understood holds as long as every input is what it was.

use msk_compiler::body::BodyDescription;
use msk_compiler::files::{BodySource, LoadError, Loader, Piece};
use msk_compiler::motion::Motion;
use msk_compiler::vocabulary::Vocabulary;
use std::cell::RefCell;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// Files and bodies, each with what it was.
#[derive(Debug, Default)]
pub struct Inputs {
    texts: Vec<(PathBuf, Result<u64, LoadError>)>,
    /// Those that are no texts, with their limits.
    others: Vec<(PathBuf, u64, Result<u64, LoadError>)>,
    bodies: Vec<(BodyDescription, u64)>,
}

impl Inputs {
    /// Whether every file has the content, and every body the revision, that it had. A file that could not be read must still be
    /// unreadable for the same reason.
    pub fn are_unchanged(&self, loader: &dyn Loader, bodies: &dyn BodySource) -> bool {
        self.texts.iter().all(|(path, known)| digest(&loader.load(path)) == *known)
            && self.others.iter().all(|(path, limit, known)| digest(&loader.load_bytes(path, *limit)) == *known)
            && self.bodies.iter().all(|(description, known)| bodies.revision(description) == *known)
    }
}

fn digest<T: Hash>(text: &Result<T, LoadError>) -> Result<u64, LoadError> {
    let mut hasher = DefaultHasher::new();
    text.as_ref().map_err(Clone::clone)?.hash(&mut hasher);
    Ok(hasher.finish())
}

/// Reads files and bodies, and writes down which.
pub struct Recorder<'a> {
    loader: &'a dyn Loader,
    bodies: &'a dyn BodySource,
    inputs: RefCell<Inputs>,
}

impl<'a> Recorder<'a> {
    /// Nothing is read yet.
    pub fn new(loader: &'a dyn Loader, bodies: &'a dyn BodySource) -> Self {
        Self { loader, bodies, inputs: RefCell::default() }
    }

    /// What was read.
    pub fn into_inputs(self) -> Inputs {
        self.inputs.into_inner()
    }

    fn body(&self, description: &BodyDescription) {
        // Before the body is read: one that changes meanwhile counts as changed.
        let revision = self.bodies.revision(description);
        let mut inputs = self.inputs.borrow_mut();
        if !inputs.bodies.iter().any(|(known, _)| known == description) {
            inputs.bodies.push((description.clone(), revision));
        }
    }
}

impl Loader for Recorder<'_> {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        let text = self.loader.load(path);
        self.inputs.borrow_mut().texts.push((path.to_path_buf(), digest(&text)));
        text
    }

    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        let bytes = self.loader.load_bytes(path, limit);
        self.inputs.borrow_mut().others.push((path.to_path_buf(), limit, digest(&bytes)));
        bytes
    }

    fn side_by_side(&self, work: Vec<Piece<'_>>) {
        self.loader.side_by_side(work);
    }
}

impl BodySource for Recorder<'_> {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        self.bodies.find(name)
    }

    fn vocabulary(&self, description: &BodyDescription) -> Result<Vocabulary, String> {
        self.body(description);
        self.bodies.vocabulary(description)
    }

    fn revision(&self, description: &BodyDescription) -> u64 {
        self.bodies.revision(description)
    }

    fn trace(&self, description: &BodyDescription, motion: &Motion) -> Result<Vec<Vec<[f64; 3]>>, String> {
        self.body(description);
        self.bodies.trace(description, motion)
    }
}

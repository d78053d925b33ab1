//! The open texts over the files on disk, and what the compiler understood of them.

use crate::index::Index;
use lsp_types::Uri;
use msk_compiler::body::BodyDescription;
use msk_compiler::compile::Inspection;
use msk_compiler::diagnostics::{Diagnostic, FileId, codes};
use msk_compiler::files::{BodySource, LoadError, Loader};
use msk_compiler::inspect;
use msk_compiler::vocabulary::Vocabulary;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// A text that the editor has open.
#[derive(Debug, Clone)]
pub struct Document {
    /// As the editor calls it.
    pub uri: Uri,
    /// Counts up with each change.
    pub version: i32,
    /// As it is now.
    pub text: String,
}

/// Most files of the client's folders in which names are looked for.
const MOST_FILES: usize = 1000;

/// Texts and what is known of them.
pub struct Workspace<'a> {
    loader: &'a dyn Loader,
    bodies: Bodies<'a>,
    list: &'a dyn Fn(&Path) -> Vec<PathBuf>,
    /// Folders that the client has open.
    pub roots: Vec<PathBuf>,
    documents: BTreeMap<PathBuf, Document>,
    inspected: RefCell<BTreeMap<PathBuf, Rc<Inspection>>>,
    indexed: RefCell<Option<Rc<Index>>>,
}

impl<'a> Workspace<'a> {
    /// Nothing is open.
    pub fn new(loader: &'a dyn Loader, bodies: &'a dyn BodySource, list: &'a dyn Fn(&Path) -> Vec<PathBuf>) -> Self {
        Self {
            loader,
            bodies: Bodies::new(bodies),
            list,
            roots: Vec::new(),
            documents: BTreeMap::new(),
            inspected: RefCell::default(),
            indexed: RefCell::default(),
        }
    }

    /// The open texts.
    pub fn documents(&self) -> impl Iterator<Item = (&PathBuf, &Document)> {
        self.documents.iter()
    }

    /// The open text at `path`.
    pub fn document(&self, path: &Path) -> Option<&Document> {
        self.documents.get(path)
    }

    /// Takes the text of `path` from the editor.
    pub fn put(&mut self, path: PathBuf, document: Document) {
        self.forget(&path);
        self.documents.insert(path, document);
    }

    /// Goes back to what is on disk.
    pub fn close(&mut self, path: &Path) {
        self.documents.remove(path);
        self.forget(path);
        self.inspected.borrow_mut().remove(path);
    }

    /// Forgets everything that was understood: files on disk have changed.
    pub fn forget_all(&mut self) {
        self.inspected.borrow_mut().clear();
        *self.indexed.borrow_mut() = None;
    }

    /// Forgets what depends on `path`, or on a file that could not be found.
    fn forget(&mut self, path: &Path) {
        *self.indexed.borrow_mut() = None;
        self.inspected.borrow_mut().retain(|entry, known| {
            let reads = entry == path || known.files.iter().any(|file| file.path == path);
            !reads && !known.report.diagnostics.iter().any(|told| told.code == codes::names::FILE)
        });
    }

    /// The present text of a file.
    pub fn text(&self, path: &Path) -> Option<String> {
        self.load(path).ok()
    }

    /// What the compiler understood of a file and of what it uses.
    pub fn inspect(&self, path: &Path) -> Rc<Inspection> {
        if let Some(known) = self.inspected.borrow().get(path) {
            return known.clone();
        }
        let fresh = Rc::new(inspect(path, self, &self.bodies));
        self.inspected.borrow_mut().insert(path.to_path_buf(), fresh.clone());
        fresh
    }

    /// The same for a file of which another text is assumed.
    pub fn inspect_assuming(&self, path: &Path, text: String) -> Inspection {
        inspect(path, &Assumed { below: self, texts: &BTreeMap::from([(path.to_path_buf(), text)]) }, &self.bodies)
    }

    /// What is wrong in a file if the texts of some files were others.
    pub fn diagnostics_assuming(&self, entry: &Path, texts: &BTreeMap<PathBuf, String>) -> Vec<Diagnostic> {
        inspect(entry, &Assumed { below: self, texts }, &self.bodies).report.diagnostics
    }

    /// Inspections in which a file takes part: its own first, then those of the other open texts.
    pub fn inspections_of(&self, path: &Path) -> Vec<(FileId, Rc<Inspection>)> {
        let mut entries = vec![path.to_path_buf()];
        entries.extend(self.documents.keys().filter(|known| *known != path).cloned());
        let whole = entries.iter().map(|entry| self.inspect(entry));
        whole.filter_map(|whole| Some((file_of(&whole, path)?, whole))).collect()
    }

    /// Every file in which names may be found: open ones, those of the client's folders, and what they use.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files: Vec<PathBuf> = self.documents.keys().cloned().collect();
        files.extend(self.roots.iter().flat_map(|root| (self.list)(root)));
        // Bodies are found without being named by their file.
        let read = self.documents.keys().map(|path| self.inspect(path));
        files.extend(read.flat_map(|whole| whole.files.iter().map(|file| file.path.clone()).collect::<Vec<_>>()));
        files.sort();
        files.dedup();
        files.truncate(MOST_FILES);
        files
    }

    /// Which word means which declaration, in all files.
    pub fn index(&self) -> Rc<Index> {
        if let Some(known) = self.indexed.borrow().as_ref() {
            return known.clone();
        }
        let fresh = Rc::new(Index::of(&self.files(), self));
        *self.indexed.borrow_mut() = Some(fresh.clone());
        fresh
    }

    /// The same if the texts of some files were others.
    pub fn index_assuming(&self, texts: &BTreeMap<PathBuf, String>) -> Index {
        Index::of(&self.files(), &Assumed { below: self, texts })
    }

    /// A vocabulary for texts of which too little can be read to know their body: that of the body used last.
    pub fn some_vocabulary(&self) -> Option<Vocabulary> {
        self.bodies.described.borrow().iter().rev().find_map(|(_, vocabulary)| vocabulary.clone().ok())
    }
}

impl Loader for Workspace<'_> {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        match self.documents.get(path) {
            Some(document) => Ok(document.text.clone()),
            None => self.loader.load(path),
        }
    }
}

/// Texts that are only assumed, over those that are there.
struct Assumed<'a> {
    below: &'a dyn Loader,
    texts: &'a BTreeMap<PathBuf, String>,
}

impl Loader for Assumed<'_> {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        self.texts.get(path).map_or_else(|| self.below.load(path), |text| Ok(text.clone()))
    }
}

/// The file at `path` in an inspection.
pub fn file_of(whole: &Inspection, path: &Path) -> Option<FileId> {
    whole.files.iter().find(|file| file.path == path).map(|file| file.tree.file)
}

/// Bodies that are described once: their vocabularies are large, and texts change with every key.
struct Bodies<'a> {
    source: &'a dyn BodySource,
    found: RefCell<BTreeMap<String, Option<(PathBuf, String)>>>,
    described: RefCell<Vec<(BodyDescription, Result<Vocabulary, String>)>>,
}

/// Most bodies that are kept.
const MOST_BODIES: usize = 8;

impl<'a> Bodies<'a> {
    fn new(source: &'a dyn BodySource) -> Self {
        Self { source, found: RefCell::default(), described: RefCell::default() }
    }
}

impl BodySource for Bodies<'_> {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        self.found.borrow_mut().entry(name.to_owned()).or_insert_with(|| self.source.find(name)).clone()
    }

    fn vocabulary(&self, description: &BodyDescription) -> Result<Vocabulary, String> {
        if let Some((_, known)) = self.described.borrow().iter().find(|(known, _)| known == description) {
            return known.clone();
        }
        let fresh = self.source.vocabulary(description);
        let mut described = self.described.borrow_mut();
        if described.len() >= MOST_BODIES {
            drop(described.remove(0));
        }
        described.push((description.clone(), fresh.clone()));
        fresh
    }
}

//! The open texts over the files on disk, and what the compiler understood of them.

use crate::inputs::{Inputs, Recorder};
use lsp_types::Uri;
use msk_compiler::body::BodyDescription;
use msk_compiler::compile::Inspection;
use msk_compiler::diagnostics::{Diagnostic, FileId};
use msk_compiler::files::{BodySource, LoadError, Loader};
use msk_compiler::inspect;
use msk_compiler::motion::Motion;
use msk_compiler::resolve::index::Index;
use msk_compiler::vocabulary::Vocabulary;
use std::any::Any;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
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

/// Most inspections that are kept beside those of open texts.
const MOST_INSPECTIONS: usize = 16;

/// Texts and what is known of them.
pub struct Workspace<'a> {
    loader: &'a dyn Loader,
    bodies: Bodies<'a>,
    list: &'a dyn Fn(&Path) -> Vec<PathBuf>,
    /// Folders that the client has open.
    pub roots: Vec<PathBuf>,
    documents: BTreeMap<PathBuf, Document>,
    inspected: RefCell<BTreeMap<PathBuf, Inspected>>,
    indexed: RefCell<Option<Indexed>>,
    /// Counts messages and changes. Between two of them, files on disk are looked at once.
    turn: Cell<u64>,
}

/// What the compiler understood of a file.
struct Inspected {
    whole: Rc<Inspection>,
    /// The message of the panic of the compiler.
    defect: Option<String>,
    inputs: Inputs,
    /// When the inputs were last looked at.
    turn: u64,
}

/// The names of all files.
struct Indexed {
    index: Rc<Index>,
    files: Vec<PathBuf>,
    inputs: Inputs,
    /// When the inputs were last looked at.
    turn: u64,
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
            turn: Cell::default(),
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
        self.next_turn();
        self.documents.insert(path, document);
    }

    /// Goes back to what is on disk; gives the text that was open.
    pub fn close(&mut self, path: &Path) -> Option<Document> {
        self.next_turn();
        self.documents.remove(path)
    }

    /// A message has come: files on disk may have changed since the last.
    pub fn next_turn(&self) {
        self.turn.set(self.turn.get() + 1);
    }

    /// Forgets everything but the open texts.
    pub fn forget_all(&mut self) {
        self.inspected.get_mut().clear();
        *self.indexed.get_mut() = None;
        self.bodies.described.get_mut().clear();
    }

    /// The present text of a file.
    pub fn text(&self, path: &Path) -> Option<String> {
        self.load(path).ok()
    }

    /// What the compiler understood of a file and of what it uses; nothing if it panicked.
    pub fn inspect(&self, path: &Path) -> Rc<Inspection> {
        self.inspected(path).0
    }

    /// The message of the panic of the compiler at a file.
    pub fn defect(&self, path: &Path) -> Option<String> {
        self.inspected(path).1
    }

    fn inspected(&self, path: &Path) -> (Rc<Inspection>, Option<String>) {
        let turn = self.turn.get();
        if let Some(known) = self.inspected.borrow_mut().get_mut(path)
            && (known.turn == turn || known.inputs.are_unchanged(self, &self.bodies))
        {
            known.turn = turn;
            return (known.whole.clone(), known.defect.clone());
        }
        let recorder = Recorder::new(self, &self.bodies);
        // The compiler keeps nothing between two calls, so that a panic leaves nothing half done.
        let (whole, defect) = match catch_unwind(AssertUnwindSafe(|| inspect(path, &recorder, &recorder))) {
            Ok(whole) => (Rc::new(whole), None),
            Err(panic) => (Rc::default(), Some(words_of(&*panic))),
        };
        let fresh = Inspected { whole: whole.clone(), defect: defect.clone(), inputs: recorder.into_inputs(), turn };
        let mut inspected = self.inspected.borrow_mut();
        inspected.insert(path.to_path_buf(), fresh);
        while inspected.len() > MOST_INSPECTIONS + self.documents.len() {
            let closed = inspected.iter().filter(|(path, _)| !self.documents.contains_key(*path));
            let Some(oldest) = closed.min_by_key(|(_, known)| known.turn).map(|(path, _)| path.clone()) else { break };
            inspected.remove(&oldest);
        }
        (whole, defect)
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
        let turn = self.turn.get();
        if let Some(known) = self.indexed.borrow().as_ref().filter(|known| known.turn == turn) {
            return known.index.clone();
        }
        let files = self.files();
        let mut indexed = self.indexed.borrow_mut();
        if let Some(known) = indexed.as_mut()
            && known.files == files
            && known.inputs.are_unchanged(self, &self.bodies)
        {
            known.turn = turn;
            return known.index.clone();
        }
        let recorder = Recorder::new(self, &self.bodies);
        let index = Rc::new(Index::of(&files, &recorder));
        *indexed = Some(Indexed { index: index.clone(), files, inputs: recorder.into_inputs(), turn });
        index
    }

    /// The same if the texts of some files were others.
    pub fn index_assuming(&self, texts: &BTreeMap<PathBuf, String>) -> Index {
        Index::of(&self.files(), &Assumed { below: self, texts })
    }

    /// A vocabulary for texts of which too little can be read to know their body: that of the body used last.
    pub fn some_vocabulary(&self) -> Option<Vocabulary> {
        self.bodies.described.borrow().iter().rev().find_map(|known| known.vocabulary.clone().ok())
    }
}

impl Loader for Workspace<'_> {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        match self.documents.get(path) {
            Some(document) => Ok(document.text.clone()),
            None => self.loader.load(path),
        }
    }

    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        self.loader.load_bytes(path, limit)
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

    fn load_bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
        self.below.load_bytes(path, limit)
    }
}

/// The file at `path` in an inspection.
pub fn file_of(whole: &Inspection, path: &Path) -> Option<FileId> {
    whole.files.iter().find(|file| file.path == path).map(|file| file.tree.file)
}

/// The words of a panic.
pub fn words_of(panic: &(dyn Any + Send)) -> String {
    let words = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    words.unwrap_or("a panic without message").to_owned()
}

/// Bodies that are described once: their vocabularies are large, and texts change with every key.
struct Bodies<'a> {
    source: &'a dyn BodySource,
    /// The last one used stands at the end.
    described: RefCell<Vec<Described>>,
}

/// A body at one of its revisions.
struct Described {
    description: BodyDescription,
    revision: u64,
    vocabulary: Result<Vocabulary, String>,
}

/// Most bodies that are kept.
const MOST_BODIES: usize = 8;

impl<'a> Bodies<'a> {
    fn new(source: &'a dyn BodySource) -> Self {
        Self { source, described: RefCell::default() }
    }
}

impl BodySource for Bodies<'_> {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        self.source.find(name)
    }

    fn vocabulary(&self, description: &BodyDescription) -> Result<Vocabulary, String> {
        let revision = self.source.revision(description);
        let known = self.described.borrow().iter().position(|known| known.description == *description);
        let known = known.map(|place| self.described.borrow_mut().remove(place));
        let vocabulary = match known.filter(|known| known.revision == revision) {
            Some(known) => known.vocabulary,
            None => self.source.vocabulary(description),
        };
        let mut described = self.described.borrow_mut();
        let excess = (described.len() + 1).saturating_sub(MOST_BODIES);
        described.drain(..excess);
        described.push(Described { description: description.clone(), revision, vocabulary: vocabulary.clone() });
        vocabulary
    }

    fn revision(&self, description: &BodyDescription) -> u64 {
        self.source.revision(description)
    }

    fn trace(&self, description: &BodyDescription, motion: &Motion) -> Result<Vec<Vec<[f64; 3]>>, String> {
        self.source.trace(description, motion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Nothing;

    impl Loader for Nothing {
        fn load(&self, path: &Path) -> Result<String, LoadError> {
            Err(LoadError::Missing(path.to_path_buf()))
        }
    }

    impl BodySource for Nothing {
        fn find(&self, _: &str) -> Option<(PathBuf, String)> {
            None
        }

        fn vocabulary(&self, _: &BodyDescription) -> Result<Vocabulary, String> {
            Ok(Vocabulary::default())
        }
    }

    #[test]
    fn what_is_understood_of_closed_files_is_bounded() {
        let mut workspace = Workspace::new(&Nothing, &Nothing, &|_| Vec::new());
        let path = |number: usize| PathBuf::from(format!("/{number}.msk"));
        let uri: Uri = "file:///0.msk".parse().unwrap();
        workspace.put(path(0), Document { uri, version: 1, text: "const a = 1\n".to_owned() });
        let open = workspace.inspect(&path(0));
        for number in 1..100 {
            workspace.next_turn();
            workspace.inspect(&path(number));
            assert!(workspace.inspected.borrow().len() <= MOST_INSPECTIONS + 1);
        }
        assert!(Rc::ptr_eq(&open, &workspace.inspect(&path(0))), "the analysis of an open document is kept");
    }

    #[test]
    fn bodies_are_bounded_and_the_one_used_last_stays() {
        let bodies = Bodies::new(&Nothing);
        let body = |number: usize| BodyDescription { name: format!("body{number}"), ..BodyDescription::default() };
        bodies.vocabulary(&body(0)).unwrap();
        for number in 1..100 {
            bodies.vocabulary(&body(number)).unwrap();
            bodies.vocabulary(&body(0)).unwrap();
            assert!(bodies.described.borrow().len() <= MOST_BODIES);
            assert!(bodies.described.borrow().iter().any(|known| known.description == body(0)));
        }
    }
}

//! Reading: the entry, the files that it uses, and the body files of its tasks, each once.

use super::SourceFile;
use crate::diagnostics::{Diagnostic, FileId, SourceMap, Span, codes};
use crate::files::{BodySource, LoadError, Loader, Piece, plain};
use crate::syntax::tree::{self, Item, TaskStatement};
use crate::syntax::{self, Parsed};
use crate::work::visit;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Files that are being read.
pub(super) struct Reader<'a> {
    loader: &'a dyn Loader,
    pub(super) sources: SourceMap,
    pub(super) files: Vec<SourceFile>,
    /// Place of each file, by its path.
    places: BTreeMap<PathBuf, usize>,
    /// Bytes of the entry and of all that is used.
    bytes: usize,
    pub(super) diagnostics: Vec<Diagnostic>,
}

/// Most files that one compilation reads.
pub const MAXIMUM_FILES: usize = 1000;

/// Most bytes that all files of one compilation may have.
pub const MAXIMUM_BYTES: usize = 16 << 20;

impl<'a> Reader<'a> {
    pub(super) fn new(loader: &'a dyn Loader) -> Self {
        let (sources, files, places, diagnostics) = Default::default();
        Self { loader, sources, files, places, bytes: 0, diagnostics }
    }

    /// Reads the entry and, breadth first, what it uses; a file that several use is read once.
    pub(super) fn read_all(&mut self, entry: &Path) -> Result<(), LoadError> {
        let entry = plain(entry);
        let text = self.loader.load(&entry)?;
        self.bytes = text.len();
        self.add(vec![(entry, text)]);
        let mut next = 0;
        while next < self.files.len() {
            let file = self.files[next].tree.file;
            let base = self.files[next].path.parent().map(Path::to_path_buf).unwrap_or_default();
            let used: Vec<tree::Text> = self.files[next]
                .tree
                .items
                .iter()
                .filter_map(|item| if let Item::Use(used) = item { Some(used.path.clone()) } else { None })
                .collect();
            let (mut uses, mut read, mut full) = (BTreeSet::new(), Vec::new(), false);
            for path in used {
                visit(1);
                match self.read_used(&plain(&base.join(&path.value)), &mut read) {
                    Ok(index) if uses.insert(index) => self.files[next].uses.push(index),
                    Ok(_) => {}
                    Err(UseError::Load(problem)) => {
                        let message = format!("cannot use \"{}\": {problem}", path.value);
                        let diagnostic = Diagnostic::new(codes::names::FILE, file, path.span, message)
                            .help("the path is relative to the file that contains the `use`");
                        self.diagnostics.push(diagnostic);
                    }
                    Err(UseError::TooMany(message)) => {
                        let diagnostic = Diagnostic::new(codes::tasks::TOO_LARGE, file, path.span, message)
                            .help("compile its parts separately: this file and later ones are not compiled");
                        self.diagnostics.push(diagnostic);
                        full = true;
                        break;
                    }
                }
            }
            self.add(read);
            if full {
                return Ok(());
            }
            next += 1;
        }
        Ok(())
    }

    /// The place of a file that is used, and its text in `read` if it is new.
    fn read_used(&mut self, path: &Path, read: &mut Vec<(PathBuf, String)>) -> Result<usize, UseError> {
        if let Some(known) = self.places.get(path) {
            return Ok(*known);
        }
        let place = self.files.len() + read.len();
        if place >= MAXIMUM_FILES {
            return Err(UseError::TooMany(format!(
                "this would be file number {}: the limit is {MAXIMUM_FILES}",
                MAXIMUM_FILES + 1
            )));
        }
        let text = self.loader.load(path)?;
        if self.bytes + text.len() > MAXIMUM_BYTES {
            let found = format!("with this file the total size exceeds {} MB", MAXIMUM_BYTES >> 20);
            return Err(UseError::TooMany(found));
        }
        self.bytes += text.len();
        self.places.insert(path.to_path_buf(), place);
        read.push((path.to_path_buf(), text));
        Ok(place)
    }

    /// Parses texts, of which none needs another, and keeps them in their order.
    fn add(&mut self, texts: Vec<(PathBuf, String)>) {
        let named = texts.into_iter().map(|(path, text)| (self.sources.add(path.display().to_string(), text), path));
        let named: Vec<(FileId, PathBuf)> = named.collect();
        let sources = &self.sources;
        let parse = |file: FileId| syntax::parse(file, sources.text(file));
        let mut parsed: Vec<Option<Parsed>> = named.iter().map(|_| None).collect();
        let work =
            named.iter().zip(&mut parsed).map(|((file, _), parsed)| -> Piece<'_> { Box::new(|| *parsed = Some(parse(*file))) });
        self.loader.side_by_side(work.collect());
        for ((file, path), parsed) in named.into_iter().zip(parsed) {
            let Parsed { tree, diagnostics, .. } = parsed.unwrap_or_else(|| parse(file));
            self.diagnostics.extend(diagnostics);
            self.places.insert(path.clone(), self.files.len());
            self.files.push(SourceFile { path, tree, uses: Vec::new() });
        }
    }

    /// Finds the body of every task that no file declares: in a folder `bodies` beside or above the entry, else built in.
    pub(super) fn read_bodies(&mut self, entry: &Path, bodies: &dyn BodySource) {
        let mut wanted = BTreeSet::new();
        let mut declared = BTreeSet::new();
        for item in self.files.iter().flat_map(|file| &file.tree.items) {
            match item {
                Item::Task(tree::Task { statements, .. }) | Item::Sequence(tree::Sequence { statements, .. }) => {
                    wanted.extend(statements.iter().filter_map(|statement| match statement {
                        TaskStatement::Body(body) => Some(body.name.text.clone()),
                        _ => None,
                    }));
                }
                Item::Body(body) => {
                    declared.insert(body.name.text.clone());
                }
                _ => {}
            }
        }
        for name in wanted.difference(&declared) {
            self.read_body(entry, name, bodies);
        }
    }

    fn read_body(&mut self, entry: &Path, name: &str, bodies: &dyn BodySource) {
        let entry = plain(entry);
        for folder in entry.ancestors().skip(1) {
            let path = folder.join("bodies").join(format!("{name}.msk"));
            match self.loader.load(&path) {
                Ok(text) => {
                    self.add(vec![(path, text)]);
                    return;
                }
                Err(LoadError::Missing(_)) => {}
                Err(problem) => {
                    let file = self.files[0].tree.file;
                    let message = problem.to_string();
                    self.diagnostics.push(Diagnostic::new(codes::names::FILE, file, Span::default(), message));
                    return;
                }
            }
        }
        if let Some((path, text)) = bodies.find(name) {
            self.add(vec![(path, text)]);
        }
    }
}

/// Why a file cannot be used.
enum UseError {
    Load(LoadError),
    /// There are too many, or too much is written in them: in words.
    TooMany(String),
}

impl From<LoadError> for UseError {
    fn from(error: LoadError) -> Self {
        Self::Load(error)
    }
}

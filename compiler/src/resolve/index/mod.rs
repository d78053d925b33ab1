//! Which name means which declaration, in all files, whether their tasks are checked or not. Editors query it for definitions,
//! references and renaming.
//!
//! 1. [`Index::of`] reads the files and what they use;
//! 2. `declare` collects what files, tasks and bodies declare; what a task overrides is the same symbol as what it inherits;
//! 3. `refer` walks through all formulas and statements and resolves each name, in the order in which `scope` looks.
//!
//! `compiler/tests/agreement.rs` tests that the checker, which resolves through `scope`, finds the same.

mod declare;
mod refer;

use crate::diagnostics::{FileId, SourceMap, Span};
use crate::files::{Loader, plain};
use crate::syntax;
use crate::syntax::tree::{self, Item};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Names of different spaces do not clash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Space {
    /// Constants, functions, lets, states, parameters, objects and their parts (`door.leaf`), ...
    Value,
    /// Terms of the reward.
    Term,
    /// Labels of channels and metrics.
    Label,
    /// Reasons that end an episode.
    Reason,
    /// Tasks and sequences.
    Task,
    /// Bodies.
    Body,
    /// Landmarks, groups and aliases of a body file.
    Part,
    /// Poses of a body file.
    Pose,
}

/// A declared name.
#[derive(Debug)]
pub struct Symbol {
    /// As written; of a part of an object, its last word.
    pub name: String,
    /// Among which names.
    pub space: Space,
    /// What declares it: `let`, `fn`, `state`, ...
    pub what: &'static str,
    /// Its documentation.
    pub docs: String,
}

/// A place at which a symbol is named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Occurrence {
    /// Which file.
    pub file: usize,
    /// Which bytes.
    pub span: Span,
    /// Which symbol.
    pub symbol: usize,
    /// Whether it is declared there.
    pub declares: bool,
    /// Whether it is one of the names of a brace pattern, which cannot be changed by itself.
    pub pattern: bool,
}

/// A file of the index.
pub struct SourceFile {
    /// Where it is.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// As read.
    pub tree: tree::File,
    /// Files that it uses.
    pub uses: Vec<usize>,
}

/// What is declared in a task or sequence: by space and name, `door.leaf` for parts of objects.
pub type Names = BTreeMap<(Space, String), usize>;

/// All names of all files.
#[derive(Default)]
pub struct Index {
    /// The files.
    pub files: Vec<SourceFile>,
    /// The symbols.
    pub symbols: Vec<Symbol>,
    /// Sorted by file and place.
    pub occurrences: Vec<Occurrence>,
    /// What each file declares at its top, without what it uses.
    top: Vec<Names>,
    /// Place of each file, by its path.
    places: BTreeMap<PathBuf, usize>,
    /// Names that tasks were given by those that they extend, counted.
    inherited: usize,
    /// What is in sight of each task, by file and place among its items.
    tasks: BTreeMap<(usize, usize), Names>,
}

impl Index {
    /// Reads files and all that they use. What cannot be loaded is left out.
    pub fn of(paths: &[PathBuf], loader: &dyn Loader) -> Self {
        let mut index = Self::default();
        let mut sources = SourceMap::default();
        for path in paths {
            index.read(path, loader, &mut sources);
        }
        let mut next = 0;
        while next < index.files.len() {
            let base = index.files[next].path.parent().map(Path::to_path_buf).unwrap_or_default();
            let items = index.files[next].tree.items.iter();
            let used: Vec<PathBuf> = items
                .filter_map(|item| if let Item::Use(used) = item { Some(plain(&base.join(&used.path.value))) } else { None })
                .collect();
            for path in used {
                let place = index.read(&path, loader, &mut sources);
                index.files[next].uses.extend(place);
            }
            next += 1;
        }
        declare::declare(&mut index);
        refer::refer(&mut index);
        index.occurrences.sort_unstable();
        index.occurrences.dedup();
        index
    }

    fn read(&mut self, path: &Path, loader: &dyn Loader, sources: &mut SourceMap) -> Option<usize> {
        if let Some(known) = self.file(path) {
            return Some(known);
        }
        let text = loader.load(path).ok()?;
        let file: FileId = sources.add(path.display().to_string(), "");
        let tree = syntax::parse(file, &text).tree;
        self.places.insert(path.to_path_buf(), self.files.len());
        self.files.push(SourceFile { path: path.to_path_buf(), text, tree, uses: Vec::new() });
        Some(self.files.len() - 1)
    }

    /// The place of a file in the index.
    pub fn file(&self, path: &Path) -> Option<usize> {
        self.places.get(path).copied()
    }

    /// What is named at a byte of a file, the end of the name included.
    pub fn at(&self, file: usize, byte: usize) -> Option<Occurrence> {
        let here =
            |known: &&Occurrence| known.file == file && known.span.start as usize <= byte && byte <= known.span.end as usize;
        self.occurrences.iter().filter(here).min_by_key(|known| known.span.end - known.span.start).copied()
    }

    /// Every place at which a symbol is named.
    pub fn places_of(&self, symbol: usize) -> impl Iterator<Item = &Occurrence> {
        self.occurrences.iter().filter(move |known| known.symbol == symbol)
    }

    /// Symbols in sight at a byte of a file: of the task around it, of the file and of what it uses.
    pub fn in_sight(&self, file: usize, byte: usize) -> Vec<&Symbol> {
        let mut found: Vec<usize> = Vec::new();
        let items = self.files[file].tree.items.iter().enumerate();
        let around =
            items.filter(|(_, item)| span_of(item).is_some_and(|span| span.start as usize <= byte && byte <= span.end as usize));
        for (place, _) in around {
            found.extend(self.tasks.get(&(file, place)).into_iter().flat_map(|names| names.values()));
        }
        for source in std::iter::once(&file).chain(&self.files[file].uses) {
            found.extend(self.top[*source].values());
        }
        found.sort_unstable();
        found.dedup();
        found.into_iter().map(|symbol| &self.symbols[symbol]).collect()
    }

    /// What a name means at the top of a file or of what it uses.
    fn top_level(&self, file: usize, space: Space, name: &str) -> Option<usize> {
        let key = (space, name.to_owned());
        std::iter::once(&file).chain(&self.files[file].uses).find_map(|source| self.top[*source].get(&key).copied())
    }

    fn symbol(&mut self, name: &str, space: Space, what: &'static str, docs: Option<&tree::Docs>) -> usize {
        let docs = docs.map(|docs| docs.text.clone()).unwrap_or_default();
        self.symbols.push(Symbol { name: name.to_owned(), space, what, docs });
        self.symbols.len() - 1
    }

    fn occurs(&mut self, file: usize, span: Span, symbol: usize, declares: bool, pattern: bool) {
        self.occurrences.push(Occurrence { file, span, symbol, declares, pattern });
    }
}

/// The span of a task or sequence.
fn span_of(item: &Item) -> Option<Span> {
    match item {
        Item::Task(task) => Some(task.span),
        Item::Sequence(sequence) => Some(sequence.span),
        _ => None,
    }
}

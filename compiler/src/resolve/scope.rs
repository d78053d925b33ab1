//! Name resolution: which declarations each place sees.
//!
//! 1. [`Globals`] holds the declarations of all files, collected once for a compilation: a function or constant of a library sees
//!    its own file and the files that it uses directly;
//! 2. [`Names`] lays over them what a task declares, which its formulas see besides.
//!
//! Local names come first, then declarations, then the body and the signals.

use super::inherit::WholeTask;
use crate::diagnostics::{Diagnostic, FileId, Span, codes};
use crate::hir::{DefinitionId, TypedFormulas};
use crate::syntax::tree::{
    Binding, Clock, Docs, Entry, File, Function, Item, Observation, Random, Reference, StateDeclaration, TaskParameter,
    TaskStatement,
};
use crate::work::visit;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Where a formula stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Place {
    /// In which file.
    pub file: FileId,
    /// Whether what the task declares is in sight.
    pub in_task: bool,
}

/// What a name is declared to be.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Definition<'a> {
    Const(&'a Binding),
    Let(&'a Binding),
    Function(&'a Function),
    Observation(&'a Observation),
    State(&'a StateDeclaration),
    Clock(&'a Clock),
    Parameter(&'a TaskParameter),
    Random(&'a Random),
    Reference(&'a Reference),
}

impl<'a> Definition<'a> {
    /// Its documentation comment.
    pub(crate) fn docs(&self) -> Option<&'a Docs> {
        match self {
            Self::Const(binding) | Self::Let(binding) => binding.docs.as_ref(),
            Self::Function(function) => function.docs.as_ref(),
            Self::Observation(observation) => observation.docs.as_ref(),
            Self::State(state) => state.docs.as_ref(),
            Self::Clock(clock) => clock.docs.as_ref(),
            Self::Parameter(parameter) => parameter.docs.as_ref(),
            Self::Random(random) => random.docs.as_ref(),
            Self::Reference(reference) => reference.docs.as_ref(),
        }
    }

    pub(crate) fn span(&self) -> Span {
        match self {
            Self::Const(binding) | Self::Let(binding) => binding.name.span,
            Self::Function(function) => function.name.span,
            Self::Observation(observation) => observation.name.span,
            Self::State(state) => state.name.span,
            Self::Clock(clock) => clock.name.span,
            Self::Parameter(parameter) => parameter.name.span,
            Self::Random(random) => random.name.span,
            Self::Reference(reference) => reference.name.span,
        }
    }
}

/// A declaration with its file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Declared<'a> {
    pub definition: Definition<'a>,
    pub file: FileId,
}

impl Declared<'_> {
    /// Its identity.
    pub(crate) fn id(&self) -> DefinitionId {
        DefinitionId { file: self.file, span: self.definition.span() }
    }
}

/// A file with the files that it uses directly.
pub(crate) struct FileInSight<'a> {
    pub tree: &'a File,
    pub uses: Vec<FileId>,
}

/// The declarations of all files, and which file sees which.
///
/// Files may all use each other, so that tables of what each file sees would hold the square of what is declared: a name is looked
/// up among the few files that declare it instead.
#[derive(Debug, Default)]
pub(crate) struct Globals<'a> {
    /// By name, in the order of files and texts.
    declared: BTreeMap<&'a str, Vec<Declared<'a>>>,
    /// Names that each file declares.
    own: BTreeMap<FileId, Vec<&'a str>>,
    /// For each file the files that it sees: itself first, then those that it uses, by their rank in its text.
    ranks: BTreeMap<FileId, BTreeMap<FileId, usize>>,
}

impl<'a> Globals<'a> {
    /// Collects the declarations of all files; visits each declaration and each `use` once.
    pub(crate) fn collect(files: impl IntoIterator<Item = FileInSight<'a>>) -> Self {
        let mut globals = Self::default();
        for FileInSight { tree, uses } in files {
            let own = globals.own.entry(tree.file).or_default();
            for (name, definition) in tree.items.iter().filter_map(top_level) {
                globals.declared.entry(name).or_default().push(Declared { definition, file: tree.file });
                own.push(name);
            }
            visit(own.len() + uses.len());
            let ranks = globals.ranks.entry(tree.file).or_default();
            for (rank, file) in std::iter::once(tree.file).chain(uses).enumerate() {
                ranks.entry(file).or_insert(rank);
            }
        }
        globals
    }

    /// The declaration of `name` that `file` sees: its own before those of files that it uses.
    fn find(&self, file: FileId, name: &str) -> Option<Declared<'a>> {
        let ranks = self.ranks.get(&file)?;
        let seen = self.declared.get(name)?.iter().filter_map(|declared| Some((ranks.get(&declared.file)?, declared)));
        seen.min_by_key(|(rank, _)| **rank).map(|(_, declared)| *declared)
    }

    /// Names that `file` sees, for suggestions: they are put together anew each time.
    fn in_sight(&self, file: FileId) -> BTreeSet<&'a str> {
        let files = self.ranks.get(&file).into_iter().flat_map(BTreeMap::keys);
        files.flat_map(|file| self.own.get(file).into_iter().flatten().copied()).collect()
    }

    /// Reports names that a file sees declared more than once; not many more than `most` of them.
    pub(crate) fn clashes(&self, most: usize) -> Vec<Diagnostic> {
        let mut users: BTreeMap<FileId, Vec<(FileId, usize)>> = BTreeMap::new();
        for (user, ranks) in &self.ranks {
            for (file, rank) in ranks {
                users.entry(*file).or_default().push((*user, *rank));
            }
        }
        let mut clashes = Vec::new();
        for (name, all) in self.declared.iter().filter(|(_, all)| all.len() > 1) {
            // What each file sees of this name. A file that sees two declarations is an error, so that this work is bounded by the
            // number of files for each name that is declared well.
            let mut seen: BTreeMap<FileId, Vec<(usize, Declared<'a>)>> = BTreeMap::new();
            for declared in all {
                for (user, rank) in users.get(&declared.file).into_iter().flatten() {
                    visit(1);
                    seen.entry(*user).or_default().push((*rank, *declared));
                }
            }
            for (_, mut seen) in seen {
                seen.sort_by_key(|(rank, _)| *rank);
                let Some(((_, first), others)) = seen.split_first() else { continue };
                clashes.extend(others.iter().map(|(_, second)| clash(name, *first, *second)));
                if clashes.len() > most {
                    return clashes;
                }
            }
        }
        clashes
    }
}

/// Declarations in sight of one task.
pub(crate) struct Names<'a> {
    task: BTreeMap<&'a str, Declared<'a>>,
    globals: &'a Globals<'a>,
    /// The typed HIR of all that is checked in its sight, where the language server asks for it.
    pub typed: Option<RefCell<Vec<TypedFormulas>>>,
    /// Functions that were called, and so checked.
    pub called: RefCell<BTreeSet<(FileId, String)>>,
}

impl<'a> Names<'a> {
    /// The declarations of files alone.
    pub(crate) fn global(globals: &'a Globals<'a>) -> Self {
        Self { task: BTreeMap::new(), globals, typed: None, called: RefCell::default() }
    }

    /// The declarations of files and those of `task`; clashes with the latter are errors.
    pub(crate) fn of(globals: &'a Globals<'a>, task: &'a WholeTask, diagnostics: &mut Vec<Diagnostic>) -> Self {
        let mut names = Self::global(globals);
        for placed in &task.statements {
            for (name, definition) in in_task(&placed.statement) {
                let declared = Declared { definition, file: placed.file };
                // What is inherited must clash neither where it was written nor where it now stands.
                match [placed.file, task.file].into_iter().find_map(|file| globals.find(file, name)) {
                    Some(first) => diagnostics.push(clash(name, first, declared)),
                    None => declare(&mut names.task, name, declared, diagnostics),
                }
            }
        }
        names
    }

    /// What `name` is declared to be at `place`, and where its own formula stands.
    pub(crate) fn find(&self, place: Place, name: &str) -> Option<(Declared<'a>, Place)> {
        if let Some(declared) = self.task.get(name).filter(|_| place.in_task) {
            return Some((*declared, Place { file: declared.file, in_task: true }));
        }
        let declared = self.globals.find(place.file, name)?;
        Some((declared, Place { file: declared.file, in_task: false }))
    }

    /// Names in sight at `place`.
    pub(crate) fn in_sight(&self, place: Place) -> impl Iterator<Item = &'a str> + '_ {
        let task = self.task.keys().copied().filter(move |_| place.in_task);
        task.chain(self.globals.in_sight(place.file))
    }

    /// What the task itself declares.
    pub(crate) fn of_task(&self) -> impl Iterator<Item = (&'a str, Declared<'a>)> + '_ {
        self.task.iter().map(|(name, declared)| (*name, *declared))
    }
}

fn declare<'a>(
    sight: &mut BTreeMap<&'a str, Declared<'a>>,
    name: &'a str,
    declared: Declared<'a>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    match sight.get(name) {
        // The same declaration reached over two paths is one.
        Some(first) if first.file == declared.file && first.definition.span() == declared.definition.span() => {}
        Some(first) => diagnostics.push(clash(name, *first, declared)),
        None => {
            sight.insert(name, declared);
        }
    }
}

fn clash(name: &str, first: Declared<'_>, second: Declared<'_>) -> Diagnostic {
    Diagnostic::new(codes::names::DECLARED_TWICE, second.file, second.definition.span(), format!("`{name}` is declared twice"))
        .here("again here")
        .label(first.file, first.definition.span(), "first here")
}

fn top_level(item: &Item) -> Option<(&str, Definition<'_>)> {
    match item {
        Item::Const(binding) => Some((&binding.name.text, Definition::Const(binding))),
        Item::Function(function) => Some((&function.name.text, Definition::Function(function))),
        Item::Observation(observation) => Some((&observation.name.text, Definition::Observation(observation))),
        Item::Use(_) | Item::Task(_) | Item::Sequence(_) | Item::Suite(_) | Item::Body(_) => None,
    }
}

fn in_task(statement: &TaskStatement) -> Vec<(&str, Definition<'_>)> {
    match statement {
        TaskStatement::Let(binding) => vec![(&binding.name.text, Definition::Let(binding))],
        TaskStatement::State(state) => vec![(&state.name.text, Definition::State(state))],
        TaskStatement::Clock(clock) => vec![(&clock.name.text, Definition::Clock(clock))],
        TaskStatement::Random(random) => vec![(&random.name.text, Definition::Random(random))],
        TaskStatement::Reference(reference) => vec![(&reference.name.text, Definition::Reference(reference))],
        TaskStatement::Params(block) => {
            let parameters = block.entries.iter().filter_map(|entry| match entry {
                Entry::Item(parameter) => Some((parameter.name.text.as_str(), Definition::Parameter(parameter))),
                _ => None,
            });
            parameters.collect()
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::SourceMap;
    use crate::syntax;
    use crate::work::assert_linear;

    /// Files of one declaration each that all use each other.
    fn crowd(files: usize) -> Vec<File> {
        let mut sources = SourceMap::default();
        let text = |number| format!("const of_{number} = 1\n");
        (0..files).map(|number| syntax::parse(sources.add(format!("{number}.msk"), ""), &text(number)).tree).collect()
    }

    fn globals(trees: &[File]) -> Globals<'_> {
        let ids: Vec<FileId> = trees.iter().map(|tree| tree.file).collect();
        Globals::collect(trees.iter().map(|tree| FileInSight { tree, uses: ids.clone() }))
    }

    #[test]
    fn files_that_all_use_each_other_are_visited_once_for_each_use() {
        // The number of uses is the square of the number of files: the work must not be its cube.
        assert_linear(400, |uses| {
            let trees = crowd(uses.isqrt());
            globals(&trees).declared.len()
        });
        let trees = crowd(30);
        let names = globals(&trees);
        assert_eq!(names.declared.len(), 30);
        for (user, declaring) in [(0, 29), (29, 0), (7, 7)] {
            let found = names.find(trees[user].file, &format!("of_{declaring}")).unwrap();
            assert_eq!(found.file, trees[declaring].file);
        }
    }

    #[test]
    fn a_name_that_many_files_declare_is_reported_a_bounded_number_of_times() {
        let mut sources = SourceMap::default();
        let parse = |_| syntax::parse(sources.add("a.msk", ""), "const same = 1\n").tree;
        let trees: Vec<File> = (0..100).map(parse).collect();
        assert_eq!(globals(&trees).clashes(150).len(), 198);
    }
}

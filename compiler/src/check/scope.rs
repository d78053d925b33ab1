//! Which names mean what, and where.
//!
//! A function or constant of a library sees its own file and what that file uses; a formula of a task sees, besides, what the
//! task declares. Local names come first, then declarations, then the body and the signals.

use super::inherit::WholeTask;
use super::notes::Notebook;
use crate::diagnostics::{Diagnostic, FileId, Span, codes};
use crate::syntax::tree::{
    Binding, Clock, Docs, Entry, Function, Item, Observation, Random, Reference, StateDeclaration, TaskParameter, TaskStatement,
};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap};

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
    /// What its documentation comment says.
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

/// Declarations in sight of one task.
#[derive(Debug, Default)]
pub(crate) struct Names<'a> {
    task: BTreeMap<&'a str, Declared<'a>>,
    files: HashMap<FileId, BTreeMap<&'a str, Declared<'a>>>,
    /// What is understood of each place, where an editor asks for it.
    pub notes: Option<Notebook>,
    /// Functions that were called, and so checked.
    pub called: RefCell<BTreeSet<(FileId, String)>>,
}

/// A file with the files that it uses directly.
pub(crate) struct FileInSight<'a> {
    pub tree: &'a crate::syntax::tree::File,
    pub uses: Vec<&'a crate::syntax::tree::File>,
}

impl<'a> Names<'a> {
    /// Collects the declarations of all files and of `task`; clashes are errors.
    pub(crate) fn collect(files: &[FileInSight<'a>], task: Option<&'a WholeTask>, diagnostics: &mut Vec<Diagnostic>) -> Self {
        let mut names = Self::default();
        for file in files {
            let mut sight = BTreeMap::new();
            for tree in std::iter::once(file.tree).chain(file.uses.iter().copied()) {
                for (name, definition) in tree.items.iter().filter_map(top_level) {
                    declare(&mut sight, name, Declared { definition, file: tree.file }, diagnostics);
                }
            }
            names.files.insert(file.tree.file, sight);
        }
        for placed in task.into_iter().flat_map(|task| &task.statements) {
            for (name, definition) in in_task(&placed.statement) {
                let declared = Declared { definition, file: placed.file };
                // What is inherited must clash neither where it was written nor where it now stands.
                let homes = [Some(placed.file), task.map(|task| task.file)];
                let outside = homes.into_iter().flatten().find_map(|file| names.files.get(&file)?.get(name));
                match outside {
                    Some(first) => diagnostics.push(clash(name, *first, declared)),
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
        let declared = self.files.get(&place.file)?.get(name)?;
        Some((*declared, Place { file: declared.file, in_task: false }))
    }

    /// Names in sight at `place`.
    pub(crate) fn in_sight(&self, place: Place) -> impl Iterator<Item = &'a str> + '_ {
        let task = self.task.keys().copied().filter(move |_| place.in_task);
        task.chain(self.files.get(&place.file).into_iter().flat_map(|sight| sight.keys().copied()))
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

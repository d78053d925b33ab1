//! From files to compiled tasks.
//!
//! 1. the entry file and all that it uses are read and parsed;
//! 2. bodies are described, and the runtime answers with their vocabularies;
//! 3. every task is checked in the sight of its file;
//! 4. tasks without errors are lowered.
//!
//! All errors of all files come in one [`Report`].

mod consequences;
mod inspection;
mod motions;
mod networks;
mod reading;
mod settings;
mod units;
mod unread;

pub use crate::check::suite::{Protocol, Suite};
pub use inspection::{InspectedFile, Inspection, TaskScope};
pub use reading::{MAXIMUM_BYTES, MAXIMUM_FILES};

use crate::body::BodyDescription;
use crate::check;
use crate::check::uncalled::Cycles;
use crate::diagnostics::{Checked, Diagnostic, FileId, Report, Reported, SourceMap, Span, Stage, allowance, codes};
use crate::files::{BodySource, Loader, plain};
use crate::resolve::Texts;
use crate::resolve::scope::{FileInSight, Globals, Names};
use crate::snapshot::body_digest;
use crate::syntax;
use crate::syntax::tree::{self, Item};
use crate::task::CompiledTask;
use crate::vocabulary::Vocabulary;
use reading::Reader;
use std::cell::RefCell;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a compilation gives.
pub struct Compilation {
    /// All tasks of the entry file and of what it uses, in the order of reading.
    pub tasks: Vec<Arc<CompiledTask>>,
    /// All bodies that the files declare or the tasks run on, by name.
    pub bodies: Vec<Arc<BodyDescription>>,
    /// The suites of the entry file.
    pub suites: Vec<Suite>,
    /// Declarations of the entry file (constants, functions, blocks of channels, bodies, tasks, sequences, suites).
    pub declarations: usize,
    /// Warnings, sorted.
    pub warnings: Vec<Diagnostic>,
    /// The files that warnings point into.
    pub sources: SourceMap,
}

impl Compilation {
    /// The tasks of the suites in their order, each once; all tasks where there is no suite.
    pub fn members(&self) -> Vec<&Arc<CompiledTask>> {
        let families = self.suites.iter().flat_map(|suite| &suite.families);
        let mut names: Vec<&str> = families.flat_map(|(_, members)| members).map(String::as_str).collect();
        if names.is_empty() {
            return self.tasks.iter().collect();
        }
        let mut seen = BTreeSet::new();
        names.retain(|name| seen.insert(*name));
        names.into_iter().filter_map(|name| self.tasks.iter().find(|task| task.name == name)).collect()
    }
}

/// A parameter that is set from outside.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setting {
    /// `speed`, or `walk.speed` for the parameter of one task.
    pub name: String,
    /// The value with its unit: `1.5 m/s`; a plain number has the unit in which the parameter is written.
    pub value: String,
}

/// Compiles a file and all that it uses.
///
/// # Errors
/// A [`Report`] with every error and warning of every file.
pub fn compile(entry: &Path, loader: &dyn Loader, bodies: &dyn BodySource) -> Result<Compilation, Report> {
    compile_with(entry, loader, bodies, &[])
}

/// Compiles a file and all that it uses, with parameters set from outside.
///
/// # Errors
/// A [`Report`] with every error and warning of every file and of the settings: one that no task has is an error.
pub fn compile_with(
    entry: &Path,
    loader: &dyn Loader,
    bodies: &dyn BodySource,
    settings: &[Setting],
) -> Result<Compilation, Report> {
    let Inspection { report, tasks, bodies, suites, files, .. } = run(entry, loader, bodies, settings, false);
    if report.has_errors() {
        return Err(report);
    }
    let items = files.first().map_or(&[][..], |file| &file.tree.items);
    let declarations = items.iter().filter(|item| !matches!(item, Item::Use(_))).count();
    Ok(Compilation { tasks, bodies, suites, declarations, warnings: report.diagnostics, sources: report.sources })
}

/// Compiles a file and all that it uses, and keeps what was understood of every place: for editors. Whatever is wrong, the
/// rest is there.
pub fn inspect(entry: &Path, loader: &dyn Loader, bodies: &dyn BodySource) -> Inspection {
    run(entry, loader, bodies, &[], true)
}

fn run(entry: &Path, loader: &dyn Loader, bodies: &dyn BodySource, settings: &[Setting], noting: bool) -> Inspection {
    let mut reader = Reader::new(loader);
    if let Err(problem) = reader.read_all(entry) {
        let message = problem.to_string();
        let file = reader.sources.add(entry.display().to_string(), "");
        let diagnostic = Diagnostic::new(codes::names::FILE, file, Span::default(), message);
        return Inspection { report: Report::new(reader.sources, vec![diagnostic]), ..Inspection::default() };
    }
    reader.read_bodies(entry, bodies);
    let Reader { mut sources, files, mut diagnostics, .. } = reader;
    let motions = motions::read(&files, loader, &mut sources, &mut diagnostics);
    let networks = networks::read(&files, loader, &mut diagnostics);
    let settings = settings::read(settings, &mut sources, &mut diagnostics);
    let ids: Vec<FileId> = files.iter().map(|file| file.tree.file).collect();
    let uses = |file: &SourceFile| file.uses.iter().map(|&used| ids[used]).collect();
    let globals = Globals::collect(files.iter().map(|file| FileInSight { tree: &file.tree, uses: uses(file) }));
    let names = Names::global(&globals);
    let described = describe_bodies(&files, &names, bodies, &mut diagnostics);
    let all_tasks = task_names(&files, &mut diagnostics);
    let texts = SourceTexts(&sources);
    let mut units = units::collect(&files, &texts, &mut diagnostics);
    settings::apply(&settings, &mut units, &mut diagnostics);
    let (mut tasks, mut scopes) = (Vec::new(), Vec::new());
    let unread = RefCell::default();
    diagnostics.extend(globals.clashes(syntax::MAXIMUM_ERRORS));
    for unit in &units {
        let (described, texts, motions, networks) = (&described, &texts, &motions, &networks);
        let (globals, called, unread) = (&globals, &names.called, &unread);
        let compiler = units::Compiler { described, bodies, texts, motions, networks, globals, noting, called, unread };
        // One that fails has been reported.
        tasks.extend(compiler.compile(unit, &mut scopes, &mut diagnostics).map(Arc::new));
    }
    let suites = suites(&files, &names, &all_tasks, &mut diagnostics);
    let known: Vec<&Vocabulary> = described.values().filter_map(|body| body.vocabulary.as_ref().ok()).collect();
    let cycles = Cycles::of(files.iter().map(|file| &file.tree), &names);
    for file in &files {
        check::uncalled::check(&file.tree, &names, &cycles, &names.called.borrow(), &known, &mut diagnostics);
    }
    consequences::forget(&sources, &mut diagnostics);
    unread.into_inner().drop_read(&mut diagnostics);
    if Reported::among(&diagnostics).is_none() {
        // A task with errors may be the one that needs an `allow`.
        let allowances = tasks.iter().flat_map(|task: &Arc<CompiledTask>| &task.places.allowances);
        diagnostics.extend(allowance::unfulfilled(allowances, Stage::Compile));
    }
    let report = Report::new(sources, diagnostics);
    let bodies = described.into_values().map(|body| body.description).collect();
    let files = files.into_iter().map(|file| InspectedFile { path: file.path, tree: file.tree, uses: file.uses }).collect();
    Inspection { report, tasks, bodies, suites, files, scopes }
}

/// A file with those that it uses, by their place in the list of files.
struct SourceFile {
    path: PathBuf,
    tree: tree::File,
    uses: Vec<usize>,
}

/// A body with what tasks on it may name.
struct Described {
    description: Arc<BodyDescription>,
    /// For content hashes.
    digest: String,
    vocabulary: Checked<Vocabulary>,
}

fn describe_bodies<'a>(
    files: &'a [SourceFile],
    names: &'a Names<'a>,
    bodies: &dyn BodySource,
    diagnostics: &mut Vec<Diagnostic>,
) -> BTreeMap<String, Described> {
    let mut described = BTreeMap::new();
    let mut unreadable: BTreeMap<FileId, Reported> = BTreeMap::new();
    for diagnostic in diagnostics.iter() {
        unreadable.extend(Reported::among([diagnostic]).map(|reported| (diagnostic.file(), reported)));
    }
    for file in files {
        for item in &file.tree.items {
            let Item::Body(body) = item else { continue };
            let mut own = Vec::new();
            let mut description = check::body::describe(body, file.tree.file, names, &mut own);
            let base = file.path.parent().map(Path::to_path_buf).unwrap_or_default();
            description.model = plain(&base.join(&description.model)).display().to_string();
            // A body whose text is broken is not bound: the model would only be blamed for it.
            let broken = Reported::among(&own).or(unreadable.get(&file.tree.file).copied());
            unreadable.extend(broken.map(|reported| (file.tree.file, reported)));
            diagnostics.append(&mut own);
            let vocabulary = match broken {
                Some(reported) => Err(reported),
                None => bind(&description, body, file.tree.file, bodies, diagnostics),
            };
            let digest = body_digest(&description);
            let entry = Described { description: Arc::new(description), digest, vocabulary };
            if described.insert(body.name.text.clone(), entry).is_some() {
                let message = format!("the body `{}` is declared twice", body.name.text);
                diagnostics.push(Diagnostic::new(codes::names::DECLARED_TWICE, file.tree.file, body.name.span, message));
            }
        }
    }
    described
}

fn bind(
    description: &BodyDescription,
    body: &tree::Body,
    file: FileId,
    bodies: &dyn BodySource,
    diagnostics: &mut Vec<Diagnostic>,
) -> Checked<Vocabulary> {
    match bodies.vocabulary(description) {
        Ok(vocabulary) => Ok(vocabulary),
        Err(problems) => {
            let message = format!("the body `{}` does not match its model", body.name.text);
            let mut diagnostic = Diagnostic::new(codes::names::BODY, file, body.name.span, message);
            for problem in problems.lines() {
                diagnostic = diagnostic.help(problem);
            }
            Err(diagnostic.report(diagnostics))
        }
    }
}

fn task_names<'a>(files: &'a [SourceFile], diagnostics: &mut Vec<Diagnostic>) -> Vec<&'a str> {
    let mut names: BTreeMap<&str, (FileId, Span)> = BTreeMap::new();
    for file in files {
        for item in &file.tree.items {
            let task_name = match item {
                Item::Task(task) => &task.name,
                Item::Sequence(sequence) => &sequence.name,
                _ => continue,
            };
            match names.entry(&task_name.text) {
                Entry::Vacant(free) => {
                    free.insert((file.tree.file, task_name.span));
                }
                Entry::Occupied(known) => {
                    let (first_file, first) = *known.get();
                    let message = format!("the task `{}` is declared twice", task_name.text);
                    let diagnostic = Diagnostic::new(codes::names::DECLARED_TWICE, file.tree.file, task_name.span, message)
                        .here("again here")
                        .label(first_file, first, "first here");
                    diagnostics.push(diagnostic);
                }
            }
        }
    }
    names.into_keys().collect()
}

struct SourceTexts<'a>(&'a SourceMap);

impl Texts for SourceTexts<'_> {
    fn text(&self, file: FileId, span: Span) -> &str {
        span.of(self.0.text(file))
    }
}

/// The suites of the entry file; those of other files are checked, too.
fn suites<'a>(files: &'a [SourceFile], names: &'a Names<'a>, tasks: &[&str], diagnostics: &mut Vec<Diagnostic>) -> Vec<Suite> {
    let mut suites = Vec::new();
    for (index, file) in files.iter().enumerate() {
        for item in &file.tree.items {
            let Item::Suite(suite) = item else { continue };
            let checked = check::suite::check(suite, file.tree.file, names, tasks, diagnostics);
            if index == 0 {
                suites.push(checked);
            }
        }
    }
    suites
}

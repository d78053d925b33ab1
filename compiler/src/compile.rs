//! From files to compiled tasks.
//!
//! 1. the entry file and all that it uses are read and parsed;
//! 2. bodies are described, and the runtime answers with their vocabularies;
//! 3. every task is checked in the sight of its file;
//! 4. tasks without errors are lowered.
//!
//! All errors of all files come in one [`Report`].

mod inspection;
mod motions;
mod settings;
mod units;

pub use inspection::{InspectedFile, Inspection, TaskScope};

use crate::body::BodyDescription;
use crate::check::scope::FileInSight;
use crate::check::{self, Texts};
use crate::diagnostics::{Checked, Diagnostic, FileId, Report, Reported, SourceMap, Span, codes};
use crate::files::{BodySource, LoadError, Loader, plain};
use crate::syntax;
use crate::syntax::tree::{self, Item, TaskStatement};
use crate::task::CompiledTask;
use crate::vocabulary::Vocabulary;
use std::cell::RefCell;
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

/// Families of tasks and the protocols by which policies are compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Suite {
    /// Its name.
    pub name: String,
    /// Families with the names of their tasks.
    pub families: Vec<(String, Vec<String>)>,
    /// The ways to evaluate it; the first is the default.
    pub protocols: Vec<Protocol>,
}

/// A protocol of a suite: how many episodes, from which seed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Protocol {
    /// Its name; empty if it has none.
    pub name: String,
    /// Episodes per task.
    pub episodes: u32,
    /// Seed of the first episode.
    pub seed: u64,
}

impl Default for Protocol {
    fn default() -> Self {
        Self { name: String::new(), episodes: 50, seed: 0 }
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
    let mut reader = Reader { loader, sources: SourceMap::default(), files: Vec::new(), diagnostics: Vec::new() };
    if let Err(problem) = reader.read_all(entry) {
        let message = problem.to_string();
        let file = reader.sources.add(entry.display().to_string(), "");
        let diagnostic = Diagnostic::new(codes::names::FILE, file, Span::default(), message);
        return Inspection { report: Report::new(reader.sources, vec![diagnostic]), ..Inspection::default() };
    }
    reader.read_bodies(entry, bodies);
    let Reader { mut sources, files, mut diagnostics, .. } = reader;
    let motions = motions::read(&files, loader, &mut sources, &mut diagnostics);
    let settings = settings::read(settings, &mut sources, &mut diagnostics);
    let described = describe_bodies(&files, bodies, &mut diagnostics);
    let all_tasks = task_names(&files, &mut diagnostics);
    let texts = SourceTexts(&sources);
    let mut units = units::collect(&files, &texts, &mut diagnostics);
    settings::apply(&settings, &mut units, &mut diagnostics);
    let (mut tasks, mut scopes) = (Vec::new(), Vec::new());
    let called = RefCell::default();
    for unit in &units {
        let in_sight = in_sight(&files, unit.home);
        let (described, texts, motions) = (&described, &texts, &motions);
        let compiler = units::Compiler { described, bodies, texts, motions, in_sight, noting, called: &called };
        // One that fails has said why.
        tasks.extend(compiler.compile(unit, &mut scopes, &mut diagnostics).map(Arc::new));
    }
    let known: Vec<&Vocabulary> = described.values().filter_map(|body| body.vocabulary.as_ref().ok()).collect();
    for home in 0..files.len() {
        let mut sight = in_sight(&files, home);
        // The file itself comes first.
        sight.sort_by_key(|one| one.tree.file != files[home].tree.file);
        check::uncalled::check(&sight, &called.borrow(), &known, &mut diagnostics);
    }
    let suites = suites(&files, &all_tasks, &mut diagnostics);
    drop_consequences(&sources, &files, &mut diagnostics);
    let report = Report::new(sources, diagnostics);
    let bodies = described.into_values().map(|body| body.description).collect();
    let files = files.into_iter().map(|file| InspectedFile { path: file.path, tree: file.tree, uses: file.uses }).collect();
    Inspection { report, tasks, bodies, suites, files, scopes }
}

/// Drops complaints about names whose declaration is there, but could not be read: only the declaration is at fault.
fn drop_consequences(sources: &SourceMap, files: &[SourceFile], diagnostics: &mut Vec<Diagnostic>) {
    let unreadable: Vec<&str> = files
        .iter()
        .map(|file| file.tree.file)
        .filter(|file| diagnostics.iter().any(|told| told.code.id.starts_with("E01") && told.file() == *file))
        .map(|file| sources.text(file))
        .collect();
    let declared = |name: &str| {
        let words = ["fn", "let", "const", "state", "clock", "random", "reference", "observation", "task"];
        !name.is_empty() && words.iter().any(|word| unreadable.iter().any(|text| text.contains(&format!("{word} {name}"))))
    };
    diagnostics.retain(|told| told.code != codes::names::UNKNOWN_NAME || !declared(told.span().of(sources.text(told.file()))));
}

/// A file with those that it uses, by their place in the list of files.
struct SourceFile {
    path: PathBuf,
    tree: tree::File,
    uses: Vec<usize>,
}

struct Reader<'a> {
    loader: &'a dyn Loader,
    sources: SourceMap,
    files: Vec<SourceFile>,
    diagnostics: Vec<Diagnostic>,
}

impl Reader<'_> {
    /// Reads the entry and, breadth first, what it uses; a file that several use is read once.
    fn read_all(&mut self, entry: &Path) -> Result<(), LoadError> {
        let entry = plain(entry);
        let text = self.loader.load(&entry)?;
        self.add(entry, text);
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
            for path in used {
                match self.read_used(&plain(&base.join(&path.value))) {
                    Ok(index) => self.files[next].uses.push(index),
                    Err(problem) => {
                        let message = format!("cannot use \"{}\": {problem}", path.value);
                        let diagnostic = Diagnostic::new(codes::names::FILE, file, path.span, message)
                            .help("the path is relative to the file that uses it");
                        self.diagnostics.push(diagnostic);
                    }
                }
            }
            next += 1;
        }
        Ok(())
    }

    fn read_used(&mut self, path: &Path) -> Result<usize, LoadError> {
        if let Some(known) = self.files.iter().position(|file| file.path == path) {
            return Ok(known);
        }
        let text = self.loader.load(path)?;
        Ok(self.add(path.to_path_buf(), text))
    }

    fn add(&mut self, path: PathBuf, text: String) -> usize {
        let file = self.sources.add(path.display().to_string(), text);
        let parsed = syntax::parse(file, self.sources.text(file));
        self.diagnostics.extend(parsed.diagnostics);
        self.files.push(SourceFile { path, tree: parsed.tree, uses: Vec::new() });
        self.files.len() - 1
    }

    /// Finds the body of every task that no file declares: in a folder `bodies` beside or above the entry, else built in.
    fn read_bodies(&mut self, entry: &Path, bodies: &dyn BodySource) {
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
                    self.add(path, text);
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
            self.add(path, text);
        }
    }
}

/// A body with what tasks on it may name.
struct Described {
    description: Arc<BodyDescription>,
    vocabulary: Checked<Vocabulary>,
}

fn describe_bodies(
    files: &[SourceFile],
    bodies: &dyn BodySource,
    diagnostics: &mut Vec<Diagnostic>,
) -> BTreeMap<String, Described> {
    let mut described = BTreeMap::new();
    for file in files {
        for item in &file.tree.items {
            let Item::Body(body) = item else { continue };
            let mut own = Vec::new();
            let mut description = check::body::describe(body, file.tree.file, &mut own);
            let base = file.path.parent().map(Path::to_path_buf).unwrap_or_default();
            description.model = plain(&base.join(&description.model)).display().to_string();
            // A body whose text is broken is not bound: the model would only be blamed for it.
            let broken = Reported::among(diagnostics.iter().chain(&own).filter(|told| told.file() == file.tree.file));
            diagnostics.append(&mut own);
            let vocabulary = match broken {
                Some(reported) => Err(reported),
                None => bind(&description, body, file.tree.file, bodies, diagnostics),
            };
            let entry = Described { description: Arc::new(description), vocabulary };
            if described.insert(body.name.text.clone(), entry).is_some() {
                let message = format!("there are two bodies called `{}`", body.name.text);
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
            let message = format!("the body `{}` does not fit its model", body.name.text);
            let mut diagnostic = Diagnostic::new(codes::names::BODY, file, body.name.span, message);
            for problem in problems.lines() {
                diagnostic = diagnostic.help(problem);
            }
            Err(diagnostic.report(diagnostics))
        }
    }
}

fn task_names<'a>(files: &'a [SourceFile], diagnostics: &mut Vec<Diagnostic>) -> Vec<&'a str> {
    let mut names: Vec<(&str, FileId, Span)> = Vec::new();
    for file in files {
        for item in &file.tree.items {
            let task_name = match item {
                Item::Task(task) => &task.name,
                Item::Sequence(sequence) => &sequence.name,
                _ => continue,
            };
            if let Some((name, first_file, first)) = names.iter().find(|(name, ..)| *name == task_name.text) {
                let message = format!("there are two tasks called `{name}`");
                let diagnostic = Diagnostic::new(codes::names::DECLARED_TWICE, file.tree.file, task_name.span, message)
                    .here("again here")
                    .label(*first_file, *first, "first here");
                diagnostics.push(diagnostic);
            } else {
                names.push((&task_name.text, file.tree.file, task_name.span));
            }
        }
    }
    names.into_iter().map(|(name, ..)| name).collect()
}

/// For every file that the file at `index` may lead to: its own declarations and those it uses.
fn in_sight(files: &[SourceFile], index: usize) -> Vec<FileInSight<'_>> {
    let mut reached = BTreeSet::from([index]);
    let mut pending = vec![index];
    while let Some(next) = pending.pop() {
        for &used in &files[next].uses {
            if reached.insert(used) {
                pending.push(used);
            }
        }
    }
    let sight = |index: usize| FileInSight {
        tree: &files[index].tree,
        uses: files[index].uses.iter().map(|&used| &files[used].tree).collect(),
    };
    reached.into_iter().map(sight).collect()
}

struct SourceTexts<'a>(&'a SourceMap);

impl Texts for SourceTexts<'_> {
    fn text(&self, file: FileId, span: Span) -> &str {
        span.of(self.0.text(file))
    }
}

/// The suites of the entry file; those of other files are checked, too.
fn suites(files: &[SourceFile], tasks: &[&str], diagnostics: &mut Vec<Diagnostic>) -> Vec<Suite> {
    let mut suites = Vec::new();
    for (index, file) in files.iter().enumerate() {
        for item in &file.tree.items {
            let Item::Suite(suite) = item else { continue };
            let checked = check::suite::check(suite, file.tree.file, tasks, diagnostics);
            if index == 0 {
                suites.push(checked);
            }
        }
    }
    suites
}

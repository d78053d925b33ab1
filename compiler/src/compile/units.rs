//! What becomes a compiled task: a task with what it inherits, or a sequence with its phases.

use super::unread::Unread;
use super::{Described, SourceFile, TaskScope};
use crate::body::BodyDescription;
use crate::check::action::Networks;
use crate::check::reference::{Motions, Tables};
use crate::check::task::{Around, InSequence, TaskDiagnostics, body_of};
use crate::check::{self, CheckedTests};
use crate::diagnostics::{Allowance, Checked, Diagnostic, Failures, FileId, Reported, Severity, allowance, codes};
use crate::files::BodySource;
use crate::frame::Query;
use crate::hir::TypedFormulas;
use crate::link::definitions;
use crate::link::{CheckedPhase, Heading, Tested, finish};
use crate::lint;
use crate::motion::Motion;
use crate::resolve::inherit::{self, Budget, Find, InFile, Placed, WholeTask};
use crate::resolve::scope::{Globals, Names};
use crate::resolve::{Texts, written};
use crate::snapshot::body_digest;
use crate::syntax::tree::{Docs, Ident, Item, Phase, Sequence, Task, TaskStatement, walk};
use crate::task::CompiledTask;
use crate::vocabulary::Vocabulary;
use crate::work::visit;
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A task, or a sequence of tasks.
pub(super) struct Unit<'a> {
    pub name: &'a Ident,
    docs: Option<&'a Docs>,
    file: FileId,
    /// One for a task, two or more for a sequence.
    pub phases: Vec<PhaseTask<'a>>,
    /// The statements of the sequence itself.
    sequence: Option<Vec<Placed>>,
    /// Whether it is a task that a sequence has as a phase.
    is_phase: bool,
}

/// A task of a unit.
pub(super) struct PhaseTask<'a> {
    pub task: WholeTask,
    /// `phase NAME until CONDITION` of a sequence.
    phase: Option<&'a Phase>,
}

/// Everything that becomes a task, in the order of files and texts.
pub(super) fn collect<'a>(files: &'a [SourceFile], texts: &dyn Texts, diagnostics: &mut Vec<Diagnostic>) -> Vec<Unit<'a>> {
    let index = TaskIndex::of(files);
    let find = |file: FileId, name: &str| index.find(file, name);
    let budget = Budget::default();
    let mut units = Vec::new();
    for source in files {
        let file = source.tree.file;
        for item in &source.tree.items {
            match item {
                Item::Task(task) => {
                    let whole = inherit::whole(InFile { task, file }, &find, &budget, texts, diagnostics);
                    units.extend(whole.map(|whole| Unit {
                        name: &task.name,
                        docs: task.docs.as_ref(),
                        file,
                        phases: vec![PhaseTask { task: whole, phase: None }],
                        sequence: None,
                        is_phase: false,
                    }));
                }
                Item::Sequence(sequence) => {
                    let phases = phases(sequence, file, &find, &budget, texts, diagnostics);
                    let own = sequence
                        .statements
                        .iter()
                        .cloned()
                        .map(|statement| Placed { statement, file, layer: 0, allowed: Vec::new() })
                        .collect();
                    units.extend(phases.map(|phases| Unit {
                        name: &sequence.name,
                        docs: sequence.docs.as_ref(),
                        file,
                        phases,
                        sequence: Some(own),
                        is_phase: false,
                    }));
                }
                _ => {}
            }
        }
    }
    let place = |task: &WholeTask| (task.file, task.task.name.span);
    let sequences = units.iter().filter(|unit| unit.sequence.is_some());
    let phases: BTreeSet<_> = sequences.flat_map(|unit| &unit.phases).map(|phase| place(&phase.task)).collect();
    for unit in units.iter_mut().filter(|unit| unit.sequence.is_none()) {
        unit.is_phase = unit.phases.iter().any(|own| phases.contains(&place(&own.task)));
    }
    units
}

/// Tasks by name, and what each file uses.
struct TaskIndex<'a> {
    files: &'a [SourceFile],
    places: BTreeMap<FileId, usize>,
    /// The tasks of each file; of two with one name the first.
    tasks: Vec<BTreeMap<&'a str, &'a Task>>,
}

impl<'a> TaskIndex<'a> {
    fn of(files: &'a [SourceFile]) -> Self {
        let places = files.iter().enumerate().map(|(place, file)| (file.tree.file, place)).collect();
        let tasks = files.iter().map(|file| {
            let tasks = file.tree.items.iter().rev();
            tasks
                .filter_map(|item| if let Item::Task(task) = item { Some((task.name.text.as_str(), task)) } else { None })
                .collect()
        });
        Self { files, places, tasks: tasks.collect() }
    }

    /// A task in sight of a file: its own or one of a file that it uses; else the names of those in sight.
    fn find(&self, file: FileId, name: &str) -> Result<InFile<'a>, Vec<String>> {
        let Some(&home) = self.places.get(&file) else { return Err(Vec::new()) };
        let in_sight = std::iter::once(home).chain(self.files[home].uses.iter().copied());
        let found = in_sight.clone().find_map(|place| {
            visit(1);
            Some(InFile { task: self.tasks[place].get(name)?, file: self.files[place].tree.file })
        });
        found.ok_or_else(|| in_sight.flat_map(|place| self.tasks[place].keys().map(|name| (*name).to_owned())).collect())
    }
}

/// The phases of a sequence, each with the shared statements of the sequence.
fn phases<'a>(
    sequence: &'a Sequence,
    file: FileId,
    find: Find<'_, 'a>,
    budget: &Budget,
    texts: &dyn Texts,
    diagnostics: &mut Vec<Diagnostic>,
) -> Checked<Vec<PhaseTask<'a>>> {
    let mut failures = Failures::default();
    let mut report = |message: String, span| {
        failures.add(Diagnostic::new(codes::composition::SEQUENCE, file, span, message).report(diagnostics));
    };
    let declared: Vec<&Phase> =
        sequence.statements.iter().filter_map(|s| if let TaskStatement::Phase(p) = s { Some(p) } else { None }).collect();
    if declared.len() < 2 {
        report("a sequence has at least two phases: `phase walk until arrived`".to_owned(), sequence.name.span);
    }
    let mut named = BTreeSet::new();
    for phase in &declared {
        visit(1);
        if !named.insert(phase.task.text.as_str()) {
            report(format!("the phase `{}` is declared twice; its results would be ambiguous", phase.task.text), phase.span);
        }
    }
    if let Some(last) = declared.last().filter(|last| last.until.is_some()) {
        report("the last phase ends with its task; no other phase follows".to_owned(), last.span);
    }
    for statement in &sequence.statements {
        let (word, span) = match statement {
            TaskStatement::State(state) => ("state", state.span),
            TaskStatement::Horizon(expr) => ("horizon", expr.span),
            TaskStatement::Params(block) => ("params", block.keyword),
            TaskStatement::Reference(reference) => ("reference", reference.span),
            _ => continue,
        };
        report(format!("`{word}` belongs in the tasks of a sequence: it restarts with each phase"), span);
    }
    let own: Vec<Placed> =
        sequence.statements.iter().cloned().map(|statement| Placed { statement, file, layer: 0, allowed: Vec::new() }).collect();
    let mut tasks = Vec::new();
    for phase in declared {
        match find(file, &phase.task.text) {
            Ok(found) => {
                // Every phase is a copy of its task.
                budget.spend(found.task.statements.len(), &phase.task, file, diagnostics)?;
                let whole = failures.catch(inherit::whole(found, find, budget, texts, diagnostics));
                tasks.extend(whole.map(|task| PhaseTask { task, phase: Some(phase) }));
            }
            Err(known) => failures.add(inherit::unknown_task(&phase.task, file, &known).report(diagnostics)),
        }
    }
    failures.catch(same_body(&tasks, &own, file, texts, diagnostics));
    let tasks = failures.or(tasks)?;
    // Fewer than two are refused above.
    let first = tasks[0].task.clone();
    let merged = tasks.into_iter().map(|one| PhaseTask { task: inherit::in_sequence(one.task, &first, &own, texts), ..one });
    Ok(merged.collect())
}

/// Phases written for different bodies, or different control frequencies, do not make one episode, unless the sequence itself
/// says which.
fn same_body(
    tasks: &[PhaseTask<'_>],
    own: &[Placed],
    file: FileId,
    texts: &dyn Texts,
    diagnostics: &mut Vec<Diagnostic>,
) -> Checked<()> {
    let mut failures = Failures::default();
    let declared = |statements: &[Placed], body: bool| {
        statements.iter().find_map(|placed| match &placed.statement {
            TaskStatement::Body(used) if body => Some(texts.text(placed.file, used.span).trim().to_owned()),
            TaskStatement::Control(expr) if !body => Some(written(expr, placed.file, texts)),
            _ => None,
        })
    };
    for (what, body) in [("body", true), ("control", false)] {
        if declared(own, body).is_some() {
            continue;
        }
        let first = tasks.first().and_then(|task| declared(&task.task.statements, body));
        for task in tasks {
            let other = declared(&task.task.statements, body);
            if let (Some(phase), true) = (task.phase, other != first) {
                let message = format!("this phase has another `{what}` than the first");
                let diagnostic = Diagnostic::new(codes::composition::SEQUENCE, file, phase.span, message)
                    .expected(first.clone().unwrap_or_default())
                    .found(other.unwrap_or_default())
                    .help(format!("declare `{what}` in the sequence: it then applies to all phases"));
                failures.add(diagnostic.report(diagnostics));
            }
        }
    }
    failures.or(())
}

/// The typed HIR of the scene and of all phases.
fn gathered(all_names: &[Names<'_>]) -> Vec<TypedFormulas> {
    all_names.iter().filter_map(|names| names.typed.as_ref()).flat_map(RefCell::take).collect()
}

/// Checks all phases of a unit, or the one that a task is. Each knows which `queries` of the ground those before it make.
/// All are there, or none.
fn phases_of<'a>(
    unit: &'a Unit<'_>,
    all_names: &'a [Names<'a>],
    around: Around<'a>,
    whole: InSequence<'a>,
    mut queries: Vec<Query>,
    unread: &mut Unread,
) -> (Checked<Vec<CheckedPhase<'a>>>, TaskDiagnostics) {
    let (mut checked, mut diagnostics) = (Vec::new(), TaskDiagnostics::default());
    let mut failures = Failures::default();
    for (index, (phase, names)) in unit.phases.iter().zip(all_names).enumerate() {
        let until = phase.phase.and_then(|phase| phase.until.as_ref()).map(|until| (until, unit.file));
        let before = checked.iter().fold(0_u32, |sum, phase: &CheckedPhase<'_>| sum.saturating_add(phase.checked.timing.horizon));
        let sequence = InSequence { index, until, before, ..whole };
        let (checker, mut found, mut reported) = check::task::check(&phase.task, names, around, sequence, queries.clone());
        if let Ok(checked) = &mut found {
            lint::find(&checker, checked, sequence, &mut reported);
        }
        unread.note(names, around.scene, &reported.whole);
        diagnostics.formulas.extend(reported.formulas);
        diagnostics.whole.extend(reported.whole);
        let found = failures.catch(found);
        if let Some(found) = &found {
            queries.clone_from(
                found.tests.as_ref().filter(|_| !whole.phases.is_empty()).map_or(&found.queries, |tests| &tests.queries),
            );
        }
        checked.extend(found.map(|checked| {
            let definitions = definitions(&phase.task, names, until.into_iter().chain(whole.success));
            CheckedPhase { source: &phase.task, checked, until, definitions }
        }));
    }
    (failures.or(checked), diagnostics)
}

fn is_test(placed: &Placed) -> bool {
    matches!(placed.statement, TaskStatement::Test(_))
}

/// The tests of a task by itself, with what they look at.
fn tests_taken<'a>(checked: &mut [CheckedPhase<'a>]) -> Option<Tested<'a>> {
    let tests = checked.first_mut()?.checked.tests.take()?;
    Some(Tested { phases: vec![checked.first()?.clone()], tests: vec![tests] })
}

/// The tests of a sequence, put together from all its phases.
fn tests_of<'a>(mut phases: Vec<CheckedPhase<'a>>, diagnostics: &mut Vec<Diagnostic>) -> Checked<Tested<'a>> {
    let mut tests: Vec<CheckedTests> = phases.iter_mut().filter_map(|phase| phase.checked.tests.take()).collect();
    CheckedTests::gather(&mut tests.iter_mut().collect::<Vec<_>>(), diagnostics)?;
    Ok(Tested { phases, tests })
}

/// The body of a task, with what the task changes on it.
struct Fitted<'a> {
    description: Arc<BodyDescription>,
    digest: Cow<'a, str>,
    vocabulary: Cow<'a, Vocabulary>,
}

/// Compiles units.
pub(super) struct Compiler<'a> {
    pub described: &'a BTreeMap<String, Described>,
    pub bodies: &'a dyn BodySource,
    pub texts: &'a dyn Texts,
    pub motions: &'a Tables,
    pub networks: &'a Networks,
    pub globals: &'a Globals<'a>,
    /// Whether what is understood is kept.
    pub noting: bool,
    /// Functions that were called.
    pub called: &'a RefCell<BTreeSet<(FileId, String)>>,
    /// Names that no task reads.
    pub unread: &'a RefCell<Unread>,
}

impl Compiler<'_> {
    pub(super) fn compile(
        &self,
        unit: &Unit<'_>,
        scopes: &mut Vec<TaskScope>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Checked<CompiledTask> {
        let first = &unit.phases[0].task;
        let mut all_names: Vec<Names<'_>> =
            unit.phases.iter().map(|phase| Names::of(self.globals, &phase.task, diagnostics)).collect();
        if self.noting {
            all_names.iter_mut().for_each(|names| names.typed = Some(RefCell::default()));
        }
        let Fitted { description, digest, vocabulary } = self.body(first, &all_names[0], diagnostics)?;
        let phase_names: Vec<String> = match &unit.sequence {
            Some(_) => unit.phases.iter().map(|phase| phase.task.task.name.text.clone()).collect(),
            None => Vec::new(),
        };
        let success = unit.sequence.iter().flatten().find_map(|placed| match &placed.statement {
            TaskStatement::Success(expr) => Some((expr, placed.file)),
            _ => None,
        });
        // All phases share the scene: it is that of the first.
        let (scene, mut of_scene) = check::scene::of_task(first, &all_names[0], &vocabulary);
        let broken = Reported::among(&of_scene);
        let vocabulary = Arc::new(vocabulary.with_scene(&scene.description));
        let trace = |motion: &Motion| self.bodies.trace(&description, motion);
        let around = Around {
            vocabulary: &vocabulary,
            scene: &scene,
            texts: self.texts,
            motions: Motions { tables: self.motions, trace: &trace },
            networks: self.networks,
        };
        let (tests, is_phase) = (phase_names.is_empty(), unit.is_phase);
        let whole = InSequence { phases: &phase_names, success, tests, is_phase, ..InSequence::default() };
        let unread = &mut *self.unread.borrow_mut();
        let (checked, mut reported) = phases_of(unit, &all_names, around, whole, Vec::new(), unread);
        if broken.is_some() {
            // What formulas do not find may be what is broken in the scene: only the scene is at fault.
            reported.formulas.retain(|diagnostic| !matches!(diagnostic.code.id, "E0201" | "E0202" | "E0205" | "E0423"));
        }
        let statements = unit.phases.iter().map(|phase| &phase.task.statements);
        let mut misnamed = Vec::new();
        let mut allowances: Vec<Allowance> = statements.flat_map(|list| check::allows::of_task(list, &mut misnamed)).collect();
        let libraries = checked.iter().flatten().flat_map(|phase| &phase.checked.allowances);
        allowances.extend(libraries.cloned());
        reported.formulas.append(&mut of_scene);
        for list in [&mut reported.formulas, &mut reported.whole] {
            allowance::apply(&mut allowances, list);
        }
        if unit.sequence.is_some() || !misnamed.is_empty() {
            // What an `allow` with a wrong name is to cover is not known. And a task is checked by itself: as a phase, its
            // warnings would only be repeated.
            reported.whole.retain(|diagnostic| diagnostic.severity == Severity::Error);
        }
        diagnostics.append(&mut misnamed);
        diagnostics.append(&mut reported.formulas);
        diagnostics.append(&mut reported.whole);
        let mut checked = broken.map_or(checked, Err);
        let tested = match (&unit.sequence, &mut checked) {
            (Some(statements), Ok(checked)) if statements.iter().any(is_test) => {
                // The tests of a sequence in a pass of their own: they may ask for more of the ground than all phases do.
                let known = checked.last().map(|last| last.checked.queries.clone()).unwrap_or_default();
                let horizon = checked.iter().fold(0_u32, |sum, phase| sum.saturating_add(phase.checked.timing.horizon));
                let tested = InSequence { tests: true, horizon, ..whole };
                let (phases, reported) = phases_of(unit, &all_names, around, tested, known, unread);
                // Its warnings are reported already.
                let errors = reported
                    .formulas
                    .into_iter()
                    .chain(reported.whole)
                    .filter(|diagnostic| diagnostic.severity == Severity::Error);
                diagnostics.extend(errors.filter(|_| phases.is_err()));
                Some(tests_of(phases?, diagnostics)?)
            }
            (_, Ok(checked)) => tests_taken(checked),
            (_, Err(_)) => None,
        };
        for names in &all_names {
            self.called.borrow_mut().append(&mut names.called.borrow_mut());
        }
        if self.noting {
            let (name, span) = (unit.name.text.clone(), unit.name.span);
            scopes.push(TaskScope { name, file: unit.file, span, typed: gathered(&all_names), vocabulary: vocabulary.clone() });
        }
        let checked = checked?;
        let shared = unit.sequence.iter().flatten().flat_map(|placed| match &placed.statement {
            TaskStatement::Random(random) => vec![random.name.text.clone()],
            TaskStatement::Params(block) => walk::items(&block.entries).map(|parameter| parameter.name.text.clone()).collect(),
            _ => Vec::new(),
        });
        let heading = Heading {
            name: &unit.name.text,
            docs: unit.docs,
            family: checked.first().map(|phase| phase.checked.family.clone()).unwrap_or_default(),
            body: description.clone(),
            body_digest: digest,
            vocabulary: vocabulary.clone(),
            success,
            shared: shared.collect(),
        };
        let mut task = finish(heading, checked, tested, self.texts);
        task.places.allowances = allowances;
        Ok(task)
    }

    /// The body that a task runs on, with what the task changes on it.
    fn body(&self, task: &WholeTask, names: &Names<'_>, diagnostics: &mut Vec<Diagnostic>) -> Checked<Fitted<'_>> {
        let Some((used, file)) = body_of(&task.statements) else {
            let message = format!("the task `{}` does not declare its `body`", task.task.name.text);
            let diagnostic = Diagnostic::new(codes::tasks::MISSING, task.file, task.task.name.span, message);
            let diagnostic = diagnostic.help("without a body no name can be resolved, so nothing else was checked");
            return Err(diagnostic.report(diagnostics));
        };
        let name = &used.name;
        let Some(described) = self.described.get(&name.text) else {
            let message = format!("undefined body `{}`", name.text);
            let help = format!("a body is defined in `bodies/{}.msk` beside or above the task, or built in: `human`", name.text);
            return Err(Diagnostic::new(codes::names::BODY, file, name.span, message).help(help).report(diagnostics));
        };
        let vocabulary = described.vocabulary.as_ref().map_err(|reported| *reported)?;
        if used.edits.is_empty() {
            return Ok(Fitted {
                description: described.description.clone(),
                digest: Cow::Borrowed(&described.digest),
                vocabulary: Cow::Borrowed(vocabulary),
            });
        }
        let (changes, reported) = check::edits::edits(used, file, task, names, vocabulary);
        diagnostics.extend(reported);
        let mut description = BodyDescription::clone(&described.description);
        description.changes = changes?;
        match self.bodies.vocabulary(&description) {
            Ok(vocabulary) => {
                let digest = Cow::Owned(body_digest(&description));
                Ok(Fitted { description: Arc::new(description), digest, vocabulary: Cow::Owned(vocabulary) })
            }
            Err(problems) => {
                let message = format!("invalid change of the body `{}`", name.text);
                let diagnostic = Diagnostic::new(codes::names::BODY, file, used.span, message);
                let diagnostic = problems.lines().fold(diagnostic, |diagnostic, problem| diagnostic.help(problem));
                Err(diagnostic.report(diagnostics))
            }
        }
    }
}

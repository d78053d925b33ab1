//! Mutation testing of tasks: which one-token mutants are killed by checks, lints or tests, and which survive.

use super::lanes::{self, Line};
use super::series::{Item, Series, length};
use crate::probe;
use msk_compiler::compile;
use msk_compiler::diagnostics::{Diagnostic, Report};
use msk_compiler::mutation::{Class, Mutant, Part, mutants};
use msk_physics::lanes::WIDTH;
use msk_program::files::Loader;
use msk_program::task::{CompiledTask, TaskTests};
use msk_runtime::episode::Engine;
use msk_runtime::files::WithText;
use msk_runtime::library::{BodyLibrary, BoundBody};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// What kills a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Killer {
    /// It does not compile.
    Checks,
    /// The compiler or probing gives one more warning.
    Lints,
    /// A test fails.
    Tests,
}

/// What became of a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// It is rejected.
    Killed(Killer),
    /// Nothing rejects it.
    Survived,
    /// The compiled task is the same: it counts nowhere.
    Equivalent,
}

impl Outcome {
    /// As printed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Killed(_) => "killed",
            Self::Survived => "survived",
            Self::Equivalent => "equivalent",
        }
    }

    /// What killed it, if anything did.
    pub fn killer(self) -> Option<Killer> {
        if let Self::Killed(killer) = self { Some(killer) } else { None }
    }
}

/// A mutant and what became of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    /// The mutant.
    pub mutant: Mutant,
    /// What became of it.
    pub outcome: Outcome,
    /// The code of the error or warning, or the title of the test, that killed it.
    pub by: String,
}

/// A row of a table: of a class of mutants, or of a part of the task.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Count {
    /// Mutants that are not equivalent.
    pub all: usize,
    /// Killed by checks.
    pub checks: usize,
    /// Killed by lints.
    pub lints: usize,
    /// Killed by tests.
    pub tests: usize,
    /// Those that survived.
    pub survived: usize,
}

impl Count {
    /// Counts the verdicts that `wanted` selects by part and class.
    pub fn of<'a>(verdicts: impl Iterator<Item = &'a Verdict>, wanted: impl Fn(Part, Class) -> bool) -> Self {
        let mut count = Self::default();
        for verdict in verdicts.filter(|verdict| wanted(verdict.mutant.part, verdict.mutant.class)) {
            let slot = match verdict.outcome {
                Outcome::Killed(Killer::Checks) => &mut count.checks,
                Outcome::Killed(Killer::Lints) => &mut count.lints,
                Outcome::Killed(Killer::Tests) => &mut count.tests,
                Outcome::Survived => &mut count.survived,
                Outcome::Equivalent => continue,
            };
            *slot += 1;
            count.all += 1;
        }
        count
    }
}

/// Makes every mutant of these parts of a task in the text of its file and tries to kill it. Verdicts come in the order of the
/// text, whatever the number of threads; none where the file has no such task.
///
/// # Errors
/// The text does not compile as it is.
pub fn mutate(
    path: &Path,
    text: &str,
    name: &str,
    parts: &[Part],
    loader: &(dyn Loader + Sync),
    bodies: &BodyLibrary,
) -> Result<Vec<Verdict>, Report> {
    let with = |text: String| WithText { path: path.to_path_buf(), text, others: loader };
    // Compiled by itself even if a suite uses it: the changed file is, too, and warnings of other files are none of its own.
    let plain = compile(path, &with(text.to_owned()), bodies)?;
    let Some(task) = plain.tasks.iter().find(|task| task.name == name) else { return Ok(Vec::new()) };
    let known = Known {
        task,
        warnings: &plain.warnings,
        probed: probe::tasks(std::slice::from_ref(task), bodies),
        engine: bodies.stage(&task.body, &task.scene).ok().and_then(|body| engine(&body, task, None)),
        bodies,
    };
    let wanted: Vec<Mutant> = mutants(text, name).into_iter().filter(|mutant| parts.contains(&mutant.part)).collect();
    let (next, found) = (AtomicUsize::new(0), Mutex::new(vec![None; wanted.len()]));
    let judged = |place: usize, verdict: Judged| {
        let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
        found[place] = Some(verdict);
    };
    let work = |_| {
        let mut claim = |present: Option<&Engine>| loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let (task, line) = match known.line(&with(wanted.get(place)?.apply(text))) {
                Ok(line) => line,
                Err(verdict) => {
                    judged(place, verdict);
                    continue;
                }
            };
            if present.is_none_or(|present| line.engine().goes_with(present)) {
                return Some(((place, task), line));
            }
            // A mutant with a scene of its own has no company.
            judged(place, known.verdict(&task, &line.play_alone()));
        };
        let mut done = |(place, task): (usize, Arc<CompiledTask>), series: Series<'_, Tests>| {
            judged(place, known.verdict(&task, &series));
        };
        lanes::play(WIDTH, &mut claim, &mut done);
    };
    (0..rayon::current_num_threads()).into_par_iter().for_each(work);
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    let verdicts = wanted.into_iter().zip(found.into_iter().flatten());
    Ok(verdicts.map(|(mutant, (outcome, by))| Verdict { mutant, outcome, by }).collect())
}

/// What has become of a mutant, and by what.
type Judged = (Outcome, String);

/// Tests that a mutant keeps alive.
type Tests = Arc<TaskTests>;

/// The task without any mutation, with its warnings.
struct Known<'a> {
    task: &'a Arc<CompiledTask>,
    warnings: &'a [Diagnostic],
    probed: Vec<Diagnostic>,
    /// What its tests are played with.
    engine: Option<Engine>,
    bodies: &'a BodyLibrary,
}

impl Known<'_> {
    /// The tests of a mutant that neither checks nor lints kill, the short ones first, as far as the first failure; or what has become of
    /// it. Checks come before lints, lints before tests, and last, since it takes longest, probing.
    fn line(&self, changed: &WithText<'_>) -> Result<(Arc<CompiledTask>, Line<'static, Tests>), Judged> {
        let compilation = match compile(&changed.path, changed, self.bodies) {
            Ok(compilation) => compilation,
            Err(report) => {
                let code = report.diagnostics.first().map_or(String::new(), |diagnostic| diagnostic.code.id.to_owned());
                return Err((Outcome::Killed(Killer::Checks), code));
            }
        };
        let Some(found) = compilation.tasks.iter().find(|found| found.name == self.task.name) else {
            return Err((Outcome::Killed(Killer::Checks), "the task does not exist".to_owned()));
        };
        if let Some(code) = one_more(&compilation.warnings, self.warnings) {
            return Err((Outcome::Killed(Killer::Lints), code));
        }
        if found.hash == self.task.hash {
            return Err((Outcome::Equivalent, String::new()));
        }
        let Some(tests) = found.tests.clone() else { return Err(self.probe(found)) };
        let killed = |why: &str| (Outcome::Killed(Killer::Tests), why.to_owned());
        let Ok(body) = self.bodies.stage(&found.body, &found.scene) else { return Err(killed("the scene cannot be built")) };
        let Some(engine) = engine(&body, &tests.task, self.engine.as_ref()) else {
            return Err(killed("the task does not match its body"));
        };
        let mut order: Vec<usize> = (0..tests.tests.len()).filter(|&place| !tests.tests[place].needs_policy()).collect();
        order.sort_by_key(|&place| length(&tests.tests[place]));
        let order = order.into_iter().map(Item::Test);
        Ok((found.clone(), Line::new(Series::new(tests, order, None).ranking(None).until_failure(), engine)))
    }

    /// What becomes of a mutant whose tests have been played.
    fn verdict(&self, task: &Arc<CompiledTask>, series: &Series<'_, Tests>) -> Judged {
        match series.reports.iter().find(|reported| !reported.report.passed()) {
            Some(failed) => (Outcome::Killed(Killer::Tests), failed.report.title.clone()),
            None => self.probe(task),
        }
    }

    /// What becomes of a mutant that its tests do not kill.
    fn probe(&self, task: &Arc<CompiledTask>) -> Judged {
        match one_more(&probe::tasks(std::slice::from_ref(task), self.bodies), &self.probed) {
            Some(code) => (Outcome::Killed(Killer::Lints), code),
            None => (Outcome::Survived, String::new()),
        }
    }
}

/// What a task is played with on its body; a `known` engine of the same body shares what follows from the model. `None` where task and body do
/// not match.
fn engine(body: &BoundBody, task: &Arc<CompiledTask>, known: Option<&Engine>) -> Option<Engine> {
    match known.filter(|known| Arc::ptr_eq(known.model(), &body.model) && Arc::ptr_eq(known.body(), &body.body)) {
        Some(known) => known.beside(task.clone()).ok(),
        None => Engine::new(body.model.clone(), body.body.clone(), task.clone()).ok(),
    }
}

/// The first code that is reported more often than without the mutation.
fn one_more(found: &[Diagnostic], before: &[Diagnostic]) -> Option<String> {
    let count = |all: &[Diagnostic], code: &str| all.iter().filter(|known| known.code.id == code).count();
    let more = |new: &&Diagnostic| count(found, new.code.id) > count(before, new.code.id);
    found.iter().find(more).map(|new| new.code.id.to_owned())
}

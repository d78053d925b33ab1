//! Mutation testing of tasks: which one-token mutants are killed by checks, lints or tests, and which survive.

use super::Stage;
use crate::probe;
use msk_compiler::compile;
use msk_compiler::diagnostics::{Diagnostic, Report};
use msk_compiler::mutation::{Class, Mutant, Part, mutants};
use msk_program::files::Loader;
use msk_program::task::{CompiledTask, TaskTests};
use msk_program::testing::TaskTest;
use msk_runtime::files::WithText;
use msk_runtime::library::BodyLibrary;
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

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
    let known = Known { task, warnings: &plain.warnings, probed: probe::tasks(std::slice::from_ref(task), bodies) };
    let judge = |mutant: Mutant| {
        let (outcome, by) = outcome(&with(mutant.apply(text)), &known, bodies);
        Verdict { mutant, outcome, by }
    };
    let wanted: Vec<Mutant> = mutants(text, name).into_iter().filter(|mutant| parts.contains(&mutant.part)).collect();
    Ok(wanted.into_par_iter().map(judge).collect())
}

/// The task without any mutation, with its warnings.
struct Known<'a> {
    task: &'a Arc<CompiledTask>,
    warnings: &'a [Diagnostic],
    probed: Vec<Diagnostic>,
}

/// What becomes of a mutant: checks come before lints, lints before tests, and last, since it takes longest, probing.
fn outcome(changed: &WithText<'_>, known: &Known<'_>, bodies: &BodyLibrary) -> (Outcome, String) {
    let compilation = match compile(&changed.path, changed, bodies) {
        Ok(compilation) => compilation,
        Err(report) => {
            let code = report.diagnostics.first().map_or(String::new(), |diagnostic| diagnostic.code.id.to_owned());
            return (Outcome::Killed(Killer::Checks), code);
        }
    };
    let Some(found) = compilation.tasks.iter().find(|found| found.name == known.task.name) else {
        return (Outcome::Killed(Killer::Checks), "the task does not exist".to_owned());
    };
    if let Some(code) = one_more(&compilation.warnings, known.warnings) {
        return (Outcome::Killed(Killer::Lints), code);
    }
    if found.hash == known.task.hash {
        return (Outcome::Equivalent, String::new());
    }
    if let Some(title) = found.tests.as_ref().and_then(|tests| first_failure(tests, found, bodies)) {
        return (Outcome::Killed(Killer::Tests), title);
    }
    match one_more(&probe::tasks(std::slice::from_ref(found), bodies), &known.probed) {
        Some(code) => (Outcome::Killed(Killer::Lints), code),
        None => (Outcome::Survived, String::new()),
    }
}

/// The first code that is reported more often than without the mutation.
fn one_more(found: &[Diagnostic], before: &[Diagnostic]) -> Option<String> {
    let count = |all: &[Diagnostic], code: &str| all.iter().filter(|known| known.code.id == code).count();
    let more = |new: &&Diagnostic| count(found, new.code.id) > count(before, new.code.id);
    found.iter().find(more).map(|new| new.code.id.to_owned())
}

/// The title of the first test that fails, the short ones played first.
fn first_failure(tests: &TaskTests, task: &CompiledTask, bodies: &BodyLibrary) -> Option<String> {
    let Ok(body) = bodies.stage(&task.body, &task.scene) else { return Some("the scene cannot be built".to_owned()) };
    let Ok(mut stage) = Stage::new(tests, &body) else { return Some("the task does not match its body".to_owned()) };
    let mut order: Vec<usize> = (0..tests.tests.len()).filter(|&place| !tests.tests[place].needs_policy()).collect();
    order.sort_by_key(|&place| length(&tests.tests[place]));
    let failed = order.into_iter().find(|&place| !stage.play(place).passed())?;
    Some(tests.tests[failed].title.clone())
}

/// How long a test moves, in control steps; physics counts a hundredfold.
fn length(test: &TaskTest) -> u32 {
    let long = |take: &msk_program::testing::Take| {
        let moved = take.script.last().map_or(0, |key| key.step);
        let run = take.run.as_ref().map_or(0, |run| take.until.unwrap_or(10_000).saturating_sub(run.from));
        moved.saturating_add(run.saturating_mul(100)).saturating_add(1)
    };
    // A cheat is held to the horizon, and the demonstration is played beside it.
    let ranked = if test.cheat { 1_000 } else { 0 };
    test.takes.iter().map(long).fold(ranked, u32::saturating_add)
}

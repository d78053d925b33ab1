//! How many one-token changes of a task its checks and tests notice.

use super::Stage;
use crate::library::BodyLibrary;
use crate::probe;
use msk_compiler::compile;
use msk_compiler::diagnostics::{Diagnostic, Report};
use msk_compiler::files::{LoadError, Loader};
use msk_compiler::mutation::{Class, Mutant, Part, mutants};
use msk_compiler::task::CompiledTask;
use msk_compiler::testing::{TaskTest, TaskTests};
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Who notices a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Notice {
    /// It does not compile.
    Checks,
    /// It compiles with a warning more, or probing has one more.
    Lints,
    /// A test fails.
    Tests,
    /// Nobody.
    Unseen,
    /// It means the same.
    Same,
}

/// What came of a change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    /// The change.
    pub mutant: Mutant,
    /// Who notices it.
    pub notice: Notice,
    /// The code of the error or warning, or the title of the test.
    pub by: String,
}

/// A row of a table: of a class of changes, or of a part of the task.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Count {
    /// Changes that mean something else.
    pub all: usize,
    /// Noticed by checks.
    pub checks: usize,
    /// Noticed by lints.
    pub lints: usize,
    /// Noticed by tests.
    pub tests: usize,
    /// Noticed by nobody.
    pub unseen: usize,
}

impl Count {
    /// Of those verdicts that `wanted` names, by part and class.
    pub fn of<'a>(verdicts: impl Iterator<Item = &'a Verdict>, wanted: impl Fn(Part, Class) -> bool) -> Self {
        let mut count = Self::default();
        for verdict in verdicts.filter(|verdict| wanted(verdict.mutant.part, verdict.mutant.class)) {
            let slot = match verdict.notice {
                Notice::Checks => &mut count.checks,
                Notice::Lints => &mut count.lints,
                Notice::Tests => &mut count.tests,
                Notice::Unseen => &mut count.unseen,
                Notice::Same => continue,
            };
            *slot += 1;
            count.all += 1;
        }
        count
    }
}

/// A file with another text.
struct Changed<'a> {
    path: PathBuf,
    text: String,
    loader: &'a dyn Loader,
}

impl Loader for Changed<'_> {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        if path == self.path { Ok(self.text.clone()) } else { self.loader.load(path) }
    }
}

/// Makes every change of these parts of a task in the text of its file and sees who notices; in the order of the text, whatever
/// the number of threads. Empty where the file has no such task.
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
    let with = |text: String| Changed { path: path.to_path_buf(), text, loader };
    // Compiled by itself even if a suite uses it: the changed file is, too, and warnings of other files are none of its own.
    let plain = compile(path, &with(text.to_owned()), bodies)?;
    let Some(task) = plain.tasks.iter().find(|task| task.name == name) else { return Ok(Vec::new()) };
    let known = Known { task, warnings: &plain.warnings, probed: probe::tasks(std::slice::from_ref(task), bodies) };
    let judge = |mutant: Mutant| {
        let (notice, by) = notice(&with(mutant.apply(text)), &known, bodies);
        Verdict { mutant, notice, by }
    };
    let wanted: Vec<Mutant> = mutants(text, name).into_iter().filter(|mutant| parts.contains(&mutant.part)).collect();
    Ok(wanted.into_par_iter().map(judge).collect())
}

/// A task as it is, with what is told of it.
struct Known<'a> {
    task: &'a Arc<CompiledTask>,
    warnings: &'a [Diagnostic],
    probed: Vec<Diagnostic>,
}

/// Who notices a change: checks before lints, lints before tests, and last, since it takes longest, probing.
fn notice(changed: &Changed<'_>, known: &Known<'_>, bodies: &BodyLibrary) -> (Notice, String) {
    let compilation = match compile(&changed.path, changed, bodies) {
        Ok(compilation) => compilation,
        Err(report) => {
            let code = report.diagnostics.first().map_or(String::new(), |told| told.code.id.to_owned());
            return (Notice::Checks, code);
        }
    };
    let Some(found) = compilation.tasks.iter().find(|found| found.name == known.task.name) else {
        return (Notice::Checks, "the task is gone".to_owned());
    };
    if let Some(code) = one_more(&compilation.warnings, known.warnings) {
        return (Notice::Lints, code);
    }
    if found.hash == known.task.hash {
        return (Notice::Same, String::new());
    }
    if let Some(title) = found.tests.as_ref().and_then(|tests| first_failure(tests, found, bodies)) {
        return (Notice::Tests, title);
    }
    match one_more(&probe::tasks(std::slice::from_ref(found), bodies), &known.probed) {
        Some(code) => (Notice::Lints, code),
        None => (Notice::Unseen, String::new()),
    }
}

/// The first code that is told more often than before.
fn one_more(told: &[Diagnostic], before: &[Diagnostic]) -> Option<String> {
    let count = |told: &[Diagnostic], code: &str| told.iter().filter(|told| told.code.id == code).count();
    let more = |new: &&Diagnostic| count(told, new.code.id) > count(before, new.code.id);
    told.iter().find(more).map(|new| new.code.id.to_owned())
}

/// The title of the first test that fails, the short ones played first.
fn first_failure(tests: &TaskTests, task: &CompiledTask, bodies: &BodyLibrary) -> Option<String> {
    let Ok(body) = bodies.stage(&task.body, &task.scene) else { return Some("the scene cannot be built".to_owned()) };
    let Ok(mut stage) = Stage::new(tests, &body) else { return Some("the task does not fit its body".to_owned()) };
    let mut order: Vec<usize> = (0..tests.tests.len()).collect();
    order.sort_by_key(|&place| length(&tests.tests[place]));
    let failed = order.into_iter().find(|&place| !stage.play(place).passed())?;
    Some(tests.tests[failed].title.clone())
}

/// How long a test moves, in control steps; physics counts a hundredfold.
fn length(test: &TaskTest) -> u32 {
    let long = |take: &msk_compiler::testing::Take| {
        let moved = take.script.last().map_or(0, |key| key.step);
        let run = take.run.as_ref().map_or(0, |run| take.until.unwrap_or(10_000).saturating_sub(run.from));
        moved.saturating_add(run.saturating_mul(100)).saturating_add(1)
    };
    // A cheat is held to the horizon, and the demonstration is played beside it.
    let ranked = if test.cheat { 1_000 } else { 0 };
    test.takes.iter().map(long).fold(ranked, u32::saturating_add)
}

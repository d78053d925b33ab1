//! `msk diff A B`: what differs between two tasks in meaning.

use crate::error::{Context, Error, FAILURE};
use crate::project::{Settings, compiled};
use crate::terminal;
use crate::texts;
use clap::ValueEnum;
use msk::compiler::difference::Difference;
use msk::compiler::snapshot::Snapshot;
use msk::compiler::task::CompiledTask;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Compare the semantics of tasks: terms, weights, ranges, thresholds, observations, terminations, scene, initial state
///
/// Comments, layout and the names of local declarations are ignored. Exit code 0 if both are equal, 1 if they differ, 2 if
/// they cannot be compared.
#[derive(clap::Args)]
pub struct Args {
    /// A file, a task of a file as FILE@TASK, a task of tasks.msk, or a written snapshot (*.snapshot)
    before: String,
    /// The other side of the comparison
    after: String,
    /// How to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    #[command(flatten)]
    settings: Settings,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Text for people
    Text,
    /// JSON for tools: a list with an entry per pair of tasks
    Json,
}

/// Compares.
///
/// # Errors
/// A file that cannot be read or compiled, or two files that have no task in common; the exit code is then 2.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    compare(&args).map_err(Error::into_usage)
}

fn compare(args: &Args) -> Result<ExitCode, Error> {
    let (before, after) = (sides(&args.before, &args.settings)?, sides(&args.after, &args.settings)?);
    let differences = match (before.as_slice(), after.as_slice()) {
        // Two single tasks are compared whatever they are called.
        ([before], [after]) => vec![before.difference(after)],
        _ => by_name(&before, &after),
    };
    if differences.is_empty() {
        let message = format!("`{}` and `{}` have no task in common", args.before, args.after);
        return Err(Error::new(message).hint("name a task of each: FILE@TASK"));
    }
    let same = differences.iter().all(Difference::is_empty);
    let mut out = terminal::out();
    match args.format {
        Format::Json => writeln!(out, "{}", serde_json::to_string_pretty(&differences)?)?,
        Format::Text => differences
            .iter()
            .filter(|difference| !difference.is_empty())
            .try_for_each(|difference| write!(out, "{difference}"))?,
    }
    Ok(if same { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) })
}

/// One side of a comparison: a snapshot, and its task where it is not read from a file of its own.
#[derive(Clone, Default)]
struct Side {
    snapshot: Snapshot,
    task: Option<Arc<CompiledTask>>,
}

impl Side {
    fn difference(&self, after: &Self) -> Difference {
        let difference = Difference::between(&self.snapshot, &after.snapshot, false);
        match (&self.task, &after.task) {
            (Some(before), Some(after)) => difference.with_names(before, after).with_units(after),
            (Some(task), None) | (None, Some(task)) => difference.with_units(task),
            (None, None) => difference,
        }
    }
}

/// Tasks of both by their names; one that the other side lacks differs in everything.
fn by_name(before: &[Side], after: &[Side]) -> Vec<Difference> {
    let find = |list: &[Side], name: &str| list.iter().find(|known| known.snapshot.task() == name).cloned();
    if !after.iter().any(|task| find(before, task.snapshot.task()).is_some()) {
        return Vec::new();
    }
    let mut differences: Vec<Difference> =
        after.iter().map(|task| find(before, task.snapshot.task()).unwrap_or_default().difference(task)).collect();
    let gone = before.iter().filter(|task| find(after, task.snapshot.task()).is_none());
    differences.extend(gone.map(|task| task.difference(&Side::default())));
    differences
}

/// What is named: a task, the tasks of a file, or a snapshot.
fn sides(named: &str, settings: &Settings) -> Result<Vec<Side>, Error> {
    if named.ends_with(".snapshot") {
        let text = texts::read(Path::new(named))?;
        return Ok(vec![Side { snapshot: text.parse().context(|| format!("cannot read `{named}`"))?, task: None }]);
    }
    let tasks = compiled(named, &settings.settings)?;
    Ok(tasks.into_iter().map(|task| Side { snapshot: task.snapshot(), task: Some(task) }).collect())
}

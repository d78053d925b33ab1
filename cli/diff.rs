//! `msk diff A B`: what differs between two tasks in meaning.

use crate::error::{Context, Error, FAILURE};
use crate::project::{Settings, compiled};
use crate::texts;
use clap::ValueEnum;
use msk::compiler::difference::Difference;
use msk::compiler::snapshot::Snapshot;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

/// Compare tasks by meaning: terms, weights, ranges, thresholds, observations, ends, scene, beginning
///
/// Comments, layout and the names of local declarations make no difference. Exit code 0 if both mean the same, 1 if they differ,
/// 2 if they cannot be compared.
#[derive(clap::Args)]
pub struct Args {
    /// A file, a task of a file as FILE@TASK, a task of tasks.msk, or a written snapshot (*.snapshot)
    before: String,
    /// What it is compared with
    after: String,
    /// How to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    #[command(flatten)]
    settings: Settings,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people
    Text,
    /// For tools: a list with an entry per pair of tasks
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
    let (before, after) = (snapshots(&args.before, &args.settings)?, snapshots(&args.after, &args.settings)?);
    let differences = match (before.as_slice(), after.as_slice()) {
        // Two single tasks are compared whatever they are called.
        ([before], [after]) => vec![Difference::between(before, after, false)],
        _ => by_name(&before, &after),
    };
    if differences.is_empty() {
        let message = format!("`{}` and `{}` have no task in common", args.before, args.after);
        return Err(Error::new(message).hint("name a task of each: FILE@TASK"));
    }
    let same = differences.iter().all(Difference::is_empty);
    let mut out = io::stdout().lock();
    match args.format {
        Format::Json => writeln!(out, "{}", serde_json::to_string_pretty(&differences)?)?,
        Format::Text => differences.iter().filter(|told| !told.is_empty()).try_for_each(|told| write!(out, "{told}"))?,
    }
    Ok(if same { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) })
}

/// Tasks of both by their names; one that the other side lacks differs in everything.
fn by_name(before: &[Snapshot], after: &[Snapshot]) -> Vec<Difference> {
    let find = |list: &[Snapshot], name: &str| list.iter().find(|known| known.task() == name).cloned();
    if !after.iter().any(|task| find(before, task.task()).is_some()) {
        return Vec::new();
    }
    let mut differences: Vec<Difference> =
        after.iter().map(|task| Difference::between(&find(before, task.task()).unwrap_or_default(), task, false)).collect();
    let gone = before.iter().filter(|task| find(after, task.task()).is_none());
    differences.extend(gone.map(|task| Difference::between(task, &Snapshot::default(), false)));
    differences
}

/// What is named: a task, the tasks of a file, or a snapshot.
fn snapshots(named: &str, settings: &Settings) -> Result<Vec<Snapshot>, Error> {
    if named.ends_with(".snapshot") {
        let text = texts::read(Path::new(named))?;
        return Ok(vec![text.parse().context(|| format!("cannot read `{named}`"))?]);
    }
    Ok(compiled(named, &settings.settings)?.iter().map(|task| task.snapshot()).collect())
}

//! `msk weights extract FILE --weights weights.toml`.

use super::{Target, print};
use crate::error::Error;
use crate::project::Project;
use msk::compiler::task::CompiledTask;
use msk::compiler::weights::{Bounds, Change, written};
use msk::tuning::overlay::{EditError, edited};
use msk::tuning::store::{Store, StoreError};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Write the weights of a source into a weights file: all that are not fixed
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// The weights file; its other contents are kept
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
    /// Only the weights of this task
    #[arg(long)]
    task: Option<String>,
}

/// Writes the weights file.
///
/// # Errors
/// A file that cannot be read or written, or a task that is not there.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let project = Project::open(&args.target.file, &[])?;
    let tasks: Vec<_> = project.trials(args.task.as_deref())?.into_iter().map(|trial| trial.task).collect();
    let mut weights = Vec::new();
    for task in &tasks {
        let tunable = (0..task.terms.len()).filter(|&term| task.weight_bounds(term) != Bounds::Fixed);
        weights.extend(tunable.map(|term| (task.name.as_str(), task.terms[term].name.as_str(), task.terms[term].weight)));
    }
    if weights.is_empty() {
        let message = format!("`{}` contains no weight that is not fixed", args.target.file.display());
        return Err(Error::new(message));
    }
    write_overlay(&args.weights, &tasks, &weights, &args.target, "extract")
}

/// Why a weights file was not written.
#[derive(Debug, thiserror::Error)]
enum WriteError {
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Edit(#[from] EditError),
}

/// Puts weights (task, term, weight) into a weights file, or shows what would change.
pub fn write_overlay(
    path: &Path,
    tasks: &[Arc<CompiledTask>],
    weights: &[(&str, &str, f64)],
    target: &Target,
    by: &str,
) -> Result<ExitCode, Error> {
    let store = Store::open(path)?;
    let edit = |text: &str| -> Result<(String, Vec<Change>), WriteError> {
        let after = edited(text, weights)?;
        let changes = changes(text, &after, tasks);
        Ok((after, changes))
    };
    let changes = if target.dry_run {
        edit(&store.read()?.map_or(String::new(), |version| version.text))?.1
    } else {
        store.edit(by, |version| edit(&version.text))?
    };
    print(&changes, &Target { file: path.to_path_buf(), ..*target })
}

/// Which weights another text of a weights file changes; one that is not there yet is that of the source.
fn changes(before: &str, after: &str, tasks: &[Arc<CompiledTask>]) -> Vec<Change> {
    let lines = |text: &str| {
        let mut sources = msk::compiler::diagnostics::SourceMap::default();
        msk::tuning::overlay::Overlay::read("", text, &mut sources).map(|overlay| overlay.lines().to_vec()).unwrap_or_default()
    };
    let before = lines(before);
    let source = |task: &str, term: &str| {
        let task = tasks.iter().find(|known| known.name == task)?;
        task.find_term(term).ok().map(|term| task.terms[term].written)
    };
    let change = |line: msk::tuning::overlay::Line| {
        let known = before.iter().find(|known| known.task == line.task && known.term == line.term).map(|known| known.weight);
        let from = known.or_else(|| source(&line.task, &line.term)).unwrap_or(0.0);
        let changed = known != Some(line.weight);
        changed.then(|| Change { task: line.task, term: line.term, from, to: line.weight, was: written(from) })
    };
    lines(after).into_iter().filter_map(change).collect()
}

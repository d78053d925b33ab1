//! `msk explain TASK`: what was understood of a task.

use crate::error::Error;
use crate::project::{Project, Settings};
use msk::compiler::explain;
use std::io::{self, Write};
use std::process::ExitCode;

/// Explain a task: formulas, weights, ranges, values at reset, what each term reads
#[derive(clap::Args)]
pub struct Args {
    /// Name of a task in tasks.msk, or a file with one task
    task: String,
    #[command(flatten)]
    settings: Settings,
}

/// Prints the explanation.
///
/// # Errors
/// Errors in the file.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (_, trial) = Project::find(&args.task, &args.settings.settings)?;
    let episode = trial.episode()?;
    let options = explain::Options { reset: Some(episode.frame()) };
    write!(io::stdout().lock(), "{}", explain::text(&trial.task, &options))?;
    Ok(ExitCode::SUCCESS)
}

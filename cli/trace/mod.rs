//! `msk trace`: what an evaluation has kept of episodes, step by step.

mod args;
pub mod emg;
mod envelopes;
mod export;
mod plot;

pub use args::{Quantities, TraceArgs, parse};

use crate::error::{Context, Error};
use msk::evaluate::MOST_BYTES;
use msk::evaluate::trace::{ArchiveError, Trace};
use msk_storage::{Folder, read_file};
use std::path::Path;
use std::process::ExitCode;

/// Work on traces: what `msk run --trace` and `msk eval --trace` keep of an episode, step by step
///
/// A trace is a NumPy archive: `time`, and an array for each quantity with a row per state or control step. The entry trace.json
/// names the columns with their units (docs/traces.md).
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    Plot(plot::Args),
    Export(export::Args),
    Emg(emg::Args),
    Envelopes(envelopes::Args),
}

/// Runs the subcommand.
///
/// # Errors
/// A file that is no trace, or an output that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    match args.command {
        Command::Plot(args) => plot::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Emg(args) => emg::run(&args),
        Command::Envelopes(args) => envelopes::run(&args),
    }
}

/// Reads a trace.
///
/// # Errors
/// A file that cannot be read, or is none.
pub fn read(path: &Path) -> Result<Trace, Error> {
    of(&read_file(path, MOST_BYTES).context(|| format!("cannot read `{}`", path.display()))?, path)
}

/// Reads a trace of a folder, which no link may have brought there.
///
/// # Errors
/// A file that cannot be read, is a link, or is none.
pub fn read_in(folder: &Folder, name: &Path) -> Result<Trace, Error> {
    let path = folder.path().join(name);
    let bytes = folder.read_private(name, MOST_BYTES).context(|| format!("cannot read `{}`", path.display()))?;
    of(&bytes.unwrap_or_default(), &path)
}

fn of(bytes: &[u8], path: &Path) -> Result<Trace, Error> {
    Trace::read(bytes).map_err(|error: ArchiveError| {
        let error = Error::new(format!("`{}` {error}", path.display()));
        error.hint("a trace is what `msk run TASK --trace FILE` writes")
    })
}

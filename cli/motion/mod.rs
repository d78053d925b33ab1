//! `msk motion ...`: tables of motions, measured and drawn on a body.

mod check;
mod plot;
mod view;

use crate::draw::describe;
use crate::error::{Context, Error};
use msk::compiler::diagnostics::{Report, SourceMap};
use msk::compiler::files::{LoadError, Loader};
use msk::compiler::motion::{self, Motion};
use msk::runtime::library::{BodyLibrary, BoundBody, FileLoader};
use std::path::PathBuf;
use std::process::ExitCode;

/// Check, draw or show a reference motion
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    Check(check::Args),
    Plot(plot::Args),
    View(view::Args),
}

/// Runs the chosen subcommand.
///
/// # Errors
/// Those of the subcommand.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    match args.command {
        Command::Check(args) => check::run(args),
        Command::Plot(args) => plot::run(args),
        Command::View(args) => view::run(args),
    }
}

/// Which motion on which body.
#[derive(clap::Args)]
struct Start {
    /// The table, a file of comma-separated values
    file: PathBuf,
    /// Name of a body (bodies/NAME.msk here or in a folder above, else built in), or a body file
    #[arg(long, default_value = "human")]
    body: String,
}

impl Start {
    /// The motion and the body, which it fits.
    fn load(&self) -> Result<(Motion, BoundBody), Error> {
        let text = FileLoader.load(&self.file).map_err(|problem| match problem {
            LoadError::Missing(path) => {
                Error::new(format!("there is no motion `{}`", path.display())).hint("a motion is a CSV file")
            }
            other => Error::from(other),
        })?;
        let mut sources = SourceMap::default();
        let file = sources.add(self.file.display().to_string(), text);
        let refused = |sources: SourceMap, diagnostics| Error::rendered(&Report::new(sources, diagnostics));
        let motion = match motion::read(file, sources.text(file)) {
            Ok(motion) => motion,
            Err(problems) => return Err(refused(sources, problems)),
        };
        let library = BodyLibrary::default();
        let bound =
            library.bind(&describe(&self.body, &library)?).context(|| format!("the body `{}` cannot be used", self.body))?;
        let problems = motion::problems(&motion, file, &bound.body.vocabulary(&bound.model));
        if problems.is_empty() { Ok((motion, bound)) } else { Err(refused(sources, problems)) }
    }
}

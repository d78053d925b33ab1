//! `msk check FILE...`: everything that is wrong, in one go.

use crate::error::{Error, FAILURE};
use crate::project;
use clap::ValueEnum;
use msk::compiler::compile;
use msk::compiler::diagnostics::Report;
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Check files: syntax, names, dimensions, meaning
///
/// Prints every error and warning with its place and what to do. Exit code 0 if there is no error, 1 if there is.
#[derive(clap::Args)]
pub struct Args {
    /// Files to check, with all that they use
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people
    Text,
    /// For editors and agents: a line per file, with edits that a machine can apply
    Json,
}

/// Checks the files.
///
/// # Errors
/// The report cannot be printed. Errors in the files are its content and make the exit code 1.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let bodies = BodyLibrary::default();
    let mut out = io::stdout().lock();
    let mut sound = true;
    for file in &args.files {
        let (report, tasks) = match compile(file, &FileLoader, &bodies) {
            Ok(compilation) => (Report::new(compilation.sources, compilation.warnings), compilation.tasks.len()),
            Err(report) => (report, 0),
        };
        sound &= !report.has_errors();
        match args.format {
            Format::Json => writeln!(out, "{}", report.to_json())?,
            Format::Text => {
                write!(out, "{}", report.render(project::style(&io::stdout())))?;
                if !report.has_errors() {
                    writeln!(out, "{}: {}", file.display(), found(tasks, report.diagnostics.len()))?;
                }
            }
        }
    }
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) })
}

fn found(tasks: usize, warnings: usize) -> String {
    let plural = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
    let remarks = if warnings == 0 { "nothing to remark".into() } else { plural(warnings, "warning") };
    format!("{}, {remarks}", plural(tasks, "task"))
}

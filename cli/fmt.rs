//! `msk fmt [PATH...]`: the one layout.

use crate::error::{Context, Error, FAILURE};
use crate::terminal;
use crate::texts;
use msk::compiler::diagnostics::{Report, SourceMap};
use msk::compiler::files::Loader;
use msk::compiler::format::{FormatError, format};
use msk::runtime::library::FileLoader;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Format files: spaces, indentation, weights and names in columns
///
/// Only whitespace changes. Files with syntax errors are unchanged and reported. Exit code 1 if a file has errors, or, with
/// --check, if a file is not formatted.
#[derive(clap::Args)]
pub struct Args {
    /// Files or folders; `-` reads standard input and writes to standard output
    #[arg(default_value = ".")]
    paths: Vec<PathBuf>,
    /// Change nothing, list the files that would change
    #[arg(long)]
    check: bool,
}

/// Lays out the files.
///
/// # Errors
/// A file that cannot be read or written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    if args.paths == [Path::new("-")] {
        return standard_input(args.check);
    }
    let mut sound = true;
    let mut out = terminal::out();
    for path in texts::find(&args.paths)? {
        let text = FileLoader.load(&path)?;
        let Some(formatted) = laid_out(&path.display().to_string(), &text)? else {
            sound = false;
            continue;
        };
        if formatted == text {
            continue;
        }
        sound &= !args.check;
        if args.check {
            writeln!(out, "{} would change", path.display())?;
        } else {
            texts::replace(&path, &formatted)?;
            writeln!(out, "{}", path.display())?;
        }
    }
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) })
}

fn standard_input(check: bool) -> Result<ExitCode, Error> {
    let mut text = String::new();
    io::stdin().lock().read_to_string(&mut text).context(|| "cannot read standard input".into())?;
    let Some(formatted) = laid_out("standard input", &text)? else { return Ok(ExitCode::from(FAILURE)) };
    if check {
        return Ok(if formatted == text { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) });
    }
    write!(terminal::bytes(), "{formatted}")?;
    Ok(ExitCode::SUCCESS)
}

/// The text in its layout; errors in it are printed.
fn laid_out(name: &str, text: &str) -> Result<Option<String>, Error> {
    let mut sources = SourceMap::default();
    let file = sources.add(name.to_owned(), text);
    match format(file, text) {
        Ok(formatted) => Ok(Some(formatted)),
        Err(FormatError::Unreadable(errors)) => {
            let report = Report::new(sources, errors);
            terminal::notes().diagnostics(&terminal::rendered(&report))?;
            Ok(None)
        }
        Err(error @ FormatError::Changed) => Err(error).context(|| format!("{name} is unchanged")),
    }
}

//! `msk motion plot FILE`: a motion as a picture.

use super::Start;
use crate::error::Error;
use crate::output;
use crate::terminal;
use msk::draw::motion;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Draw a motion as SVG: the body through it, and its joints over time
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    start: Start,
    /// How many bodies are drawn
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u16).range(2..=40))]
    bodies: u16,
    /// The file to write; without it, standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Runs the subcommand.
///
/// # Errors
/// A motion or body that cannot be read or do not fit each other, or a file that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (table, bound) = args.start.load()?;
    let picture = motion::svg(&bound.model, &bound.body, &table, usize::from(args.bodies));
    match &args.out {
        Some(path) => output::write(path, picture)?,
        None => terminal::bytes().write_all(picture.as_bytes())?,
    }
    Ok(ExitCode::SUCCESS)
}

//! `msk explain [TASK]`: what was understood of a task, or of all tasks of a file.

use crate::error::Error;
use crate::help;
use crate::output;
use crate::overlays::Overlays;
use crate::project::{self, Project, Settings};
use crate::terminal;
use clap::ValueEnum;
use msk::compiler::explain::{self, Options, TaskReport};
use msk::evaluate::Trial;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Explain tasks: formulas, weights, ranges, values at reset, inputs of each term, scene, initial state, terminations
#[derive(clap::Args)]
pub struct Args {
    /// Name of a task in tasks.msk, a file, or a task of a file as FILE@TASK; without it, the tasks of tasks.msk. An error code
    /// or the name of a lint gives its page, as `msk help` does
    task: Option<String>,
    /// How to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// The file to write; without it, standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    overlays: Overlays,
    #[command(flatten)]
    settings: Settings,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Text for a terminal
    Text,
    /// JSON for tools: a list of tasks, in SI units, formulas as text, LaTeX and MathML
    Json,
    /// LaTeX for papers: a document with tables of rewards, settings and success, for pdflatex
    Latex,
    /// HTML for browsers: one self-contained page
    Html,
}

/// Prints the explanation.
///
/// # Errors
/// Errors in the file, or a file that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let named = args.task.as_deref().unwrap_or(project::SUITE);
    if help::has_page(named) {
        write!(terminal::out(), "{}", help::page_of(named)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    let (project, mut trials) = Project::select(named, &args.settings.settings)?;
    args.overlays.apply(&project, &mut trials)?;
    let text = match args.format {
        Format::Text => {
            let texts: Vec<String> = trials
                .iter()
                .map(|trial| {
                    let episode = trial.episode()?;
                    Ok(explain::text(&trial.task, &Options { reset: Some(episode.frame()) }))
                })
                .collect::<Result<_, Error>>()?;
            texts.join("\n\n")
        }
        Format::Json => serde_json::to_string_pretty(&reports(&trials)?)? + "\n",
        Format::Latex => explain::latex(&reports(&trials)?),
        Format::Html => explain::html(&title(named), &reports(&trials)?),
    };
    match &args.out {
        Some(path) => output::write(path, text)?,
        None if matches!(args.format, Format::Text | Format::Json) => terminal::out().write_all(text.as_bytes())?,
        None => terminal::bytes().write_all(text.as_bytes())?,
    }
    Ok(ExitCode::SUCCESS)
}

fn reports(trials: &[Trial]) -> Result<Vec<TaskReport>, Error> {
    let report = |trial: &Trial| {
        let episode = trial.episode()?;
        Ok(explain::task_report(&trial.task, &Options { reset: Some(episode.frame()) }))
    };
    trials.iter().map(report).collect()
}

/// Of a page: the name of the file or task.
fn title(named: &str) -> String {
    let stem = Path::new(named).file_stem().unwrap_or_default().to_string_lossy();
    stem.replace('_', " ")
}

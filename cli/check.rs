//! `msk check FILE...`: everything that is wrong, in one go.

use crate::error::{Error, FAILURE};
use crate::levels::LevelArgs;
use crate::project::Settings;
use crate::terminal;
use crate::texts;
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use msk::compiler::diagnostics::{Diagnostic, Report};
use msk::compiler::task::CompiledTask;
use msk::compiler::{compile, compile_with};
use msk::evaluate::probe;
use msk::runtime::library::{BodyLibrary, FileLoader};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Check files: syntax, names, dimensions, semantics, lints
///
/// Prints every error and warning with its position and a suggested fix. Tasks without errors are also reset on their body
/// and evaluated in many poses, to find penetrations and violated constraints of the initial state, terminations and success
/// that hold at the first step, and conditions and terms that no pose reaches. Finally an episode of each task is played
/// with every muscle at rest: it must neither succeed nor earn more than holding the pose. A file without tasks is checked
/// as a library; a file without declarations is an error. Every warning belongs to a lint; --deny, --warn and --allow set
/// its level. Exit code 0 if there is no error, 1 otherwise.
#[derive(clap::Args)]
pub struct Args {
    /// Files to check, with their imports
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// First apply all safe fixes; the remaining findings are printed
    #[arg(long)]
    fix: bool,
    /// Skip the lints that need the model: neither poses nor an episode
    #[arg(long)]
    no_probe: bool,
    /// Skip the episode at rest, which takes most of the time
    #[arg(long)]
    no_play: bool,
    #[command(flatten)]
    lints: LevelArgs,
    #[command(flatten)]
    settings: Settings,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Text for people
    Text,
    /// JSON for editors and agents: a line per file, with machine-applicable fixes
    Json,
}

/// Checks the files.
///
/// # Errors
/// The report cannot be printed. Errors in the files are its content and make the exit code 1.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let bodies = BodyLibrary::default();
    let mut out = terminal::out();
    let mut sound = true;
    for file in &args.files {
        if args.fix {
            mend(file, &bodies)?;
        }
        let (mut report, tasks) = match compile_with(file, &FileLoader, &bodies, &args.settings.settings) {
            Ok(compilation) => {
                if compilation.declarations == 0 && compilation.tasks.is_empty() {
                    let nothing = Error::new(format!("`{}` declares nothing: there is nothing to check", file.display()));
                    nothing.hint("a task begins with `task NAME {`").report();
                    sound = false;
                    continue;
                }
                let mut diagnostics = compilation.warnings;
                if !args.no_probe {
                    diagnostics.extend(probe::new_of(&compilation.tasks, &bodies, &diagnostics));
                    if !args.no_play {
                        diagnostics.extend(play(&compilation.tasks, &bodies));
                    }
                }
                (Report::new(compilation.sources, diagnostics), compilation.tasks.len())
            }
            Err(report) => (report, 0),
        };
        args.lints.levels.apply(&mut report.diagnostics);
        sound &= !report.has_errors();
        match args.format {
            Format::Json => writeln!(out, "{}", report.to_json())?,
            Format::Text => {
                out.diagnostics(&terminal::rendered_out(&report))?;
                if !report.has_errors() {
                    writeln!(out, "{}: {}", file.display(), found(tasks, report.diagnostics.len()))?;
                }
            }
        }
    }
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) })
}

/// Plays an episode of each task at rest; with a progress line on a terminal.
fn play(tasks: &[Arc<CompiledTask>], bodies: &BodyLibrary) -> Vec<Diagnostic> {
    let bar = ProgressBar::with_draw_target(Some(tasks.len() as u64), ProgressDrawTarget::stderr_with_hz(10));
    // The template is a constant of this file; without it the bar has its default look.
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} tasks played at rest  {elapsed}") {
        bar.set_style(style);
    }
    let diagnostics = probe::episodes(tasks, bodies, &|| bar.inc(1));
    bar.finish_and_clear();
    diagnostics
}

/// Most rounds of fixes: one may make room for another, but none may go round in circles.
const ROUNDS: usize = 16;

/// Applies automatic fixes to a file and those that it uses, until there is none left, and prints what was changed.
fn mend(file: &Path, bodies: &BodyLibrary) -> Result<(), Error> {
    for _ in 0..ROUNDS {
        let report = match compile(file, &FileLoader, bodies) {
            Ok(compilation) => Report::new(compilation.sources, compilation.warnings),
            Err(report) => report,
        };
        let mut changed = false;
        for source in report.sources.files() {
            let (text, count) = report.fixed(source);
            let path = Path::new(report.sources.path(source));
            // What is embedded in the program is not there to be changed.
            if count > 0 && path.exists() && texts::replace_if(path, report.sources.text(source), &text)? {
                writeln!(terminal::notes(), "{}: {} applied", path.display(), plural(count, "fix", "fixes"))?;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    Ok(())
}

fn plural(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

fn found(tasks: usize, warnings: usize) -> String {
    let remarks = if warnings == 0 { "no errors, no warnings".into() } else { plural(warnings, "warning", "warnings") };
    let what = if tasks == 0 { "a library without tasks".into() } else { plural(tasks, "task", "tasks") };
    format!("{what}: {remarks}")
}

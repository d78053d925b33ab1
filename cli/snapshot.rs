//! `msk snapshot [FILES] [--check]`: what tasks mean, written down, so that a change of meaning is seen.

use crate::error::{Context, Error, FAILURE};
use crate::output;
use crate::project::{self, Settings, compiled};
use crate::terminal;
use msk::compiler::difference::Difference;
use msk::compiler::snapshot::Snapshot;
use msk::compiler::task::CompiledTask;
use msk_storage::read_text_file;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// The folder of `--out` by itself.
const FOLDER: &str = "snapshots";

/// Write snapshots of the semantics of tasks, or check tasks against them
///
/// Each task has a text file, NAME.snapshot: terms with weights, ranges and operations, terminations, observations, scene,
/// initial state. With --check nothing is written; a semantic difference is described and sets the exit code to 1, while
/// comments and layout are ignored. Intended for continuous integration.
#[derive(clap::Args)]
pub struct Args {
    /// Files, or tasks of a file as FILE@TASK, or tasks of tasks.msk; without any, the tasks of tasks.msk
    files: Vec<String>,
    /// Compare only, write nothing
    #[arg(long)]
    check: bool,
    /// The folder of the snapshots
    #[arg(long, value_name = "DIR", default_value = FOLDER)]
    out: PathBuf,
    #[command(flatten)]
    settings: Settings,
}

/// Writes or compares.
///
/// # Errors
/// A file that cannot be read, compiled or written. Differences are the content of a check and make the exit code 1.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let whole = args.files.is_empty();
    let files = if whole { vec![project::SUITE.to_owned()] } else { args.files };
    let mut tasks: Vec<(Snapshot, Arc<CompiledTask>)> = Vec::new();
    for file in &files {
        for task in compiled(file, &args.settings.settings)? {
            if tasks.iter().any(|(known, _)| known.task() == task.name) {
                let message = format!("two of the files contain a task called `{}`", task.name);
                return Err(Error::usage(message).hint("write their snapshots to different folders: --out DIR"));
            }
            tasks.push((task.snapshot(), task));
        }
    }
    if args.check { check(&tasks, &args.out, whole) } else { write(&tasks, &args.out) }
}

/// Largest snapshot that is read, bytes.
const LARGEST: u64 = 1 << 24;

fn name(task: &str) -> PathBuf {
    format!("{task}.snapshot").into()
}

fn write(tasks: &[(Snapshot, Arc<CompiledTask>)], folder: &Path) -> Result<ExitCode, Error> {
    // A folder from somebody else may hold links in place of snapshots: nothing is written through them.
    let opened = output::folder(folder, FOLDER)?;
    let mut out = terminal::out();
    for (snapshot, task) in tasks {
        let (name, text) = (name(snapshot.task()), snapshot.to_string());
        // What cannot be read as a snapshot has nothing to be compared with.
        let known = opened.read_text(&name, LARGEST).ok().flatten();
        if known.as_deref() == Some(&text) {
            continue;
        }
        // Changes are printed while they are written, so that none is accepted unseen.
        if let Some(Ok(before)) = known.map(|known| known.parse::<Snapshot>()) {
            let difference = Difference::between(&before, snapshot, true).with_units(task);
            if !difference.is_empty() {
                write!(out, "{difference}")?;
            }
        }
        opened.replace(&name, text.as_bytes())?;
        writeln!(out, "{}", folder.join(name).display())?;
    }
    Ok(ExitCode::SUCCESS)
}

fn check(tasks: &[(Snapshot, Arc<CompiledTask>)], folder: &Path, whole: bool) -> Result<ExitCode, Error> {
    let mut out = terminal::out();
    let mut sound = true;
    for (snapshot, task) in tasks {
        let path = folder.join(name(snapshot.task()));
        if !path.exists() {
            writeln!(out, "{}\n  has no snapshot yet: write it with `msk snapshot`", snapshot.task())?;
            sound = false;
            continue;
        }
        let text = read_text_file(&path, LARGEST)?;
        let before: Snapshot = text.parse().context(|| format!("cannot read `{}`", path.display()))?;
        let difference = Difference::between(&before, snapshot, true).with_units(task);
        if !difference.is_empty() {
            write!(out, "{difference}")?;
            sound = false;
        }
    }
    for left in if whole { left_over(tasks, folder)? } else { Vec::new() } {
        writeln!(out, "{}\n  has a snapshot, but the task does not exist any more", left)?;
        sound = false;
    }
    if !sound {
        writeln!(terminal::notes(), "hint: if the change is intended, run `msk snapshot` and commit the result")?;
        return Ok(ExitCode::from(FAILURE));
    }
    writeln!(
        out,
        "{} equals its snapshot",
        if tasks.len() == 1 { "1 task".into() } else { format!("each of {} tasks", tasks.len()) }
    )?;
    Ok(ExitCode::SUCCESS)
}

/// Tasks that have a snapshot and are not there.
fn left_over(tasks: &[(Snapshot, Arc<CompiledTask>)], folder: &Path) -> Result<Vec<String>, Error> {
    let mut left = Vec::new();
    if !folder.exists() {
        return Ok(left);
    }
    let cannot = || format!("cannot read the folder `{}`", folder.display());
    for entry in fs::read_dir(folder).context(cannot)? {
        let path = entry.context(cannot)?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if path.extension().is_some_and(|extension| extension == "snapshot") && !tasks.iter().any(|(task, _)| task.task() == name)
        {
            left.push(name);
        }
    }
    left.sort();
    Ok(left)
}

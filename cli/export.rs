//! `msk export TASK --target python`: tasks for people who stay on MuJoCo.

use crate::error::Error;
use crate::output;
use crate::project::{Project, Settings};
use crate::terminal;
use clap::ValueEnum;
use msk::export;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The folder of `--out` by itself.
const FOLDER: &str = "export";

/// Write tasks as modules over MuJoCo's own model and data: observation, terms, terminations, success
///
/// Each task has a module NAME.py with one function per term, condition and channel, and a model NAME.xml, its body in its scene; one
/// file, msk_mujoco.py, serves them all. How an episode begins and how an action becomes excitations is not exported. What MuJoCo does
/// not measure is refused with the reason.
#[derive(clap::Args)]
pub struct Args {
    /// Name of a task in tasks.msk, a file, or a task of a file as FILE@TASK
    task: String,
    /// The language of the modules
    #[arg(long, value_enum)]
    target: Target,
    /// The folder of the files
    #[arg(long, value_name = "DIR", default_value = FOLDER)]
    out: PathBuf,
    #[command(flatten)]
    settings: Settings,
}

#[derive(Clone, Copy, ValueEnum)]
enum Target {
    /// Python 3.11 or newer, with NumPy and MuJoCo
    Python,
}

/// Exports.
///
/// # Errors
/// Errors in the file, a task that cannot be expressed, or a file that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (_, trials) = Project::select(&args.task, &args.settings.settings)?;
    let Target::Python = args.target;
    let mut files: BTreeMap<String, String> = BTreeMap::new();
    for trial in &trials {
        let exported = export::python(&trial.task, &trial.body.body, &trial.body.model)
            .map_err(|refused| Error::new(refused.to_string()).hint("leave these signals out, or stay on MSK's own simulator"))?;
        files.extend(exported.files().into_iter().map(|(name, text)| (name, text.to_owned())));
    }
    let (folder, mut out) = (output::folder(&args.out, FOLDER)?, terminal::out());
    for (name, text) in &files {
        folder.replace(Path::new(name), text.as_bytes())?;
        writeln!(out, "{}", args.out.join(name).display())?;
    }
    Ok(ExitCode::SUCCESS)
}

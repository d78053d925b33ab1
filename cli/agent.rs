//! `msk agent`: what `msk train` has made, shown and written for other programs.

use crate::error::Error;
use crate::output;
use crate::terminal;
use clap::Subcommand;
use msk::compiler::numbers::for_people;
use msk::train::Agent;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Show an agent, or write it for other programs
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// Print what an agent was trained on, and how well it does
    Show {
        /// Folder of an agent, or of a training, of which it is then the one that succeeded most
        agent: PathBuf,
    },
    /// Write an agent in another form: for other programs, or small
    Export {
        /// Folder of an agent, or of a training, of which it is then the one that succeeded most
        agent: PathBuf,
        #[command(flatten)]
        forms: Forms,
    },
}

/// The forms in which an agent is written.
#[derive(clap::Args)]
#[group(required = true, multiple = true)]
struct Forms {
    /// Write it as an ONNX file, which takes observations as the task gives them and gives actions: its normaliser is part of it
    #[arg(long, value_name = "FILE")]
    onnx: Option<PathBuf>,
    /// Write it as the folder of an agent whose network is in half precision, in about half the bytes; it acts slightly differently, and
    /// its evaluation is left out
    #[arg(long, value_name = "DIR")]
    half: Option<PathBuf>,
}

/// Shows or exports.
///
/// # Errors
/// A folder that holds no agent, or a file that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let mut out = terminal::out();
    match args.action {
        Action::Show { agent } => {
            let agent = Agent::read(&agent)?;
            let known = &agent.description;
            writeln!(out, "task       {} ({})", known.task, known.task_hash)?;
            writeln!(out, "body       {} ({})", known.body, known.body_hash)?;
            writeln!(out, "learned    {}, {} control steps, seed {}", known.algorithm, known.steps, known.seed)?;
            writeln!(out, "network    {}", agent.sizes())?;
            if known.action_repeat > 1 {
                writeln!(out, "actions    last for {} control steps", known.action_repeat)?;
            }
            if let Some(found) = known.evaluation {
                let (success, total) = (for_people(100.0 * found.success), for_people(found.total));
                writeln!(out, "evaluated  return {total}, {success} % of {} episodes succeeded", found.episodes)?;
            }
        }
        Action::Export { agent, forms } => {
            let agent = Agent::read(&agent)?;
            if let Some(file) = forms.onnx {
                output::write(&file, agent.onnx())?;
                writeln!(out, "{}", file.display())?;
            }
            if let Some(folder) = forms.half {
                agent.in_half_precision()?.save(&folder)?;
                writeln!(out, "{}", folder.display())?;
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}

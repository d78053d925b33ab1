//! `msk agent`: what `msk train` has made, shown and written for other programs.

use crate::error::{Context, Error};
use clap::Subcommand;
use msk::compiler::numbers::for_people;
use msk::train::Agent;
use std::fs;
use std::io::{self, Write};
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
    /// Write an agent as an ONNX file, which takes observations as the task gives them and gives actions: its normaliser is part of it
    Export {
        /// Folder of an agent, or of a training, of which it is then the one that succeeded most
        agent: PathBuf,
        /// The file
        #[arg(long, value_name = "FILE")]
        onnx: PathBuf,
    },
}

/// Shows or exports.
///
/// # Errors
/// A folder that holds no agent, or a file that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let mut out = io::stdout().lock();
    match args.action {
        Action::Show { agent } => {
            let agent = Agent::read(&agent)?;
            let known = &agent.description;
            writeln!(out, "task       {} ({})", known.task, known.task_hash)?;
            writeln!(out, "body       {} ({})", known.body, known.body_hash)?;
            writeln!(out, "learned    {}, {} control steps, seed {}", known.algorithm, known.steps, known.seed)?;
            writeln!(out, "network    {}", agent.sizes())?;
            if let Some(found) = known.evaluation {
                let (success, total) = (for_people(100.0 * found.success), for_people(found.total));
                writeln!(out, "evaluated  return {total}, {success} % of {} episodes succeeded", found.episodes)?;
            }
        }
        Action::Export { agent, onnx } => {
            let agent = Agent::read(&agent)?;
            fs::write(&onnx, agent.onnx()).context(|| format!("cannot write `{}`", onnx.display()))?;
            writeln!(out, "{}", onnx.display())?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

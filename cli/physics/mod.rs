//! `msk physics ...`: doors to the simulator for people and scripts, in MuJoCo's names and orders.
//!
//! As in the root, a subcommand's file holds its `Args` and `run`, and gets one line in [`Command`] and one in [`run`].

mod bench;
mod forward;
mod import;
mod rollout;

use crate::error::{Context, Error};
use msk_runtime::{bodies, inspect::StateFile, model::Model, physics::State};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Look into the simulator
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    Bench(bench::Args),
    Forward(forward::Args),
    Rollout(rollout::Args),
    Import(import::Args),
}

/// Runs the chosen subcommand.
///
/// # Errors
/// Those of the subcommand.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    match args.command {
        Command::Bench(args) => bench::run(args),
        Command::Forward(args) => forward::run(args),
        Command::Rollout(args) => rollout::run(args),
        Command::Import(args) => import::run(args),
    }
}

/// What most of these commands start from.
#[derive(clap::Args)]
struct Start {
    /// The MJCF model; without it, the human body that comes with the program
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// The state as JSON: qpos, qvel, act, ctrl, qfrc_applied, xfrc_applied; what is absent is at rest
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
}

impl Start {
    fn load(&self) -> Result<(Model, State<f64>), Error> {
        let path = self.model.clone().unwrap_or_else(|| Path::new(bodies::ROOT).join("bodies/models/human416.xml"));
        let model = bodies::model(&path)?;
        let file = match &self.state {
            Some(path) => read_state(path)?,
            None => StateFile::default(),
        };
        let state = file.state(&model)?;
        Ok((model, state))
    }
}

/// Reads a state file of at most 64 MiB.
pub fn read_state(path: &Path) -> Result<StateFile, Error> {
    const LARGEST: u64 = 64 << 20;
    let mut text = String::new();
    let file = File::open(path).context(|| format!("cannot read {}", path.display()))?;
    file.take(LARGEST).read_to_string(&mut text).context(|| format!("cannot read {}", path.display()))?;
    serde_json::from_str(&text).context(|| format!("{} is not a state", path.display()))
}

//! `msk physics ...`: doors to the simulator for people and scripts, in MuJoCo's names and orders.
//!
//! As in the root, a subcommand's file holds its `Args` and `run`, and gets one line in [`Command`] and one in [`run`].

mod bench;
mod forward;
mod import;
mod muscle;
mod rollout;

use crate::error::{Context, Error};
use crate::texts;
use msk_physics::State;
use msk_physics::model::Model;
use msk_runtime::{bodies, inspect::StateFile};
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
    Muscle(muscle::Args),
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
        Command::Muscle(args) => muscle::run(args),
    }
}

/// What most of these commands start from.
#[derive(clap::Args)]
struct Start {
    /// The MJCF model; without it, the human body that comes with the program
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// The state as JSON: qpos, qvel, act, ctrl, qfrc_applied, xfrc_applied; what is absent is at rest
    #[arg(long, value_name = "FILE", conflicts_with = "keyframe")]
    state: Option<PathBuf>,
    /// The key frame of the model to start from
    #[arg(long, value_name = "NAME")]
    keyframe: Option<String>,
}

impl Start {
    fn load(&self) -> Result<(Model, State<f64>), Error> {
        let path = self.model.clone().unwrap_or_else(|| Path::new(bodies::ROOT).join("bodies/models/human416.xml"));
        let model = bodies::model(&path)?;
        if let Some(name) = &self.keyframe {
            let state = named_state(&model, name)?;
            return Ok((model, state));
        }
        let file = match &self.state {
            Some(path) => read_state(path)?,
            None => StateFile::default(),
        };
        let state = file.state(&model)?;
        Ok((model, state))
    }
}

/// The state of a key frame.
fn named_state(model: &Model, name: &str) -> Result<State<f64>, Error> {
    let named = model.keyframes.iter().find(|frame| frame.name == name);
    let frame = named.ok_or_else(|| {
        let known: Vec<String> = model.keyframes.iter().map(|frame| format!("`{}`", frame.name)).collect();
        let known = if known.is_empty() { "it has none".to_owned() } else { format!("it has {}", known.join(", ")) };
        Error::new(format!("the model has no keyframe `{name}`: {known}"))
    })?;
    Ok(frame.state(model))
}

/// Reads a state file.
pub fn read_state(path: &Path) -> Result<StateFile, Error> {
    let text = texts::read(path)?;
    serde_json::from_str(&text).context(|| format!("{} is not a state", path.display()))
}

//! `msk physics ...`: doors to the simulator for people and scripts, in MuJoCo's names and orders.
//!
//! As in the root, a subcommand's file holds its `Args` and `run`, and gets one line in [`Command`] and one in [`run`].

mod import;

use crate::error::Error;
use std::process::ExitCode;

/// Look into the simulator
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    Import(import::Args),
}

/// Runs the chosen subcommand.
///
/// # Errors
/// Those of the subcommand.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    match args.command {
        Command::Import(args) => import::run(args),
    }
}

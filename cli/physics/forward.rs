//! `msk physics forward`: every intermediate quantity of one forward computation.

use super::Start;
use crate::error::Error;
use crate::terminal;
use msk_physics::{self as physics, Workspace};
use msk_runtime::inspect::{Extra, forward_report};
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

/// Print every quantity of one forward computation as JSON, in MuJoCo's names and orders
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    start: Start,
    /// Also list how each muscle's length changes with each degree of freedom (actuator_moment)
    #[arg(long)]
    moment_arms: bool,
    /// Also list the Jacobian of the constraint rows (efc_J)
    #[arg(long)]
    constraint_jacobian: bool,
}

/// Runs the subcommand.
///
/// # Errors
/// A model or state that cannot be read, or a state that the physics refuses.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (model, state) = args.start.load()?;
    let mut workspace = Workspace::new(&model);
    physics::forward(&model, &state, &mut workspace)?;
    let extra = Extra { moment_arms: args.moment_arms, constraint_jacobian: args.constraint_jacobian };
    let mut out = BufWriter::new(terminal::out());
    serde_json::to_writer(&mut out, &forward_report(&model, &state, &workspace, extra)).map_err(io::Error::from)?;
    out.write_all(b"\n")?;
    out.flush()?;
    Ok(ExitCode::SUCCESS)
}

//! `msk physics import`: somebody else's model as one flat file of figures.

use crate::error::Error;
use crate::output;
use crate::terminal;
use msk::compiler::numbers::fixed;
use msk_physics::model::{Model, import};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Flatten an MJCF model into one file: no includes, no meshes, every inertia explicit
#[derive(clap::Args)]
pub struct Args {
    /// The model to read, with everything it includes
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Runs the subcommand.
///
/// # Errors
/// A model that cannot be read or uses unsupported features, or a file that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let model = import::import(Model::from_file(&args.model)?);
    let text = import::to_file_text(&model, &args.model);
    output::write(&args.out, text)?;
    writeln!(
        terminal::notes(),
        "{}: {} bodies, {} joints, {} muscles, {} kg",
        args.out.display(),
        model.bodies.name.len() - 1,
        model.joints.name.len(),
        model.actuators.name.len(),
        fixed(model.bodies.subtree_mass[0], 2)
    )?;
    Ok(ExitCode::SUCCESS)
}

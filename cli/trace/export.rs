//! `msk trace export`: a trace as files of OpenSim.

use crate::error::Error;
use crate::output;
use crate::terminal;
use msk::evaluate::trace::opensim;
use msk_storage::Folder;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Write a trace as files of OpenSim: activations.sto, controls.sto, forces.sto, coordinates.mot, ground_reactions.mot
///
/// Angles are in degrees, y is up. Joints keep the names of the body file.
#[derive(clap::Args)]
pub struct Args {
    /// The trace
    trace: PathBuf,
    /// Folder for the files, which are called after the trace [default: that of the trace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Writes the files, and their paths to standard output.
///
/// # Errors
/// A file that is no trace, one without anything that OpenSim has a file for, or a file that cannot be written.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let trace = super::read(&args.trace)?;
    let folder = args.out.clone().or_else(|| args.trace.parent().map(PathBuf::from)).unwrap_or_default();
    let stem = args.trace.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let files = opensim(&trace);
    if files.is_empty() {
        let error = Error::new(format!("`{}` has nothing that OpenSim has a file for", args.trace.display()));
        return Err(error.hint("keep activations, positions or ground_reactions with `--trace`"));
    }
    let opened = Folder::create(&folder)?;
    for file in files {
        let name = format!("{stem}_{}", file.name);
        output::write_in(&opened, &name, file.text)?;
        writeln!(terminal::out(), "{}", folder.join(name).display())?;
    }
    Ok(ExitCode::SUCCESS)
}

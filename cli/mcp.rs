//! `msk mcp`: a server for agents over standard input and output.

use crate::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

/// Serve agents over standard input and output by the Model Context Protocol
///
/// Tools list tasks and terms, explain, check a text, propose and apply weights, run a few episodes within a budget,
/// compare, and read results; resources hold the reference and the vocabulary. Nothing outside of the project is read or
/// written, and writing is a dry run unless the agent requests otherwise. docs/weights.md shows how to set a client up.
#[derive(clap::Args)]
pub struct Args {
    /// The folder that holds tasks.msk
    #[arg(long, value_name = "DIR", default_value = ".")]
    project: PathBuf,
}

/// Serves until the client closes standard input.
///
/// # Errors
/// A folder that cannot be used, or a client that does not speak the protocol.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    msk_mcp::serve(&args.project)?;
    Ok(ExitCode::SUCCESS)
}

//! `msk help [COMMAND]`: what a command does.

use crate::Cli;
use crate::error::Error;
use clap::CommandFactory;
use std::io::{self, Write};
use std::process::ExitCode;

/// Explain a command
#[derive(clap::Args)]
pub struct Args {
    /// A command, such as `eval`; nothing for the list of all
    #[arg(value_name = "COMMAND")]
    topic: Vec<String>,
}

/// Prints the help of a command.
///
/// # Errors
/// An unknown command.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let mut command = Cli::command();
    command.build();
    for name in &args.topic {
        command = command
            .find_subcommand(name)
            .cloned()
            .ok_or_else(|| Error::usage(format!("there is no command `{name}`")).hint("`msk help` lists them"))?;
    }
    write!(io::stdout().lock(), "{}", command.render_long_help())?;
    Ok(ExitCode::SUCCESS)
}

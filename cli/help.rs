//! `msk help [COMMAND | CODE]`: what a command does, or what an error code means.

use crate::Cli;
use crate::error::Error;
use clap::CommandFactory;
use msk::compiler::diagnostics::{Code, codes};
use std::io::{self, Write};
use std::process::ExitCode;

/// Explain a command, or an error code such as E0203
#[derive(clap::Args)]
pub struct Args {
    /// A command, such as `eval`, or a code, such as `E0203`; nothing for the list of commands
    #[arg(value_name = "COMMAND | CODE")]
    topic: Vec<String>,
}

/// Prints the help of a command or the page of a code.
///
/// # Errors
/// An unknown command or code.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let mut out = io::stdout().lock();
    match args.topic.as_slice() {
        [id] if is_code(id) => {
            let code = codes::find(id)
                .ok_or_else(|| Error::usage(format!("there is no code `{id}`")).hint("`grammar/REFERENCE.md` lists all codes"))?;
            write!(out, "{}", page(code))?;
        }
        names => write!(out, "{}", command_help(names)?)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// A letter and four digits.
fn is_code(topic: &str) -> bool {
    topic.len() == 5 && topic.starts_with(|c: char| c.is_ascii_alphabetic()) && topic[1..].bytes().all(|b| b.is_ascii_digit())
}

fn page(code: &Code) -> String {
    let indent = |text: &str| text.lines().map(|line| format!("    {line}\n")).collect::<String>();
    let Code { id, title, explanation, example, fix } = code;
    format!("{id}: {title}\n\n{explanation}\n\nWrong:\n{}\nRight:\n{}", indent(example), indent(fix))
}

fn command_help(names: &[String]) -> Result<String, Error> {
    let mut command = Cli::command();
    command.build();
    for name in names {
        command = command
            .find_subcommand(name)
            .cloned()
            .ok_or_else(|| Error::usage(format!("there is no command `{name}`")).hint("`msk help` lists them"))?;
    }
    Ok(command.render_long_help().to_string())
}

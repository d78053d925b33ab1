//! `msk help [COMMAND | CODE | exit-codes]`: what a command does, what an error code means, or what the program's exit codes say.

use crate::Cli;
use crate::error::Error;
use clap::CommandFactory;
use msk::compiler::diagnostics::{Code, codes};
use std::io::{self, Write};
use std::process::ExitCode;

/// What the exit codes mean, for people and scripts; `msk help exit-codes` prints it.
const EXIT_CODES: &str = include_str!("../docs/exit-codes.md");

/// Explain a command, an error code such as E0203, or the exit codes
#[derive(clap::Args)]
pub struct Args {
    /// A command, such as `eval`, a code, such as `E0203`, or `exit-codes`; nothing for the list of commands
    #[arg(value_name = "COMMAND | CODE | exit-codes")]
    topic: Vec<String>,
}

/// Prints the help of a command, the page of a code, or the exit codes.
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
        [topic] if topic == "exit-codes" => write!(out, "{EXIT_CODES}")?,
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_command_has_a_row_of_exit_codes() {
        let rows = EXIT_CODES.lines().filter_map(|line| line.strip_prefix("| `msk ")?.split_once('`'));
        let told: BTreeSet<&str> = rows.map(|(name, _)| name).collect();
        let command = Cli::command();
        let there: BTreeSet<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        assert_eq!(told, there);
    }
}

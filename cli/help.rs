//! `msk help [COMMAND | CODE | LINT | lints | policies | training | exit-codes]`: what a command does, what a code or a lint means, which lints
//! there are, how a policy of one's own is written, or what the program's exit codes mean.

use crate::Cli;
use crate::error::Error;
use crate::terminal;
use clap::CommandFactory;
use msk::compiler::diagnostics::{Code, codes, lints};
use std::io::Write;
use std::process::ExitCode;

/// What the exit codes mean, for people and scripts; `msk help exit-codes` prints it.
const EXIT_CODES: &str = include_str!("../docs/exit-codes.md");

/// How policies are written; `msk help policies` prints it.
const POLICIES: &str = include_str!("../docs/policies.md");

/// How agents are trained; `msk help training` prints it.
const TRAINING: &str = include_str!("../docs/training.md");

/// Explain a command, an error code such as E0203, a lint such as dead_at_reset, policies, or the exit codes; list all lints
#[derive(clap::Args)]
pub struct Args {
    /// A command, such as `eval`, a code, such as `E0203`, a lint, such as `dead_at_reset`, `lints` for the list of all,
    /// `policies` for how to write one, `training` for how agents are trained, or `exit-codes`; nothing for the list of commands
    #[arg(value_name = "COMMAND | CODE | LINT | lints | policies | training | exit-codes")]
    topic: Vec<String>,
}

/// Prints the help of a command, the page of a code, or the exit codes.
///
/// # Errors
/// An unknown command or code.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let mut out = terminal::out();
    match args.topic.as_slice() {
        [topic] if has_page(topic) => write!(out, "{}", page_of(topic)?)?,
        [topic] if topic == "lints" => write!(out, "{}", table_of_lints())?,
        [topic] if topic == "policies" => write!(out, "{POLICIES}")?,
        [topic] if topic == "training" => write!(out, "{TRAINING}")?,
        [topic] if topic == "exit-codes" => write!(out, "{EXIT_CODES}")?,
        names => write!(out, "{}", command_help(names)?)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Whether a word is a code, or the name of a lint: what `page_of` has a page for, or refuses.
pub fn has_page(topic: &str) -> bool {
    is_code(topic) || lints().any(|(_, lint)| lint.name == topic)
}

/// The page of a code or of a lint.
///
/// # Errors
/// There is none.
pub fn page_of(topic: &str) -> Result<String, Error> {
    let named = lints().find(|(_, lint)| lint.name == topic).map(|(code, _)| code);
    let unknown = || Error::usage(format!("there is no code `{topic}`")).hint("`grammar/REFERENCE.md` lists all codes");
    named.or_else(|| codes::find(topic)).map(page).ok_or_else(unknown)
}

/// Every lint with its level, the stage of `msk check` that finds it, and what it finds.
fn table_of_lints() -> String {
    let wide = lints().map(|(_, lint)| lint.name.len()).max().unwrap_or(0);
    let line = |code: &str, name: &str, level: &str, stage: &str, title: &str| {
        format!("{code:<5}  {name:<wide$}  {level:<5}  {stage:<7}  {title}\n")
    };
    let rows = lints().map(|(code, lint)| line(code.id, lint.name, lint.level().name(), lint.stage.name(), code.title));
    let head = line("code", "lint", "level", "stage", "what it finds");
    head + &rows.collect::<String>() + "\n`msk help NAME` prints the page of a lint.\n"
}

/// A letter and four digits.
fn is_code(topic: &str) -> bool {
    topic.len() == 5 && topic.starts_with(|c: char| c.is_ascii_alphabetic()) && topic[1..].bytes().all(|b| b.is_ascii_digit())
}

fn page(code: &Code) -> String {
    let indent = |text: &str| text.lines().map(|line| format!("    {line}\n")).collect::<String>();
    let Code { title, explanation, example, fix, .. } = code;
    let named = code.named();
    format!("{named}: {title}\n\n{explanation}\n\nWrong:\n{}\nRight:\n{}", indent(example), indent(fix))
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
        let documented: BTreeSet<&str> = rows.map(|(name, _)| name).collect();
        let command = Cli::command();
        let there: BTreeSet<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        assert_eq!(documented, there);
    }
}

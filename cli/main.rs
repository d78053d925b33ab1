//! The `msk` command line: one file per subcommand, each a thin door to the libraries.
//!
//! A subcommand's file holds its `Args` and `run`; here it gets one line in [`Command`] and one in [`Command::run`].
//! What goes wrong comes back as an [`Error`] and is printed in one place.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod agent;
mod check;
mod collect;
mod compare;
mod condition;
mod diff;
mod draw;
mod error;
mod eval;
mod explain;
mod exploit;
mod export;
mod fmt;
mod help;
mod html;
mod interrupt;
mod levels;
mod lsp;
mod mcp;
mod merge;
mod motion;
mod mutate;
mod named;
mod new;
mod numbers;
mod output;
mod overlays;
mod physics;
mod pictures;
mod policies;
mod progress;
mod project;
mod ranking;
mod renamed;
mod report;
mod run;
mod sensitivity;
mod session;
mod snapshot;
mod terminal;
mod test;
mod texts;
mod trace;
mod train;
mod tune;
mod view;
mod vocabulary;
mod weights;

use clap::{Parser, Subcommand};
use error::Error;
use std::process::ExitCode;

/// MSK: write full-body motor-control tasks as text, check them, and run them on a 416-muscle human.
#[derive(Parser)]
#[command(name = "msk", version, disable_help_subcommand = true, max_term_width = 100)]
#[command(after_help = "`msk help COMMAND` explains a command, `msk help E0203` an error code, `msk help lints` the lints, \
                  `msk help exit-codes` the exit codes.")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    New(new::Args),
    Check(check::Args),
    Explain(explain::Args),
    Diff(diff::Args),
    Snapshot(snapshot::Args),
    Fmt(fmt::Args),
    Lsp(lsp::Args),
    Run(run::Args),
    Eval(eval::Args),
    Session(session::Args),
    Report(report::Args),
    Merge(merge::Args),
    Compare(compare::Args),
    Collect(collect::Args),
    Trace(trace::Args),
    Test(test::Args),
    Mutate(mutate::Args),
    Exploit(exploit::Args),
    Vocabulary(vocabulary::Args),
    Weights(weights::Args),
    Train(train::Args),
    Agent(agent::Args),
    Tune(tune::Args),
    View(view::Args),
    Sensitivity(sensitivity::Args),
    Mcp(mcp::Args),
    Draw(draw::Args),
    Motion(motion::Args),
    Export(export::Args),
    Physics(physics::Args),
    Help(help::Args),
}

impl Command {
    fn run(self) -> Result<ExitCode, Error> {
        match self {
            Self::New(args) => new::run(args),
            Self::Check(args) => check::run(args),
            Self::Explain(args) => explain::run(args),
            Self::Diff(args) => diff::run(args),
            Self::Snapshot(args) => snapshot::run(args),
            Self::Fmt(args) => fmt::run(args),
            Self::Lsp(args) => lsp::run(args),
            Self::Run(args) => run::run(args),
            Self::Eval(args) => eval::run(args),
            Self::Session(args) => session::run(args),
            Self::Report(args) => report::run(&args),
            Self::Merge(args) => merge::run(&args),
            Self::Compare(args) => compare::run(&args),
            Self::Collect(args) => collect::run(args),
            Self::Trace(args) => trace::run(args),
            Self::Test(args) => test::run(args),
            Self::Mutate(args) => mutate::run(args),
            Self::Exploit(args) => exploit::run(args),
            Self::Vocabulary(args) => vocabulary::run(args),
            Self::Weights(args) => weights::run(args),
            Self::Train(args) => train::run(args),
            Self::Agent(args) => agent::run(args),
            Self::Tune(args) => tune::run(args),
            Self::View(args) => view::run(args),
            Self::Sensitivity(args) => sensitivity::run(args),
            Self::Mcp(args) => mcp::run(args),
            Self::Draw(args) => draw::run(args),
            Self::Motion(args) => motion::run(args),
            Self::Export(args) => export::run(args),
            Self::Physics(args) => physics::run(args),
            Self::Help(args) => help::run(args),
        }
    }
}

fn main() -> ExitCode {
    match Cli::try_parse() {
        Ok(cli) => cli.command.run().unwrap_or_else(|error| error.report()),
        Err(error) => terminal::usage(&renamed::with_present_name(error)),
    }
}

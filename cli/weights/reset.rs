//! `msk weights reset FILE [TERM...]`.

use super::{Opened, Target};
use crate::error::Error;
use msk::compiler::weights::Edit;
use msk::tuning::history;
use std::process::ExitCode;

/// Take changes back: the weights as they were before the first change in the history
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Which terms; all that were changed if none is named
    terms: Vec<String>,
}

/// Goes back.
///
/// # Errors
/// A file or history that cannot be read or written, or a weight that may not be so.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let opened = Opened::open(&args.target)?;
    let first = history::first(&opened.path)?;
    let chosen = opened.chosen(&args.terms)?;
    let wish = |index: usize| {
        let entry = &opened.weights.entries[index];
        let before = first.iter().find(|change| change.task == entry.task && change.term == entry.term)?;
        // The digits come back as they were written, not only their value.
        Some(Edit { digits: Some(before.was.clone()), ..opened.wish(index, before.from) })
    };
    let edits: Vec<Edit> = chosen.into_iter().filter_map(wish).collect();
    opened.change(&edits, &args.target, "reset")
}

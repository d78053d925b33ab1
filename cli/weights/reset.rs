//! `msk weights reset FILE [TERM...]`.

use super::{Target, change};
use crate::error::Error;
use msk::compiler::weights::Edit;
use msk::tuning::store::Store;
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
    change(&args.target, "reset", |opened| {
        let first = Store::open(&opened.path)?.first_changes()?;
        let wish = |index: usize| {
            let entry = &opened.weights.entries[index];
            let before = first.iter().find(|change| change.task == entry.task && change.term == entry.term)?;
            // The digits come back as they were written, not only their value.
            Some(Edit { digits: Some(before.was.clone()), ..opened.wish(index, before.from) })
        };
        Ok(opened.chosen(&args.terms)?.into_iter().filter_map(wish).collect())
    })
}

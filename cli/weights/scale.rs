//! `msk weights scale FILE 0.5 [TERM...]`.

use super::{Opened, Target};
use crate::error::Error;
use msk::compiler::weights::Edit;
use std::process::ExitCode;

/// Multiply weights by a factor
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// By what
    factor: f64,
    /// Which terms; all that are not fixed if none is named
    terms: Vec<String>,
}

/// Scales the weights.
///
/// # Errors
/// A file that cannot be read or written, or a weight that may not be so.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let opened = Opened::open(&args.target)?;
    let entries = &opened.weights.entries;
    let edits: Vec<Edit> =
        opened.chosen(&args.terms)?.into_iter().map(|index| opened.wish(index, entries[index].value * args.factor)).collect();
    opened.change(&edits, &args.target, "scale")
}

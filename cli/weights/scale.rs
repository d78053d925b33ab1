//! `msk weights scale FILE 0.5 [TERM...]`.

use super::{Target, change};
use crate::error::Error;
use crate::numbers::within;
use std::process::ExitCode;

/// Multiply weights by a factor
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// By what
    #[arg(allow_negative_numbers = true, value_parser = within(-1e9, 1e9))]
    factor: f64,
    /// Which terms; all that are not fixed if none is named
    terms: Vec<String>,
}

/// Scales the weights.
///
/// # Errors
/// A file that cannot be read or written, or a weight that may not be so.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    change(&args.target, "scale", |opened| {
        let entries = &opened.weights.entries;
        let chosen = opened.chosen(&args.terms)?.into_iter();
        Ok(chosen.map(|index| opened.wish(index, entries[index].value * args.factor)).collect())
    })
}

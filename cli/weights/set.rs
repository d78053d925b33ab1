//! `msk weights set FILE pose=11.5 balance=8`.

use super::{Opened, Target};
use crate::error::Error;
use msk::compiler::weights::Edit;
use std::process::ExitCode;

/// Set weights: all of them, or, if one may not be so, none
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// New weights, as in `pose=11.5` or `stand.pose=11.5`
    #[arg(required = true, value_name = "TERM=WEIGHT", value_parser = wish)]
    weights: Vec<Edit>,
}

fn wish(text: &str) -> Result<Edit, String> {
    let (term, value) = text.split_once('=').ok_or("a wish is written `term=weight`, as in `pose=11.5`")?;
    let value = value.trim().parse().map_err(|_| format!("`{value}` is not a number"))?;
    Ok(Edit { term: term.trim().to_owned(), value })
}

/// Sets the weights.
///
/// # Errors
/// A file that cannot be read or written, or a weight that may not be so.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    Opened::read(&args.target.file)?.change(&args.weights, &args.target, "set")
}

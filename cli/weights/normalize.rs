//! `msk weights normalize FILE --norm 40 [--outside done]`.

use super::{Opened, Target, change};
use crate::error::{Context, Error};
use crate::numbers::within;
use msk::compiler::weights::rules::{Weight, normalized};
use msk::compiler::weights::{Bounds, Edit};
use std::collections::BTreeSet;
use std::process::ExitCode;

/// Scale the weights of a task by one factor so that their sizes sum to a norm
///
/// Fixed weights and those named with --outside stay and are not counted.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// The sum of sizes
    #[arg(long, default_value_t = 40.0, value_parser = within(1e-6, 1e12))]
    norm: f64,
    /// The task; may be left out if the file has one
    #[arg(long)]
    task: Option<String>,
    /// Terms that stay as they are, such as the price of a fall
    #[arg(long, value_name = "TERM")]
    outside: Vec<String>,
}

/// Scales the weights.
///
/// # Errors
/// A file that cannot be read or written, or a weight that may not be so.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    change(&args.target, "normalize", |opened| edits(args, opened))
}

/// The wishes that bring the weights of the task to the norm.
fn edits(args: &Args, opened: &Opened) -> Result<Vec<Edit>, Error> {
    let entries = &opened.weights.entries;
    let tasks: BTreeSet<&str> = entries.iter().map(|entry| entry.task.as_str()).collect();
    let task = match (&args.task, tasks.iter().collect::<Vec<_>>().as_slice()) {
        (Some(task), _) if tasks.contains(task.as_str()) => task.as_str(),
        (None, [only]) => only,
        _ => {
            let names = tasks.into_iter().collect::<Vec<_>>().join(", ");
            return Err(Error::usage("select the task with --task").hint(format!("the file has: {names}")));
        }
    };
    let outside: Vec<usize> =
        args.outside.iter().map(|term| opened.weights.find(term)).collect::<Result<_, _>>().map_err(Error::from)?;
    let of_task: Vec<usize> = (0..entries.len()).filter(|index| entries[*index].task == task).collect();
    let weight = |&index: &usize| Weight {
        value: entries[index].value,
        bounds: entries[index].bounds,
        in_scope: entries[index].bounds != Bounds::Fixed && !outside.contains(&index),
    };
    let weights: Vec<Weight> = of_task.iter().map(weight).collect();
    let next = normalized(&weights, args.norm).context(|| "nothing was changed".into())?;
    Ok(of_task.iter().zip(next).map(|(&index, value)| opened.wish(index, value)).collect())
}

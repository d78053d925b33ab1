//! `msk weights set FILE pose=11.5 balance=8`.

use super::extract::write_overlay;
use super::{Target, change};
use crate::error::{Context, Error};
use crate::project::Project;
use msk::compiler::task::Origin;
use msk::compiler::weights::Edit;
use msk::tuning::overlay::{Wish, wished};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Set weights: all of them, or, if one may not be so, none
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// New weights, as in `pose=11.5` or `stand.pose=11.5`
    #[arg(required = true, value_name = "TERM=WEIGHT", value_parser = wish)]
    weights: Vec<Edit>,
    /// Leave the file as it is, and write the weights into this weights file over it
    #[arg(long, value_name = "OVERLAY")]
    into: Option<PathBuf>,
}

fn wish(text: &str) -> Result<Edit, String> {
    let (term, value) = text.split_once('=').ok_or("a weight is set as `term=weight`, as in `pose=11.5`")?;
    let value = value.trim().parse().map_err(|_| format!("`{value}` is not a number"))?;
    Ok(Edit::new(term.trim(), value))
}

/// Sets the weights.
///
/// # Errors
/// A file that cannot be read or written, or a weight that may not be so.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    if let Some(overlay) = &args.into {
        return into(args, overlay);
    }
    change(&args.target, "set", |_| Ok(args.weights.clone()))
}

/// Sets weights in an overlay, by the bounds of the tasks that it lies over.
fn into(args: &Args, overlay: &Path) -> Result<ExitCode, Error> {
    let project = Project::open(&args.target.file, &[])?;
    let tasks = &project.compilation.tasks;
    let wishes: Vec<Wish> = args.weights.iter().map(|edit| Wish { term: edit.term.clone(), weight: edit.value }).collect();
    let places = wished(tasks, &wishes, &Origin::CommandLine).context(|| "nothing was changed".into())?.places;
    let weights: Vec<(&str, &str, f64)> = wishes
        .iter()
        .zip(places)
        .map(|(wish, (task, term))| (tasks[task].name.as_str(), tasks[task].terms[term].name.as_str(), wish.weight))
        .collect();
    write_overlay(overlay, tasks, &weights, &args.target, "set")
}

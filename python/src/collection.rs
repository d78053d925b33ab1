//! Data sets, with the files that the command line writes.

use crate::compilation::{Failure, compiled, staged_one};
use crate::evaluation::{part, policy, unmerged};
use crate::guard::{detached, interruptible};
use msk_evaluate::Protocol;
use msk_evaluate::collection::{Collection, CollectionError, Totals, merge_data};
use msk_runtime::library::in_words;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// (episodes, control steps, successes, mean return) of a data set.
type Content = (u64, u64, u64, f64);

fn content(totals: &Totals) -> Content {
    (totals.returns.count(), totals.steps, totals.successes, totals.returns.mean())
}

/// Plays the missing episodes of the task of a file that is called `task`, or of the only one, and keeps every step of them.
///
/// # Errors
/// Errors in the file, a policy that does not exist, a folder that cannot be used; what Python's signals raise.
#[pyfunction]
#[pyo3(signature = (path, task, parameters, policy, protocol, shard, out))]
pub fn collect(
    py: Python<'_>,
    path: PathBuf,
    task: Option<String>,
    parameters: Vec<(String, String)>,
    policy: String,
    protocol: (u64, u64),
    shard: String,
    out: PathBuf,
) -> PyResult<Content> {
    let (shard, source) = (part(&shard)?, self::policy(&policy)?);
    let work = move |stop: &AtomicBool| {
        let name = path.display().to_string();
        let compilation = compiled(path, None, parameters).map_err(Failure::Report)?;
        let trial = staged_one(&name, &compilation, task.as_deref())?;
        let words = |error: CollectionError| Failure::Words(in_words(&error));
        let protocol = Protocol { episodes: protocol.0, seed: protocol.1 };
        let mut collection = Collection::open(&out, trial, source, (protocol, shard)).map_err(words)?;
        let complete = collection.complete(stop, &mut |_| ()).map_err(words)?;
        Ok(complete.then(|| content(collection.totals())))
    };
    let collected = interruptible(py, work)?.map_err(Failure::into_error)?;
    // It stops for a signal alone, which has raised by now.
    collected.ok_or_else(|| PyKeyboardInterrupt::new_err(()))
}

/// Joins the shards of a data set in a new folder.
///
/// # Errors
/// Folders that are not the shards of one data set, or a folder that cannot be written.
#[pyfunction]
pub fn merge_collected(py: Python<'_>, shards: Vec<PathBuf>, out: PathBuf) -> PyResult<Content> {
    let merged = detached(py, move || merge_data(&shards, &out))?;
    merged.map(|totals| content(&totals)).map_err(|error| unmerged(&error))
}

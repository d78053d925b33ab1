//! Evaluations of tasks, with the results that the command line writes.

use crate::compilation::{Failure, compiled, staged};
use crate::guard::interruptible;
use crate::workers::threads;
use msk_evaluate::{EpisodeRecord, MergeError, Plan, Protocol, Resumed, RunSettings, Shard, ShardError, Watcher};
use msk_runtime::library::in_words;
use msk_runtime::policy::PolicySource;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// Shows nothing.
struct Silent;

impl Watcher for Silent {
    fn stepped(&self) {}
    fn ended(&self, _: usize, _: &EpisodeRecord) {}
    fn skipped(&self, _: usize, _: &str) {}
}

/// What a command line names, but for policies that imagine episodes.
///
/// # Errors
/// `ValueError`: there is none, or a file that cannot be read.
pub fn policy(text: &str) -> PyResult<PolicySource> {
    let source = msk_train::source(text).unwrap_or_else(|| PolicySource::parse(text));
    source.map_err(|error| PyValueError::new_err(error.to_string()))
}

/// A part of the episodes: `2/5`.
///
/// # Errors
/// `ValueError`: what is none.
pub fn part(text: &str) -> PyResult<Shard> {
    text.parse().map_err(|error: ShardError| PyValueError::new_err(error.to_string()))
}

/// Why folders cannot be joined, as Python knows it.
pub fn unmerged(error: &MergeError) -> PyErr {
    match error {
        MergeError::Folder { .. } => PyOSError::new_err(in_words(error)),
        _ => PyValueError::new_err(in_words(error)),
    }
}

/// Plays the missing episodes of the tasks of a file, or of the one that is called `task`, and gives the summary as JSON. Episodes and
/// seed that are not given are those of the first protocol of the suite.
///
/// # Errors
/// Errors in the file, a policy that does not exist, a folder that cannot be used; what Python's signals raise.
#[pyfunction]
#[pyo3(signature = (path, task, parameters, policy, protocol, shard, threads, out))]
#[expect(clippy::too_many_arguments, reason = "the Python part gives them names")]
pub fn evaluate(
    py: Python<'_>,
    path: PathBuf,
    task: Option<String>,
    parameters: Vec<(String, String)>,
    policy: String,
    protocol: (Option<u64>, Option<u64>),
    shard: String,
    threads: Option<NonZeroUsize>,
    out: PathBuf,
) -> PyResult<String> {
    let shard = part(&shard)?;
    let policy = self::policy(&policy)?;
    let work = move |stop: &AtomicBool| {
        let name = path.display().to_string();
        let compilation = compiled(path, None, parameters).map_err(Failure::Report)?;
        let usual = msk_compiler::Protocol::default();
        let first = compilation.suites.iter().flat_map(|suite| &suite.protocols).next().unwrap_or(&usual);
        let (episodes, seed) = protocol;
        let protocol = Protocol { episodes: episodes.unwrap_or(first.episodes.into()), seed: seed.unwrap_or(first.seed) };
        let plan = Plan { trials: staged(&name, &compilation, task.as_deref())?, policy, protocol, shard };
        let words = |error: &dyn std::error::Error| Failure::Words(in_words(error));
        let (journal, resumed) = Resumed::open(&out, &plan, &RunSettings::of(&plan)).map_err(|error| words(&error))?;
        let threads = self::threads(threads);
        let outcome = msk_evaluate::run(&plan, resumed, &journal, threads, stop, &Silent).map_err(|error| words(&error))?;
        journal.write_summary(&outcome.summary).map_err(|error| words(&error))?;
        Ok(outcome.summary.json())
    };
    interruptible(py, work)?.map_err(Failure::into_error)
}

/// Joins the shards of an evaluation in a new folder, and gives the summary as JSON.
///
/// # Errors
/// Folders that are not the shards of one evaluation, or a folder that cannot be written.
#[pyfunction]
pub fn merge(py: Python<'_>, shards: Vec<PathBuf>, out: PathBuf) -> PyResult<String> {
    let merged = crate::guard::detached(py, move || msk_evaluate::merge(&shards, &out))?;
    merged.map(|merged| merged.summary.json()).map_err(|error| unmerged(&error))
}

//! `msk merge`: the shards of an evaluation, or of a data set, as one.

use crate::collect::in_words;
use crate::error::Error;
use crate::eval::explain;
use crate::terminal;
use msk::evaluate::collection::{is_data, merge_data};
use msk::evaluate::{MergeError, merge, report};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Merge the shards of an evaluation or of a data set, which several machines have played, into the results of one
///
/// `msk eval --shard 1/3`, `2/3` and `3/3` with the same other options play a third of the episodes of every task each. The
/// merged run.json, episodes.jsonl, summary.json and report.md have the bytes that one machine would have written; wall_times.jsonl and traces are taken
/// over. So are the archives of a data set, the shards of which `msk collect --shard` has played. Shards may overlap; an episode that two of
/// them have must be the same in both.
#[derive(clap::Args)]
pub struct Args {
    /// Folders of the results of the shards
    #[arg(required = true)]
    shards: Vec<PathBuf>,
    /// Folder for the whole evaluation or data set, which must not exist yet
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Merges, and prints the table or what the data set holds.
///
/// # Errors
/// Folders that are not the shards of one evaluation or data set, or are incomplete.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    if args.shards.iter().any(|shard| is_data(shard)) {
        let totals = merge_data(&args.shards, &args.out).map_err(with_hint)?;
        writeln!(terminal::out(), "{}\nData: {}", in_words(&totals), args.out.display())?;
        return Ok(ExitCode::SUCCESS);
    }
    let merged = merge(&args.shards, &args.out).map_err(with_hint)?;
    let mut out = terminal::out();
    write!(out, "{}", report::overview(&merged.summary))?;
    writeln!(out, "Results: {}", args.out.display())?;
    writeln!(out, "         {} episodes from {} shards", merged.episodes, args.shards.len())?;
    Ok(ExitCode::SUCCESS)
}

fn with_hint(error: MergeError) -> Error {
    let hint = match error {
        MergeError::Journal(error) => return explain(error),
        MergeError::Folder { .. } => "choose a folder that does not exist with `--out DIR`, in one that does",
        MergeError::OtherRun { .. } => "shards differ in `--shard` and `--out` alone, and come from one build of the program",
        MergeError::Summary { .. } => "run the evaluation of this shard again with `--out`: it resumes, and writes the file",
        MergeError::Order { .. } => "play this shard anew",
        MergeError::Differ { .. } => "an episode depends on nothing but the run: play it on both machines again",
        MergeError::Missing { .. } => "finish all shards: the same command with its `--shard` and `--out` resumes",
    };
    Error::from(error).hint(hint)
}

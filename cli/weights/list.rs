//! `msk weights list FILE`: what may be tuned, and how far.

use super::Opened;
use crate::error::Error;
use crate::terminal;
use msk::compiler::weights::{Entry, written};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// List the weights with their bounds
#[derive(clap::Args)]
pub struct Args {
    /// The file
    file: PathBuf,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

/// Prints the weights.
///
/// # Errors
/// A file that cannot be read, or that holds no weights.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let opened = Opened::read(&args.file)?;
    let mut out = terminal::out();
    let entries = &opened.weights.entries;
    if entries.is_empty() {
        return Err(opened.none());
    }
    if args.json {
        let entry = |entry: &Entry| serde_json::json!({ "task": entry.task, "term": entry.term, "from": entry.from, "weight": entry.value, "bounds": entry.bounds });
        writeln!(out, "{}", serde_json::Value::from(entries.iter().map(entry).collect::<Vec<_>>()))?;
        return Ok(ExitCode::SUCCESS);
    }
    let row = |entry: &Entry| {
        let from = entry.from.map_or_else(String::new, |from| format!("{} -> ", written(from)));
        let weight = format!("{from}{}", written(entry.value));
        [format!("{}.{}", entry.task, entry.term), weight, entry.bounds.described(entry.value)]
    };
    let rows: Vec<[String; 3]> = entries.iter().map(row).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let (term, weight) = (width(0), width(1));
    for row in &rows {
        writeln!(out, "{:<term$}  {:>weight$}  {}", row[0], row[1], row[2])?;
    }
    Ok(ExitCode::SUCCESS)
}

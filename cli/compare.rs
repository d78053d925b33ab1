//! `msk compare A B`: two evaluations in pairs of episodes.

use crate::error::Error;
use crate::eval::explain;
use crate::terminal;
use msk::compiler::numbers::{fixed, for_people};
use msk::evaluate::compare::{Estimate, Outcomes, Pairing, compare};
use msk::evaluate::{Journal, report::Table};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Compare two evaluations of the same tasks: differences of success and return over pairs of episodes, with intervals
///
/// Episodes of the same seed and index begin in the same state and are compared in pairs. Returns are summed up by their
/// interquartile means; [ ] are 95 % intervals of a bootstrap over the pairs. A difference whose interval contains 0 may be chance.
#[derive(clap::Args)]
pub struct Args {
    /// Folder of the results of the first evaluation
    first: PathBuf,
    /// Folder of the results of the second one
    second: PathBuf,
    /// Print the numbers as JSON instead
    #[arg(long)]
    json: bool,
}

/// Prints the comparison.
///
/// # Errors
/// A folder without results, damaged ones, or two that have no episode in common.
pub fn run(args: &Args) -> Result<ExitCode, Error> {
    let read = |folder: &Path| -> Result<Outcomes, Error> {
        let mut outcomes = Outcomes::default();
        Journal::each(folder, |record| outcomes.add(&record)).map_err(explain)?;
        Ok(outcomes)
    };
    let (first, second) = (read(&args.first)?, read(&args.second)?);
    let pairings = compare(&first, &second);
    if pairings.is_empty() {
        let message = format!("`{}` and `{}` have no episode in common", args.first.display(), args.second.display());
        return Err(Error::new(message).hint("evaluate the same tasks with the same seed"));
    }
    let mut out = terminal::out();
    if args.json {
        serde_json::to_writer_pretty(&mut out, &pairings)?;
        writeln!(out)?;
        return Ok(ExitCode::SUCCESS);
    }
    writeln!(out, "A: {}, policy {}", args.first.display(), first.policy)?;
    writeln!(out, "B: {}, policy {}", args.second.display(), second.policy)?;
    for pairing in &pairings {
        let Pairing { task, conditions: [a, b], task_hashes, model_hashes, .. } = pairing;
        if task_hashes[0] != task_hashes[1] {
            writeln!(out, "The task `{task}` differs between A and B: their returns are of different rewards")?;
        }
        let named = |condition: &str| if condition.is_empty() { "healthy".to_owned() } else { condition.to_owned() };
        if a != b {
            writeln!(out, "The muscles of `{task}` differ: A is {}, B is {}", named(a), named(b))?;
        }
        if model_hashes[0] != model_hashes[1] {
            writeln!(out, "The body of `{task}` differs between A and B")?;
        }
    }
    writeln!(out, "\n{}", success(&pairings).markdown())?;
    write!(out, "{}", returns(&pairings).markdown())?;
    Ok(ExitCode::SUCCESS)
}

fn estimate(estimate: Estimate, scale: f64) -> String {
    let [low, high] = estimate.interval.map(|bound| for_people(scale * bound));
    format!("{} [{low}, {high}]", for_people(scale * estimate.value))
}

/// The task, with the condition of the muscles that both have.
fn name(pairing: &Pairing) -> String {
    match &pairing.conditions {
        [first, second] if first == second && !first.is_empty() => format!("{} ({first})", pairing.task),
        _ => pairing.task.clone(),
    }
}

fn success(pairings: &[Pairing]) -> Table {
    let mut table = Table::new(&["task", "pairs", "success A, %", "success B, %", "B - A, % [95 %]"]);
    for pairing in pairings {
        let [first, second] = pairing.success.map(|rate| fixed(100.0 * rate, 0));
        let difference = estimate(pairing.success_difference, 100.0);
        table.row(vec![name(pairing), pairing.pairs.to_string(), first, second, difference]);
    }
    table
}

fn returns(pairings: &[Pairing]) -> Table {
    let mut table = Table::new(&["task", "return A [95 %]", "return B [95 %]", "B - A [95 %]"]);
    for pairing in pairings {
        let [first, second] = pairing.returns.map(|returns| estimate(returns, 1.0));
        table.row(vec![name(pairing), first, second, estimate(pairing.return_difference, 1.0)]);
    }
    table
}

//! `msk sensitivity TASK`: how behaviour changes with each weight.

mod table;

use crate::condition::Condition;
use crate::error::Error;
use crate::eval;
use crate::interrupt::Interrupt;
use crate::numbers::threads;
use crate::output;
use crate::overlays::Overlays;
use crate::policies::Limits;
use crate::progress::Progress;
use crate::project::{Project, Settings};
use crate::terminal;
use msk::compiler::numbers::{exact, for_people};
use msk::compiler::task::Origin;
use msk::compiler::weights::Bounds;
use msk::evaluate::{self, Plan, Protocol, Resumed, RunSettings, Shard, Summary, Trial};
use msk_storage::Folder;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use table::{Row, markdown, plot, text};

/// Change one weight at a time and show how behaviour changes: which terms matter, and which act against each other
///
/// Every weight takes the ends of its range; without one, half of itself and twice itself. The policy plays some episodes under each, the
/// same ones every time. The table shows success, length, and the return that the unchanged weights would give; then by how much each
/// weight changes the value of each term. Results go to a folder, with sensitivity.md, sensitivity.svg, and a folder for each
/// variant as `msk eval` writes it. With --out, a folder that contains part of the same results is completed.
#[derive(clap::Args)]
pub struct Args {
    /// Name of a task in tasks.msk, a file with one task, or FILE@TASK
    task: String,
    /// The policy, one that reacts to weights: plan ("plan fast", "plan good", "plan best" or "plan FILE" with settings)
    #[arg(long, default_value = "plan", value_name = "POLICY")]
    policy: String,
    #[command(flatten)]
    limits: Limits,
    #[command(flatten)]
    condition: Condition,
    /// Change this term only; can be repeated
    #[arg(long, value_name = "TERM")]
    term: Vec<String>,
    /// Episodes for each variant
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    episodes: u64,
    /// Random seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder for the results [default: a new one under results/]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    overlays: Overlays,
    #[command(flatten)]
    settings: Settings,
}

/// Plays all variants.
///
/// # Errors
/// Errors in the file, a policy that does not react to weights or does not support the task, or a folder that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (project, mut trial) = Project::find(&args.task, &args.settings.settings)?;
    args.condition.apply(std::slice::from_mut(&mut trial))?;
    args.overlays.apply(&project, std::slice::from_mut(&mut trial))?;
    let policy = args.limits.source(&args.policy)?;
    if !policy.reacts_to_weights() {
        let message = format!("`{}` does the same whatever the weights are", policy.name());
        return Err(Error::new(message).hint("use `--policy plan`, which acts on the reward itself"));
    }
    let variants = variants(&trial, &args.term)?;
    let name = format!("{}-sensitivity", trial.task.name);
    let folder = args.out.clone().map_or_else(|| eval::fresh_folder(&name), Ok)?;
    let interrupt = Interrupt::listen()?;
    let protocol = Protocol { episodes: args.episodes, seed: args.seed };
    let mut rows: Vec<Row> = Vec::new();
    for (number, variant) in variants.iter().enumerate() {
        writeln!(terminal::notes(), "{} of {}: {}", number + 1, variants.len(), variant.name())?;
        let trials = vec![variant.trial.clone()];
        let plan = Plan { trials, policy: policy.clone(), protocol, shard: Shard::WHOLE };
        let Some(summary) = play(&plan, &output::subfolder(&folder, &variant.folder())?, &interrupt)? else {
            writeln!(terminal::notes(), "interrupted; the same command with `--out {}` goes on", folder.display())?;
            return Ok(interrupt.code());
        };
        if let Some(reason) = summary.tasks.iter().find_map(|task| task.skipped.clone()) {
            return Err(Error::new(format!("policy `{}` does not support the task: {reason}", plan.policy.name())));
        }
        rows.extend(Row::of(&variant.name(), variant.change, &summary, &trial.task.weights()));
    }
    let kept = Folder::open(&folder)?;
    let title = format!("`{}` under `{}`", trial.task.name, policy.name());
    output::write_in(&kept, "sensitivity.md", markdown(&title, &rows))?;
    output::write_in(&kept, "sensitivity.svg", plot(&title, &rows))?;
    let mut out = terminal::out();
    writeln!(out, "{}", text(&rows))?;
    writeln!(out, "Results: {}", folder.display())?;
    writeln!(out, "         sensitivity.svg draws the table, each variant has a folder with its episodes")?;
    Ok(ExitCode::SUCCESS)
}

/// Plays the missing episodes of a variant; `None` after an interruption.
fn play(plan: &Plan, folder: &Path, interrupt: &Interrupt) -> Result<Option<Summary>, Error> {
    let (journal, resumed) = Resumed::open(folder, plan, &RunSettings::of(plan)).map_err(eval::explain)?;
    let progress = Progress::new(plan, &resumed);
    let outcome = evaluate::run(plan, resumed, &journal, threads(None), interrupt.stop(), &progress)?;
    progress.finish();
    let summary = outcome.summary;
    journal.write("summary.json", summary.json()).map_err(eval::explain)?;
    Ok((!outcome.interrupted).then_some(summary))
}

/// The task with one weight changed, or as it is.
struct Variant {
    trial: Trial,
    /// The term, and the weight that it takes.
    change: Option<(usize, f64)>,
}

impl Variant {
    /// What it is called in tables.
    fn name(&self) -> String {
        match self.change {
            None => "unchanged".to_owned(),
            Some((term, weight)) => format!("{} = {}", self.trial.task.terms[term].name, for_people(weight)),
        }
    }

    /// Its folder: numbers do not change with the way in which they are printed.
    fn folder(&self) -> String {
        match self.change {
            None => "unchanged".to_owned(),
            Some((term, weight)) => format!("{}={}", eval::in_path(&self.trial.task.terms[term].name), exact(weight)),
        }
    }
}

/// The unchanged task, then each of the named terms, or each that may change, with the weights at the ends of its range.
fn variants(trial: &Trial, names: &[String]) -> Result<Vec<Variant>, Error> {
    let task = &trial.task;
    let chosen = names.iter().map(|name| task.find_term(name)).collect::<Result<Vec<usize>, _>>()?;
    let mut variants = vec![Variant { trial: trial.clone(), change: None }];
    for (index, term) in task.terms.iter().enumerate() {
        let bounds = task.weight_bounds(index);
        if !(chosen.is_empty() || chosen.contains(&index)) {
            continue;
        }
        let ends = match bounds {
            Bounds::Fixed if chosen.is_empty() => continue,
            Bounds::Fixed => {
                let hint = "its weight is fixed in the source: give it a range, as in `10 (5..20)  pose = ...`";
                return Err(Error::new(format!("the weight of `{}` cannot change", term.name)).hint(hint));
            }
            Bounds::Range(low, high) => [low, high],
            Bounds::Free => [0.5 * term.weight, 2.0 * term.weight],
        };
        for weight in ends.into_iter().filter(|weight| *weight != term.weight) {
            let reweighted = task.reweighted(&[(index, weight)], &Origin::CommandLine);
            let task = Arc::new(reweighted.map_err(|refused| Error::new(refused.to_string()))?);
            variants.push(Variant { trial: Trial { task, ..trial.clone() }, change: Some((index, weight)) });
        }
    }
    if variants.len() == 1 {
        return Err(Error::new(format!("no weight of `{}` may change", task.name)));
    }
    Ok(variants)
}

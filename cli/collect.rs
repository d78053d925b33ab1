//! `msk collect TASK`: episodes under a policy as a data set for learners.

use crate::condition::Condition;
use crate::error::Error;
use crate::eval;
use crate::interrupt::Interrupt;
use crate::overlays::Overlays;
use crate::policies::Limits;
use crate::progress;
use crate::project::{Project, Settings};
use crate::terminal;
use msk::compiler::numbers::fixed;
use msk::evaluate::collection::{Collection, CollectionError, Event, Totals};
use msk::evaluate::{Protocol, Shard};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Play episodes under a policy and keep them as a data set: observations, actions, rewards and terms of every control step
///
/// Each episode becomes a NumPy file EPISODE.npz in the folder of the data set, with a row per control step. data.json names the
/// columns with their units, run.json has the settings, episodes.jsonl a line per episode with its return and whether it succeeded. With
/// --out, a folder that contains part of the same data set is completed.
///
/// Exit code 0 if all episodes are there, 1 after a failure, 2 for an invalid command line; 130, 143 or 129 after SIGINT, SIGTERM
/// or SIGHUP, which keep all completed episodes.
#[derive(clap::Args)]
pub struct Args {
    /// Name of a task in tasks.msk, a file with one task, or FILE@TASK
    task: String,
    /// The policy, as `msk run --policy` names it
    #[arg(long, default_value = "plan", value_name = "POLICY")]
    policy: String,
    #[command(flatten)]
    limits: Limits,
    #[command(flatten)]
    condition: Condition,
    /// Number of episodes
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    episodes: u64,
    /// Random seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Play this part of the episodes only, such as 2/5: about a fifth. `msk merge` joins the parts, which may be played on several
    /// machines
    #[arg(long, value_name = "NUMBER/COUNT", default_value_t, hide_default_value = true)]
    shard: Shard,
    /// Folder of the data set [default: a new one under results/]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    overlays: Overlays,
    #[command(flatten)]
    settings: Settings,
}

/// Plays the missing episodes.
///
/// # Errors
/// Errors in the file, a policy that does not exist or does not support the task, or a folder that cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (project, mut trial) = Project::find(&args.task, &args.settings.settings)?;
    args.condition.apply(std::slice::from_mut(&mut trial))?;
    args.overlays.apply(&project, std::slice::from_mut(&mut trial))?;
    let policy = args.limits.source(&args.policy)?;
    let protocol = Protocol { episodes: args.episodes, seed: args.seed };
    if args.shard.among(args.episodes) == 0 {
        let error = Error::usage(format!("shard {} has none of the episodes", args.shard));
        return Err(error.hint("cut the run into at most as many shards as it has episodes"));
    }
    let (words, shard) = (eval::in_path(policy.name()), eval::shard_in_path(args.shard));
    let name = format!("{}-data-{words}{shard}", trial.task.name);
    let folder = args.out.clone().map_or_else(|| eval::fresh_folder(&name), Ok)?;
    let steps = progress::steps(trial.task.horizon);
    let mut collection = Collection::open(&folder, trial, policy, (protocol, args.shard)).map_err(explain)?;
    let interrupt = Interrupt::listen()?;
    let complete = collection.complete(interrupt.stop(), &mut |event| match event {
        Event::Step(step) => steps.set_position(step.into()),
        Event::End(record) => {
            let outcome = if record.success { "success" } else { "no success" };
            let line =
                format!("episode {}: {} steps, return {}, {outcome}", record.episode, record.steps, fixed(record.total, 1));
            // A terminal that is gone does not end a collection.
            steps.suspend(|| drop(writeln!(terminal::notes(), "{line}")));
        }
    });
    steps.finish_and_clear();
    if !complete.map_err(explain)? {
        writeln!(terminal::notes(), "interrupted; the same command with `--out {}` goes on", folder.display())?;
        return Ok(interrupt.code());
    }
    let mut out = terminal::out();
    writeln!(out, "{}\nData: {}", in_words(collection.totals()), folder.display())?;
    writeln!(out, "      data.json names the columns, episodes.jsonl has a line per episode")?;
    Ok(ExitCode::SUCCESS)
}

/// What a data set holds.
pub fn in_words(Totals { steps, successes, returns }: &Totals) -> String {
    let (episodes, mean) = (returns.count(), returns.mean());
    let mean = fixed(mean, 1);
    format!("{episodes} episodes, {steps} control steps, {successes} successes, mean return {mean}")
}

fn explain(error: CollectionError) -> Error {
    match error {
        CollectionError::Journal(error) => eval::explain(error),
        CollectionError::Evaluation(error) => error.into(),
        CollectionError::Lost { .. } => {
            Error::from(error).hint("restore the files, or collect anew into another folder with `--out DIR`")
        }
        error => error.into(),
    }
}

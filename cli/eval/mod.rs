//! `msk eval FILE`: every task of a file under a policy, some episodes of each, one table.

mod folder;
mod pages;
mod protocol;
mod sweep;

pub use folder::{explain, fresh as fresh_folder, in_path, shard_in_path};

use crate::condition::Condition;
use crate::error::Error;
use crate::interrupt::Interrupt;
use crate::levels::LevelArgs;
use crate::numbers::threads;
use crate::output;
use crate::overlays::Overlays;
use crate::policies::Limits;
use crate::progress::Progress;
use crate::project::{Project, Settings};
use crate::terminal;
use crate::trace::TraceArgs;
use msk::evaluate::{self, Extras, Plan, Resumed, RunSettings, Shard, Summary, report};
use msk::runtime::policy::PolicySource;
use msk::tuning::live::Live;
use protocol::Chosen;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Evaluate a policy: run episodes of every task, write results, print a table
///
/// The first protocol of the suite defines the number of episodes and the seed, unless --protocol, --episodes or --seed
/// override it. The row of each task is printed when it is complete, and one table at the end. Results go to a folder:
/// run.json (the settings), episodes.jsonl (a line per episode, in the order of tasks and episodes), summary.json and report.md
/// (with terms and metrics), and wall_times.jsonl (how long episodes took). With --out, a folder that contains part of the same
/// run is resumed, to the same bytes but for wall times; a folder with another run is rejected.
///
/// Several policies are evaluated one after the other, each in a separate subfolder of the results.
///
/// A task that the policy does not support is skipped, with the reason in its row. Exit code 0 if all other episodes are
/// complete, 1 after a failure or if the policy supports none of the tasks, 2 for an invalid command line; 130, 143 or 129
/// after SIGINT, SIGTERM or SIGHUP, which keep all completed episodes.
#[derive(clap::Args)]
pub struct Args {
    /// File with tasks, or with a suite of them
    #[arg(default_value = "tasks.msk")]
    file: PathBuf,
    /// Run this task only
    #[arg(long)]
    task: Option<String>,
    /// The policy: cmc (computed muscle control that tracks the task's reference motion, or holds the initial pose),
    /// demonstration (tracks the script of the task's first succeeding test), zero (every muscle at rest), random (every
    /// action uniform in -1..1), plan (search on the reward itself: "plan fast", "plan good", "plan best" or "plan FILE" with
    /// settings), "process [--messagepack] COMMAND" (an external program: `msk help policies` describes its protocol),
    /// "agent FOLDER" (what `msk train` made), "agents" or "agents FOLDER" (for each task the best that was trained on it: of those
    /// that come with MSK, or in a folder), "network FILE" (a trained network, as safetensors), "replay FILE" (actions from a NumPy
    /// file, a row per step). Several,
    /// each with its own `--policy`, are compared in one table
    #[arg(long, default_value = "cmc", value_name = "POLICY")]
    policy: Vec<String>,
    #[command(flatten)]
    limits: Limits,
    #[command(flatten)]
    condition: Condition,
    /// Protocol of the suite, by name [default: its first]
    #[arg(long, value_name = "NAME")]
    protocol: Option<String>,
    /// Episodes per task [default: the protocol's, else 50]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    episodes: Option<u64>,
    /// Random seed [default: the protocol's, else 0]
    #[arg(long)]
    seed: Option<u64>,
    /// Worker threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Play this part of the episodes only, such as 2/5: of every task about a fifth. `msk merge` joins the parts, which may be played on
    /// several machines
    #[arg(long, value_name = "NUMBER/COUNT", default_value_t, hide_default_value = true, conflicts_with_all = ["live", "sweep"])]
    shard: Shard,
    /// Folder for the results [default: a new one under results/]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write a page for a browser for each task to the folder of the results, with these of its episodes: worst, median, best, by
    /// their returns
    #[arg(long, value_name = "WHICH", value_enum, value_delimiter = ',', conflicts_with = "live")]
    html: Vec<pages::Which>,
    /// Write film strips, moments of an episode beside each other, for each task to the folder of the results, of these of its
    /// episodes: worst, median, best, by their returns
    #[arg(long, value_name = "WHICH", value_enum, value_delimiter = ',', conflicts_with = "live")]
    strip: Vec<pages::Which>,
    /// Evaluate the policy under growing perturbations instead, along each of these axes, with the scales and episodes of the
    /// protocol's sweep (30 episodes unless it has another number, or --episodes is given): success at every scale and the area
    /// under it, for tasks, families and all tasks
    #[arg(long, value_name = "AXES", value_enum, value_delimiter = ',', conflicts_with_all = ["live", "html", "strip"])]
    sweep: Vec<sweep::Along>,
    #[command(flatten)]
    traces: TraceArgs,
    #[command(flatten)]
    overlays: Overlays,
    /// Reload the file of --weights before every episode; each episode records the version of its weights
    #[arg(long, requires = "weights")]
    live: bool,
    #[command(flatten)]
    lints: LevelArgs,
    #[command(flatten)]
    settings: Settings,
}

/// Runs the evaluation.
///
/// # Errors Errors in the file, a folder that cannot be used, or a policy that does not support the task.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let policies: Vec<PolicySource> =
        args.policy.iter().map(|policy| args.limits.source(policy)).collect::<Result<_, Error>>()?;
    let project = Project::open_at(&args.file, &args.settings.settings, &args.lints.levels)?;
    let chosen = Chosen::of(&args, &project)?;
    let mut trials = project.trials(args.task.as_deref())?;
    args.condition.apply(&mut trials)?;
    let live = match args.live {
        true => Some(args.overlays.live(&project, &mut trials)?),
        false => args.overlays.apply(&project, &mut trials).map(|()| None)?,
    };
    let plans: Vec<Plan> = policies
        .into_iter()
        .map(|policy| Plan { trials: trials.clone(), policy, protocol: chosen.protocol, shard: args.shard })
        .collect();
    if plans.iter().all(|plan| plan.episodes() == 0) {
        let error = Error::usage(format!("shard {} has none of the episodes", args.shard));
        return Err(error.hint("cut the run into at most as many shards as it has episodes"));
    }
    let names: Vec<&str> = plans.iter().map(|plan| plan.policy.name()).collect();
    let Some(first) = plans.first() else { return Ok(ExitCode::SUCCESS) };
    if let Some(twice) = names.iter().enumerate().find_map(|(place, name)| names[..place].contains(name).then_some(name)) {
        return Err(Error::usage(format!("the policy `{twice}` is given twice")));
    }
    if !args.sweep.is_empty() && names.len() > 1 {
        return Err(Error::usage("a sweep is of one policy: give `--policy` once"));
    }
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None if names.len() == 1 => folder::fresh(&folder::name(first, &args.file, names[0]))?,
        None => folder::fresh(&folder::name(first, &args.file, &format!("{} policies", names.len())))?,
    };
    let interrupt = Interrupt::listen()?;
    writeln!(terminal::notes(), "{}", chosen.heading(first, &names))?;
    let evaluation = Evaluation { args: &args, interrupt: &interrupt, live: live.as_ref() };
    if let (false, [plan]) = (args.sweep.is_empty(), plans.as_slice()) {
        return evaluation.sweep(plan, &chosen.sweep, &folder);
    }
    let [plan] = plans.as_slice() else { return evaluation.several(&plans, &folder) };
    let (summary, interrupted) = evaluation.one(plan, &folder)?;
    let printed = print(&report::overview(&summary), &folder, "report.md has every term, episodes.jsonl a line per episode");
    if interrupted {
        return Ok(evaluation.leave(&[summary], plan.episodes(), &folder));
    }
    printed?;
    acted(&[summary])
}

/// What all policies of an evaluation share.
struct Evaluation<'a> {
    args: &'a Args,
    interrupt: &'a Interrupt,
    live: Option<&'a Live>,
}

impl Evaluation<'_> {
    /// Plays the missing episodes of one policy and writes its results; returns whether it was interrupted.
    fn one(&self, plan: &Plan, folder: &Path) -> Result<(Summary, bool), Error> {
        let settings = RunSettings::of(plan);
        let settings = if self.args.live { settings.live(self.args.overlays.file()) } else { settings };
        let (journal, resumed) = Resumed::open(folder, plan, &settings).map_err(explain)?;
        if resumed.episodes() > 0 {
            let (there, all) = (resumed.episodes(), plan.episodes());
            writeln!(terminal::notes(), "resuming `{}`: {there} of {all} episodes exist", folder.display())?;
        }
        let threads = threads(self.args.threads);
        let progress = Progress::new(plan, &resumed);
        let feed = self.live.map(|live| live as &dyn evaluate::Feed);
        let tracing = self.args.traces.tracing();
        let extras = Extras { feed, tracing: tracing.as_ref() };
        let outcome = evaluate::run_with(plan, resumed, &journal, threads, self.interrupt.stop(), &progress, extras);
        let outcome = outcome.map_err(|error| match error {
            evaluate::EvaluationError::Journal(error) => explain(error),
            error => error.into(),
        })?;
        progress.finish();
        let summary = outcome.summary;
        journal.write_summary(&summary).map_err(explain)?;
        if !outcome.interrupted {
            pages::write([&self.args.html, &self.args.strip], plan, &journal, self.interrupt.stop())?;
        }
        Ok((summary, outcome.interrupted))
    }

    /// Evaluates one policy after the other, each in a folder of its own, and compares them in one table.
    fn several(&self, plans: &[Plan], folder: &Path) -> Result<ExitCode, Error> {
        let mut summaries = Vec::new();
        for (number, plan) in plans.iter().enumerate() {
            let own = output::subfolder(folder, &format!("{}-{}", number + 1, folder::in_path(plan.policy.name())))?;
            writeln!(terminal::notes(), "\npolicy {}", plan.policy.name())?;
            let (summary, interrupted) = self.one(plan, &own)?;
            summaries.push(summary);
            if interrupted {
                let _ = print(&report::comparison(&summaries), folder, "a folder per policy");
                let all = plans.iter().map(Plan::episodes).sum();
                return Ok(self.leave(&summaries, all, folder));
            }
        }
        print(&report::comparison(&summaries), folder, "a folder per policy, each with its report.md")?;
        acted(&summaries)
    }

    /// The last words after a signal.
    fn leave(&self, summaries: &[Summary], all: u64, folder: &Path) -> ExitCode {
        let done: u64 = summaries.iter().flat_map(|summary| &summary.tasks).map(|task| task.episodes).sum();
        let again = format!("the same command with `--out {}` resumes", folder.display());
        // The terminal may be what has gone; the results are in their folder.
        let _ = writeln!(terminal::notes(), "interrupted after {done} of {all} episodes; {again}");
        self.interrupt.code()
    }
}

/// Whether each policy can act on at least one task.
fn acted(summaries: &[Summary]) -> Result<ExitCode, Error> {
    match summaries.iter().find(|summary| summary.tasks.iter().all(|task| task.skipped.is_some())) {
        Some(Summary { policy, .. }) => {
            let message = format!("policy `{policy}` supports none of the tasks");
            Err(Error::new(message).hint("choose another with `--policy`; the rows above show the reasons"))
        }
        None => Ok(ExitCode::SUCCESS),
    }
}

/// The final output: one table, and the paths of the results.
fn print(table: &str, folder: &Path, rest: &str) -> io::Result<()> {
    let mut out = terminal::out();
    write!(out, "\n{table}")?;
    writeln!(out, "Results: {}", folder.display())?;
    writeln!(out, "         {rest}")
}

//! `msk tune TASK`: episodes, statistics, a reasoner, the rules of change, again.

mod learner;

use self::learner::Wanted;
use crate::condition::Condition;
use crate::error::{Error, FAILURE};
use crate::interrupt::Interrupt;
use crate::numbers::{threads, within};
use crate::overlays::Overlays;
use crate::policies::Limits;
use crate::progress;
use crate::project::{Project, Settings as Parameters};
use crate::terminal;
use indicatif::ProgressBar;
use msk::compiler::numbers::{beside, fixed, for_people};
use msk::evaluate::EpisodeRecord;
use msk::tuning::reasoner::{Reasoner, RuleBook, from_file};
use msk::tuning::session::{Ended, KeptRules, Objective, OnFailure, Round, Session, Settings, Watcher};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Tune the weights of a task: run episodes, request a proposal, apply it within the rules, keep the best weights
///
/// A round runs episodes until the control steps of all workers together reach the interval. Its statistics are sent to the
/// reasoner, whose proposal is projected onto the rules for changes and the bounds in the source. The folder of the session
/// contains rounds.jsonl (statistics, prompt, proposal, applied weights or reason of rejection), episodes.jsonl,
/// weights.toml (reloaded before every episode, so it can be edited during the session) and best.toml. With --out, a folder
/// that contains part of the same session is resumed.
#[derive(clap::Args)]
pub struct Args {
    /// Name of a task in tasks.msk, or a file with one task
    task: String,
    /// The reasoner: rules (built in), or a TOML file with kind = "http" (url, model, key_variable), kind = "process"
    /// (command, environment) or kind = "rules"
    #[arg(long, default_value = "rules", value_name = "rules | FILE")]
    reasoner: String,
    /// The policy: plan (search on the reward itself: "plan fast", "plan good", "plan best" or "plan FILE" with settings), or learner (an
    /// agent that goes on learning before each round: "learner", "learner ALGORITHM" or "learner FILE" with settings of `msk train`).
    /// Others, as `msk run --policy` names them, do the same whatever the weights are; they are accepted with --rehearse only
    #[arg(long, default_value = "plan", value_name = "POLICY")]
    policy: String,
    #[command(flatten)]
    limits: Limits,
    /// Accept a policy whose behaviour does not depend on the weights, to try out a reasoner in little time: scores then differ by
    /// chance alone
    #[arg(long)]
    rehearse: bool,
    #[command(flatten)]
    condition: Condition,
    /// For a learner: control steps that it learns from before each round
    #[arg(long, value_name = "STEPS", default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..))]
    learn: u64,
    /// For a learner: the agent that it begins as, the folder of an agent or of a training
    #[arg(long, value_name = "DIR")]
    start: Option<PathBuf>,
    /// Control steps of a round, of all workers together [default: 3000 of a policy that plans, 10000 of a learner, else 20000]
    #[arg(long, value_name = "STEPS", value_parser = clap::value_parser!(u64).range(1..))]
    interval: Option<u64>,
    /// Maximal number of rounds
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..))]
    rounds: u64,
    /// Maximal number of control steps of all rounds together
    #[arg(long, value_name = "STEPS")]
    steps: Option<u64>,
    /// Largest relative change of a weight in one round
    #[arg(long, default_value_t = 0.2, value_name = "PART", value_parser = within(1e-6, 1.0))]
    step: f64,
    /// Keep the sum of the absolute values of all weights in scope at this number; they are scaled to it first
    #[arg(long, value_name = "SUM", value_parser = within(1e-6, 1e12))]
    norm: Option<f64>,
    /// The terms that are tuned and part of the norm: all, or only those of a running episode, without the cost of
    /// termination
    #[arg(long, value_enum, default_value_t = Scope::All)]
    scope: Scope,
    /// Terms that stay unchanged and are not part of the norm, such as the cost of a fall; can be repeated
    #[arg(long, value_name = "TERM")]
    outside: Vec<String>,
    /// The objective: success, survival, or a metric of the task, with a - before it if lower is better
    #[arg(long, default_value = "success", allow_hyphen_values = true)]
    objective: String,
    /// Behaviour when the reasoner fails or its response is invalid
    #[arg(long, value_enum, default_value_t = Failure::Keep)]
    on_failure: Failure,
    /// Random seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Worker threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder of the session [default: a new one under results/]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    overlays: Overlays,
    #[command(flatten)]
    parameters: Parameters,
}

/// Control steps of a round by default: of a policy that imagines hundreds of steps for each, and of another.
const PLANNED: u64 = 3_000;
const LEARNED: u64 = 10_000;
const PLAYED: u64 = 20_000;

#[derive(Clone, Copy, clap::ValueEnum)]
enum Scope {
    /// All terms that are not fixed
    All,
    /// Without terms whose formula is `terminated`
    Running,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Failure {
    /// Keep the weights, log the failure, continue
    Keep,
    /// Stop
    Stop,
}

/// Runs the session.
///
/// # Errors Errors in the file, a folder or reasoner that cannot be used, or a policy that does not support the task.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (project, mut trial) = Project::find(&args.task, &args.parameters.settings)?;
    args.condition.apply(std::slice::from_mut(&mut trial))?;
    args.overlays.apply(&project, std::slice::from_mut(&mut trial))?;
    let threads = threads(args.threads);
    let folder = match args.out {
        Some(folder) => folder,
        None => crate::eval::fresh_folder(&format!("{}-tune", trial.task.name))?,
    };
    let wanted = Wanted::parse(&args.policy, args.start, args.learn)?;
    let mut learning = wanted.map(|wanted| wanted.open(&trial, &folder, (args.seed, args.rounds), threads)).transpose()?;
    let policy = match &learning {
        Some(learning) => learning.policy()?,
        None => args.limits.source(&args.policy)?,
    };
    if learning.is_none() && !policy.reacts_to_weights() && !args.rehearse {
        let message =
            format!("`{}` does the same whatever the weights are, so tuning them cannot improve what it does", policy.name());
        let hint = "use `--policy plan` or `--policy learner`, or `--rehearse` to try out a reasoner all the same";
        return Err(Error::new(message).hint(hint));
    }
    let interval = args.interval.unwrap_or(match &learning {
        Some(_) => LEARNED,
        None if policy.reacts_to_weights() => PLANNED,
        None => PLAYED,
    });
    let reasoner: Box<dyn Reasoner> = match args.reasoner.as_str() {
        "rules" => Box::new(RuleBook),
        file => from_file(Path::new(file), |name| std::env::var(name).ok())?,
    };
    let mut outside = args.outside.clone();
    if matches!(args.scope, Scope::Running) {
        let terms = trial.task.terms.iter().enumerate();
        outside.extend(terms.filter(|(term, _)| trial.task.is_terminal(*term)).map(|(_, term)| term.name.clone()));
    }
    let settings = Settings {
        policy,
        seed: args.seed,
        interval,
        rules: KeptRules { step: args.step, norm: args.norm },
        outside,
        objective: Objective::parse(&args.objective),
        rounds: args.rounds,
        steps: args.steps,
        on_failure: match args.on_failure {
            Failure::Keep => OnFailure::Keep,
            Failure::Stop => OnFailure::Stop,
        },
    };
    let progress = Progress::new(interval);
    let bar = progress.bar.clone();
    if let Some(learning) = &mut learning {
        learning.show(bar.clone());
    }
    let mut session = Session::open(&folder, settings, trial, move |message| bar.suspend(|| print(message)))?;
    if !session.rounds().is_empty() {
        print(&format!("resuming `{}`: {} of {} rounds exist", folder.display(), session.rounds().len(), args.rounds));
    }
    let interrupt = Interrupt::listen()?;
    let stop = interrupt.stop();
    let ended = match &mut learning {
        Some(learning) => session.run_learner(learning, reasoner.as_ref(), threads, stop, &progress)?,
        None => session.run(reasoner.as_ref(), threads, stop, &progress)?,
    };
    progress.bar.finish_and_clear();
    finish(&session, ended, &interrupt)
}

/// Prints the result.
fn finish(session: &Session, ended: Ended, interrupt: &Interrupt) -> Result<ExitCode, Error> {
    let folder = session.folder().display();
    let mut out = terminal::out();
    for round in session.rounds() {
        writeln!(out, "{}", line(round))?;
    }
    if let Some(best) = session.best() {
        let (round, score) = (best.round, for_people(best.score));
        writeln!(out, "\nBest: round {round} with score {score} ({}): `{folder}/best.toml`", session.objective())?;
        writeln!(out, "Use it with `--weights {folder}/best.toml`, or write it into the source with `msk weights apply`.")?;
    }
    match ended {
        Ended::Budget => Ok(ExitCode::SUCCESS),
        Ended::Interrupted => {
            writeln!(terminal::notes(), "interrupted; the same command with `--out {folder}` resumes")?;
            Ok(interrupt.code())
        }
        Ended::Failed => {
            let why = session.rounds().last().and_then(|round| round.rejected.clone()).unwrap_or_default();
            writeln!(
                terminal::notes(),
                "error: {why}\n  hint: the same command with `--out {folder}` resumes, with --on-failure keep also after failures"
            )?;
            Ok(ExitCode::from(FAILURE))
        }
    }
}

/// A round in one line: its result and the changed weights.
fn line(round: &Round) -> String {
    let statistics = &round.statistics;
    let head = format!(
        "round {}: score {}, {} episodes, {} % succeeded",
        round.round,
        for_people(round.score),
        statistics.episodes,
        fixed(100.0 * statistics.success_rate, 0)
    );
    let changes = match (&round.rejected, &round.applied) {
        (Some(why), _) => format!("weights stay: {}", why.lines().next().unwrap_or_default()),
        (None, None) => return head,
        (None, Some(next)) => {
            let changed = round.weights.iter().zip(next).filter(|((_, before), (_, after))| before != after);
            let changed: Vec<String> = changed
                .map(|((term, before), (_, after))| {
                    format!("{term} {} -> {}", beside(*before, &[*after]), beside(*after, &[*before]))
                })
                .collect();
            if changed.is_empty() { "weights stay".into() } else { changed.join(", ") }
        }
    };
    format!("{head}; {changes}")
}

fn print(message: &str) {
    // Nothing is left to be done when standard error itself cannot be written.
    let _ = writeln!(terminal::notes(), "{message}");
}

/// A line that shows how far the round is. Silent unless on a terminal.
struct Progress {
    bar: ProgressBar,
}

impl Progress {
    fn new(interval: u64) -> Self {
        let bar = progress::line(interval, "{bar:24} {pos}/{len} steps  {msg}  {elapsed}", 10);
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar }
    }
}

impl Watcher for Progress {
    fn stepped(&self) {
        self.bar.inc(1);
    }

    fn ended(&self, _: &EpisodeRecord) {}

    fn asking(&self, reasoner: &str) {
        self.bar.set_message(format!("asking {reasoner}"));
    }

    fn round(&self, round: &Round) {
        self.bar.set_position(0);
        self.bar.set_message(format!("round {}: score {}", round.round, for_people(round.score)));
    }
}

//! `msk eval FILE`: every task of a file under a policy, some episodes of each, one table.

use crate::condition::Condition;
use crate::error::Error;
use crate::interrupt::Interrupt;
use crate::levels::LevelArgs;
use crate::overlays::Overlays;
use crate::progress::Progress;
use crate::project::{Project, Settings, policy_name};
use msk::runtime::evaluate::{self, Journal, JournalError, Plan, Protocol, RunSettings, Summary, report};
use msk_storage::{Folder, StorageError};
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Evaluate a policy: run episodes of every task, write results, print a table
///
/// How many episodes, and from which seed, is the first protocol of the suite, unless --protocol, --episodes or --seed say
/// otherwise. Each task's row is shown as it ends, one table at the end. Results go to a folder: run.json (what was run),
/// episodes.jsonl (a line per episode, written as it ends), summary.json and report.md (also terms and metrics). With --out, a
/// folder that already holds part of the same run is continued; another run there is refused.
///
/// A task that the policy cannot act on is skipped, with the reason in its row. Exit code 0 if all other episodes have ended,
/// 1 if something failed or the policy can act on no task, 2 for a wrong command line; after SIGINT, SIGTERM or SIGHUP, which
/// keep all ended episodes, 130, 143 or 129.
#[derive(clap::Args)]
pub struct Args {
    /// File with tasks, or with a suite of them
    #[arg(default_value = "tasks.msk")]
    file: PathBuf,
    /// Run this task only
    #[arg(long)]
    task: Option<String>,
    /// What acts: cmc (computed muscle control along the task's reference motion, or of the beginning
    /// pose), demonstration (the same along the script of the task's first test that succeeds), zero (every
    /// muscle at rest), random (every action uniform in -1..1)
    #[arg(long, default_value = "cmc", value_parser = policy_name)]
    policy: String,
    #[command(flatten)]
    condition: Condition,
    /// Protocol of the suite, by name [default: its first]
    #[arg(long, value_name = "NAME")]
    protocol: Option<String>,
    /// Episodes per task [default: the protocol's, else 50]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    episodes: Option<u64>,
    /// Seed of all chance [default: the protocol's, else 0]
    #[arg(long)]
    seed: Option<u64>,
    /// Worker threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder for the results [default: a new one under results/]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    overlays: Overlays,
    /// Read the file of --weights anew before every episode; each episode records the version that paid it
    #[arg(long, requires = "weights")]
    live: bool,
    #[command(flatten)]
    lints: LevelArgs,
    #[command(flatten)]
    settings: Settings,
}

/// Runs the evaluation.
///
/// # Errors
/// Errors in the file, a folder that cannot be used, or a policy that cannot act.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let project = Project::open_at(&args.file, &args.settings.settings, &args.lints.levels)?;
    let chosen = Chosen::of(&args, &project)?;
    let mut trials = project.trials(args.task.as_deref())?;
    args.condition.apply(&mut trials)?;
    let live = match args.live {
        true => Some(args.overlays.live(&project, &mut trials)?),
        false => args.overlays.apply(&project, &mut trials).map(|()| None)?,
    };
    let plan = Plan { trials, policy: args.policy.clone(), protocol: chosen.protocol };
    msk::runtime::policy::create(&plan.policy)?;
    let asked = args.threads.and_then(|threads| NonZeroUsize::new(threads.into()));
    let threads = asked.or_else(|| std::thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);

    let folder = match args.out {
        Some(folder) => folder,
        None => fresh_folder(&name(&plan, &args.file))?,
    };
    let settings = RunSettings::of(&plan);
    let settings = if args.live { settings.live(args.overlays.file()) } else { settings };
    let (journal, done) = Journal::open(&folder, &settings).map_err(explain)?;
    if !done.is_empty() {
        writeln!(io::stderr(), "continuing `{}`: {} of {} episodes are there", folder.display(), done.len(), plan.episodes())?;
    }
    writeln!(io::stderr(), "{}", chosen.heading(&plan))?;
    let interrupt = Interrupt::listen()?;
    let progress = Progress::new(&plan, &done);
    let feed = live.as_ref().map(|live| live as &dyn evaluate::Feed);
    let outcome =
        evaluate::run_fed(&plan, done, &journal, threads, interrupt.stop(), &progress, feed).map_err(|error| match error {
            evaluate::EvaluationError::Journal(error) => explain(error),
            error => error.into(),
        })?;
    progress.finish();

    let summary = Summary::of(&plan, &outcome.records).with_skipped(&outcome.skipped);
    journal.write("summary.json", &summary.json()).map_err(explain)?;
    journal.write("report.md", &report::markdown(&summary)).map_err(explain)?;
    let printed = print(&summary, &folder);
    if outcome.interrupted {
        let (done, all) = (outcome.records.len(), plan.episodes());
        let again = format!("the same command with `--out {}` continues", folder.display());
        // The terminal may be what has gone; the results are in their folder.
        let _ = writeln!(io::stderr(), "interrupted after {done} of {all} episodes; {again}");
        return Ok(interrupt.code());
    }
    printed?;
    if outcome.skipped.len() == plan.trials.len() {
        let message = format!("policy `{}` can act on none of the tasks", plan.policy);
        return Err(Error::new(message).hint("choose another with `--policy`; the rows above say why"));
    }
    Ok(ExitCode::SUCCESS)
}

/// The last screen: one table, and where the rest lies.
fn print(summary: &Summary, folder: &Path) -> io::Result<()> {
    let mut out = io::stdout().lock();
    write!(out, "\n{}", report::overview(summary))?;
    writeln!(out, "Results: {}", folder.display())?;
    writeln!(out, "         report.md has every term, episodes.jsonl a line per episode")
}

/// The protocol of an evaluation, and what there is to choose from.
struct Chosen {
    /// Its name in the suite; empty if it has none.
    name: String,
    /// Names of the others.
    others: Vec<String>,
    protocol: Protocol,
}

impl Chosen {
    /// The command line wins over the suite, the suite over the usual protocol.
    fn of(args: &Args, project: &Project) -> Result<Self, Error> {
        let protocols = || project.compilation.suites.iter().flat_map(|suite| &suite.protocols);
        let names = || protocols().map(|protocol| protocol.name.clone()).filter(|name| !name.is_empty());
        let of_suite = match &args.protocol {
            None => protocols().next(),
            Some(name) => Some(protocols().find(|protocol| protocol.name == *name).ok_or_else(|| {
                let known = names().collect::<Vec<_>>().join(", ");
                let hint = if known.is_empty() {
                    "a suite declares one as in `protocol quick { episodes 5, seed 0 }`".to_owned()
                } else {
                    format!("there are: {known}")
                };
                Error::new(format!("`{}` has no protocol `{name}`", args.file.display())).hint(hint)
            })?),
        };
        let usual = msk::compiler::Protocol::default();
        let from = of_suite.unwrap_or(&usual);
        let others = names().filter(|name| *name != from.name).collect();
        let protocol = Protocol { episodes: args.episodes.unwrap_or(from.episodes.into()), seed: args.seed.unwrap_or(from.seed) };
        // With another number of episodes it is no longer the protocol of that name.
        let name = if protocol.episodes == u64::from(from.episodes) { from.name.clone() } else { String::new() };
        Ok(Self { name, others, protocol })
    }

    /// What is going to be run.
    fn heading(&self, plan: &Plan) -> String {
        let count = |number: usize, one: &str| format!("{number} {one}{}", if number == 1 { "" } else { "s" });
        let tasks = count(plan.trials.len(), "task");
        let episodes = count(usize::try_from(self.protocol.episodes).unwrap_or(usize::MAX), "episode");
        let protocol = match (self.name.as_str(), self.others.as_slice()) {
            ("", _) => String::new(),
            (name, []) => format!(" (protocol {name})"),
            (name, others) => format!(" (protocol {name}; there is also {})", others.join(", ")),
        };
        format!("{tasks}, {episodes} each{protocol}, seed {}, policy {}", self.protocol.seed, plan.policy)
    }
}

/// What a run is called: after its task or its file, and its policy.
fn name(plan: &Plan, file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let name = if let [trial] = plan.trials.as_slice() { trial.task.name.clone() } else { stem.into_owned() };
    format!("{name}-{}", plan.policy)
}

/// Makes `results/NAME-1`, or the first that does not exist yet: nothing is ever overwritten. It is on the disk when this returns.
///
/// # Errors
/// A folder that cannot be made.
pub fn fresh_folder(name: &str) -> Result<PathBuf, Error> {
    let results = Path::new("results");
    let cannot = |source: StorageError| explain(JournalError::Unusable { folder: results.into(), source });
    Folder::create(results).map_err(cannot)?;
    for number in 1_u64.. {
        let folder = results.join(format!("{name}-{number}"));
        match Folder::create_new(&folder) {
            Err(StorageError::System { source, .. }) if source.kind() == io::ErrorKind::AlreadyExists => {}
            made => return made.map(|_| folder).map_err(cannot),
        }
    }
    Err(Error::new("`results` is full"))
}

/// Says what to do about a folder that cannot be used.
pub fn explain(error: JournalError) -> Error {
    let hint = match &error {
        JournalError::Unusable { .. } => {
            "make room or choose a folder that can be written with `--out DIR`; what has ended is kept"
        }
        JournalError::OtherRun { .. } => "choose another folder with `--out DIR`, or repeat that run's settings",
        JournalError::Unclaimed { .. } => "put its `run.json` back, or choose another folder with `--out DIR`",
        JournalError::Empty { .. } => "name a folder of results, such as results/tasks-cmc-1",
        JournalError::Damaged { .. } | JournalError::Foreign { .. } => {
            "take out the line or put the file back, or choose another folder with `--out DIR`; nothing was changed"
        }
        JournalError::Busy { .. } => "wait for it, or choose another folder with `--out DIR`",
    };
    Error::from(error).hint(hint)
}

//! `msk eval FILE`: every task of a file under a policy, many episodes, a table.

use crate::condition::Condition;
use crate::error::{Error, INTERRUPTED};
use crate::overlays::Overlays;
use crate::progress::Progress;
use crate::project::{Project, Settings};
use msk::runtime::evaluate::{self, Journal, JournalError, Plan, Protocol, RunSettings, Summary, report};
use std::fs;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Evaluate a policy: run episodes of every task, write results, print a table
///
/// Results go to a folder: run.json (what was run), episodes.jsonl (a line per episode, written as it ends), summary.json and
/// report.md. With --out, a folder that already holds part of the same run is continued; another run there is refused.
#[derive(clap::Args)]
pub struct Args {
    /// File with tasks, or with a suite of them
    #[arg(default_value = "tasks.msk")]
    file: PathBuf,
    /// Run this task only
    #[arg(long)]
    task: Option<String>,
    /// What acts: posture (computed muscle control along the task's reference motion, or of the beginning
    /// pose), witness (the same along the script of the task's first test that succeeds), zero (every
    /// muscle at rest), random (every action uniform in -1..1)
    #[arg(long, default_value = "posture")]
    policy: String,
    #[command(flatten)]
    condition: Condition,
    /// Episodes per task [default: the suite's protocol, else 50]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    episodes: Option<u64>,
    /// Seed of all chance [default: the suite's protocol, else 0]
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
    settings: Settings,
}

/// Runs the evaluation.
///
/// # Errors
/// Errors in the file, a folder that cannot be used, or a policy that cannot act.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let project = Project::open(&args.file, &args.settings.settings)?;
    let protocol = protocol(&args, &project);
    let mut trials = project.trials(args.task.as_deref())?;
    args.condition.apply(&mut trials)?;
    let live = match args.live {
        true => Some(args.overlays.live(&project, &mut trials)?),
        false => args.overlays.apply(&project, &mut trials).map(|()| None)?,
    };
    let plan = Plan { trials, policy: args.policy.clone(), protocol };
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
    let stop = stop_on_interrupt()?;
    let progress = Progress::new(plan.episodes(), done.len() as u64);
    let feed = live.as_ref().map(|live| live as &dyn evaluate::Feed);
    let outcome = evaluate::run_fed(&plan, done, &journal, threads, &stop, &progress, feed).map_err(|error| match error {
        evaluate::EvaluationError::Journal(error) => explain(error),
        error => error.into(),
    })?;
    progress.finish();

    let summary = Summary::of(&plan, &outcome.records);
    let report = report::markdown(&summary);
    journal.write("summary.json", &summary.json()).map_err(explain)?;
    journal.write("report.md", &report).map_err(explain)?;
    let mut out = io::stdout().lock();
    write!(out, "{report}")?;
    writeln!(out, "\nResults: {}", folder.display())?;
    if outcome.interrupted {
        let (done, all) = (outcome.records.len(), plan.episodes());
        writeln!(
            io::stderr(),
            "interrupted after {done} of {all} episodes; the same command with `--out {}` continues",
            folder.display()
        )?;
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::SUCCESS)
}

/// The command line wins over the suite, the suite over the usual protocol.
fn protocol(args: &Args, project: &Project) -> Protocol {
    let suite = project.compilation.suites.first().map(|suite| &suite.protocol);
    Protocol {
        episodes: args.episodes.or(suite.map(|protocol| protocol.episodes.into())).unwrap_or(50),
        seed: args.seed.or(suite.map(|protocol| protocol.seed)).unwrap_or(0),
    }
}

/// What a run is called: after its task or its file, and its policy.
fn name(plan: &Plan, file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let name = if let [trial] = plan.trials.as_slice() { trial.task.name.clone() } else { stem.into_owned() };
    format!("{name}-{}", plan.policy)
}

/// Makes `results/NAME-1`, or the first that does not exist yet: nothing is ever overwritten.
///
/// # Errors
/// A folder that cannot be made.
pub fn fresh_folder(name: &str) -> Result<PathBuf, Error> {
    let results = Path::new("results");
    let unwritable = |path: &Path, source| explain(JournalError::Unwritable { path: path.into(), source });
    fs::create_dir_all(results).map_err(|source| unwritable(results, source))?;
    for number in 1_u64.. {
        let folder = results.join(format!("{name}-{number}"));
        match fs::create_dir(&folder) {
            Ok(()) => return Ok(folder),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(unwritable(&folder, error)),
        }
    }
    Err(Error::new("`results` is full"))
}

/// Says what to do about a folder that cannot be used.
fn explain(error: JournalError) -> Error {
    let hint = match &error {
        JournalError::Unwritable { .. } | JournalError::Unreadable { .. } => {
            "choose a folder that can be written with `--out DIR`"
        }
        JournalError::OtherRun { .. } => "choose another folder with `--out DIR`, or repeat that run's settings",
        JournalError::Damaged { .. } => "mend or remove the file, or choose another folder with `--out DIR`",
        JournalError::Busy { .. } => "wait for it, or choose another folder with `--out DIR`",
    };
    Error::from(error).hint(hint)
}

/// Ctrl-C asks the workers to stop; a second one ends the program at once. The journal is valid either way.
pub fn stop_on_interrupt() -> Result<Arc<AtomicBool>, Error> {
    let stop = Arc::new(AtomicBool::new(false));
    let asked = stop.clone();
    ctrlc::set_handler(move || {
        if asked.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    })?;
    Ok(stop)
}

//! `msk session`: an episode that waits for each decision.

use crate::error::{Context, Error};
use crate::numbers::within;
use crate::policies::Limits;
use crate::project::Project;
use crate::terminal;
use msk::compiler::numbers::{fixed, for_people};
use msk::evaluate::session::{Comparison, Errors, Moment, Session, SessionFolder, SessionFolderError, read_action};
use msk::evaluate::trace::{Quantity, StepReader};
use msk::evaluate::{Trial, play_watched};
use msk::runtime::episode::{Environment, EpisodeKey};
use msk_storage::{Folder, read_text_file};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// Largest file with an action that is read, bytes.
const LARGEST: u64 = 64 << 20;

/// Control a body directly: an episode that waits for each action, as files for people, scripts and language models
///
/// `init` writes what is seen first, `submit` takes an action and writes what is seen next, `status` tells how far the session is,
/// `tracking` how closely it follows the reference motion of its task.
/// docs/sessions.md describes the files.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Begin a session: writes session.json and decision-000.json to a new folder
    Init(Init),
    /// Take the next action: a JSON list with a number from -1 to 1 for each entry of the action space. A list that is anything
    /// else is rejected and changes nothing
    Submit {
        /// Folder of the session
        folder: PathBuf,
        /// File with the action
        action: PathBuf,
    },
    /// Print how far a session is
    Status {
        /// Folder of the session
        folder: PathBuf,
    },
    /// Print the distance of the body's landmarks from the reference motion of the task, and when the session diverged from a policy
    /// that follows the same motion: the first of five consecutive control steps whose errors are above the 0.95 quantile of the
    /// policy's errors, and above its error at the same time. `msk report` shows what was found
    Tracking(TrackingArgs),
}

#[derive(clap::Args)]
struct TrackingArgs {
    /// Folder of the session
    folder: PathBuf,
    /// The policy to compare with, which plays the same episode as long as the session may last
    #[arg(long, default_value = "cmc", value_name = "POLICY")]
    reference: String,
    #[command(flatten)]
    limits: Limits,
}

#[derive(clap::Args)]
struct Init {
    /// Name of a task in tasks.msk, or a file with one task; later commands are run in the same folder
    task: String,
    /// Folder of the session, which must not exist
    folder: PathBuf,
    /// Seed of the episode
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// How long an action is held, s: whole control steps
    #[arg(long, default_value_t = 0.2, value_name = "SECONDS", value_parser = within(1e-6, 1e6))]
    hold: f64,
    /// Most decisions
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    decisions: u32,
}

/// Runs the subcommand.
///
/// # Errors
/// A task that cannot be used, an action that is rejected, or a folder that cannot be written or is none of a session.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    match args.command {
        Command::Init(args) => init(&args),
        Command::Submit { folder, action } => submit(&folder, &action),
        Command::Status { folder } => status(&open(&folder)?.1),
        Command::Tracking(args) => tracking(&args),
    }
}

fn init(args: &Init) -> Result<ExitCode, Error> {
    let (_, trial) = Project::find(&args.task, &[])?;
    let hold = Session::hold(&trial, args.hold)
        .map_err(|error| Error::usage(error.to_string()).hint("choose a whole number of control steps with `--hold`"))?;
    let moment = Session::begin(&trial, &args.task, (args.seed, hold, args.decisions))?;
    let cannot = || format!("cannot begin a session in `{}`", args.folder.display());
    let folder = Folder::create_new(&args.folder).context(cannot)?;
    SessionFolder::begin(folder, &moment).map_err(explain)?;
    status(&moment.session)
}

fn submit(path: &Path, action: &Path) -> Result<ExitCode, Error> {
    let (folder, session) = open(path)?;
    let trial: Trial = Project::find(&session.settings.task, &[])?.1;
    let text = read_text_file(action, LARGEST).context(|| format!("cannot read `{}`", action.display()))?;
    let names = trial.task.action.names(&trial.task.vocabulary);
    let entries = read_action(&text, &names).map_err(|error| {
        let error = Error::new(format!("`{}` is rejected: {error}", action.display()));
        error.hint("nothing was changed; the session waits for another action")
    })?;
    let decided: Result<Moment, SessionFolderError> = folder.decide(|session| Ok(session.decide(&trial, entries)?));
    status(&decided.map_err(explain)?.session)
}

fn tracking(args: &TrackingArgs) -> Result<ExitCode, Error> {
    let (folder, session) = open(&args.folder)?;
    let trial: Trial = Project::find(&session.settings.task, &[])?.1;
    let trace = folder.trace().map_err(explain)?;
    let errors = Errors::of(&trace).and_then(|errors| Some((errors.summary()?, errors)));
    let Some((summary, errors)) = errors else {
        let message = format!("the task `{}` follows no reference motion", session.settings.task);
        return Err(Error::new(message).hint("a task follows one with `reference gait = motion \"FILE.csv\"`"));
    };
    let steps = session.settings.decisions.saturating_mul(session.settings.hold);
    let reference = followed(&trial, args, session.settings.seed, steps)?;
    let meters = |value: f64| format!("{} m", for_people(value));
    let mut out = terminal::out();
    writeln!(out, "tracking error {}, last {}, largest {}", meters(summary.rmse), meters(summary.last), meters(summary.largest))?;
    if let Some(summary) = reference.summary() {
        let largest = meters(summary.largest);
        writeln!(
            out,
            "of `{}`: {}, largest {largest}, {} control steps",
            args.reference,
            meters(summary.rmse),
            reference.times.len().saturating_sub(1)
        )?;
    }
    let diverged = errors.divergence(&reference);
    folder.keep(&Comparison { policy: args.reference.clone(), steps: session.steps(), diverged }).map_err(explain)?;
    match diverged {
        Some(time) => writeln!(out, "diverged after {} s", for_people(time))?,
        None => writeln!(out, "has not diverged")?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The errors of a policy that plays the same episode, for so many control steps at most.
fn followed(trial: &Trial, args: &TrackingArgs, seed: u64, steps: u32) -> Result<Errors, Error> {
    let stop = AtomicBool::new(false);
    let source = args.limits.source(&args.reference)?;
    let mut policy = source.open(&stop)?;
    let mut environment = trial.episode()?;
    let mut reader = StepReader::new(environment.engine(), &[Quantity::TrackingError]);
    let mut errors = Errors::default();
    let mut look = |environment: &Environment| {
        let row = reader.read(&environment.context());
        let time = f64::from(environment.steps()) * environment.control_period();
        row.of(Quantity::TrackingError).iter().for_each(|error| errors.add(time, *error));
        stop.store(environment.steps() >= steps, Ordering::Relaxed);
    };
    let key = EpisodeKey { seed, episode: 0 };
    play_watched(trial, &mut environment, key, policy.as_mut(), &stop, &mut look)?;
    Ok(errors)
}

fn open(path: &Path) -> Result<(SessionFolder, Session), Error> {
    let folder = Folder::open(path).context(|| format!("cannot open `{}`", path.display()))?;
    SessionFolder::open(folder).map_err(explain)
}

/// Adds what to do about a folder that cannot be used.
fn explain(error: SessionFolderError) -> Error {
    let hint = match &error {
        SessionFolderError::Empty(_) => "begin one with `msk session init TASK DIR`",
        SessionFolderError::Busy(_) => "wait for it",
        _ => return error.into(),
    };
    Error::from(error).hint(hint)
}

fn status(session: &Session) -> Result<ExitCode, Error> {
    let steps = session.steps();
    let (taken, all) = (session.decisions.len(), session.settings.decisions);
    let mut out = terminal::out();
    let task = &session.settings.task;
    writeln!(out, "{task}: {taken} of {all} decisions, {steps} control steps, return {}", fixed(session.total, 3))?;
    match &session.stopped {
        Some(reason) => {
            let success = if session.success { "success" } else { "no success" };
            writeln!(out, "stopped: {reason}, {success}")?;
        }
        None => writeln!(out, "waits for the answer to decision-{taken:03}.json")?,
    }
    Ok(ExitCode::SUCCESS)
}

//! `msk session`: an episode that waits for each decision.

use crate::error::{Context, Error};
use crate::project::Project;
use msk::evaluate::Trial;
use msk::evaluate::session::{Moment, Session, read_action};
use msk_storage::{Folder, read_text_file};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Largest file that is read, bytes.
const LARGEST: u64 = 64 << 20;
const SESSION: &str = "session.json";
const LOCK: &str = ".lock";
/// What one who decides must not read.
const PRIVATE: &str = "private";

/// Control a body directly: an episode that waits for each action, as files for people, scripts and language models
///
/// `init` writes what is seen first, `submit` takes an action and writes what is seen next, `status` tells how far the session is.
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
    #[arg(long, default_value_t = 0.2, value_name = "SECONDS")]
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
        Command::Status { folder } => status(&read(&folder)?.1),
    }
}

fn init(args: &Init) -> Result<ExitCode, Error> {
    let (_, trial) = Project::find(&args.task, &[])?;
    let steps = args.hold * trial.task.control_frequency;
    let hold = steps.round();
    if !((1.0..=1e6).contains(&hold) && (steps - hold).abs() < 1e-6) {
        let message = format!("--hold {} is {steps} control steps of `{}`", args.hold, trial.task.name);
        return Err(Error::usage(message).hint("choose a whole number of control steps"));
    }
    let moment = Session::begin(&trial, &args.task, (args.seed, hold as u32, args.decisions))?;
    let cannot = || format!("cannot begin a session in `{}`", args.folder.display());
    let folder = Folder::create_new(&args.folder).context(cannot)?;
    write(&folder, &moment)?;
    status(&moment.session)
}

fn submit(path: &Path, action: &Path) -> Result<ExitCode, Error> {
    let (folder, session) = read(path)?;
    let _lock = folder
        .try_lock(Path::new(LOCK))
        .context(|| format!("cannot lock `{}`", path.display()))?
        .ok_or_else(|| Error::new(format!("another process takes a decision in `{}`", path.display())).hint("wait for it"))?;
    let trial: Trial = Project::find(&session.settings.task, &[])?.1;
    let text = read_text_file(action, LARGEST).context(|| format!("cannot read `{}`", action.display()))?;
    let names = trial.task.action.names(&trial.task.vocabulary);
    let entries = read_action(&text, &names).map_err(|error| {
        let error = Error::new(format!("`{}` is rejected: {error}", action.display()));
        error.hint("nothing was changed; the session waits for another action")
    })?;
    let moment = session.decide(&trial, entries)?;
    write(&folder, &moment)?;
    status(&moment.session)
}

/// Writes what a decision has come to. The session itself comes last: until then nothing has happened.
fn write(folder: &Folder, moment: &Moment) -> Result<(), Error> {
    let cannot = || format!("cannot write to `{}`", folder.path().display());
    folder.create_subfolder(Path::new(PRIVATE)).context(cannot)?;
    let keep = |name: &str, bytes: &[u8]| folder.replace(Path::new(name), bytes).context(cannot);
    keep(&format!("{PRIVATE}/trace.npz"), &moment.trace.archive()?)?;
    if let Some(visible) = &moment.visible {
        let text = serde_json::to_string_pretty(visible)? + "\n";
        keep(&format!("decision-{:03}.json", visible.decision), text.as_bytes())?;
    }
    keep(SESSION, (serde_json::to_string_pretty(&moment.session)? + "\n").as_bytes())
}

fn read(path: &Path) -> Result<(Folder, Session), Error> {
    let folder = Folder::open(path).context(|| format!("cannot open `{}`", path.display()))?;
    let text = folder.read_text(Path::new(SESSION), LARGEST).context(|| format!("cannot read `{}`", path.display()))?;
    let text = text.ok_or_else(|| {
        Error::new(format!("`{}` has no session", path.display())).hint("begin one with `msk session init TASK DIR`")
    })?;
    let session = serde_json::from_str(&text).context(|| format!("`{}` is damaged", path.join(SESSION).display()))?;
    Ok((folder, session))
}

fn status(session: &Session) -> Result<ExitCode, Error> {
    let steps = session.decisions.last().map_or(0, |decision| decision.steps);
    let (taken, all) = (session.decisions.len(), session.settings.decisions);
    let mut out = io::stdout().lock();
    writeln!(out, "{}: {taken} of {all} decisions, {steps} control steps, return {:.3}", session.settings.task, session.total)?;
    match &session.stopped {
        Some(reason) => {
            let success = if session.success { "success" } else { "no success" };
            writeln!(out, "stopped: {reason}, {success}")?;
        }
        None => writeln!(out, "waits for the answer to decision-{taken:03}.json")?,
    }
    Ok(ExitCode::SUCCESS)
}

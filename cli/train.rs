//! `msk train TASK`: an agent learns from the reward of a task.

mod lessons;

use crate::condition::Condition;
use crate::error::Error;
use crate::interrupt::Interrupt;
use crate::named::by_name;
use crate::numbers::threads;
use crate::progress;
use crate::project::{Project, Settings as Parameters};
use crate::terminal;
use indicatif::{HumanDuration, ProgressBar};
use lessons::Named;
use msk::compiler::numbers::for_people;
use msk::evaluate::{BUILD, Trial};
use msk::runtime::episode::Engine;
use msk::train::session::{BEST_BY_RETURN, BEST_BY_SUCCESS, Ended, Observer, Progress, Session};
use msk::train::{Algorithm, Evaluation, Lessons, Preset, Provenance, ReplaySize, Round, Settings, TrainError, Training};
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Train an agent on the reward of a task
///
/// The agent is evaluated every so often, in episodes that it does not learn from; the best by success and the best by return are kept as
/// folders, which `--policy "agent FOLDER"` of `msk run`, `msk eval` and `msk test` uses. With --out, a folder that contains the same
/// training is resumed, also after it was killed: its results are those of an undisturbed one, bit for bit, on any number of threads.
/// With more --steps it goes on beyond its end.
///
/// Exit code 0 after all steps, 1 after a failure, 2 for an invalid command line; 130, 143 or 129 after SIGINT, SIGTERM or SIGHUP, which
/// keep what was learned.
#[derive(clap::Args)]
pub struct Args {
    /// Name of a task in tasks.msk, or a file with one task
    task: String,
    /// The algorithm: ppo (proximal policy optimisation), sac (soft actor-critic), simba (sac with residual networks), dynsyn (sac with
    /// groups of muscles that change together), mpo (maximum a posteriori policy optimisation, with differential extrinsic plasticity:
    /// DepRL), clone (imitation of --data and --teacher) [default: ppo]
    #[arg(long, value_name = "NAME", value_parser = algorithm)]
    algorithm: Option<Algorithm>,
    /// The settings: fast (networks that take about as long as the simulation), paper (those of the benchmark's paper: days on two cores)
    /// [default: fast]
    #[arg(long, value_name = "NAME", value_parser = preset)]
    preset: Option<Preset>,
    /// Settings of the learner, as TOML: keys that it does not set are those of its algorithm and preset
    #[arg(long = "settings", value_name = "FILE", conflicts_with_all = ["algorithm", "preset"])]
    learner: Option<PathBuf>,
    /// Control steps to learn from, in all episodes together [default: 1000000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000), conflicts_with = "budget")]
    steps: Option<u64>,
    /// Time to train for, such as 90s, 30m, 2h or 1h30m: it is turned into a number of steps by timing the first ones, and printed
    #[arg(long, value_name = "TIME", value_parser = duration)]
    budget: Option<Duration>,
    /// Random seed
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u64).range(0..=i64::MAX as u64))]
    seed: u64,
    /// Threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    lessons: Named,
    /// Folder of the training [default: a new one under results/]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write returns, success, terms and losses as event files of TensorBoard into the folder, too
    #[arg(long)]
    tensorboard: bool,
    #[command(flatten)]
    condition: Condition,
    #[command(flatten)]
    parameters: Parameters,
}

fn algorithm(name: &str) -> Result<Algorithm, String> {
    by_name(name, &Algorithm::NAMED)
}

fn preset(name: &str) -> Result<Preset, String> {
    by_name(name, &Preset::NAMED)
}

/// `1h30m`, `90s`, `2h`.
fn duration(text: &str) -> Result<Duration, String> {
    let wrong = || format!("`{text}` is no time: write 90s, 30m, 2h or 1h30m");
    let (mut rest, mut seconds) = (text, 0.0);
    while !rest.is_empty() {
        let unit = rest.find(['s', 'm', 'h']).ok_or_else(wrong)?;
        let number: f64 = rest[..unit].parse().map_err(|_| wrong())?;
        let factor = match &rest[unit..=unit] {
            "s" => 1.0,
            "m" => 60.0,
            _ => 3600.0,
        };
        seconds += number * factor;
        rest = &rest[unit + 1..];
    }
    // A year is more than anybody trains for, and less than any clock overflows at.
    if seconds > 0.0 && seconds <= 3.2e7 { Ok(Duration::from_secs_f64(seconds)) } else { Err(wrong()) }
}

/// Trains.
///
/// # Errors Errors in the file or the settings, a folder that cannot be used, or numbers that are not finite.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let settings = settings(&args)?;
    let (_, mut trial) = Project::find(&args.task, &args.parameters.settings)?;
    args.condition.apply(std::slice::from_mut(&mut trial))?;
    let engine = trial.engine()?;
    let threads = threads(args.threads);
    let lessons = args.lessons.lessons(&engine, settings.algorithm)?;
    let interrupt = Interrupt::listen()?;
    let there = args.out.as_deref().map(Session::identity_in).transpose()?.flatten();
    let steps = match (args.budget, there) {
        // A budget of time becomes steps only once.
        (Some(_), Some(training)) => training.steps,
        (Some(budget), None) => match steps_within(budget, &engine, &settings, &lessons, args.seed, threads, interrupt.stop())? {
            Some(steps) => steps,
            None => return Ok(interrupt.code()),
        },
        (None, _) => args.steps.unwrap_or(1_000_000),
    };
    let training = Training::with(&engine, &settings, &lessons, (args.seed, steps), threads)?.with_provenance(provenance(&trial));
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => crate::eval::fresh_folder(&format!("{}-{}", trial.task.name, settings.algorithm.name()))?,
    };
    let (mut session, resumed) = Session::open(&folder, training).map_err(|error| explain(error, &folder))?;
    let name = settings.algorithm.name();
    writeln!(terminal::notes(), "{}: {name}, {steps} steps, seed {}, in `{}`", trial.task.name, args.seed, folder.display())?;
    if let Some(size) = session.training().replay().filter(|size| size.kept < size.wanted) {
        writeln!(terminal::notes(), "{}", replay_note(&size))?;
    }
    if resumed {
        writeln!(terminal::notes(), "resuming after {} steps", session.training().step())?;
    }
    if args.tensorboard {
        session = session.with_events().map_err(|error| explain(error, &folder))?;
    }
    let mut shown = Shown::new(steps);
    let ended = session.run(interrupt.stop(), &mut shown);
    shown.bar.finish_and_clear();
    let ended = ended.map_err(|error| explain(error, &folder))?;
    report(&session, &folder, &args.task)?;
    if ended == Ended::Interrupted {
        let again = format!("the same command with `--out {}` resumes", folder.display());
        writeln!(terminal::notes(), "interrupted after {} of {steps} steps; {again}", session.training().step())?;
        return Ok(interrupt.code());
    }
    Ok(ExitCode::SUCCESS)
}

fn settings(args: &Args) -> Result<Settings, Error> {
    let Some(path) = &args.learner else {
        return Ok(Settings::of(args.algorithm.unwrap_or_default(), args.preset.unwrap_or_default()));
    };
    read_settings(path)
}

/// Where a training of this trial runs.
pub fn provenance(trial: &Trial) -> Provenance {
    Provenance { model_hash: trial.body.hash().to_owned(), condition: trial.body.condition.to_string(), build: BUILD.to_owned() }
}

/// The settings of a learner in a file.
///
/// # Errors
/// A file that cannot be read, or settings that make no sense.
pub fn read_settings(path: &Path) -> Result<Settings, Error> {
    let text = msk_storage::read_text_file(path, 1 << 20)?;
    Settings::read(&text)
        .map_err(|error| Error::new(format!("`{}`: {error}", path.display())).hint("`msk help training` lists all settings"))
}

/// How many steps a time is enough for, evaluations included: from rounds that are played and thrown away. `None` if `stop` became true.
fn steps_within(
    budget: Duration,
    engine: &Engine,
    settings: &Settings,
    lessons: &Lessons,
    seed: u64,
    threads: NonZeroUsize,
    stop: &AtomicBool,
) -> Result<Option<u64>, Error> {
    let mut trial = settings.clone();
    // What is slow begins at once.
    (trial.sac.start, trial.mpo.start) = (1, 1);
    let mut training = Training::with(engine, &trial, lessons, (seed, u64::MAX), threads)?;
    let begin = Instant::now();
    let enough = Duration::from_secs(5).min(budget / 20);
    training.round()?;
    while begin.elapsed() < enough && !stop.load(Ordering::Relaxed) {
        training.round()?;
    }
    let of_step = begin.elapsed().as_secs_f64() / training.step() as f64;
    let begin = Instant::now();
    let agent = training.agent();
    if training.evaluate(&agent, stop)?.is_none() || stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let of_evaluations = begin.elapsed().as_secs_f64() / settings.evaluate_every as f64;
    let steps = (budget.as_secs_f64() / (of_step + of_evaluations)) as u64;
    let rounded = if steps > 10_000 { steps / 1000 * 1000 } else { steps };
    writeln!(terminal::notes(), "{:.0} steps/s: {rounded} steps within the budget", 1.0 / (of_step + of_evaluations))?;
    Ok(Some(rounded.clamp(1, 1_000_000_000_000)))
}

/// Adds what to do about a training that cannot go on.
fn explain(error: TrainError, folder: &Path) -> Error {
    let hint = match &error {
        TrainError::Storage(storage) if storage.kind() == Some(io::ErrorKind::StorageFull) => {
            Some(format!("free some space: the same command with `--out {}` resumes from the last checkpoint", folder.display()))
        }
        TrainError::Storage(_) => Some("choose a writable folder with `--out DIR`".to_owned()),
        _ => None,
    };
    let error = Error::from(error);
    match hint {
        Some(hint) => error.hint(hint),
        None => error,
    }
}

/// That fewer transitions are kept than the settings ask for.
fn replay_note(size: &ReplaySize) -> String {
    let ReplaySize { kept, wanted, bytes } = size;
    let others = "`replay_precision = \"compact\"` takes half the memory, `replay_memory` allows more";
    format!("keeps the last {kept} of {wanted} transitions, because one takes {bytes} bytes: {others}")
}

/// Prints the best agents.
fn report(session: &Session, folder: &Path, task: &str) -> Result<(), Error> {
    let mut out = terminal::out();
    let kinds = [("by success", BEST_BY_SUCCESS), ("by return", BEST_BY_RETURN)];
    for ((what, name), best) in kinds.into_iter().zip(session.best()) {
        if let Some(best) = best {
            writeln!(out, "best {what}: {}: {}", described(&best), folder.join(name).display())?;
        }
    }
    if session.best()[0].is_some() {
        writeln!(out, "\nUse it: msk run {task} --policy \"agent {}\"", folder.join(BEST_BY_SUCCESS).display())?;
    }
    Ok(())
}

fn described(evaluation: &Evaluation) -> String {
    let Evaluation { episodes, success, total, steps } = evaluation;
    let (success, total) = (for_people(100.0 * success), for_people(*total));
    format!("return {total}, {success} % of {episodes} episodes succeeded, {} steps each", for_people(*steps))
}

/// A line that shows how far the training is, on a terminal; a row for each evaluation.
struct Shown {
    bar: ProgressBar,
}

impl Shown {
    fn new(steps: u64) -> Self {
        Self { bar: progress::line(steps, "{bar:24} {pos}/{len} steps  {msg}", 4) }
    }
}

impl Observer for Shown {
    fn round(&mut self, _: &Round, progress: &Progress) {
        let Progress { step, steps, rate, total, success } = *progress;
        self.bar.set_position(step.min(steps));
        let left = Duration::try_from_secs_f64(steps.saturating_sub(step) as f64 / rate).unwrap_or_default();
        let lately = match (total, success) {
            (Some(total), Some(success)) => {
                format!("return {}  {} % succeeded  ", for_people(total), for_people(100.0 * success))
            }
            _ => String::new(),
        };
        self.bar.set_message(format!("{rate:.0} steps/s  {lately}left {}", HumanDuration(left)));
    }

    fn evaluated(&mut self, step: u64, evaluation: &Evaluation) {
        // Nothing is left to be done when standard error itself cannot be written.
        self.bar.suspend(|| {
            let _ = writeln!(terminal::notes(), "{step:>10} steps: {}", described(evaluation));
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        let seconds = |text: &str| duration(text).map(|time| time.as_secs_f64()).ok();
        assert_eq!([seconds("90s"), seconds("1h30m"), seconds("0.5m")], [Some(90.0), Some(5400.0), Some(30.0)]);
        for wrong in ["", "2", "h", "-1h", "nans", "1e9h", "1hh"] {
            assert_eq!(seconds(wrong), None, "{wrong}");
        }
    }
}

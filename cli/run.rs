//! `msk run TASK`: one episode, reported term by term.

use crate::condition::Condition;
use crate::error::Error;
use crate::html;
use crate::interrupt::Interrupt;
use crate::output;
use crate::overlays::Overlays;
use crate::pictures::{PictureArgs, Pictures};
use crate::policies::{Limits, write_actions};
use crate::progress;
use crate::project::{Project, Settings};
use crate::terminal;
use crate::trace;
use crate::view::live::Live;
use msk::compiler::numbers::{exact, fixed, for_people};
use msk::evaluate::collection::ActionRecorder;
use msk::evaluate::{
    EpisodeRecord, EvaluationError, Journal, Plan, Protocol, Shard, Summary, TraceRecorder, Tracing, Trial, ensure_room,
    play_to_horizon, play_watched, replay_watched, report,
};
use msk::runtime::episode::{Environment, EpisodeKey};
use msk::runtime::inspect::StateFile;
use msk::runtime::policy::{Policy, PolicyError, PolicySource};
use msk::view::Caption;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Run one episode of a task and print the contribution of each reward term
#[derive(clap::Args)]
pub struct Args {
    /// Name of a task in tasks.msk, or a file with one task
    task: String,
    /// The policy: cmc (computed muscle control that tracks the task's reference motion, or holds the initial pose),
    /// demonstration (tracks the script of the task's first succeeding test), zero (every muscle at rest), random (every
    /// action uniform in -1..1), plan (search on the reward itself: "plan fast", "plan good", "plan best" or "plan FILE" with
    /// settings), "process [--messagepack] COMMAND" (an external program: `msk help policies` describes its protocol),
    /// "agent FOLDER" (what `msk train` made), "agents" or "agents FOLDER" (for each task the best that was trained on it: of those
    /// that come with MSK, or in a folder), "network FILE" (a trained network, as safetensors), "replay FILE" (actions from a NumPy
    /// file, a row per step)
    #[arg(long, default_value = "cmc", value_name = "POLICY")]
    policy: String,
    #[command(flatten)]
    limits: Limits,
    /// Write the actions to this NumPy file, as the policy `replay` reads them
    #[arg(long, value_name = "FILE", conflicts_with_all = ["replay", "ignore_terminations"])]
    actions: Option<PathBuf>,
    #[command(flatten)]
    condition: Condition,
    /// Random seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Index of the episode
    #[arg(long, default_value_t = 0)]
    episode: u64,
    /// Print the record of the episode as JSON instead
    #[arg(long)]
    json: bool,
    /// Write the final state to this file, for `msk draw --state`
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Write the episode to this file as a page for a browser: the moving body with its muscles, reward terms and signals. It works
    /// without a network
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Write the episode to this file step by step: a NumPy archive with a row per control step, for `msk trace`
    #[arg(long, value_name = "FILE", conflicts_with = "ignore_terminations")]
    trace: Option<PathBuf>,
    /// What the trace holds, separated by commas, as `msk eval --trace` has it
    #[arg(long, value_name = "QUANTITIES", default_value = "all", requires = "trace", value_parser = trace::parse)]
    trace_columns: trace::Quantities,
    #[command(flatten)]
    pictures: PictureArgs,
    /// Show the episode in a browser on this machine while it is being played, as it looks and what it is rewarded with so far: the address
    /// of a page is printed. Afterwards the page waits until the whole episode has been fetched, or for Ctrl-C
    #[arg(long, conflicts_with_all = ["replay", "ignore_terminations"])]
    live: bool,
    /// Port of this machine for the page; 0 for any that is free
    #[arg(long, default_value_t = 0, requires = "live")]
    port: u16,
    /// Continue up to the horizon, ignoring terminations, and print when the episode would have ended, faults of the
    /// physics, and the largest penetration
    #[arg(long, conflicts_with_all = ["json", "replay", "weights", "weight"])]
    ignore_terminations: bool,
    /// Replay an episode of an evaluation with its recorded weights, and report whether the result is bit-identical: the
    /// folder of its results; with --episode
    #[arg(long, value_name = "DIR", conflicts_with_all = ["policy", "seed", "weights", "weight", "state"])]
    replay: Option<PathBuf>,
    #[command(flatten)]
    overlays: Overlays,
    #[command(flatten)]
    settings: Settings,
}

/// Runs the episode.
///
/// # Errors Errors in the file, a policy that does not exist or does not support the task, or a state file that cannot be
/// written.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let (project, mut trial) = Project::find(&args.task, &args.settings.settings)?;
    args.condition.apply(std::slice::from_mut(&mut trial))?;
    if let Some(folder) = &args.replay {
        return replay_recorded(&args, &trial, folder);
    }
    args.overlays.apply(&project, std::slice::from_mut(&mut trial))?;
    let source = args.limits.source(&args.policy)?;
    let interrupt = Interrupt::listen()?;
    if !args.live {
        return play(&args, trial, source, &interrupt, None);
    }
    let caption = Caption {
        task: trial.task.name.clone(),
        policy: args.policy.clone(),
        episode: Some([args.seed, args.episode]),
        condition: html::condition(&trial),
        ..Caption::default()
    };
    let live = Live::open(&trial, caption, args.port)?;
    live.beside(interrupt.stop(), || play(&args, trial, source, &interrupt, Some(&live)))
}

/// Plays the episode and reports it.
fn play(args: &Args, trial: Trial, source: PolicySource, interrupt: &Interrupt, live: Option<&Live>) -> Result<ExitCode, Error> {
    let mut recorded = ActionRecorder::new(source.open(interrupt.stop())?);
    let mut episode = trial.episode()?;
    let policy = match args.actions {
        Some(_) => {
            let entries = recorded.acts_on().size(&trial.task, episode.engine().body());
            ensure_room(&trial.task, trial.task.horizon, entries * size_of::<f64>())?;
            &mut recorded
        }
        None => recorded.inner_mut(),
    };
    let key = EpisodeKey { seed: args.seed, episode: args.episode };
    if args.ignore_terminations {
        return to_horizon(args, &trial, &mut episode, key, policy);
    }
    let mut film = html::Film::of(&episode, &trial, args.html.is_some() || args.live)?;
    let mut pictures = Pictures::of(&args.pictures, &episode, &trial)?;
    let steps = progress::steps(trial.task.horizon);
    let mut recorder = recorder(args, &episode)?;
    let mut watch = |episode: &Environment| {
        steps.set_position(episode.steps().into());
        film.look(episode);
        recorder.look(&episode.context());
        pictures.look(episode);
        if let Some(live) = live {
            live.look(episode, &film);
        }
    };
    let played = play_watched(&trial, &mut episode, key, policy, interrupt.stop(), &mut watch);
    steps.finish_and_clear();
    let record = match played {
        Ok(Some(record)) => record,
        Ok(None) | Err(EvaluationError::Policy(PolicyError::Interrupted)) => return Ok(interrupt.code()),
        Err(error) => return Err(error.into()),
    };
    if let Some(path) = &args.actions {
        write_actions(&recorded, path)?;
    }
    write_state(args, &episode)?;
    write_trace(args, recorder, &record)?;
    film.write(args.html.as_deref(), html::caption(&record))?;
    pictures.write(&episode)?;
    if let Some(live) = live {
        live.end(&film, html::caption(&record))?;
    }
    let mut out = terminal::out();
    if args.json {
        serde_json::to_writer(&mut out, &record)?;
        writeln!(out)?;
        return Ok(ExitCode::SUCCESS);
    }
    let protocol = Protocol { episodes: 1, seed: args.seed };
    let time = f64::from(record.steps) / trial.task.control_frequency;
    let plan = Plan { trials: vec![trial], policy: source, protocol, shard: Shard::WHOLE };
    let summary = Summary::of(&plan, std::slice::from_ref(&record));
    writeln!(out, "{}", headline(&record, time))?;
    for task in &summary.tasks {
        writeln!(out, "\n{}", report::terms(&task.terms))?;
        if !task.metrics.is_empty() {
            writeln!(out, "{}", report::metrics(&task.metrics))?;
        }
    }
    writeln!(out, "return {}, {}", for_people(record.total), if record.success { "success" } else { "no success" })?;
    Ok(ExitCode::SUCCESS)
}

/// Writes the state where it was asked for.
fn write_state(args: &Args, episode: &Environment) -> Result<(), Error> {
    let Some(path) = &args.state else { return Ok(()) };
    let state = serde_json::to_string(&StateFile::of(episode.engine().model(), episode.state()))?;
    output::write(path, state)
}

/// Reads the steps of the episode, as far as a trace is asked for.
fn recorder(args: &Args, episode: &Environment) -> Result<TraceRecorder, Error> {
    let tracing = args.trace.as_ref().map(|_| Tracing { quantities: args.trace_columns.0.clone(), episodes: u64::MAX });
    Ok(TraceRecorder::new(episode.engine(), args.episode, tracing.as_ref())?)
}

/// Writes the trace where it was asked for.
fn write_trace(args: &Args, recorder: TraceRecorder, record: &EpisodeRecord) -> Result<(), Error> {
    let (Some(path), Some(trace)) = (&args.trace, recorder.finish(record)) else { return Ok(()) };
    output::write(path, trace.archive()?)
}

/// Plays an episode up to its horizon, ignoring terminations.
fn to_horizon(
    args: &Args,
    trial: &Trial,
    episode: &mut Environment,
    key: EpisodeKey,
    policy: &mut dyn Policy,
) -> Result<ExitCode, Error> {
    let mut film = html::Film::of(episode, trial, args.html.is_some())?;
    let mut pictures = Pictures::of(&args.pictures, episode, trial)?;
    let found = play_to_horizon(episode, key, policy, &mut |episode| {
        film.look(episode);
        pictures.look(episode);
    })?;
    write_state(args, episode)?;
    let task = &trial.task;
    let first = match &found.first {
        Some((steps, ending)) if ending.is_of_task() => format!("{} after {steps}", ending.conditions(task)),
        _ => "no termination before the horizon".to_owned(),
    };
    let fault = found.fault.map_or("no fault".to_owned(), |fault| format!("stopped by a fault: {fault}"));
    let (steps, deepest, fastest) = (found.steps, 1e3 * found.deepest, found.fastest);
    let caption = Caption {
        task: task.name.clone(),
        policy: args.policy.clone(),
        episode: Some([key.seed, key.episode]),
        outcome: format!("{first}; continued to the horizon"),
        condition: html::condition(trial),
        ..Caption::default()
    };
    film.write(args.html.as_deref(), caption)?;
    pictures.write(episode)?;
    let summary = format!("{first}; continued to {steps} steps of {}, {fault}", task.horizon);
    let mut out = terminal::out();
    writeln!(
        out,
        "{}, policy {}: {summary}; largest penetration {} mm, largest speed of the root {} m/s",
        task.name,
        args.policy,
        fixed(deepest, 1),
        fixed(fastest, 1)
    )?;
    Ok(ExitCode::SUCCESS)
}

/// Replays an episode of an evaluation.
fn replay_recorded(args: &Args, trial: &Trial, folder: &Path) -> Result<ExitCode, Error> {
    let mut found = None;
    let wanted = |record: &EpisodeRecord| record.task == trial.task.name && record.episode == args.episode;
    Journal::each(folder, |record| found = found.take().or_else(|| wanted(&record).then_some(record)))
        .map_err(crate::eval::explain)?;
    let Some(record) = &found else {
        let message = format!("`{}` contains no episode {} of task `{}`", folder.display(), args.episode, trial.task.name);
        return Err(Error::new(message).hint("select one with --episode; the journal is episodes.jsonl"));
    };
    let episode = trial.episode()?;
    let mut film = html::Film::of(&episode, trial, args.html.is_some())?;
    let mut recorder = recorder(args, &episode)?;
    let mut pictures = Pictures::of(&args.pictures, &episode, trial)?;
    let mut watch = |episode: &Environment| {
        film.look(episode);
        recorder.look(&episode.context());
        pictures.look(episode);
    };
    let played = replay_watched(trial, record, &mut watch)?;
    write_trace(args, recorder, &played)?;
    film.write(args.html.as_deref(), html::caption(&played))?;
    pictures.write(&episode)?;
    let mut out = terminal::out();
    if args.json {
        serde_json::to_writer(&mut out, &played)?;
        writeln!(out)?;
    } else {
        writeln!(out, "{}", headline(&played, f64::from(played.steps) / trial.task.control_frequency))?;
        let weights =
            if record.weights_version.is_empty() { String::new() } else { format!(", weights {}", record.weights_version) };
        writeln!(out, "return {}{weights}", for_people(played.total))?;
    }
    if played.same_as(record) {
        writeln!(terminal::notes(), "the same as in `{}`, bit for bit", folder.display())?;
        return Ok(ExitCode::SUCCESS);
    }
    let message = format!(
        "this differs from the episode in `{}`: its return was {}, not {}",
        folder.display(),
        exact(played.total),
        exact(record.total)
    );
    Err(Error::new(message).hint("it was made by another version of the program, or on a machine with different arithmetic"))
}

/// How an episode ended.
pub fn ending(record: &EpisodeRecord) -> String {
    match &record.fault {
        Some(fault) => format!("stopped by a fault: {fault}"),
        None if record.truncated && !record.awaited.is_empty() => {
            format!("reached the horizon in {}, which never held,", record.awaited)
        }
        None if record.truncated => "reached the horizon".into(),
        None if record.terminated_by.is_empty() => format!("finished by {}", record.finished_by.join(" and ")),
        None => format!("ended by {}", record.ended_by()),
    }
}

/// What ran and how it ended.
fn headline(record: &EpisodeRecord, time: f64) -> String {
    let EpisodeRecord { task, policy, seed, episode, steps, .. } = record;
    let end = ending(record);
    format!("{task}, policy {policy}, seed {seed}, episode {episode}: {end} after {steps} steps ({} s)", fixed(time, 2))
}

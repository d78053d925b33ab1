//! `msk collect TASK`: episodes under a policy as a data set for learners.

mod recording;

use crate::condition::Condition;
use crate::error::Error;
use crate::eval;
use crate::interrupt::Interrupt;
use crate::overlays::Overlays;
use crate::policies::{Limits, Recorder};
use crate::progress;
use crate::project::{Project, Settings};
use crate::terminal;
use msk::compiler::numbers::fixed;
use msk::evaluate::play_watched;
use msk::evaluate::{
    EpisodeRecord, EpisodeSet, EvaluationError, Journal, JournalError, Moments, Plan, Protocol, RunSettings, Shard, Trial,
};
use msk::runtime::episode::{Environment, EpisodeKey};
use msk::runtime::policy::PolicyError;
use msk_storage::Folder;
use recording::{LAYOUT, Recording, layout};
use std::io::Write;
use std::path::{Path, PathBuf};
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
    let plan = Plan { trials: vec![trial], policy, protocol, shard: Shard::WHOLE };
    let name = format!("{}-data-{}", plan.trials[0].task.name, eval::in_path(plan.policy.name()));
    let folder = args.out.clone().map_or_else(|| eval::fresh_folder(&name), Ok)?;
    let cannot = |source| eval::explain(JournalError::Unusable { folder: folder.clone(), source });
    let mut totals = Totals::default();
    let settings = RunSettings::of(&plan);
    let opened = Journal::open_with(Folder::create(&folder).map_err(cannot)?, &settings, &mut |record| totals.add(&record));
    let (journal, kept) = opened.map_err(eval::explain)?;
    let interrupt = Interrupt::listen()?;
    let collection = Collection { plan: &plan, journal: &journal, interrupt: &interrupt };
    must_have_archives(&folder, &kept.done, args.episodes)?;
    if !collection.complete(&kept.done, &mut totals)? {
        writeln!(terminal::notes(), "interrupted; the same command with `--out {}` goes on", folder.display())?;
        return Ok(interrupt.code());
    }
    let Totals { steps, successes, returns } = totals;
    let mut out = terminal::out();
    let (episodes, mean) = (returns.count(), returns.mean());
    let numbers = format!("{episodes} episodes, {steps} control steps, {successes} successes, mean return {}", fixed(mean, 1));
    writeln!(out, "{numbers}\nData: {}", folder.display())?;
    writeln!(out, "      data.json names the columns, episodes.jsonl has a line per episode")?;
    Ok(ExitCode::SUCCESS)
}

/// Whether every episode with a line has its arrays; its line cannot be written once more.
fn must_have_archives(folder: &Path, done: &EpisodeSet, episodes: u64) -> Result<(), Error> {
    let gone = |episode: &u64| done.contains((0, *episode)) && !folder.join(archive_name(*episode)).is_file();
    let missing: Vec<u64> = (0..episodes).filter(gone).collect();
    let Some(first) = missing.first() else { return Ok(()) };
    let (folder, name) = (folder.display(), archive_name(*first));
    let message = format!("`{folder}` has lost the arrays of {} episodes, such as `{name}`", missing.len());
    Err(Error::new(message).hint("restore the files, or collect anew into another folder with `--out DIR`"))
}

/// The file with the arrays of an episode.
pub fn archive_name(episode: u64) -> String {
    format!("{episode:04}.npz")
}

/// Sums over the episodes of a data set.
#[derive(Default)]
struct Totals {
    steps: u64,
    successes: u64,
    returns: Moments,
}

impl Totals {
    fn add(&mut self, record: &EpisodeRecord) {
        self.steps += u64::from(record.steps);
        self.successes += u64::from(record.success);
        self.returns.add(record.total);
    }
}

/// A data set that is being made.
struct Collection<'a> {
    plan: &'a Plan,
    journal: &'a Journal,
    interrupt: &'a Interrupt,
}

impl Collection<'_> {
    /// Plays the episodes that are not `done`; gives whether all are there, which they are not after an interruption.
    fn complete(&self, done: &EpisodeSet, totals: &mut Totals) -> Result<bool, Error> {
        let Plan { trials, policy: source, protocol, .. } = self.plan;
        let trial = &trials[0];
        let mut policy = Recorder::new(source.open(self.interrupt.stop())?);
        let mut environment = trial.episode()?;
        for episode in (0..protocol.episodes).filter(|episode| !done.contains((0, *episode))) {
            let key = EpisodeKey { seed: protocol.seed, episode };
            let Some(record) = self.play(trial, key, &mut environment, &mut policy)? else { return Ok(false) };
            let outcome = if record.success { "success" } else { "no success" };
            writeln!(
                terminal::notes(),
                "episode {episode}: {} steps, return {}, {outcome}",
                record.steps,
                fixed(record.total, 1)
            )?;
            totals.add(&record);
        }
        Ok(true)
    }

    /// Plays one episode and keeps it: its arrays first, then the line that says that they are whole.
    fn play(
        &self,
        trial: &Trial,
        key: EpisodeKey,
        environment: &mut Environment,
        policy: &mut Recorder<'_>,
    ) -> Result<Option<EpisodeRecord>, Error> {
        let steps = progress::steps(trial.task.horizon);
        let mut recording = Recording::default();
        let mut watch = |environment: &Environment| {
            steps.set_position(environment.steps().into());
            recording.look(environment);
        };
        let played = play_watched(trial, environment, key, policy, self.interrupt.stop(), &mut watch);
        steps.finish_and_clear();
        let record = match played {
            Ok(Some(record)) => record,
            Ok(None) | Err(EvaluationError::Policy(PolicyError::Interrupted)) => return Ok(None),
            Err(error) => return Err(error.into()),
        };
        let archive = recording.archive(policy.actions(), &record)?;
        self.journal.write(LAYOUT, layout(environment, policy)?).map_err(eval::explain)?;
        self.journal.write(&archive_name(key.episode), archive).map_err(eval::explain)?;
        self.journal.append(&record).map_err(eval::explain)?;
        Ok(Some(record))
    }
}

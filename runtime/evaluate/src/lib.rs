//! Evaluation: episodes of tasks under a policy, in parallel, journalled as they end, summarized in a table.
//!
//! 1. A [`Plan`] lists what is run; its [`RunSettings`] are its identity.
//! 2. A [`Journal`] keeps every ended episode and knows which are already there: they are [`Resumed`].
//! 3. [`run`] plays the others on a pool of workers, each of which steps up to eight episodes of one model at once. An episode
//!    depends on its seed and index alone, and episodes enter the journal in the order of the plan, so the results have the same bytes on
//!    any number of threads and after any interruption. None is kept in memory once it has entered.
//! 4. A [`Feed`] may change the weights between episodes; the record of each names those that rewarded it, so that [`replay`] can
//!    play it again.
//! 5. A [`Summary`] summarizes the episodes of each task; [`report`] prints it for people.
//!
//! A [`collection`] keeps every control step of its episodes, as a data set for learners.
//!
//! Tasks themselves are evaluated, too: [`testing`] plays the tests in task files, searches for exploits and mutates tasks; [`probe`]
//! runs the lints that need the body.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod collection;
pub mod compare;
mod desk;
mod episode_set;
mod feed;
mod journal;
mod merge;
pub mod metrics;
pub mod npz;
mod order;
pub mod probe;
mod record;
pub mod recordings;
pub mod report;
mod resumed;
mod rollout;
mod room;
pub mod session;
mod settings;
mod shard;
mod statistics;
mod summary;
pub mod sweep;
pub mod testing;
mod to_horizon;
mod together;
pub mod trace;
mod tracing;
mod worker;

pub use episode_set::{EpisodeSet, Job};
pub use feed::{Fed, Feed, ReplayError, replay, replay_watched};
pub use journal::{Journal, JournalError, Kept};
pub use merge::{MergeError, Merged, merge};
pub use record::{ByTerm, EpisodeRecord};
pub use resumed::Resumed;
pub use room::{MOST_BYTES, NoRoom, ensure_room};
pub use settings::{BUILD, Protocol, RunSettings, TaskSettings};
pub use shard::{Shard, ShardError};
pub use statistics::{Moments, Spread, wilson_interval};
pub use summary::{FamilySummary, GroupSummary, MetricSummary, StandardSummary, Summarizer, Summary, TaskSummary, TermSummary};
pub use to_horizon::{ToHorizon, play_to_horizon};
pub use tracing::{TRACES, TraceRecorder, Tracing};

use metrics::Measurement;
use msk_program::task::CompiledTask;
use msk_runtime::episode::{Engine, Environment, EpisodeError, EpisodeKey};
use msk_runtime::library::BoundBody;
use msk_runtime::perturbation::Perturbation;
use msk_runtime::policy::{Policy, PolicyError, PolicySource};
use record::Tally;
use rollout::Rollout;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use worker::Crew;

/// A task and the body it runs on.
#[derive(Clone)]
pub struct Trial {
    /// The task.
    pub task: Arc<CompiledTask>,
    /// Its body.
    pub body: BoundBody,
    /// What its episodes have to stand beside what the task draws itself.
    pub perturbation: Perturbation,
}

/// What is to be run.
#[derive(Clone)]
pub struct Plan {
    /// The tasks, in the order of the report.
    pub trials: Vec<Trial>,
    /// What acts.
    pub policy: PolicySource,
    /// Episodes and seed.
    pub protocol: Protocol,
    /// Which of these episodes; the others are played elsewhere, and [`merge`] joins them.
    pub shard: Shard,
}

/// Looks on while episodes run; called from all workers.
pub trait Watcher: Sync {
    /// A control step has been taken.
    fn stepped(&self);
    /// An episode of the plan's task number `trial` has ended and stands in the journal.
    fn ended(&self, trial: usize, record: &EpisodeRecord);
    /// The policy cannot act on the plan's task number `trial`. Called once for each such task.
    fn skipped(&self, trial: usize, reason: &str);
}

/// Why an evaluation could not go on. Faults within an episode are not among these: they are results.
#[derive(Debug, thiserror::Error)]
pub enum EvaluationError {
    /// The policy does not exist or cannot act.
    #[error(transparent)]
    Policy(#[from] PolicyError),
    /// A task does not fit its body.
    #[error(transparent)]
    Episode(#[from] EpisodeError),
    /// An ended episode could not be kept.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A trace that does not fit into an archive.
    #[error("a trace cannot be kept")]
    Trace(#[from] trace::ArchiveError),
    /// An episode of which more would be kept than fits into memory.
    #[error(transparent)]
    Room(#[from] NoRoom),
    /// The operating system gives no threads.
    #[error("cannot start {threads} threads")]
    Threads {
        /// As many as were asked for.
        threads: NonZeroUsize,
        /// The reason.
        source: rayon::ThreadPoolBuildError,
    },
}

/// What may go along with an evaluation.
#[derive(Clone, Copy, Default)]
pub struct Extras<'a> {
    /// Weights that may change at the beginning of every episode.
    pub feed: Option<&'a dyn Feed>,
    /// Traces that are kept.
    pub tracing: Option<&'a Tracing>,
}

/// What [`run`] brings back.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// All episodes of the journal, summed up, with the tasks that the policy cannot act on.
    pub summary: Summary,
    /// Whether some of the plan's other episodes are still missing because `stop` was set.
    pub interrupted: bool,
}

/// Plays the episodes of `plan` that are not among those `resumed`, on `threads` workers, and appends each to `journal`.
///
/// When `stop` becomes true the workers give up their present episodes within one control step. A task that the policy
/// cannot act on is skipped, with the reason in the outcome.
///
/// # Errors
/// A policy that does not exist, a task that does not fit its body, or a journal that cannot be written; the first error stops
/// all workers.
pub fn run(
    plan: &Plan,
    resumed: Resumed,
    journal: &Journal,
    threads: NonZeroUsize,
    stop: &AtomicBool,
    watcher: &dyn Watcher,
) -> Result<Outcome, EvaluationError> {
    run_with(plan, resumed, journal, threads, stop, watcher, Extras::default())
}

/// [`run`] with live weights, and with traces of episodes.
///
/// Traces of episodes that are resumed are made by playing these once more, where they are missing.
///
/// # Errors
/// Those of [`run`].
pub fn run_with(
    plan: &Plan,
    resumed: Resumed,
    journal: &Journal,
    threads: NonZeroUsize,
    stop: &AtomicBool,
    watcher: &dyn Watcher,
    extras: Extras<'_>,
) -> Result<Outcome, EvaluationError> {
    let crew = Crew::new(plan, resumed, threads, (journal, stop), watcher, extras)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.get())
        .build()
        .map_err(|source| EvaluationError::Threads { threads, source })?;
    pool.broadcast(|_| crew.work());
    let outcome = crew.outcome()?;
    if !outcome.interrupted {
        journal.complete()?;
        if let Some(tracing) = extras.tracing {
            tracing::complete(plan, tracing, journal, stop)?;
        }
    }
    Ok(outcome)
}

/// Plays the episode `key` of `trial`, in the memory of `episode`, under `policy`.
///
/// Gives `None` if `stop` became true before the end. `stepped` is called after every control step.
///
/// # Errors
/// The policy cannot act.
pub fn play(
    trial: &Trial,
    episode: &mut Environment,
    key: EpisodeKey,
    policy: &mut dyn Policy,
    stop: &AtomicBool,
    stepped: impl Fn(),
) -> Result<Option<EpisodeRecord>, EvaluationError> {
    let mut watch = |environment: &Environment| {
        if environment.steps() > 0 {
            stepped();
        }
    };
    play_watched(trial, episode, key, policy, stop, &mut watch)
}

/// [`play`] with a look at the environment after its reset and after every control step.
///
/// # Errors
/// The policy cannot act.
pub fn play_watched(
    trial: &Trial,
    episode: &mut Environment,
    key: EpisodeKey,
    policy: &mut dyn Policy,
    stop: &AtomicBool,
    watch: &mut dyn FnMut(&Environment),
) -> Result<Option<EpisodeRecord>, EvaluationError> {
    let start = Instant::now();
    let mut rollout = Rollout::reset(episode, key, policy)?;
    let mut tally = Tally::new(&trial.task);
    let mut measurement = Measurement::new(rollout.episode.engine());
    measurement.look(&rollout.episode.context());
    watch(rollout.episode);
    while rollout.episode.ending().is_none() {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        rollout.step::<EvaluationError>()?;
        tally.add(rollout.episode.episode());
        measurement.look(&rollout.episode.context());
        watch(rollout.episode);
    }
    let record = tally.record(trial, episode.episode(), policy.name(), start.elapsed().as_secs_f64());
    Ok(Some(measurement.note(record)))
}

impl Plan {
    /// The number of episodes of the plan.
    pub fn episodes(&self) -> u64 {
        self.shard.among((self.trials.len() as u64).saturating_mul(self.protocol.episodes))
    }

    /// The number of those of its task number `trial`.
    pub fn episodes_of(&self, trial: usize) -> u64 {
        self.shard.of_task(trial, self.protocol.episodes)
    }
}

impl RunSettings {
    /// The place among the tasks of the one that `record` is an episode of.
    pub fn place(&self, record: &EpisodeRecord) -> Option<usize> {
        self.tasks.iter().position(|task| task.owns(record))
    }
}

impl Trial {
    /// Of a task on its body, unperturbed.
    pub fn new(task: Arc<CompiledTask>, body: BoundBody) -> Self {
        Self { task, body, perturbation: Perturbation::default() }
    }

    /// What its episodes are played with.
    ///
    /// # Errors
    /// A task that does not fit the body.
    pub fn engine(&self) -> Result<Engine, EpisodeError> {
        let engine = Engine::new(self.body.model.clone(), self.body.body.clone(), self.task.clone())?;
        Ok(engine.with_fatigue(self.body.condition.fatigue.clone()).with_perturbation(self.perturbation.clone()))
    }

    /// A new episode of this trial.
    ///
    /// # Errors
    /// A task that does not fit the body.
    pub fn episode(&self) -> Result<Environment, EpisodeError> {
        Ok(Environment::of(self.engine()?))
    }
}

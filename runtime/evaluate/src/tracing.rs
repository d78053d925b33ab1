//! Traces of the episodes of an evaluation, one file each beside the journal.

use crate::trace::{Origin, Quantity, StepReader, Trace};
use crate::{EpisodeRecord, EvaluationError, Journal, NoRoom, Plan, RunSettings, Trial, play_watched};
use msk_runtime::episode::{Ending, Engine, Environment, EpisodeKey};
use msk_runtime::policy::PolicyContext;
use std::sync::atomic::{AtomicBool, Ordering};

/// The folder of traces, in that of the results.
pub const TRACES: &str = "traces";

/// Which traces an evaluation keeps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tracing {
    /// Their columns.
    pub quantities: Vec<Quantity>,
    /// Episodes of each task that have one: the first so many.
    pub episodes: u64,
}

impl Tracing {
    /// The name of an episode's trace in the folder of the results.
    pub fn file(task: &str, episode: u64) -> String {
        format!("{TRACES}/{task}-{episode:04}.npz")
    }
}

/// Keeps every step of an episode, if that is wanted.
pub struct TraceRecorder {
    recorded: Option<(StepReader, Trace)>,
    /// Rows so far.
    rows: u32,
}

impl TraceRecorder {
    /// Of the next episode of an engine, kept as a trace if `tracing` wants it.
    ///
    /// # Errors
    /// A trace that would not fit into memory if the episode reached its horizon.
    pub fn new(engine: &Engine, episode: u64, tracing: Option<&Tracing>) -> Result<Self, NoRoom> {
        let mut recorded = None;
        if let Some(tracing) = tracing.filter(|tracing| episode < tracing.episodes) {
            let reader = StepReader::new(engine, &tracing.quantities);
            reader.layout().ensure_room(engine.task(), engine.task().horizon)?;
            let trace = Trace::new(reader.layout().clone());
            recorded = Some((reader, trace));
        }
        Ok(Self { recorded, rows: 0 })
    }

    /// Reads the reset or the step that has just been taken. A step that met a fault has no numbers and is left out.
    pub fn look(&mut self, context: &PolicyContext<'_>) {
        let Some((reader, trace)) = &mut self.recorded else { return };
        if context.step == self.rows && !matches!(context.episode.ending(), Some(Ending::Fault(_))) {
            self.rows += 1;
            trace.push(&reader.read(context));
        }
    }

    /// The trace, if there is one.
    pub fn finish(self, record: &EpisodeRecord) -> Option<Trace> {
        let (_, mut trace) = self.recorded?;
        trace.origin = Origin::of(record);
        Some(trace)
    }
}

/// Keeps a trace beside the journal: it is on the disk, whole, before the line of its episode is.
pub(super) fn keep(journal: &Journal, trace: &Trace) -> Result<(), EvaluationError> {
    let name = Tracing::file(&trace.origin.task, trace.origin.episode);
    Ok(journal.write_below(&name, trace.archive()?)?)
}

/// Makes the traces that are missing of episodes that were played before, by playing these once more with the weights that rewarded
/// them.
pub(super) fn complete(plan: &Plan, tracing: &Tracing, journal: &Journal, stop: &AtomicBool) -> Result<(), EvaluationError> {
    let settings = RunSettings::of(plan);
    Journal::try_each(journal.folder(), |record| {
        let wanted = record.episode < tracing.episodes && !journal.has(&Tracing::file(&record.task, record.episode));
        let trial = settings.place(&record).filter(|_| wanted && !stop.load(Ordering::Relaxed)).map(|place| &plan.trials[place]);
        trial.map_or(Ok(()), |trial| repeat(plan, trial, &record, tracing, journal, stop))
    })
}

/// Plays an episode once more and keeps its trace, unless `stop` becomes true.
fn repeat(
    plan: &Plan,
    trial: &Trial,
    record: &EpisodeRecord,
    tracing: &Tracing,
    journal: &Journal,
    stop: &AtomicBool,
) -> Result<(), EvaluationError> {
    let mut environment = trial.episode()?;
    for (term, (_, weight)) in record.weights.0.iter().enumerate() {
        environment.set_weight(term, *weight);
    }
    let mut recorder = TraceRecorder::new(environment.engine(), record.episode, Some(tracing))?;
    let mut policy = plan.policy.open(stop)?;
    let key = EpisodeKey { seed: record.seed, episode: record.episode };
    let mut look = |environment: &Environment| recorder.look(&environment.context());
    let Some(played) = play_watched(trial, &mut environment, key, policy.as_mut(), stop, &mut look)? else { return Ok(()) };
    recorder.finish(&played).map_or(Ok(()), |trace| keep(journal, &trace))
}

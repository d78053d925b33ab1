//! What a step of many episodes gives: flat arrays, one row per slot, and the episodes that ended.

use super::super::{Ending, Episode, EpisodeKey};

/// The outcome of a step, or of a reset, of all slots. Arrays are in the order of the slots; they keep their memory from step to
/// step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VectorStep {
    /// The observations from which the next actions follow, slot after slot, in the order and units of the task's channels. After
    /// an episode has ended this is the first observation of the next one with [`AutoresetMode::SameStep`], else its last one.
    ///
    /// [`AutoresetMode::SameStep`]: super::AutoresetMode::SameStep
    pub observations: Vec<f64>,
    /// What only a critic sees beside them, slot after slot, in the order and units of the task's critic channels; empty without any.
    pub critic_observations: Vec<f64>,
    /// The rewards of this step; 0 for a reset, a step that met a fault, and a slot whose episode had ended.
    pub rewards: Vec<f64>,
    /// Whether the task ended the episode so that what would follow has no value: by a failure, or by a reason to finish unless the task
    /// says `bootstrap` beside it.
    pub terminated: Vec<bool>,
    /// Whether the horizon, a fault of the computation, or a reason to finish beside which the task says `bootstrap` ended the episode: a
    /// learner values what would have followed by the last observation.
    pub truncated: Vec<bool>,
    /// Whether an episode ended in this step. `ends` tells which and how.
    pub ended: Vec<bool>,
    /// The last observations of the episodes that ended in this step, in the rows of their slots; other rows hold older numbers.
    pub final_observations: Vec<f64>,
    /// What only a critic saw of these, likewise.
    pub final_critic_observations: Vec<f64>,
    /// The episodes that ended in this step, by slot.
    pub ends: Vec<EpisodeEnd>,
}

/// An episode that has ended.
#[derive(Debug, Clone, PartialEq)]
pub struct EpisodeEnd {
    /// Where it was played.
    pub slot: usize,
    /// Which episode it was.
    pub key: EpisodeKey,
    /// How it ended.
    pub ending: Ending,
    /// Whether the task's success holds at its last step.
    pub success: bool,
    /// Its length in control steps.
    pub steps: u32,
    /// Its return: the sum of its rewards.
    pub total: f64,
    /// What each term added to the return, in the task's order.
    pub totals: Vec<f64>,
    /// Unweighted value of each term at its last step, in the task's order; none after a fault.
    pub terms: Vec<f64>,
    /// The task's metrics at its last step, laid out by [`CompiledTask::metrics`].
    ///
    /// [`CompiledTask::metrics`]: msk_program::task::CompiledTask::metrics
    pub metrics: Vec<f64>,
}

impl EpisodeEnd {
    /// Of an episode that has ended; `None` of one that goes on.
    pub fn of(slot: usize, episode: &Episode) -> Option<Self> {
        let ending = episode.ending.clone()?;
        Some(Self {
            slot,
            key: episode.key,
            success: episode.report.success,
            steps: episode.task.step,
            total: episode.total,
            totals: episode.totals.clone(),
            terms: episode.report.terms.clone(),
            metrics: episode.report.metrics.clone(),
            ending,
        })
    }
}

impl VectorStep {
    pub(super) fn new(slots: usize, [width, critic]: [usize; 2]) -> Self {
        Self {
            observations: vec![0.0; slots * width],
            critic_observations: vec![0.0; slots * critic],
            rewards: vec![0.0; slots],
            terminated: vec![false; slots],
            truncated: vec![false; slots],
            ended: vec![false; slots],
            final_observations: vec![0.0; slots * width],
            final_critic_observations: vec![0.0; slots * critic],
            ends: Vec::new(),
        }
    }

    /// Writes the observations in single precision, as networks read them; what is too large for it becomes its largest number.
    pub fn observations_f32(&self, out: &mut [f32]) {
        for (single, value) in out.iter_mut().zip(&self.observations) {
            *single = single_precision(*value);
        }
    }
}

/// A number in single precision; what is finite stays finite.
pub fn single_precision(value: f64) -> f32 {
    let narrow = value as f32;
    if narrow.is_infinite() && value.is_finite() { f32::MAX.copysign(narrow) } else { narrow }
}

//! Weights that may change while an evaluation runs, and playing an episode again as it was.

use super::{ByTerm, EpisodeRecord, EvaluationError, Trial, play_watched};
use msk_program::task::CompiledTask;
use msk_runtime::episode::{Environment, EpisodeKey};
use msk_runtime::policy;
use std::sync::atomic::AtomicBool;

/// Where weights come from: asked once before each episode, from all workers. Within an episode they never change.
pub trait Feed: Sync {
    /// The weights in force for a task now.
    fn weights(&self, task: &CompiledTask) -> Fed;
}

/// Weights with the version that they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Fed {
    /// Names the version; results carry it.
    pub version: String,
    /// One for each term of the task.
    pub weights: Vec<f64>,
}

impl Fed {
    /// Uses these weights for the reward of the next episode.
    pub fn apply(&self, episode: &mut Environment) {
        for (term, weight) in self.weights.iter().enumerate() {
            episode.set_weight(term, *weight);
        }
    }

    /// Notes in a record that its episode was rewarded with these weights.
    pub fn note(&self, trial: &Trial, record: &mut EpisodeRecord) {
        let names = trial.task.terms.iter().map(|term| term.name.clone());
        record.weights_version.clone_from(&self.version);
        record.weights = ByTerm(names.zip(self.weights.iter().copied()).collect());
    }
}

/// Why an episode cannot be played again.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// It is an episode of something else.
    #[error("the record is of another {what}: {there} in the record, {here} here")]
    Other {
        /// Task, body, or terms.
        what: &'static str,
        /// In the record.
        there: String,
        /// Of the trial.
        here: String,
    },
    /// A parameter of it is not one of the task.
    #[error("the record has a parameter that the task does not accept: {0}")]
    Parameter(String),
    /// It cannot be played at all.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
}

/// Plays the episode of `record` once more, with the weights that rewarded it. But for its wall time the record that
/// comes back equals the first, bit for bit.
///
/// # Errors
/// A trial that is not the record's, or a policy that cannot act.
pub fn replay(trial: &Trial, record: &EpisodeRecord) -> Result<EpisodeRecord, ReplayError> {
    replay_watched(trial, record, &mut |_| {})
}

/// [`replay`] with a look at the environment after its reset and after every control step.
///
/// # Errors
/// Those of [`replay`].
pub fn replay_watched(
    trial: &Trial,
    record: &EpisodeRecord,
    watch: &mut dyn FnMut(&Environment),
) -> Result<EpisodeRecord, ReplayError> {
    let same = |what: &'static str, there: &str, here: &str| match there == here {
        true => Ok(()),
        false => Err(ReplayError::Other { what, there: there.to_owned(), here: here.to_owned() }),
    };
    same("task", &record.task, &trial.task.name)?;
    same("source text of the task", &record.task_hash, &trial.task.hash)?;
    same("body", &record.model_hash, trial.body.hash())?;
    let mut episode = trial.episode().map_err(EvaluationError::from)?;
    let fed =
        Fed { version: record.weights_version.clone(), weights: record.weights.0.iter().map(|(_, weight)| *weight).collect() };
    let live = !record.weights.is_empty();
    if live {
        let names = |names: Vec<&str>| names.join(", ");
        let there = names(record.weights.0.iter().map(|(name, _)| name.as_str()).collect());
        let here = names(trial.task.terms.iter().map(|term| term.name.as_str()).collect());
        same("list of terms", &there, &here)?;
        fed.apply(&mut episode);
    }
    for (name, value) in &record.parameters.0 {
        episode.set_parameter(name, *value).map_err(|error| ReplayError::Parameter(error.to_string()))?;
    }
    let mut policy = policy::create(&record.policy).map_err(EvaluationError::from)?;
    let key = EpisodeKey { seed: record.seed, episode: record.episode };
    let played = play_watched(trial, &mut episode, key, policy.as_mut(), &AtomicBool::new(false), watch)?;
    // It is never interrupted.
    let mut again = played.unwrap_or_else(|| record.clone());
    if live {
        fed.note(trial, &mut again);
    }
    Ok(again)
}

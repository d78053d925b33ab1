//! Recorded episodes, and what is learned from them: by imitation, or by an off-policy learner beside what it plays itself (RLPD: Ball,
//! Smith, Kostrikov and Levine 2023, arXiv 2302.02948).

use crate::error::TrainError;
use crate::play::Play;
use crate::replay::Replay;
use crate::settings::Settings;
use crate::teaching::Labels;
use msk_program::digest::hexadecimal;
use msk_runtime::episode::{Engine, single_precision};
use msk_runtime::policy::ActsOn;
use sha2::{Digest, Sha256};

/// Recorded episodes.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSet {
    /// What tells it from others, in words.
    pub name: String,
    /// Which entries its actions have.
    pub acts_on: ActsOn,
    /// One after the other.
    pub episodes: Vec<RecordedEpisode>,
}

/// What was seen and done in an episode, control step by control step.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedEpisode {
    /// One row after the other, as wide as the observation of the task: what each action answered to, and what came of the last one.
    pub observations: Vec<f32>,
    /// One action after the other.
    pub actions: Vec<f64>,
    /// What came of them: without it an episode can only be imitated.
    pub outcome: Option<RecordedOutcome>,
}

/// What came of the actions of an episode.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedOutcome {
    /// Rows that critics see beside those of the policy, as many of them.
    pub critic_observations: Vec<f32>,
    /// Of each step the value of every term before its weight.
    pub values: Vec<f64>,
    /// Whether the episode ended so that what would have followed has no value.
    pub terminated: bool,
}

impl DataSet {
    /// Of a place; results tell two of one place apart.
    pub fn new(place: &str, acts_on: ActsOn, episodes: Vec<RecordedEpisode>) -> Self {
        let mut hasher = Sha256::new();
        for RecordedEpisode { observations, actions, outcome } in &episodes {
            observations.iter().for_each(|value| hasher.update(value.to_bits().to_le_bytes()));
            actions.iter().for_each(|value| hasher.update(value.to_bits().to_le_bytes()));
            if let Some(RecordedOutcome { critic_observations, values, terminated }) = outcome {
                critic_observations.iter().for_each(|value| hasher.update(value.to_bits().to_le_bytes()));
                values.iter().for_each(|value| hasher.update(value.to_bits().to_le_bytes()));
                hasher.update([u8::from(*terminated)]);
            }
        }
        let name = format!("{place} ({})", hexadecimal(&hasher.finalize()[..4]));
        Self { name, acts_on, episodes }
    }

    /// The steps of one of its episodes: what was seen, and what was done, rows being so wide and actions having so many entries.
    ///
    /// # Errors
    /// Not one more row than actions.
    pub(crate) fn steps<'a>(
        &self,
        episode: &'a RecordedEpisode,
        [width, entries]: [usize; 2],
    ) -> Result<impl Iterator<Item = (&'a [f32], &'a [f64])> + use<'a>, TrainError> {
        let rows = episode.observations.chunks_exact(width.max(1));
        let actions = episode.actions.chunks_exact(entries.max(1));
        let whole = rows.remainder().is_empty() && actions.remainder().is_empty();
        if !whole || rows.len() != actions.len() + 1 {
            return Err(self.refuse("has an episode in which there is not one observation more than actions"));
        }
        Ok(rows.zip(actions))
    }

    /// Its actions as entries of the task's action space.
    ///
    /// # Errors
    /// Actions from which no entries follow.
    pub(crate) fn labels(&self, engine: &Engine) -> Result<Labels, TrainError> {
        let labels = Labels::of(engine, self.acts_on).map_err(|reason| self.refuse(reason))?;
        if labels.need_activations(self.acts_on) {
            return Err(self.refuse("acts on muscles, and does not say to which activations: name who acted as the teacher"));
        }
        Ok(labels)
    }

    /// The error that it cannot be learned from, in words that continue its name.
    fn refuse(&self, reason: impl Into<String>) -> TrainError {
        TrainError::Data { name: self.name.clone(), reason: reason.into() }
    }

    /// Its transitions, one from every control step on: what the mean of the actions in the time that an action of the learner lasts for
    /// has come to.
    ///
    /// # Errors
    /// Episodes of another shape, without outcome, or too many of them for the memory.
    fn add_to(&self, replay: &mut Replay, engine: &Engine, play: &mut Play, settings: &Settings) -> Result<(), TrainError> {
        let labels = self.labels(engine)?;
        let ([whole, width], entries, terms) = (play.widths(), play.entries(), play.terms());
        let size = self.acts_on.size(engine.task(), engine.body());
        let later = single_precision(settings.action_discount());
        for episode in &self.episodes {
            let mut asked = Vec::new();
            self.steps(episode, [width, size])?.for_each(|(_, action)| labels.write(self.acts_on, action, &mut asked));
            let steps = asked.len() / entries;
            let Some(outcome) = &episode.outcome else {
                return Err(
                    self.refuse("does not say what its actions came to: it can be imitated only, by the algorithm `clone`")
                );
            };
            let more = whole - width;
            if outcome.critic_observations.len() != (steps + 1) * more || outcome.values.len() != steps * terms {
                return Err(self.refuse("has an episode with other critic observations or terms than the task"));
            }
            let rows: Vec<Vec<f64>> = (0..=steps)
                .map(|step| {
                    let seen = &episode.observations[step * width..(step + 1) * width];
                    let critic = &outcome.critic_observations[step * more..(step + 1) * more];
                    seen.iter().chain(critic).map(|value| f64::from(*value)).collect()
                })
                .collect();
            rows.iter().for_each(|row| play.saw(row));
            for first in 0..steps {
                let end = steps.min(first + settings.action_repeat);
                let action = mean(&asked[first * entries..end * entries], entries);
                let values = sum(&outcome.values[first * terms..end * terms], terms);
                let ends = outcome.terminated && end == steps;
                let discount = if ends { 0.0 } else { later };
                replay.push(&rows[first], &action, &rows[end], &values, discount);
            }
        }
        Ok(())
    }
}

/// The transitions of all data sets, none of which is ever forgotten; `None` without any.
///
/// # Errors
/// A data set that cannot be learned from.
pub(crate) fn transitions(
    data: &[DataSet],
    engine: &Engine,
    play: &mut Play,
    settings: &Settings,
) -> Result<Option<Replay>, TrainError> {
    let Some(first) = data.first() else { return Ok(None) };
    let entries_of = |set: &DataSet| set.acts_on.size(engine.task(), engine.body()).max(1);
    let steps_of = |set: &DataSet| set.episodes.iter().map(|episode| episode.actions.len() / entries_of(set)).sum::<usize>();
    let count: usize = data.iter().map(steps_of).sum();
    if count == 0 {
        return Err(first.refuse("has no episodes"));
    }
    let mut replay = Replay::with_room(settings, count, [play.widths()[0], play.entries(), play.terms()]);
    if replay.room() < count {
        return Err(first.refuse(format!(
            "and those beside it have {count} transitions, and there is memory for {}: raise `replay_memory`",
            replay.room()
        )));
    }
    for set in data {
        set.add_to(&mut replay, engine, play, settings)?;
    }
    Ok(Some(replay))
}

/// The mean of rows of so many numbers.
fn mean(rows: &[f32], width: usize) -> Vec<f32> {
    let count = (rows.len() / width) as f64;
    let column = |index: usize| rows.iter().skip(index).step_by(width).map(|value| f64::from(*value)).sum::<f64>();
    (0..width).map(|index| single_precision(column(index) / count)).collect()
}

/// The sum of rows of so many numbers.
fn sum(rows: &[f64], width: usize) -> Vec<f64> {
    (0..width).map(|index| rows.iter().skip(index).step_by(width).sum()).collect()
}

//! The arrays of an episode, and what their columns are.

use super::ActionRecorder;
use crate::EpisodeRecord;
use crate::npz::NpzWriter;
use crate::room::{NoRoom, ensure_room};
use msk_program::task::Channel;
use msk_runtime::episode::{Environment, single_precision};
use msk_runtime::policy::{ActsOn, Policy};
use serde_json::{Value, json};
use std::io::{self, Cursor};

/// The file that names the columns.
pub const LAYOUT: &str = "data.json";

/// What an episode was, step by step: row i of `observations` is what action i answers to, so there is one more of them.
#[derive(Default)]
pub struct Recording {
    observations: Vec<f32>,
    critic: Vec<f32>,
    rewards: Vec<f64>,
    terms: Vec<f64>,
    /// Columns of each.
    widths: [usize; 3],
    steps: usize,
    terminates: bool,
    truncates: bool,
}

impl Recording {
    /// Checks that there is room for an episode that reaches its horizon under a policy that acts on so much.
    ///
    /// # Errors
    /// More than [`MOST_BYTES`](crate::MOST_BYTES).
    pub fn ensure_room(environment: &Environment, acts_on: ActsOn) -> Result<(), NoRoom> {
        let task = environment.task();
        let singles = environment.observation().len() + environment.critic_observation().len();
        let doubles = 1 + environment.weights().len() + acts_on.size(task, environment.engine().body());
        ensure_room(task, task.horizon, singles * size_of::<f32>() + doubles * size_of::<f64>())
    }

    /// Takes down what the last control step has come to, or the reset.
    pub fn look(&mut self, environment: &Environment) {
        let report = environment.report();
        // Learners take observations in single precision.
        self.observations.extend(environment.observation().iter().copied().map(single_precision));
        self.critic.extend(environment.critic_observation().iter().copied().map(single_precision));
        let [observation, critic] = [environment.observation(), environment.critic_observation()].map(<[f64]>::len);
        self.widths = [observation, critic, environment.weights().len()];
        if environment.steps() == 0 {
            return;
        }
        self.steps += 1;
        self.rewards.push(report.reward);
        // A fault leaves no report.
        let contribution = environment.last_weights().iter().zip(&report.terms).map(|(weight, value)| weight * value);
        self.terms.extend(contribution.chain(std::iter::repeat(0.0)).take(environment.weights().len()));
        // As vector environments have it: a learner values what would have followed a truncation.
        let bootstraps = environment.ending().map(|ending| ending.bootstraps(environment.task()));
        (self.terminates, self.truncates) = (bootstraps == Some(false), bootstraps == Some(true));
    }

    /// The arrays as a NumPy archive, with the actions of all steps.
    ///
    /// # Errors
    /// More than an archive holds.
    pub fn archive(&self, (actions, width): (&[f64], usize), record: &EpisodeRecord) -> io::Result<Vec<u8>> {
        let [observation, critic, terms] = self.widths;
        let rows = self.steps;
        let last = |ends: bool| (0..rows).map(|step| ends && step + 1 == rows).collect::<Vec<bool>>();
        let mut archive = NpzWriter::new(Cursor::new(Vec::new()));
        archive.array("observations", &self.observations, &[rows + 1, observation])?;
        if critic > 0 {
            archive.array("critic_observations", &self.critic, &[rows + 1, critic])?;
        }
        // In a step that met a fault the policy has acted, but nothing has come of it.
        let actions = actions.get(..rows * width).unwrap_or(actions);
        archive.array("actions", actions, &[rows, width])?;
        archive.array("rewards", &self.rewards, &[rows])?;
        archive.array("terms", &self.terms, &[rows, terms])?;
        archive.array("terminations", &last(self.terminates), &[rows])?;
        archive.array("truncations", &last(self.truncates), &[rows])?;
        archive.array("success", &[record.success], &[1])?;
        Ok(archive.finish()?.into_inner())
    }
}

/// What the columns are, as JSON.
///
/// # Errors
/// Numbers that JSON does not have.
pub fn layout(environment: &Environment, policy: &ActionRecorder<'_>) -> serde_json::Result<String> {
    let task = environment.task();
    let part = |channel: &Channel| {
        let Channel { name, offset, size, unit } = channel;
        json!({ "name": name, "offset": offset, "size": size, "unit": unit })
    };
    let body = environment.engine().body();
    let (acts_on, actions): (&str, Vec<String>) = match policy.acts_on() {
        ActsOn::Task => ("task", task.action.names(&task.vocabulary)),
        ActsOn::Muscles => ("muscles", body.muscles.iter().map(|muscle| muscle.name.clone()).collect()),
    };
    let terms = task.terms.iter().zip(environment.weights());
    let terms: Vec<Value> = terms.map(|(term, weight)| json!({ "name": term.name, "weight": weight })).collect();
    let layout = json!({
        "task": task.name,
        "task_hash": task.hash,
        "policy": policy.name(),
        "control_frequency": task.control_frequency,
        "observations": task.channels.iter().map(part).collect::<Vec<_>>(),
        "critic_observations": task.critic.iter().map(part).collect::<Vec<_>>(),
        "acts_on": acts_on,
        "actions": actions,
        "terms": terms,
    });
    Ok(serde_json::to_string_pretty(&layout)? + "\n")
}

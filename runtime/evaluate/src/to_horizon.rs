//! An episode beyond its ends: whether the physics goes on for the whole horizon, whatever the body does by then.

use super::EvaluationError;
use super::rollout::Rollout;
use msk_physics::scalar::Real;
use msk_runtime::episode::{Ending, Environment, EpisodeKey};
use msk_runtime::policy::Policy;

/// What came of an episode that was played on to its horizon.
#[derive(Debug, Clone, PartialEq)]
pub struct ToHorizon {
    /// When the task would have ended it for the first time, control steps, and how; `None` if it never would.
    pub first: Option<(u32, Ending)>,
    /// Control steps in all.
    pub steps: u32,
    /// The fault that stopped it.
    pub fault: Option<String>,
    /// How deep two shapes have overlapped at the end of a control step at most, m.
    pub deepest: f64,
    /// How fast the root has gone at most, m/s; 0 for a body fixed to the world.
    pub fastest: f64,
}

/// Plays the episode `key` up to its horizon or to a fault, whatever ends the task has for it. `watch` looks at the environment after
/// its reset and after every control step.
///
/// # Errors
/// The policy cannot act.
pub fn play_to_horizon(
    episode: &mut Environment,
    key: EpisodeKey,
    policy: &mut dyn Policy,
    watch: &mut dyn FnMut(&Environment),
) -> Result<ToHorizon, EvaluationError> {
    let mut rollout = Rollout::reset(episode, key, policy)?;
    let mut found = ToHorizon { first: None, steps: 0, fault: None, deepest: 0.0, fastest: 0.0 };
    watch(rollout.episode);
    while rollout.episode.ignore_termination() {
        rollout.step::<EvaluationError>()?;
        found.look(rollout.episode);
        watch(rollout.episode);
    }
    found.steps = episode.steps();
    if let Some(Ending::Fault(fault)) = episode.ending() {
        found.fault = Some(fault.to_string());
    }
    Ok(found)
}

impl ToHorizon {
    fn look(&mut self, episode: &Environment) {
        if let (None, Some(ending)) = (&self.first, episode.ending().filter(|ending| ending.is_of_task())) {
            self.first = Some((episode.steps(), ending.clone()));
        }
        let context = episode.context();
        let contacts = context.workspace.lanes.first().map(|lane| &lane.constraints.contacts);
        let depths = contacts.into_iter().flatten().map(|contact| -contact.distance);
        self.deepest = depths.fold(self.deepest, Real::at_least);
        if let Some((_, dof)) = context.body.root.free {
            let speed = context.state.velocity[dof..dof + 3].iter().map(|part| part * part).sum::<f64>().sqrt();
            self.fastest = self.fastest.at_least(speed);
        }
    }
}

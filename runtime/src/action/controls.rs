//! An action space outside of its task: for policies that think in other entries than those of the task.

use super::{Action, ActionState, ActsOn};
use crate::cmc::{ControlError, Moment};
use crate::policy::PolicyContext;
use msk_program::action::ActionSpace;
use msk_program::task::CompiledTask;
use std::sync::Arc;

/// What turns the entries of an action space into actions of muscles, for the episodes of a task that may have another space.
///
/// A clone goes on like the original, so that imagined episodes can take it along.
#[derive(Debug, Clone)]
pub struct Controls {
    /// The same task in this action space.
    task: Arc<Tasked>,
    state: ActionState,
    torques: Vec<f64>,
}

/// A task whose debug output is its name.
struct Tasked(CompiledTask);

impl core::fmt::Debug for Tasked {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Tasked").field(&self.0.name).finish()
    }
}

impl Controls {
    /// For the episode of a context, in an action space without torques.
    pub fn new(context: &PolicyContext<'_>, space: ActionSpace) -> Self {
        let task = CompiledTask { action: space, ..context.task.clone() };
        let state = ActionState::new(&task, context.body);
        Self { task: Arc::new(Tasked(task)), state, torques: vec![0.0; context.state.velocity.len()] }
    }

    /// Its action space.
    pub fn space(&self) -> &ActionSpace {
        &self.task.0.action
    }

    /// Prepares for an episode, which has just been reset.
    ///
    /// # Errors
    /// A body or task that the controller of the space cannot control.
    pub fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), ControlError> {
        let Self { task, state, .. } = self;
        state.clear(&task.0.action);
        state.reset(&moment(&task.0, context))
    }

    /// Writes the action of each muscle that `entries` ask for.
    ///
    /// # Errors
    /// It has not been reset.
    pub fn act(&mut self, context: &PolicyContext<'_>, entries: &[f64], muscles: &mut [f64]) -> Result<(), ControlError> {
        let Self { task, state, torques } = self;
        state.take(Action { acts_on: ActsOn::Task, entries }, &moment(&task.0, context), torques)?;
        muscles.copy_from_slice(&state.muscles);
        Ok(())
    }

    /// Lets computed muscle control share forces out roughly from now on, in less time: for imagined episodes.
    pub fn make_rough(&mut self) {
        self.state.make_rough();
    }
}

/// The moment of a context, for a task in another action space.
fn moment<'a>(task: &'a CompiledTask, context: &PolicyContext<'a>) -> Moment<'a> {
    Moment { task, ..context.moment() }
}

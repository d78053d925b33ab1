//! An action space outside of its task: for policies that think in other entries than those of the task.

use super::{Action, ActionState, ActsOn, ControlMemory, Taken};
use crate::cmc::{ControlError, Lead, Tracker};
use crate::policy::PolicyContext;
use msk_program::action::ActionSpace;
use std::sync::Arc;

/// What turns the entries of an action space into actions of muscles, for the episodes of a task that may have another space.
///
/// A clone goes on like the original, so that imagined episodes can take it along.
#[derive(Debug, Clone)]
pub struct Controls {
    space: Arc<ActionSpace>,
    state: ActionState,
    torques: Vec<f64>,
}

impl Controls {
    /// For episodes like that of a context, in an action space without torques.
    pub fn new(context: &PolicyContext<'_>, space: ActionSpace) -> Self {
        let state = ActionState::new(&space, context.body.muscles.len());
        Self { space: Arc::new(space), state, torques: vec![0.0; context.state.velocity.len()] }
    }

    /// Its action space.
    pub fn space(&self) -> &ActionSpace {
        &self.space
    }

    /// Prepares for an episode, which has just been reset, or for what is left of one: the pose, the places of hands and the pace are those of now.
    ///
    /// # Errors
    /// A body or task that the controller of the space cannot control.
    pub fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), ControlError> {
        self.state.clear(&self.space);
        self.state.reset(&context.moment())
    }

    /// Goes on with the demonstration that it follows, where it does, from that time of it, s. To be called before it acts.
    pub fn go_on_from(&mut self, start: f64) {
        if let Some(tracker) = self.state.tracker_mut() {
            tracker.go_on_from(start);
        }
    }

    /// Entries that are kept where an action of this episode gives none.
    pub(crate) fn keep(&mut self, entries: &[f64]) {
        self.state.entries.iter_mut().zip(entries).for_each(|(kept, entry)| *kept = *entry);
    }

    /// Writes the action of each muscle that `entries` ask for, with the memory of a worker for the context's model.
    ///
    /// # Errors
    /// It has not been reset.
    pub fn act(
        &mut self,
        context: &PolicyContext<'_>,
        entries: &[f64],
        control: &mut ControlMemory,
        muscles: &mut [f64],
    ) -> Result<(), ControlError> {
        let taken = self.begin(context, entries, control)?;
        self.state.allocate(&context.moment().present, control);
        self.finish(taken, context, control, muscles);
        Ok(())
    }

    /// The first part of an action: where it asks for forces they are to be shared out before it is finished.
    pub(crate) fn begin(
        &mut self,
        context: &PolicyContext<'_>,
        entries: &[f64],
        control: &mut ControlMemory,
    ) -> Result<Taken, ControlError> {
        self.state.begin(Action { acts_on: ActsOn::Task, entries }, &self.space, &context.moment(), control)
    }

    /// The last part of an action.
    pub(crate) fn finish(&mut self, taken: Taken, context: &PolicyContext<'_>, control: &mut ControlMemory, muscles: &mut [f64]) {
        self.state.finish(taken, &self.space, &context.moment(), control, &mut self.torques);
        muscles.copy_from_slice(&self.state.muscles);
    }

    /// The controller of the space, where there is one.
    pub(crate) fn tracker_mut(&mut self) -> Option<&mut Tracker> {
        self.state.tracker_mut()
    }

    /// Leads activations like that until the next reset.
    pub(crate) fn set_lead(&mut self, lead: Lead) {
        if let Some(tracker) = self.state.tracker_mut() {
            tracker.set_lead(lead);
        }
    }

    /// Lets computed muscle control share forces out roughly from now on, in less time: for imagined episodes.
    pub fn make_rough(&mut self) {
        self.state.make_rough();
    }
}

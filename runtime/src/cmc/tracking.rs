//! What computed muscle control tracks over an episode: the reference motion of the present phase, the script of the demonstration,
//! the pose of the initial state, or a gait, which may lead to the demonstration.

use super::activation::{Hold, Lead};
use super::goal::Course;
use super::{ControlError, ControlScratch, Controller, Offsets, Present};
use crate::script::Script;
use msk_physics::Workspace;
use msk_program::action::Along;
use msk_program::task::{CompiledTask, TaskState};
use std::sync::Arc;

/// One moment of an episode of a task.
#[derive(Clone, Copy)]
pub(crate) struct Moment<'a> {
    pub task: &'a CompiledTask,
    pub progress: &'a TaskState,
    /// Physics steps that an action is held for.
    pub substeps: u32,
    /// In the order and units of the task's channels.
    #[cfg_attr(not(feature = "system"), expect(dead_code, reason = "networks see it, and none is evaluated there"))]
    pub observation: &'a [f64],
    pub present: Present<'a>,
}

/// Computed muscle control over one episode after the other.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tracker {
    controller: Option<Controller>,
    /// What is tracked.
    along: Along,
    /// The phase of the task in which what is followed began, and the step at which it did, where that was not at the reset.
    followed: Option<(u32, u32)>,
    /// What a gait of this episode changes over to.
    then: Option<Course>,
}

impl Tracker {
    pub fn new(along: Along) -> Self {
        Self { along, ..Self::default() }
    }

    /// Goes on with the demonstration that it tracks, where it does, from that time of it, s.
    pub fn go_on_from(&mut self, start: f64) {
        if let Some(controller) = &mut self.controller {
            controller.go_on_from(start);
        }
    }

    /// Prepares for an episode, which has just been reset, or for what is left of one.
    ///
    /// # Errors
    /// A body or task that it cannot control.
    pub fn reset(&mut self, moment: &Moment<'_>) -> Result<(), ControlError> {
        let &Moment { task, progress, substeps, present, .. } = moment;
        let hold = Hold { steps: substeps, timestep: present.model.options.timestep };
        let init = task.initial_state(progress);
        let mut controller = Controller::new(&present, &init.coordinates, hold)?;
        if self.along == Along::Demonstration {
            controller.follow(Some(schedule(moment, 0.0)?), progress.step, &present);
        }
        self.then = None;
        if let Along::Gait { then, .. } = self.along {
            controller.walk(&present)?;
            self.then = then.map(|start| schedule(moment, start)).transpose()?;
        }
        self.controller = Some(controller);
        self.followed = None;
        Ok(())
    }

    /// Shares forces out roughly from now on, in less time: for imagined episodes.
    pub fn make_rough(&mut self) {
        if let Some(controller) = &mut self.controller {
            controller.make_rough();
        }
    }

    /// Leads activations like that from now on, until the next reset.
    pub fn set_lead(&mut self, lead: Lead) {
        if let Some(controller) = &mut self.controller {
            controller.lead = lead;
        }
    }

    /// Asks for the forces of the present control step, with the targets moved by `offsets`. They are then to be
    /// [shared out](Self::allocate).
    ///
    /// # Errors
    /// It has not been reset.
    pub fn ask(&mut self, moment: &Moment<'_>, offsets: &Offsets, scratch: &mut ControlScratch) -> Result<(), ControlError> {
        let &Moment { task, progress, present, .. } = moment;
        let controller = self.controller.as_mut().ok_or(ControlError::NotReset)?;
        let begun = task.followed(progress).map(|(followed, time)| (&followed.motion, time));
        let phase = begun.map(|_| (progress.phase, progress.began));
        if self.along == Along::Reference && phase != self.followed {
            let init = task.initial_state(progress);
            let course = begun.map(|(motion, time)| Course::of_motion(motion, time, &init, present.body, present.state));
            controller.follow(course, progress.step, &present);
            self.followed = phase;
        }
        // It walks no more from then on: there is nothing left to change over to.
        if let Some(course) = self.then.take_if(|_| offsets.changes_over) {
            controller.follow(Some(course), progress.step, &present);
            self.followed = Some((progress.phase, progress.step));
        }
        controller.ask(&present, progress.step, offsets, scratch);
        Ok(())
    }

    /// Shares the forces out that have been asked for.
    pub fn allocate(&mut self, present: &Present<'_>, scratch: &mut ControlScratch) {
        if let Some(controller) = &mut self.controller {
            scratch.allocate(present, controller);
        }
    }

    /// Writes the action that gives the muscles' share, one entry per muscle.
    pub fn give(&self, present: &Present<'_>, scratch: &mut ControlScratch, action: &mut [f64]) {
        if let Some(controller) = &self.controller {
            controller.give(present, scratch, action);
        }
    }

    /// How its actions are held.
    pub(super) fn hold(&self) -> Option<Hold> {
        self.controller.as_ref().map(|controller| controller.hold)
    }

    pub(super) fn controller_mut(&mut self) -> Option<&mut Controller> {
        self.controller.as_mut()
    }
}

/// Two are the same where they go on in the same way.
impl PartialEq for Tracker {
    fn eq(&self, other: &Self) -> bool {
        let (own, others) = (self.controller.as_ref(), other.controller.as_ref());
        (self.along, self.followed) == (other.along, other.followed)
            && own.map(Controller::memory) == others.map(Controller::memory)
    }
}

/// The schedule of poses with which the task's own tests show that it can succeed, from `start` on, s.
fn schedule(moment: &Moment<'_>, start: f64) -> Result<Course, ControlError> {
    let &Moment { task, progress, present: Present { body, model, .. }, .. } = moment;
    let keyframes = task.tests.as_ref().and_then(|tests| tests.demonstration());
    let keyframes = keyframes.ok_or_else(|| ControlError::NoDemonstration { task: task.name.clone() })?;
    let mut scratch = Workspace::new(model);
    let script = Script::new(keyframes, task, progress, model, body, &mut scratch)?;
    Ok(Course::Script { script: Arc::new(script), start, period: 1.0 / task.control_frequency })
}

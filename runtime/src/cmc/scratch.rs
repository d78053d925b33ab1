//! What a worker needs to control a body: memory for one control step, and what depends on the model alone.
//!
//! Nothing in it decides anything: what a later action depends on is in the [`Controller`](super::Controller) of the episode. So
//! thousands of episodes need one of these per worker.

use super::activation::Muscles;
use super::coordinates::Coordinates;
use super::reach::Reaching;
use super::share::{Member, Share};
use super::wishes::Wishes;
use super::{Controller, Present};
use msk_physics::Workspace;

/// Memory of a worker for controllers of one body.
#[derive(Debug, Clone)]
pub(crate) struct ControlScratch {
    pub(super) coordinates: Coordinates,
    pub(super) wishes: Wishes,
    pub(super) muscles: Muscles,
    pub(super) reaching: Reaching,
    /// The activations that each muscle can reach within the hold.
    pub(super) reach: Vec<[f64; 2]>,
    /// What each muscle is asked for: an activation first, then the excitation that brings it there.
    pub(super) asked: Vec<f64>,
    /// For poses of what is followed.
    pub(super) workspace: Workspace<f64>,
    /// For forces that are shared out alone.
    alone: Option<Box<Share<f64>>>,
}

impl ControlScratch {
    /// For the model of an episode.
    pub fn new(present: &Present<'_>) -> Self {
        let &Present { model, body, .. } = present;
        let coordinates = Coordinates::new(model);
        let muscles = model.actuators.muscles().count();
        Self {
            reaching: Reaching::new(model, body, &coordinates),
            coordinates,
            wishes: Wishes::default(),
            muscles: Muscles::new(model),
            reach: vec![[0.0; 2]; muscles],
            asked: vec![0.0; muscles],
            workspace: Workspace::new(model),
            alone: None,
        }
    }

    /// Shares out the forces that a controller has asked for.
    pub(super) fn allocate(&mut self, present: &Present<'_>, controller: &mut Controller) {
        let &Present { body, model, state, workspace } = present;
        let mut alone = self.alone.take().unwrap_or_else(|| Box::new(Share::new(model, body, workspace)));
        let hold = controller.hold.duration();
        alone.solve((model, state, workspace), hold, &mut [self.member(0, controller)]);
        self.alone = Some(alone);
    }

    /// What a controller has asked for, in a lane.
    pub(super) fn member<'a>(&'a mut self, lane: usize, controller: &'a mut Controller) -> Member<'a> {
        let Self { wishes, reach, asked, .. } = self;
        Member { lane, effort: controller.effort, wishes, reach, memory: &mut controller.memory, out: asked }
    }
}

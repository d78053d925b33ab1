//! Imagined episodes: copies of the present one in which a policy that looks ahead tries actions before it takes one.
//!
//! Such a copy knows what has happened and nothing of what chance brings: randoms that are drawn later come from streams of its own,
//! and a force that has not begun to act never does. What was drawn at the reset, a target for example, it knows.

use super::{Engine, Episode, EpisodeError, EpisodeKey, GroupScratch, Streams};
use crate::perturbation::Perturbation;
use msk_physics::Plan;
use msk_physics::model::Model;
use msk_program::task::Disturbance;
use std::sync::Arc;

impl Engine {
    /// The engine of imagined episodes: the task is measured only as far as its reward and its terminations depend on it, and one
    /// physics step takes the time of `coarseness` of this engine's. Their states fit each other.
    ///
    /// # Errors
    /// A control step that is not a whole number of such physics steps.
    pub fn imagining(&self, coarseness: u32) -> Result<Self, EpisodeError> {
        let (task, perturbation) = (Arc::new(self.task.deciding()), Perturbation::default());
        let observes = self.task.action.reads_observation();
        let mut imagined = Self { task, perturbation, observes, ..self.clone() };
        if coarseness > 1 {
            let mut model = Model::clone(&self.model);
            model.options.timestep *= f64::from(coarseness);
            imagined.substeps = super::engine::substeps(&self.task, model.options.timestep)?;
            imagined.plan = Plan::new(&model);
            imagined.model = Arc::new(model);
        }
        Ok(imagined)
    }

    /// Makes `imagined` a copy of `present` that does not know the future. Randoms that are drawn later come from streams that `name`
    /// distinguishes.
    pub fn imagine(&self, present: &Episode, name: &str, imagined: &mut Episode) {
        imagined.clone_from(present);
        let now = present.steps();
        imagined.pushes.iter_mut().chain(&mut imagined.disturbances).for_each(|push| *push = begun(push, now));
        let EpisodeKey { seed, episode } = present.key;
        imagined.streams = Streams::imagined(EpisodeKey { seed, episode }, name, &self.task.randoms);
    }
}

/// What is left of a force that acts in the step before the one after `now` steps and in that one; else one that never acts.
fn begun(push: &Disturbance, now: u32) -> Disturbance {
    let acts = now > 0 && push.acts(now - 1) && push.acts(now) && !push.begins(now);
    // One that begins anew does so in the future.
    let since = if push.every > 0 { now.saturating_sub(push.start) % push.every } else { now.saturating_sub(push.start) };
    let (start, steps) = if acts { (now, push.steps - since) } else { (0, 0) };
    Disturbance { start, steps, every: 0, ..*push }
}

impl Episode {
    /// Lets computed muscle control of its action space, if it has that, share forces out roughly from now on, in less
    /// time.
    pub fn make_rough(&mut self) {
        self.action.make_rough();
    }
}

impl GroupScratch {
    /// Brings the forward pass of a lane to the state of `episode`, which is to be played there; gives whether the physics can.
    pub fn bring(&mut self, lane: usize, engine: &Engine, episode: &Episode) -> bool {
        self.lanes[lane].pass(&engine.model, &episode.state).is_ok()
    }
}

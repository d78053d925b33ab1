//! Forward passes of several environments at once, in the lanes of the simulator: for scripts, which take no steps of physics.

use super::{Engine, Environment};
use crate::body::Body;
use msk_physics::lanes::WIDTH;
use msk_physics::model::Model;
use msk_physics::{LaneGroup, State, Workspace};
use std::sync::Arc;

/// The lanes of a worker that shows up to eight scripts on one model at once.
///
/// As with [`GroupScratch`](super::GroupScratch), nothing in it decides anything: an environment whose pass is made here goes on with the bits
/// of the pass that it makes alone.
#[derive(Debug, Clone)]
pub struct PassGroup {
    /// Of the engines that it can serve.
    model: Arc<Model>,
    body: Arc<Body>,
    group: LaneGroup,
}

impl Engine {
    /// Lanes for the environments of a worker.
    pub fn pass_group(&self) -> PassGroup {
        let group = LaneGroup::of(&self.model, &self.plan);
        PassGroup { model: Arc::clone(&self.model), body: Arc::clone(&self.body), group }
    }
}

impl PassGroup {
    /// Whether it can serve environments of this engine.
    pub fn serves(&self, engine: &Engine) -> bool {
        Arc::ptr_eq(&self.model, &engine.model) && Arc::ptr_eq(&self.body, &engine.body)
    }

    /// Makes the forward passes that environments miss after [`pose`](Environment::pose), where that takes less time together; the
    /// others are left to [`evaluate_pose`](Environment::evaluate_pose), and so is one that meets a fault. Environments are of engines that it
    /// serves; those beyond the lanes are left out.
    pub fn pass<'a>(&mut self, environments: impl IntoIterator<Item = &'a mut Environment>) {
        let misses = |environment: &&mut Environment| {
            let Environment { engine, episode, scratch, .. } = &**environment;
            engine.forces && episode.ending.is_none() && !scratch.is_of(&episode.state) && self.serves(engine)
        };
        let mut missing: Vec<&mut Environment> = environments.into_iter().filter(misses).take(WIDTH).collect();
        if missing.len() < self.group.least() {
            return;
        }
        let mut lanes: [Option<(&State<f64>, &mut Workspace<f64>)>; WIDTH] = Default::default();
        for (lane, environment) in lanes.iter_mut().zip(&mut missing) {
            let Environment { episode, scratch, .. } = &mut **environment;
            scratch.forget();
            *lane = Some((&episode.state, &mut scratch.workspace));
        }
        let faults = self.group.pass(lanes);
        for (environment, _) in missing.into_iter().zip(faults).filter(|(_, fault)| fault.is_none()) {
            environment.scratch.note(&environment.episode.state);
        }
    }
}

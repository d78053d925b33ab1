//! The rules by which an episode goes on: reset, and one control step.

use super::{Ending, Engine, Episode, EpisodeError, EpisodeKey, Fault, REST, Scratch, beginning, excitation, pushes};
use crate::body::sensors;
use crate::condition::Compartments;
use msk_physics::scalar::Real;
use msk_physics::{self as physics, State};
use msk_program::task::{StepReport, TaskState};
use nalgebra::Vector3;

/// An episode in the hands of a worker.
pub(super) struct Player<'a> {
    pub engine: &'a Engine,
    pub episode: &'a mut Episode,
    /// One per term.
    pub weights: &'a [f64],
    pub scratch: &'a mut Scratch,
}

impl Player<'_> {
    /// Begins the episode `key` with randoms that are `given` (place, value) and not drawn; a fault ends it at once.
    pub fn reset(&mut self, key: EpisodeKey, given: &[(usize, Vec<f64>)]) {
        self.clear(key);
        if let Err(fault) = self.start(key, given) {
            self.episode.ending = Some(Ending::Fault(fault));
        }
    }

    /// Reports the present snapshot without taking a step.
    pub fn report(&mut self) {
        let Episode { frame, task, report, .. } = &mut *self.episode;
        self.engine.task.report(frame, self.weights, task, report);
    }

    /// Forgets the episode before.
    pub fn clear(&mut self, key: EpisodeKey) {
        let engine = self.engine;
        let episode = &mut *self.episode;
        episode.key = key;
        episode.identity = Some(engine.task.hash.clone());
        episode.state = State::new(&engine.model);
        episode.pushes.clear();
        episode.task = TaskState::default();
        episode.memory = sensors::Memory::default();
        episode.compartments = engine.fatigue.as_ref().map(|_| Compartments::new(engine.body.muscles.len()));
        episode.action.fill(REST);
        episode.report = StepReport::default();
        episode.total = 0.0;
        episode.totals.fill(0.0);
        episode.ending = None;
        episode.streams.start(key, &engine.task.randoms);
        self.scratch.forget();
    }

    /// Randoms that read no signal, the beginning, the first snapshot, the other randoms.
    fn start(&mut self, key: EpisodeKey, given: &[(usize, Vec<f64>)]) -> Result<(), Fault> {
        let episode = &mut *self.episode;
        self.engine.task.begin_given(&mut episode.streams, &mut episode.task, given)?;
        self.begin(key)?;
        self.measure(0.0);
        let episode = &mut *self.episode;
        self.engine.task.reset_given(&episode.frame, &mut episode.streams, &mut episode.task, given)?;
        self.observe();
        Ok(())
    }

    /// Puts everything in its place, lets it settle if the task says so, and passes forward.
    fn begin(&mut self, key: EpisodeKey) -> Result<(), physics::Fault> {
        self.place(key);
        let Episode { state, task, .. } = &mut *self.episode;
        if let Some(settle) = &self.engine.task.beginning(task).settle {
            beginning::settle(&self.engine.model, settle, state, &mut self.scratch.workspace)?;
        }
        self.scratch.pass(&self.engine.model, state)
    }

    /// Puts everything in its place.
    pub fn place(&mut self, key: EpisodeKey) {
        let (model, body, workspace) = (&*self.engine.model, &self.engine.body, &mut self.scratch.workspace);
        let Episode { state, task, .. } = &mut *self.episode;
        beginning::begin(model, body, &self.engine.task.beginning(task), key, state, workspace);
        beginning::hold(model, body, state, workspace);
    }

    /// Takes one control step; a fault in it pays nothing, is not counted, and ends the episode.
    pub fn step(&mut self, action: &[f64]) -> Result<(), EpisodeError> {
        if self.episode.ending.is_some() {
            return Err(EpisodeError::Ended);
        }
        let expected = self.engine.body.muscles.len();
        if action.len() != expected {
            return Err(EpisodeError::ActionSize { expected, found: action.len() });
        }
        let steps = self.episode.steps();
        if let Err(fault) = self.advance(action) {
            self.end_with(fault, steps);
        }
        Ok(())
    }

    /// Ends the episode with a fault in the step after `steps`.
    pub fn end_with(&mut self, fault: Fault, steps: u32) {
        self.scratch.forget();
        self.episode.task.step = steps;
        self.episode.report = StepReport::default();
        self.episode.ending = Some(Ending::Fault(fault));
    }

    fn advance(&mut self, action: &[f64]) -> Result<(), Fault> {
        self.scratch.pass(&self.engine.model, &self.episode.state)?;
        self.excite(action)?;
        self.simulate()?;
        self.measure(self.engine.control_period());
        self.evaluate()?;
        self.observe();
        Ok(())
    }

    /// Advances the task by one snapshot, judges, lets go, and adds up.
    pub fn evaluate(&mut self) -> Result<(), Fault> {
        let episode = &mut *self.episode;
        let Episode { frame, streams, task, report, .. } = episode;
        self.engine.task.step(frame, self.weights, streams, task, report)?;
        self.episode.ending = self.judge();
        self.release()?;
        let Episode { report, total, totals, .. } = &mut *self.episode;
        *total += report.reward;
        for ((sum, value), weight) in totals.iter_mut().zip(&report.terms).zip(self.weights) {
            *sum += weight * value;
        }
        Ok(())
    }

    /// Takes the physics steps of one control step; the scratch then holds the forward pass of the new state.
    ///
    /// It also held that of the old one, which saves a pass: a new excitation changes nothing in it but the rates of
    /// activation (a muscle's force follows its activation, unless it acts early).
    fn simulate(&mut self) -> Result<(), Fault> {
        let Engine { model, body, task: compiled, substeps, .. } = self.engine;
        self.scratch.forget();
        let workspace = &mut self.scratch.workspace;
        let Episode { state, pushes, task, .. } = &mut *self.episode;
        let taken = task.step;
        let acting = || compiled.disturbances.iter().chain(pushes.iter()).filter(|push| pushes::acts(push, taken));
        let pushed = acting().next().is_some();
        let forces_change = pushed || state.body_force.iter().flatten().any(|force| *force != Vector3::zeros());
        if forces_change {
            pushes::apply(acting(), model, body, &workspace.kinematics, state);
        }
        if forces_change || model.actuators.actearly.contains(&true) {
            physics::forward(model, state, workspace)?;
        } else {
            physics::excite(model, state, workspace);
        }
        for _ in 0..*substeps {
            physics::integrate(model, state, workspace)?;
            if pushed {
                physics::kinematics::update(model, state, &mut workspace.kinematics);
                pushes::apply(acting(), model, body, &workspace.kinematics, state);
            }
            physics::forward(model, state, workspace)?;
        }
        self.scratch.note(state);
        Ok(())
    }

    /// Sets the excitations that an action asks for.
    fn excite(&mut self, action: &[f64]) -> Result<(), Fault> {
        let engine = self.engine;
        if let Some(index) = action.iter().position(|value| !value.is_finite()) {
            let muscle = engine.body.muscles[index].name.clone();
            return Err(Fault::Action { muscle, value: action[index], step: self.episode.steps() + 1 });
        }
        let episode = &mut *self.episode;
        for ((kept, control), value) in episode.action.iter_mut().zip(&mut episode.state.control).zip(action) {
            *kept = value.clip(-1.0, 1.0);
            *control = excitation(engine.body.excitation, *kept);
        }
        let elapsed = engine.control_period();
        if let (Some(rates), Some(compartments)) = (&engine.fatigue, &mut episode.compartments) {
            compartments.advance(rates, &engine.model, elapsed, &mut episode.state.control);
        }
        Ok(())
    }

    /// Fills the task's frame from the forward pass. `elapsed` is the time since the previous snapshot, s.
    pub fn measure(&mut self, elapsed: f64) {
        let Engine { model, body, task, .. } = self.engine;
        let episode = &mut *self.episode;
        // The step that is being taken is counted by the task only when it is evaluated.
        let taken = if elapsed > 0.0 { episode.task.step + 1 } else { 0 };
        let control = sensors::Control { action: &episode.action, time: f64::from(taken) / task.control_frequency, elapsed };
        let snapshot = sensors::Snapshot { body, model, state: &episode.state, workspace: &self.scratch.workspace };
        sensors::fill(&task.frame, &snapshot, &control, &mut episode.memory, &mut episode.frame);
    }

    /// Lets go what the task has said shall let go. The forward pass is then another one.
    fn release(&mut self) -> Result<(), Fault> {
        let Episode { state, report, .. } = &mut *self.episode;
        let mut changed = false;
        let releases = self.engine.task.releases.iter().zip(&report.released);
        for (&index, _) in releases.filter(|(_, lets_go)| **lets_go) {
            if let Some(connection) = self.engine.body.connections.get(index) {
                changed |= core::mem::replace(&mut state.active[connection.equality], 0.0) != 0.0;
            }
        }
        if changed {
            self.scratch.pass(&self.engine.model, state)?;
        }
        Ok(())
    }

    fn judge(&self) -> Option<Ending> {
        let report = &self.episode.report;
        let holding =
            |reasons: &[bool]| reasons.iter().enumerate().filter(|(_, holds)| **holds).map(|(index, _)| index).collect();
        let (failures, finishes): (Vec<usize>, Vec<usize>) = (holding(&report.terminations), holding(&report.finishes));
        if !failures.is_empty() {
            return Some(Ending::Terminated(failures));
        }
        if !finishes.is_empty() {
            return Some(Ending::Finished(finishes));
        }
        report.truncated.then_some(Ending::Truncated)
    }

    /// Writes the observation.
    pub fn observe(&mut self) {
        let episode = &mut *self.episode;
        self.engine.task.observe(&episode.frame, &episode.task, &mut episode.observation);
    }
}

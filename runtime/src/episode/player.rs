//! The rules by which an episode goes on: reset, and one control step.

use super::{Ending, Engine, Episode, EpisodeError, EpisodeKey, Fault, Scratch, initial_state, pushes, variation};
use crate::action::{Action, ActionState, ActsOn, Taken, excitation};
use crate::body::{OutOfReach, sensors};
use crate::cmc::{Moment, Present};
use crate::condition::Compartments;
use msk_physics::{self as physics, State};
use msk_program::action::ActionTarget;
use msk_program::task::{Channel, StepReport, TaskState};
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

    /// Forgets the episode before, but for the parameters, which are those of the next.
    pub fn clear(&mut self, key: EpisodeKey) {
        let engine = self.engine;
        let episode = &mut *self.episode;
        episode.key = key;
        episode.identity = Some(engine.task.hash.clone());
        episode.state = State::new(&engine.model);
        episode.disturbances.clear();
        episode.pushes.clear();
        episode.task = TaskState { parameters: std::mem::take(&mut episode.task.parameters), ..TaskState::default() };
        episode.memory = sensors::Memory::default();
        episode.compartments = engine.fatigue.as_ref().map(|_| Compartments::new(engine.body.muscles.len()));
        episode.action.clear(&engine.task.action);
        episode.late.clear();
        episode.report = StepReport::default();
        episode.total = 0.0;
        episode.totals.fill(0.0);
        episode.ending = None;
        episode.streams.start(key, &engine.task.randoms);
        self.scratch.forget();
    }

    /// Randoms that read no signal, the initial state, the first snapshot, the other randoms.
    fn start(&mut self, key: EpisodeKey, given: &[(usize, Vec<f64>)]) -> Result<(), Fault> {
        let episode = &mut *self.episode;
        self.engine.task.begin_given(&mut episode.streams, &mut episode.task, given)?;
        self.engine.task.begin_disturbances(&episode.task, &mut episode.disturbances);
        self.vary()?;
        self.begin(key)?;
        self.measure(0.0);
        let episode = &mut *self.episode;
        self.engine.task.reset_given(&episode.frame, &mut episode.streams, &mut episode.task, given)?;
        self.begin_control()?;
        self.observe()
    }

    /// Gives the episode what it has of its own of body and scene.
    pub fn vary(&mut self) -> Result<(), Fault> {
        let Engine { model, body, task, .. } = self.engine;
        let Episode { key, state, task: drawn, .. } = &mut *self.episode;
        variation::vary(model, body, &task.initial_state(drawn), *key, state)?;
        self.perturb_parameters();
        Ok(())
    }

    /// Puts everything in its place, lets it settle if the task asks for it, and passes forward.
    fn begin(&mut self, key: EpisodeKey) -> Result<(), Fault> {
        self.place(key)?;
        let Episode { state, task, .. } = &mut *self.episode;
        if let Some(settle) = &self.engine.task.initial_state(task).settle {
            initial_state::settle(&self.engine.model, settle, state, &mut self.scratch.workspace)?;
        }
        Ok(self.scratch.pass(&self.engine.model, state)?)
    }

    /// Puts everything in its place.
    pub fn place(&mut self, key: EpisodeKey) -> Result<(), OutOfReach> {
        let (model, body, workspace) = (&*self.engine.model, &self.engine.body, &mut self.scratch.workspace);
        let Episode { state, task, .. } = &mut *self.episode;
        initial_state::begin(model, body, &self.engine.task.initial_state(task), key, state, workspace)?;
        initial_state::hold(model, body, state, workspace);
        Ok(())
    }

    /// Sets the velocities with which formulas of time move objects in the step to be taken.
    pub fn drive(&mut self) {
        let Engine { body, task, .. } = self.engine;
        let Episode { state, task: progress, frame, .. } = &mut *self.episode;
        let period = self.engine.control_period();
        for (index, &object) in task.driven.iter().enumerate() {
            let (Some(placed), Some([x, y, z, turn])) = (body.objects[object].placed, task.drive(index, frame, progress)) else {
                continue;
            };
            state.mocap_velocity[placed] = [Vector3::new(0.0, 0.0, turn), Vector3::new(x, y, z)].map(|moved| moved / period);
        }
    }

    /// Takes one control step; a fault in it gives no reward, is not counted, and ends the episode.
    pub fn step(&mut self, action: Action<'_>) -> Result<(), EpisodeError> {
        if self.episode.ending.is_some() {
            return Err(EpisodeError::Ended);
        }
        let expected = action.acts_on.size(&self.engine.task, &self.engine.body);
        if action.entries.len() != expected {
            return Err(EpisodeError::ActionSize { expected, found: action.entries.len() });
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

    fn advance(&mut self, action: Action<'_>) -> Result<(), Fault> {
        self.pass()?;
        self.renew_pushes();
        let taken = self.take(action)?;
        if taken == Taken::AskingForces {
            self.allocate();
        }
        self.excite(taken);
        self.drive();
        self.simulate()?;
        self.conclude()?;
        Ok(())
    }

    /// Passes the present state forward, unless that has been done.
    pub fn pass(&mut self) -> Result<(), Fault> {
        Ok(self.scratch.pass(&self.engine.model, &self.episode.state)?)
    }

    /// Evaluates the task from the forward pass of the new state. Gives whether something was let go, which makes it another one.
    pub fn conclude(&mut self) -> Result<bool, Fault> {
        self.measure(self.engine.control_period());
        let released = self.evaluate()?;
        self.observe()?;
        self.add_up()?;
        Ok(released)
    }

    /// Advances the task by one snapshot, judges, and lets go. Gives whether something was let go.
    pub fn evaluate(&mut self) -> Result<bool, Fault> {
        let episode = &mut *self.episode;
        let Episode { frame, streams, task, report, .. } = episode;
        self.engine.task.step(frame, self.weights, streams, task, report)?;
        self.episode.ending = self.judge();
        self.release()
    }

    /// Adds the reward of the step to the return, and of each term to its own.
    pub fn add_up(&mut self) -> Result<(), Fault> {
        let Episode { report, total, totals, task, .. } = &mut *self.episode;
        let parts = || totals.iter().zip(&report.terms).zip(self.weights).map(|((sum, value), weight)| sum + weight * value);
        let sums = || core::iter::once(*total + report.reward).chain(parts());
        if let Some(value) = sums().find(|sum| !sum.is_finite()) {
            return Err(Fault::Return { value, reward: report.reward, step: task.step });
        }
        *total += report.reward;
        for ((sum, value), weight) in totals.iter_mut().zip(&report.terms).zip(self.weights) {
            *sum += weight * value;
        }
        Ok(())
    }

    /// Takes the physics steps of one control step; the scratch then holds the forward pass of the new state.
    fn simulate(&mut self) -> Result<(), Fault> {
        let pushed = self.is_pushed();
        self.react()?;
        let model = &self.engine.model;
        for _ in 0..self.engine.substeps {
            physics::integrate(model, &mut self.episode.state, &mut self.scratch.workspace)?;
            if pushed {
                physics::kinematics::update(model, &self.episode.state, &mut self.scratch.workspace.kinematics);
                self.push();
            }
            physics::forward(model, &self.episode.state, &mut self.scratch.workspace)?;
        }
        self.scratch.note(&self.episode.state);
        Ok(())
    }

    /// Brings the forward pass of the old state up to date with new excitations and pushes.
    ///
    /// Mostly that saves a pass: where forces follow activations, a new excitation changes nothing but the rates of these.
    pub fn react(&mut self) -> Result<(), Fault> {
        let model = &self.engine.model;
        self.scratch.forget();
        let forces_change = self.forces_change();
        if forces_change {
            self.push();
        }
        let Self { episode, scratch, .. } = self;
        if forces_change || !model.actuators.act_by_activation() {
            physics::forward(model, &episode.state, &mut scratch.workspace)?;
        } else {
            physics::excite(model, &episode.state, &mut scratch.workspace);
        }
        Ok(())
    }

    /// Draws for the pushes that begin in the step to be taken what is drawn for them.
    pub fn renew_pushes(&mut self) {
        let Episode { task, disturbances, .. } = &mut *self.episode;
        self.engine.task.renew_disturbances(task, disturbances);
    }

    /// Whether something pushes in the step to be taken.
    pub fn is_pushed(&self) -> bool {
        let Episode { task, disturbances, pushes, .. } = &*self.episode;
        disturbances.iter().chain(pushes).any(|push| push.acts(task.step))
    }

    /// Whether forces from outside are not what they were in the step before, or may not be.
    pub fn forces_change(&self) -> bool {
        matches!(self.engine.task.action.target, ActionTarget::Torque { .. })
            || self.is_pushed()
            || !self.engine.task.driven.is_empty()
            || self.episode.state.body_force.iter().flatten().any(|force| *force != Vector3::zeros())
    }

    /// Sets the forces of everything that pushes, where the frames of the scratch have the body.
    pub fn push(&mut self) {
        let Engine { model, body, .. } = self.engine;
        let Episode { state, disturbances, pushes, task, .. } = &mut *self.episode;
        let acting = disturbances.iter().chain(&*pushes).filter(|push| push.acts(task.step));
        pushes::apply(acting, model, body, &self.scratch.workspace.kinematics, state);
    }

    /// Prepares the controller of the action space for the episode, whose first snapshot has been taken.
    pub fn begin_control(&mut self) -> Result<(), Fault> {
        if self.episode.action.looks_at_state() {
            self.pass()?;
            let mut action = std::mem::take(&mut self.episode.action);
            let done = action.reset(&self.moment());
            self.episode.action = action;
            done?;
        }
        Ok(())
    }

    /// The present moment, as controllers see it.
    fn moment(&self) -> Moment<'_> {
        let Engine { model, body, task, substeps, .. } = self.engine;
        let Episode { state, task: progress, observation, .. } = &*self.episode;
        let present = Present { body, model, state, workspace: &self.scratch.workspace };
        Moment { task, progress, substeps: *substeps, observation, present }
    }

    /// Takes an action. Where the action space looks at the state, the scratch holds its forward pass; forces that it asks for are to be
    /// [shared out](Self::allocate) before muscles are [excited](Self::excite).
    pub fn take(&mut self, action: Action<'_>) -> Result<Taken, Fault> {
        let engine = self.engine;
        if let Some(index) = action.entries.iter().position(|value| !value.is_finite()) {
            let names = match action.acts_on {
                ActsOn::Task => engine.task.action.names(&engine.task.vocabulary),
                ActsOn::Muscles => engine.body.muscles.iter().map(|muscle| muscle.name.clone()).collect(),
            };
            let entry = names.get(index).cloned().unwrap_or_default();
            return Err(Fault::Action { entry, value: action.entries[index], step: self.episode.steps() + 1 });
        }
        let perturbed = self.perturbed_entries(action);
        let action = perturbed.as_ref().map_or(action, |entries| Action { entries, ..action });
        let mut state = std::mem::take(&mut self.episode.action);
        let mut control = std::mem::take(&mut self.scratch.control);
        let taken = state.begin(action, &self.engine.task.action, &self.moment(), &mut control);
        self.episode.action = state;
        self.scratch.control = control;
        Ok(taken?)
    }

    /// Shares out the forces that the action has asked for.
    pub fn allocate(&mut self) {
        let mut state = std::mem::take(&mut self.episode.action);
        let mut control = std::mem::take(&mut self.scratch.control);
        state.allocate(&self.moment().present, &mut control);
        (self.episode.action, self.scratch.control) = (state, control);
    }

    /// Sets the excitations and torques that the action asks for which has been taken.
    pub fn excite(&mut self, taken: Taken) {
        let engine = self.engine;
        let mut state = std::mem::take(&mut self.episode.action);
        let mut control = std::mem::take(&mut self.scratch.control);
        let mut torques = std::mem::take(&mut self.episode.state.applied_force);
        torques.fill(0.0);
        state.finish(taken, &engine.task.action, &self.moment(), &mut control, &mut torques);
        let episode = &mut *self.episode;
        (episode.action, episode.state.applied_force) = (state, torques);
        self.scratch.control = control;
        for (control, action) in episode.state.control.iter_mut().zip(&episode.action.muscles) {
            *control = excitation(engine.body.excitation, *action);
        }
        let elapsed = engine.control_period();
        if let (Some(rates), Some(compartments)) = (&engine.fatigue, &mut episode.compartments) {
            compartments.advance(rates, &engine.model, elapsed, &mut episode.state.control);
        }
    }

    /// Fills the task's frame from the forward pass. `elapsed` is the time since the previous snapshot, s.
    pub fn measure(&mut self, elapsed: f64) {
        let Engine { model, body, task, .. } = self.engine;
        let episode = &mut *self.episode;
        // The step that is being taken is counted by the task only when it is evaluated.
        let taken = if elapsed > 0.0 { episode.task.step + 1 } else { 0 };
        let ActionState { muscles: action, entries, .. } = &episode.action;
        let control = sensors::Control { action, entries, time: f64::from(taken) / task.control_frequency, elapsed };
        let snapshot = sensors::Snapshot { body, model, state: &episode.state, workspace: &self.scratch.workspace };
        sensors::fill(&task.frame, &snapshot, &control, &mut episode.memory, &mut episode.frame);
    }

    /// Releases the connections that the task releases. Returns whether there was something; the forward pass is then another
    /// one.
    fn release(&mut self) -> Result<bool, Fault> {
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
        Ok(changed)
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
    pub fn observe(&mut self) -> Result<(), Fault> {
        if !self.engine.observes {
            return Ok(());
        }
        let episode = &mut *self.episode;
        self.engine.task.observe(&episode.frame, &episode.task, &mut episode.observation);
        self.engine.task.observe_critic(&episode.frame, &episode.task, &mut episode.critic);
        self.perturb_observation();
        let Episode { observation, critic, task, .. } = &*self.episode;
        let channels = [(observation, &self.engine.task.channels), (critic, &self.engine.task.critic)];
        for (values, channels) in channels {
            if let Some(place) = values.iter().position(|value| !value.is_finite()) {
                let channel = channel_at(channels, place);
                return Err(Fault::Observation { channel, value: values[place], step: task.step });
            }
        }
        Ok(())
    }
}

/// The name of the channel that has a place of an observation.
fn channel_at(channels: &[Channel], place: usize) -> String {
    let of = channels.iter().find(|channel| (channel.offset..channel.offset + channel.size).contains(&place));
    of.map_or_else(|| format!("number {place}"), |channel| channel.name.clone())
}

//! Episodes in which a script sets where everything is: no physics passes, the task is evaluated as ever.
//!
//! A step sets all coordinates; velocities are the differences over the step; a forward pass gives contacts and forces.

use super::{Ending, Environment, Episode, EpisodeError, EpisodeKey, Fault, Player, initial_state};
use crate::action::action_for;
use crate::body::{Body, OutOfReach};
use msk_physics::model::{Model, Quaternion, rotation};
use msk_physics::{self as physics, State, Workspace};
use msk_program::frame::Sensor;
use msk_program::task::{StepReport, TaskState};
use nalgebra::Vector3;

/// Puts everything in its place at a time: coordinates of the state, with the scratch that this takes. Gives the activation of
/// all muscles; an error ends the episode with a fault.
pub type Placing<'a> = dyn FnMut(&Model, &Body, &mut State<f64>, &mut Workspace<f64>) -> Result<f64, OutOfReach> + 'a;

impl Environment {
    /// Begins the episode `key` with what a script shows first. Randoms that are `given` (place, value) are not drawn.
    /// `prepare` learns what was drawn before anything is placed, and may use the scratch.
    pub fn reset_playing(
        &mut self,
        key: EpisodeKey,
        given: &[(usize, Vec<f64>)],
        prepare: &mut dyn FnMut(&TaskState, &mut Workspace<f64>),
        place: &mut Placing<'_>,
    ) {
        let mut player = self.beginning();
        player.clear(key);
        if let Err(fault) = player.start_playing(given, prepare, place) {
            player.episode.ending = Some(Ending::Fault(fault));
        }
    }

    /// Begins the episode `key` in a state that `put` writes, not in the initial state of the task: everything counts, speeds and
    /// activations, too. A state that the physics or the task refuses ends the episode with a fault.
    pub fn reset_to(&mut self, key: EpisodeKey, put: &mut dyn FnMut(&mut State<f64>)) {
        let mut player = self.beginning();
        player.clear(key);
        if let Err(fault) = player.start_at(put) {
            player.episode.ending = Some(Ending::Fault(fault));
        }
    }

    /// Takes one control step to where the script has everything: a kinematic step. A fault ends the episode as in
    /// [`step`](Self::step).
    ///
    /// # Errors
    /// An episode that has ended.
    pub fn step_to(&mut self, place: &mut Placing<'_>) -> Result<&StepReport, EpisodeError> {
        self.pose(place)?;
        self.evaluate_pose();
        Ok(&self.episode.report)
    }

    /// The first half of [`step_to`](Self::step_to): everything is where the script has it. The forward pass is missing, which several
    /// environments can make [together](super::PassGroup::pass), and the [second half](Self::evaluate_pose).
    ///
    /// # Errors
    /// An episode that has ended.
    pub fn pose(&mut self, place: &mut Placing<'_>) -> Result<(), EpisodeError> {
        self.player().attempt(|player| player.pose(place))
    }

    /// The second half of [`step_to`](Self::step_to): passes forward unless that is done, and evaluates the task. An episode that has met a
    /// fault in the first half stays as it is.
    pub fn evaluate_pose(&mut self) {
        let _ = self.player().attempt(|player| {
            player.look()?;
            player.reward()
        });
    }

    /// Takes one control step in which nothing moves, after two or more that showed the same: only time passes.
    ///
    /// # Errors
    /// An episode that has ended.
    pub fn hold(&mut self) -> Result<&StepReport, EpisodeError> {
        self.player().attempt(|player| {
            match player.engine.task.driven.is_empty() {
                true => player.wait(),
                // Formulas of time go on.
                false => {
                    let activation = player.episode.state.activation.first().copied().unwrap_or(0.0);
                    player.pose(&mut |_, _, _, _| Ok(activation))?;
                    player.look()?;
                }
            }
            player.reward()
        })?;
        Ok(&self.episode.report)
    }

    /// Writes the observation of what the script has shown last, for a policy that takes over.
    ///
    /// The controller of the task's action space begins with what it shows, too; where it cannot, the episode ends with a fault.
    pub fn end_script(&mut self) {
        let mut player = self.player();
        if let Err(fault) = player.begin_control().and_then(|()| player.observe()) {
            player.episode.ending = Some(Ending::Fault(fault));
        }
    }
}

impl Player<'_> {
    fn start_playing(
        &mut self,
        given: &[(usize, Vec<f64>)],
        prepare: &mut dyn FnMut(&TaskState, &mut Workspace<f64>),
        place: &mut Placing<'_>,
    ) -> Result<(), Fault> {
        let (model, body, task) = (&self.engine.model, &self.engine.body, &self.engine.task);
        let episode = &mut *self.episode;
        task.begin_given(&mut episode.streams, &mut episode.task, given)?;
        task.begin_disturbances(&episode.task, &mut episode.disturbances);
        prepare(&episode.task, &mut self.scratch.workspace);
        self.vary()?;
        let episode = &mut *self.episode;
        let activation = place(model, body, &mut episode.state, &mut self.scratch.workspace)?;
        self.activate(activation);
        let state = &mut self.episode.state;
        initial_state::hold(model, body, state, &mut self.scratch.workspace);
        self.scratch.pass(model, state)?;
        self.measure(0.0);
        self.take_first_snapshot(given)?;
        self.observe()
    }

    fn start_at(&mut self, put: &mut dyn FnMut(&mut State<f64>)) -> Result<(), Fault> {
        let episode = &mut *self.episode;
        self.engine.task.begin(&mut episode.streams, &mut episode.task)?;
        self.engine.task.begin_disturbances(&episode.task, &mut episode.disturbances);
        self.vary()?;
        let episode = &mut *self.episode;
        put(&mut episode.state);
        self.scratch.pass(&self.engine.model, &episode.state)?;
        self.measure(0.0);
        self.take_first_snapshot(&[])?;
        self.begin_control()
    }

    /// The snapshot of the reset, reported, with values that randoms have independent of chance.
    fn take_first_snapshot(&mut self, given: &[(usize, Vec<f64>)]) -> Result<(), Fault> {
        let Episode { frame, streams, task, .. } = &mut *self.episode;
        self.engine.task.reset_given(frame, streams, task, given)?;
        self.report();
        Ok(())
    }

    /// Puts everything where the script has it.
    fn pose(&mut self, place: &mut Placing<'_>) -> Result<(), Fault> {
        let (model, body) = (&self.engine.model, &self.engine.body);
        let before = self.episode.state.position.clone();
        self.scratch.forget();
        self.drive();
        physics::integrator::move_placed(&mut self.episode.state, self.engine.control_period());
        let activation = place(model, body, &mut self.episode.state, &mut self.scratch.workspace)?;
        self.activate(activation);
        let period = self.engine.control_period();
        let state = &mut self.episode.state;
        differences(body, &before, state, period);
        state.time = f64::from(self.episode.task.step + 1) * period;
        Ok(())
    }

    /// Measures what a script shows.
    fn look(&mut self) -> Result<(), Fault> {
        let (model, state) = (&self.engine.model, &self.episode.state);
        match self.engine.forces {
            true => self.scratch.pass(model, state)?,
            false => physics::motion(model, state, &mut self.scratch.workspace)?,
        }
        self.measure(self.engine.control_period());
        Ok(())
    }

    /// Lets time pass, and nothing else.
    fn wait(&mut self) {
        let time = f64::from(self.episode.task.step + 1) * self.engine.control_period();
        self.episode.state.time = time;
        for &(sensor, offset) in self.engine.task.frame.entries() {
            if sensor == Sensor::Time {
                self.episode.frame[offset] = time;
            }
        }
    }

    /// Takes a part of a control step; a fault in it ends the episode.
    fn attempt(&mut self, part: impl FnOnce(&mut Self) -> Result<(), Fault>) -> Result<(), EpisodeError> {
        if self.episode.ending.is_some() {
            return Err(EpisodeError::Ended);
        }
        let steps = self.episode.steps();
        if let Err(fault) = part(self) {
            self.end_with(fault, steps);
        }
        Ok(())
    }

    /// Evaluates the task in the snapshot that has been taken.
    fn reward(&mut self) -> Result<(), Fault> {
        self.evaluate()?;
        self.add_up()
    }

    /// Gives all muscles one activation, its excitation, and the action that asks for it.
    fn activate(&mut self, activation: f64) {
        let episode = &mut *self.episode;
        episode.state.activation.fill(activation);
        episode.state.control.fill(activation);
        episode.action.muscles.fill(action_for(self.engine.body.excitation, activation));
    }
}

/// Velocities that lead from `before` to the coordinates of `state` in the time `period`, s.
fn differences(body: &Body, before: &[f64], state: &mut State<f64>, period: f64) {
    let (position, velocity) = (&state.position, &mut state.velocity);
    for joint in &body.joints {
        velocity[joint.dof] = (position[joint.position] - before[joint.position]) / period;
    }
    let free = body.root.free.into_iter().chain(body.objects.iter().filter_map(|object| object.free));
    for (place, dof) in free {
        for axis in 0..3 {
            velocity[dof + axis] = (position[place + axis] - before[place + axis]) / period;
        }
        let quaternion = |from: &[f64]| [from[place + 3], from[place + 4], from[place + 5], from[place + 6]];
        let turn = turn(quaternion(before), quaternion(position)) / period;
        velocity[dof + 3..dof + 6].copy_from_slice(turn.as_slice());
    }
}

/// The turn from one orientation to another in the axes of the first, rad.
fn turn([w, x, y, z]: Quaternion, to: Quaternion) -> Vector3<f64> {
    let [w, x, y, z] = rotation::product([w, -x, -y, -z], to);
    // The shorter way round.
    let sign = if w < 0.0 { -1.0 } else { 1.0 };
    let axis = Vector3::new(x, y, z) * sign;
    let sine = axis.norm();
    if sine == 0.0 { axis } else { axis * (2.0 * libm::atan2(sine, w * sign) / sine) }
}

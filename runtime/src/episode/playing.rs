//! Episodes in which a script says where everything is: no physics passes, the task is evaluated as ever.
//!
//! A step sets all coordinates; velocities are the differences over the step; a forward pass gives contacts and forces.

use super::{Ending, Episode, EpisodeError, EpisodeKey, Fault, beginning};
use crate::body::Body;
use crate::episode::excitation;
use msk_compiler::frame::Sensor;
use msk_compiler::task::{StepReport, TaskState};
use msk_physics::model::{Model, Quaternion, rotation};
use msk_physics::{self as physics, State, Workspace};
use nalgebra::Vector3;

/// Puts everything in its place at a time: coordinates of the state, with the scratch that this takes. Gives the activation of
/// all muscles.
pub type Placing<'a> = dyn FnMut(&Model, &Body, &mut State<f64>, &mut Workspace<f64>) -> f64 + 'a;

impl Episode {
    /// The same episode for scripts alone: where the task's frame has no sensor of a force, steps that a script shows leave out what
    /// only forces need, and their numbers stay the same. Physics must not take over.
    pub fn for_scripts(mut self) -> Self {
        self.forces = self.task.frame.entries().iter().any(|(sensor, _)| sensor.needs_forces());
        self
    }

    /// Begins the episode `key` with what a script shows first. Randoms that are `given` (place, value) are not drawn.
    /// `prepare` is told what was drawn before anything is placed.
    pub fn reset_playing(
        &mut self,
        key: EpisodeKey,
        given: &[(usize, Vec<f64>)],
        prepare: &mut dyn FnMut(&TaskState),
        place: &mut Placing<'_>,
    ) {
        self.clear(key);
        if let Err(fault) = self.start_playing(given, prepare, place) {
            self.present.ending = Some(Ending::Fault(fault));
        }
    }

    fn start_playing(
        &mut self,
        given: &[(usize, Vec<f64>)],
        prepare: &mut dyn FnMut(&TaskState),
        place: &mut Placing<'_>,
    ) -> Result<(), Fault> {
        let present = &mut self.present;
        self.task.begin_given(&mut present.streams, &mut present.task, given)?;
        prepare(&present.task);
        let activation = place(&self.model, &self.body, &mut present.state, &mut self.workspace);
        self.activate(activation);
        let state = &mut self.present.state;
        beginning::hold(&self.model, &self.body, state, &mut self.workspace);
        physics::forward(&self.model, state, &mut self.workspace)?;
        self.measure(0.0);
        let present = &mut self.present;
        self.task.reset_given(&present.frame, &mut present.streams, &mut present.task, given)?;
        self.task.report(&present.frame, &self.weights, &present.task, &mut present.report);
        self.observe();
        Ok(())
    }

    /// Begins the episode `key` in a state that `put` writes, whatever the task says of its beginning: everything counts, speeds and
    /// activations, too. A state that the physics or the task refuses ends the episode with a fault.
    pub fn appear(&mut self, key: EpisodeKey, put: &mut dyn FnMut(&mut State<f64>)) {
        self.clear(key);
        let appeared = || -> Result<(), Fault> {
            let present = &mut self.present;
            self.task.begin(&mut present.streams, &mut present.task)?;
            put(&mut present.state);
            physics::forward(&self.model, &present.state, &mut self.workspace)?;
            self.measure(0.0);
            let present = &mut self.present;
            self.task.reset(&present.frame, &mut present.streams, &mut present.task)?;
            self.task.report(&present.frame, &self.weights, &present.task, &mut present.report);
            Ok(())
        };
        if let Err(fault) = { appeared }() {
            self.present.ending = Some(Ending::Fault(fault));
        }
    }

    /// Takes one control step to where the script has everything. A fault ends the episode as in [`step`](Self::step).
    ///
    /// # Errors
    /// An episode that has ended.
    pub fn show(&mut self, place: &mut Placing<'_>) -> Result<&StepReport, EpisodeError> {
        self.played(|episode| {
            let before = episode.present.state.position.clone();
            let state = &mut episode.present.state;
            let activation = place(&episode.model, &episode.body, state, &mut episode.workspace);
            episode.activate(activation);
            let period = episode.control_period();
            let state = &mut episode.present.state;
            differences(&episode.body, &before, state, period);
            state.time = f64::from(episode.present.task.step + 1) * period;
            match episode.forces {
                true => physics::forward(&episode.model, state, &mut episode.workspace)?,
                false => physics::motion(&episode.model, state, &mut episode.workspace)?,
            }
            episode.measure(period);
            Ok(())
        })
    }

    /// Takes one control step in which nothing moves, after two or more that showed the same: only time passes.
    ///
    /// # Errors
    /// An episode that has ended.
    pub fn hold(&mut self) -> Result<&StepReport, EpisodeError> {
        self.played(|episode| {
            let time = f64::from(episode.present.task.step + 1) * episode.control_period();
            episode.present.state.time = time;
            for &(sensor, offset) in episode.task.frame.entries() {
                if sensor == Sensor::Time {
                    episode.present.frame[offset] = time;
                }
            }
            Ok(())
        })
    }

    fn played(&mut self, measure: impl FnOnce(&mut Self) -> Result<(), Fault>) -> Result<&StepReport, EpisodeError> {
        if self.present.ending.is_some() {
            return Err(EpisodeError::Ended);
        }
        let steps = self.steps();
        let outcome = measure(self).and_then(|()| {
            let present = &mut self.present;
            self.task.step(&present.frame, &self.weights, &mut present.streams, &mut present.task, &mut present.report)?;
            self.present.ending = self.judge();
            self.release()
        });
        if let Err(fault) = outcome {
            self.present.task.step = steps;
            self.present.report = StepReport::default();
            self.present.ending = Some(Ending::Fault(fault));
        }
        Ok(&self.present.report)
    }

    /// Lets a policy see what the script has shown last.
    pub fn end_script(&mut self) {
        self.observe();
    }

    /// Gives all muscles one activation, its excitation, and the action that asks for it.
    fn activate(&mut self, activation: f64) {
        let present = &mut self.present;
        present.state.activation.fill(activation);
        present.state.control.fill(activation);
        present.action.fill(excitation::action(self.body.excitation, activation));
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

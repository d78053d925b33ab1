//! Time stepping (MuJoCo's manual, "Numerical integration").
//!
//! * Euler: semi-implicit, v += h a, then positions move with the new velocity; joint damping pulls at the end of the step,
//!   (M + h B) a = force, with h the step and B the joints' damping.
//! * [`implicit`]: the same with the dampers of tendons and the velocity slopes of actuators in B ("implicitfast").
//! * [`runge_kutta`]: the classical fourth order, on the group of rotations for orientations.
//!
//! Activations advance at their rate from the step's start (Runge-Kutta: at the mean rate) and stay in their range.
//! Nothing writes to the state before everything that can fail has succeeded.

pub mod implicit;
pub mod runge_kutta;

use super::{
    Fault, Workspace, actuation,
    dispatch::{Stage, run},
    inertia, rotation,
    state::State,
    stepping,
};
use crate::{
    model::{Integrator, JointKind, Model},
    scalar::Real,
};
use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

/// Advances `state` by one step from the forward pass in `workspace`.
///
/// # Errors
/// A step that would end beyond all measure; with Runge-Kutta, as for [`forward`](stepping::forward), at any stage. `state` is then what
/// it was before. Of several lanes the first that has a fault; the others have been advanced.
pub fn integrate<T: Real>(model: &Model, state: &mut State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    run(Stage::Damped, model, state, workspace);
    advance(model, state, workspace)
}

/// The same at the rates in `workspace`: accelerations, also damped, and activations. A lane with a fault stays.
pub(super) fn advance<T: Real>(model: &Model, state: &mut State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    match model.options.integrator {
        Integrator::RungeKutta => runge_kutta::runge_kutta(model, state, workspace),
        Integrator::Euler | Integrator::Implicit => workspace.arch.dispatch(Advance { model, state, workspace }),
    }
}

struct Advance<'a, T: Real> {
    model: &'a Model,
    state: &'a mut State<T>,
    workspace: &'a mut Workspace<T>,
}

impl<T: Real> WithSimd for Advance<'_, T> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Result<(), Fault> {
        advance_lanes(self.model, self.state, self.workspace)
    }
}

#[inline(always)]
fn advance_lanes<T: Real>(model: &Model, state: &mut State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    let time = model.options.timestep;
    let step = T::splat(time);
    let Workspace { actuation, faults, masked, damped_acceleration, acceleration, .. } = workspace;
    let activations = actuation::advanced(actuation, &actuation.activation_rate, time, &state.activation);
    let outcome = stepping::check_end(model, state, damped_acceleration, None, activations, (masked, faults));
    let lives = T::mask(|lane| !masked[lane] && faults[lane].is_none());
    if !T::any(lives) {
        return outcome;
    }
    actuation::advance(actuation, &actuation.activation_rate, time, lives, &mut state.activation);
    actuation.keep_fibres(state, time, lives);
    for (velocity, acceleration) in state.velocity.iter_mut().zip(&*damped_acceleration) {
        *velocity = T::select(lives, *velocity + step * *acceleration, *velocity);
    }
    advance_positions(model, &mut state.position, &state.velocity, step, lives);
    advance_placed(state, step, lives);
    state.time = T::select(lives, state.time + step, state.time);
    keep_where(lives, &mut state.warm_start, acceleration);
    outcome
}

/// Copies the lanes of the mask.
#[inline(always)]
pub(super) fn keep_where<T: Real>(lives: T::Mask, to: &mut [T], from: &[T]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = T::select(lives, *from, *to);
    }
}

/// Solves (M + h B) a = smooth + constraint forces; without damping a is the acceleration itself. Runge-Kutta's method needs none.
#[inline(always)]
pub(super) fn damped_acceleration<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    match model.options.integrator {
        Integrator::RungeKutta => return,
        Integrator::Implicit => return implicit::acceleration(model, state, workspace),
        Integrator::Euler => {}
    }
    if !model.options.euler_damping || model.dofs.damping.iter().all(|damping| *damping == 0.0) {
        workspace.damped_acceleration.copy_from_slice(&workspace.acceleration);
        return;
    }
    // The factor of M is not needed any more in this step.
    let factor = &mut workspace.inertia.factor;
    factor.copy_from_slice(&workspace.inertia.matrix);
    add_joint_damping(model, state, factor);
    inertia::factor(model, factor);
    total_force(workspace);
    inertia::solve(model, &workspace.inertia.factor, &mut workspace.damped_acceleration);
}

/// h B of the joints.
#[inline(always)]
fn add_joint_damping<T: Real>(model: &Model, state: &State<T>, matrix: &mut [T]) {
    for (row, damping) in model.dofs.row.iter().zip(&state.damping) {
        matrix[row.end - 1] += T::splat(model.options.timestep) * *damping;
    }
}

/// Puts smooth and constraint forces where the solution is wanted.
#[inline(always)]
fn total_force<T: Real>(workspace: &mut Workspace<T>) {
    let forces = workspace.forces.smooth.iter().zip(&workspace.constraint_force);
    for (total, (smooth, constraint)) in workspace.damped_acceleration.iter_mut().zip(forces) {
        *total = *smooth + *constraint;
    }
}

/// Moves the positions of the lanes of the mask by `step` seconds at the given velocities; orientations turn in their own axes.
#[inline(always)]
pub fn advance_positions<T: Real>(model: &Model, positions: &mut [T], velocities: &[T], step: T, lives: T::Mask) {
    let joints = &model.joints;
    for joint in 0..joints.kind.len() {
        let position = &mut positions[joints.position_address[joint]..];
        let velocity = &velocities[joints.dof_address[joint]..];
        match joints.kind[joint] {
            JointKind::Hinge | JointKind::Slide => position[0] = T::select(lives, position[0] + step * velocity[0], position[0]),
            JointKind::Ball => turn(position, velocity, step, lives),
            JointKind::Free => {
                for axis in 0..3 {
                    position[axis] = T::select(lives, position[axis] + step * velocity[axis], position[axis]);
                }
                turn(&mut position[3..], &velocity[3..], step, lives);
            }
        }
    }
}

/// Moves the bodies that are placed from outside for `time` seconds at their velocities.
pub fn move_placed(state: &mut State<f64>, time: f64) {
    advance_placed(state, time, true);
}

/// Moves the bodies that are placed from outside at their velocities, which are in world axes.
#[inline(always)]
pub(super) fn advance_placed<T: Real>(state: &mut State<T>, step: T, lives: T::Mask) {
    let places = state.mocap_position.iter_mut().zip(&mut state.mocap_orientation);
    for ((position, orientation), [spin, linear]) in places.zip(&state.mocap_velocity) {
        for (value, speed) in position.iter_mut().zip(linear.iter()) {
            *value = T::select(lives, *value + step * *speed, *value);
        }
        if spin.iter().any(|speed| *speed != T::splat(0.0)) {
            // A rotation vector in world axes turns the body's own axes by its image in them.
            let own = rotation::matrix(orientation).tr_mul(spin);
            turn(orientation, own.as_slice(), step, lives);
        }
    }
}

#[inline(always)]
fn turn<T: Real>(quaternion: &mut [T], velocity: &[T], step: T, lives: T::Mask) {
    let before = [quaternion[0], quaternion[1], quaternion[2], quaternion[3]];
    let after = rotation::integrate(&before, &Vector3::new(velocity[0], velocity[1], velocity[2]), step);
    keep_where(lives, &mut quaternion[..4], &after);
}

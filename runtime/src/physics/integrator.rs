//! Time stepping: semi-implicit Euler with implicit joint damping.
//!
//! Damping pulls at the end of the step: (M + h B) a = force, with h the step and B the joints' damping (MuJoCo's manual,
//! "Integrators"). Then v += h a, positions move with the new velocity, activations with the rate at the step's start.

use super::{Workspace, inertia, rotation, state::State};
use crate::{
    model::{JointKind, Model},
    scalar::Real,
};
use nalgebra::Vector3;

/// Advances `state` by one step from the forces in `workspace`.
pub fn euler<T: Real>(model: &Model, state: &mut State<T>, workspace: &mut Workspace<T>) {
    let step = T::splat(model.options.timestep);
    for (activation, rate) in state.activation.iter_mut().zip(&workspace.muscles.activation_rate) {
        *activation += step * *rate;
    }
    damped_acceleration(model, workspace);
    for (velocity, acceleration) in state.velocity.iter_mut().zip(&workspace.damped_acceleration) {
        *velocity += step * *acceleration;
    }
    advance_positions(model, state, step);
    state.time += model.options.timestep;
    state.warm_start.copy_from_slice(&workspace.acceleration);
}

/// Solves (M + h B) a = smooth + constraint forces; without damping a is the acceleration itself.
fn damped_acceleration<T: Real>(model: &Model, workspace: &mut Workspace<T>) {
    if model.dofs.damping.iter().all(|damping| *damping == 0.0) {
        workspace.damped_acceleration.copy_from_slice(&workspace.acceleration);
        return;
    }
    // The factor of M is not needed any more in this step.
    let factor = &mut workspace.inertia.factor;
    factor.copy_from_slice(&workspace.inertia.matrix);
    for (row, damping) in model.dofs.row.iter().zip(&model.dofs.damping) {
        factor[row.end - 1] += T::splat(model.options.timestep * damping);
    }
    inertia::factor(model, factor);
    let forces = workspace.forces.smooth.iter().zip(&workspace.constraint_force);
    for (acceleration, (smooth, constraint)) in workspace.damped_acceleration.iter_mut().zip(forces) {
        *acceleration = *smooth + *constraint;
    }
    inertia::solve(model, factor, &mut workspace.damped_acceleration);
}

/// Moves positions by `step` seconds at the state's velocities; orientations turn in their own axes.
pub fn advance_positions<T: Real>(model: &Model, state: &mut State<T>, step: T) {
    let joints = &model.joints;
    for joint in 0..joints.kind.len() {
        let position = &mut state.position[joints.position_address[joint]..];
        let velocity = &state.velocity[joints.dof_address[joint]..];
        match joints.kind[joint] {
            JointKind::Hinge | JointKind::Slide => position[0] += step * velocity[0],
            JointKind::Ball => turn(position, velocity, step),
            JointKind::Free => {
                for axis in 0..3 {
                    position[axis] += step * velocity[axis];
                }
                turn(&mut position[3..], &velocity[3..], step);
            }
        }
    }
}

fn turn<T: Real>(quaternion: &mut [T], velocity: &[T], step: T) {
    let before = [quaternion[0], quaternion[1], quaternion[2], quaternion[3]];
    let after = rotation::integrate(&before, &Vector3::new(velocity[0], velocity[1], velocity[2]), step);
    quaternion[..4].copy_from_slice(&after);
}

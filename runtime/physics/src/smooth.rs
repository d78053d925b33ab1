//! The constraint-free half of a step.

use super::{
    actuation,
    dispatch::{Stage, run},
    forces,
    forces::Forces,
    inertia,
    state::State,
    tendons, velocities,
    workspace::Workspace,
};
use crate::{model::Model, scalar::Real};

/// Everything up to the acceleration without constraints, stage by stage.
pub fn smooth<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    forward_position(model, state, workspace);
    forward_velocity(model, state, workspace);
    forward_actuation(model, state, workspace);
    unconstrained(model, state, workspace);
}

/// Stages that depend on positions alone: frames, the mass matrix, tendon lengths.
pub fn forward_position<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    for stage in [Stage::Kinematics, Stage::Inertia, Stage::Tendons] {
        run(stage, model, state, workspace);
    }
}

/// Stages that depend on positions and velocities: velocities of bodies and tendons, bias and passive forces.
pub fn forward_velocity<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    run(Stage::Velocities, model, state, workspace);
}

#[inline(always)]
pub(super) fn velocity_stage<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    let Workspace { kinematics, inertia, tendons, velocities, forces, .. } = workspace;
    velocities::update(model, state, kinematics, velocities);
    tendons::update_velocities(state, velocities, tendons);
    forces::bias(model, state, kinematics, inertia, velocities, forces);
    forces::passive(model, state, kinematics, tendons, velocities, forces);
}

/// Fills the activation rates alone, for a control that is new since the forward pass: nothing else changes where
/// [`Actuators::act_by_activation`](crate::model::Actuators::act_by_activation) holds.
pub fn excite<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    run(Stage::Excitation, model, state, workspace);
}

/// Stages that depend on excitations, activations and applied forces too: actuators, total force. An actuator that draws a body
/// to what it touches acts on the contacts that were detected last.
pub fn forward_actuation<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    run(Stage::Actuation, model, state, workspace);
}

#[inline(always)]
pub(super) fn actuation_stage<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    let Workspace { kinematics, tendons, actuation, forces, lanes, .. } = workspace;
    actuation::update(model, state, kinematics, tendons, lanes, actuation);
    let Forces { compensation, body_force, actuator, .. } = forces;
    actuation::generalised_force(model, kinematics, tendons, actuation, compensation, body_force, actuator);
    forces::smooth(model, state, kinematics, forces);
}

/// Factors the mass matrix and solves for the acceleration without constraints, after [`forward_actuation`] or
/// [`forward`](crate::forward): a step with constraint rows does without either.
pub fn unconstrained<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    run(Stage::Unconstrained, model, state, workspace);
}

#[inline(always)]
pub(super) fn unconstrained_stage<T: Real>(model: &Model, workspace: &mut Workspace<T>) {
    let Workspace { inertia, forces, .. } = workspace;
    inertia::factorize(model, inertia);
    forces.smooth_acceleration.copy_from_slice(&forces.smooth);
    inertia::solve(model, &inertia.factor, &mut forces.smooth_acceleration);
}

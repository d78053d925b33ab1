//! The constraint-free half of a step.

use super::{actuation, forces, forces::Forces, inertia, kinematics, state::State, tendons, velocities, workspace::Workspace};
use crate::{model::Model, scalar::Real};

/// Everything up to the acceleration without constraints, stage by stage.
pub fn smooth<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    forward_position(model, state, workspace);
    forward_velocity(model, state, workspace);
    forward_actuation(model, state, workspace);
}

/// Stages that depend on positions alone: frames, the mass matrix and its factor, tendon lengths.
pub fn forward_position<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    kinematics::update_lanes(model, state, &mut workspace.kinematics);
    inertia::update(model, &workspace.kinematics, &mut workspace.inertia);
    tendons::update(state, &workspace.kinematics, &mut workspace.tendons);
}

/// Stages that depend on positions and velocities: velocities of bodies and tendons, bias and passive forces.
pub fn forward_velocity<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    let Workspace { kinematics, inertia, tendons, velocities, forces, .. } = workspace;
    velocities::update(model, state, kinematics, velocities);
    tendons::update_velocities(state, velocities, tendons);
    forces::bias(model, state, kinematics, inertia, velocities, forces);
    forces::passive(model, state, kinematics, tendons, velocities, forces);
}

/// Lengths, velocities, activation rates and forces of all actuators. Needs positions, motions and contacts.
pub fn excite<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    let Workspace { kinematics, tendons, actuation, lanes, .. } = workspace;
    actuation::update(model, state, kinematics, tendons, lanes, actuation);
}

/// Stages that depend on excitations, activations and applied forces too: actuators, total force, acceleration. An actuator
/// that draws a body to what it touches acts on the contacts that were detected last.
pub fn forward_actuation<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    excite(model, state, workspace);
    let Workspace { kinematics, inertia, tendons, actuation, forces, .. } = workspace;
    let Forces { compensation, body_force, actuator, .. } = forces;
    actuation::generalised_force(model, kinematics, tendons, actuation, compensation, body_force, actuator);
    forces::smooth(model, state, kinematics, inertia, forces);
}

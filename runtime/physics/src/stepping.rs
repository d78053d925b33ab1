//! One step of a body.

use super::{
    Workspace, constrained,
    fault::{Fault, Quantity, is_valid},
    inertia,
    integrator::{self, implicit, runge_kutta},
    kinematics,
    smooth::{forward_actuation, forward_velocity},
    state::State,
    tendons, velocities,
};
use crate::{
    model::{Integrator, JointKind, Model},
    scalar::Real,
};

/// Everything up to the acceleration, constraints included, in MuJoCo's order.
///
/// # Errors
/// A state or acceleration that is not finite, or a constraint problem without solution, with its body, joint and time.
pub fn forward<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    forward_by_stage(model, state, workspace, &mut || {})
}

/// [`forward`] with a call of `lap` after each of the [`STAGES`] but the last: for clocks.
///
/// # Errors
/// As for [`forward`].
pub fn forward_by_stage<T: Real>(
    model: &Model,
    state: &State<T>,
    workspace: &mut Workspace<T>,
    lap: &mut impl FnMut(),
) -> Result<(), Fault> {
    check(model, state)?;
    kinematics::update_lanes(model, state, &mut workspace.kinematics);
    lap();
    inertia::update(model, &workspace.kinematics, &mut workspace.inertia);
    lap();
    tendons::update(state, &workspace.kinematics, &mut workspace.tendons);
    lap();
    constrained::contacts(model, workspace);
    lap();
    forward_velocity(model, state, workspace);
    lap();
    constrained::rows(model, state, workspace);
    lap();
    forward_actuation(model, state, workspace);
    lap();
    constrained::solve(model, state, workspace)?;
    lap();
    Ok(())
}

/// Names of the stages of a step, in their order.
pub const STAGES: [&str; 9] =
    ["kinematics", "inertia", "tendons", "contacts", "velocities", "rows", "muscles", "solver", "integrator"];

/// The part of [`forward`] that knows no forces: positions, contacts, velocities of bodies.
///
/// # Errors
/// A state that is not finite.
pub fn motion<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    check(model, state)?;
    kinematics::update_lanes(model, state, &mut workspace.kinematics);
    constrained::contacts(model, workspace);
    velocities::update(model, state, &workspace.kinematics, &mut workspace.velocities);
    Ok(())
}

/// Advances `state` by one step of the model's options.
///
/// # Errors
/// As for [`forward`]; `state` is then what it was before.
pub fn step<T: Real>(model: &Model, state: &mut State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    forward(model, state, workspace)?;
    integrate(model, state, workspace)
}

/// Advances `state` by one step from its forward pass in `workspace`; with Runge-Kutta the later stages follow.
///
/// # Errors
/// As for [`forward`]; `state` is then what it was before.
pub fn integrate<T: Real>(model: &Model, state: &mut State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    match model.options.integrator {
        Integrator::Euler => integrator::euler(model, state, workspace),
        Integrator::Implicit => implicit::implicit(model, state, workspace),
        Integrator::RungeKutta => runge_kutta::runge_kutta(model, state, workspace),
    }
}

/// Refuses states and inputs that are not finite.
pub fn check<T: Real>(model: &Model, state: &State<T>) -> Result<(), Fault> {
    if let Some((coordinate, value)) = invalid(&state.position) {
        return Err(Fault::of_coordinate(model, state.time, coordinate, value));
    }
    if let Some((dof, value)) = invalid(&state.velocity) {
        return Err(Fault::of_dof(model, state.time, Quantity::Velocity, dof, value));
    }
    if let Some((slot, value)) = invalid(&state.activation) {
        let owner = model.actuators.activation.iter().position(|activation| *activation == Some(slot));
        return Err(Fault::of_input(model, state.time, "activation", owner.unwrap_or(0), value));
    }
    if let Some((actuator, value)) = invalid(&state.control) {
        return Err(Fault::of_input(model, state.time, "excitation", actuator, value));
    }
    for (input, fibres) in [("fibre length", &state.fibre_length), ("fibre velocity", &state.fibre_velocity)] {
        if let Some((actuator, value)) = invalid(fibres) {
            return Err(Fault::of_input(model, state.time, input, actuator, value));
        }
    }
    let placed = state.mocap_position.iter().zip(&state.mocap_orientation);
    for (index, (position, orientation)) in placed.enumerate() {
        if invalid(position.as_slice()).or(invalid(orientation)).is_some() {
            return Err(Fault::of_mocap(model, state.time, index));
        }
    }
    Ok(())
}

/// The first value that is not finite or too large, and its index.
fn invalid<T: Real>(values: &[T]) -> Option<(usize, f64)> {
    let lanes = |(index, value): (usize, &T)| (0..T::LANES).map(move |lane| (index, value.lane(lane))).collect::<Vec<_>>();
    // Only a faulty state pays for finding out where.
    if values.iter().all(all_valid) {
        return None;
    }
    values.iter().enumerate().flat_map(lanes).find(|(_, value)| !is_valid(*value))
}

/// Whether a value is sound in every lane.
fn all_valid<T: Real>(value: &T) -> bool {
    (0..T::LANES).all(|lane| is_valid(value.lane(lane)))
}

/// Refuses a step that would end in a state that is not sound, from the accelerations, the rates of positions and the
/// activations (by actuator) that it would take: found before anything is written.
pub(super) fn check_end<T: Real>(
    model: &Model,
    state: &State<T>,
    accelerations: &[T],
    rates: Option<&[T]>,
    mut activations: impl Iterator<Item = (usize, T)>,
) -> Result<(), Fault> {
    let step = T::splat(model.options.timestep);
    let beyond = |(actuator, after): (usize, T)| invalid(&[after]).map(|(_, value)| (actuator, value));
    if let Some((actuator, value)) = activations.find_map(beyond) {
        return Err(Fault::of_input(model, state.time, "activation", actuator, value));
    }
    if let Some((dof, value)) = invalid(accelerations) {
        return Err(Fault::of_dof(model, state.time, Quantity::Acceleration, dof, value));
    }
    let joints = &model.joints;
    for (dof, (&velocity, &acceleration)) in state.velocity.iter().zip(accelerations).enumerate() {
        let after = velocity + step * acceleration;
        if let Some((_, value)) = invalid(&[after]) {
            return Err(Fault::of_dof(model, state.time, Quantity::Velocity, dof, value));
        }
        let joint = model.dofs.joint[dof];
        let axis = dof - joints.dof_address[joint];
        let moves = match joints.kind[joint] {
            JointKind::Hinge | JointKind::Slide => true,
            JointKind::Free => axis < 3,
            JointKind::Ball => false,
        };
        if moves {
            let coordinate = joints.position_address[joint] + axis;
            let rate = rates.map_or(after, |rates| rates[dof]);
            if let Some((_, value)) = invalid(&[state.position[coordinate] + step * rate]) {
                return Err(Fault::of_coordinate(model, state.time, coordinate, value));
            }
        }
    }
    Ok(())
}

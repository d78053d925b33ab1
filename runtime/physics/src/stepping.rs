//! One step of a body.

use super::{
    Workspace, constrained,
    dispatch::{Stage, run},
    fault::{self, Fault, Input, Quantity, is_valid},
    integrator,
    smooth::{forward_actuation, forward_velocity},
    state::State,
    velocities,
};
use crate::{
    model::{JointKind, Model},
    scalar::Real,
};
use pulp::{Simd, WithSimd};

/// Everything up to the acceleration, constraints included, in MuJoCo's order.
///
/// # Errors
/// A state or acceleration that is not finite, or a constraint problem without solution, with its body, joint and time. Of several
/// lanes the first that has a fault; the others have been passed forward.
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
    check(model, state, workspace);
    if !(0..T::LANES).any(|lane| workspace.lives(lane)) {
        return workspace.outcome();
    }
    run(Stage::Kinematics, model, state, workspace);
    lap();
    run(Stage::Inertia, model, state, workspace);
    lap();
    run(Stage::Tendons, model, state, workspace);
    lap();
    constrained::contacts(model, workspace);
    lap();
    forward_velocity(model, state, workspace);
    lap();
    constrained::rows(model, state, workspace);
    lap();
    forward_actuation(model, state, workspace);
    lap();
    constrained::solve(model, state, workspace);
    lap();
    workspace.outcome()
}

/// Names of the stages of a step, in their order.
pub const STAGES: [&str; 9] =
    ["kinematics", "inertia", "tendons", "contacts", "velocities", "rows", "muscles", "solver", "integrator"];

/// The part of [`forward`] that knows no forces: positions, contacts, velocities of bodies.
///
/// # Errors
/// A state that is not finite.
pub fn motion<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    check(model, state, workspace);
    workspace.outcome()?;
    run(Stage::Kinematics, model, state, workspace);
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
    integrator::integrate(model, state, workspace)
}

/// Finds states and inputs that are not finite; forgets the faults of the last step.
fn check<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    workspace.faults.fill(None);
    if workspace.arch.dispatch(AllValid(state)) {
        return;
    }
    for lane in (0..T::LANES).filter(|&lane| !workspace.masked[lane]) {
        workspace.faults[lane] = invalid_input(model, state, lane);
    }
}

/// The first number of a lane that is not finite or too large.
fn invalid_input<T: Real>(model: &Model, state: &State<T>, lane: usize) -> Option<Fault> {
    let time = state.time.lane(lane);
    if let Some((coordinate, value)) = invalid(&state.position, lane) {
        return Some(Fault::of_coordinate(model, time, coordinate, value));
    }
    if let Some((dof, value)) = invalid(&state.velocity, lane) {
        return Some(Fault::of_dof(model, time, Quantity::Velocity, dof, value));
    }
    if let Some((slot, value)) = invalid(&state.activation, lane) {
        let owner = model.actuators.activation.iter().position(|activation| *activation == Some(slot));
        return Some(Fault::of_input(model, time, Input::Activation, owner.unwrap_or(0), value));
    }
    let inputs = [
        (Input::Excitation, &state.control),
        (Input::FibreLength, &state.fibre_length),
        (Input::FibreVelocity, &state.fibre_velocity),
    ];
    for (input, values) in inputs {
        if let Some((actuator, value)) = invalid(values, lane) {
            return Some(Fault::of_input(model, time, input, actuator, value));
        }
    }
    let mut placed = state.mocap_position.iter().zip(&state.mocap_orientation);
    let index = placed.position(|(at, turned)| invalid(at.as_slice(), lane).or(invalid(turned, lane)).is_some())?;
    Some(Fault::of_mocap(model, time, index))
}

/// The first value of a lane that is not finite or too large, and its index.
fn invalid<T: Real>(values: &[T], lane: usize) -> Option<(usize, f64)> {
    values.iter().map(|value| value.lane(lane)).enumerate().find(|(_, value)| !is_valid(*value))
}

/// Whether all that a state gives a step is sound in every lane.
struct AllValid<'a, T: Real>(&'a State<T>);

impl<T: Real> WithSimd for AllValid<'_, T> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self(state) = self;
        let mut valid = T::mask(|_| true);
        let parts: [&[T]; 6] =
            [&state.position, &state.velocity, &state.activation, &state.control, &state.fibre_length, &state.fibre_velocity];
        for part in parts {
            valid = T::and(valid, all_valid(part));
        }
        for (position, orientation) in state.mocap_position.iter().zip(&state.mocap_orientation) {
            valid = T::and(valid, T::and(all_valid(position.as_slice()), all_valid(orientation)));
        }
        T::all(valid)
    }
}

/// In which lanes all values are sound.
#[inline(always)]
fn all_valid<T: Real>(values: &[T]) -> T::Mask {
    let mut valid = T::mask(|_| true);
    for value in values {
        valid = T::and(valid, fault::valid(*value));
    }
    valid
}

/// Finds steps that would end in a state that is not sound, from the accelerations, the rates of positions and the activations
/// (by actuator) that they would take: before anything is written.
///
/// # Errors
/// The fault of the first lane that has one.
#[inline(always)]
pub(super) fn check_end<T: Real>(
    model: &Model,
    state: &State<T>,
    accelerations: &[T],
    rates: Option<&[T]>,
    activations: impl Iterator<Item = (usize, T)> + Clone,
    (masked, faults): (&[bool], &mut [Option<Fault>]),
) -> Result<(), Fault> {
    let step = T::splat(model.options.timestep);
    let after = |dof: usize| state.velocity[dof] + step * accelerations[dof];
    let moved = |dof: usize| {
        let coordinate = moved_coordinate(model, dof)?;
        Some((coordinate, state.position[coordinate] + step * rates.map_or_else(|| after(dof), |rates| rates[dof])))
    };
    let mut valid = T::mask(|_| true);
    for (dof, &acceleration) in accelerations.iter().enumerate() {
        valid = T::and(valid, T::and(fault::valid(acceleration), fault::valid(after(dof))));
        if let Some((_, position)) = moved(dof) {
            valid = T::and(valid, fault::valid(position));
        }
    }
    for (_, activation) in activations.clone() {
        valid = T::and(valid, fault::valid(activation));
    }
    if T::all(valid) {
        return Ok(());
    }
    for lane in (0..T::LANES).filter(|&lane| !masked[lane] && !T::holds(valid, lane)) {
        let time = state.time.lane(lane);
        let beyond = |value: T| Some(value.lane(lane)).filter(|value| !is_valid(*value));
        let activation = || activations.clone().find_map(|(actuator, after)| Some((actuator, beyond(after)?)));
        let of_dof = |quantity: Quantity, value: &dyn Fn(usize) -> T| {
            let (dof, value) = (0..model.nv).find_map(|dof| Some((dof, beyond(value(dof))?)))?;
            Some(Fault::of_dof(model, time, quantity, dof, value))
        };
        let of_motion = || {
            (0..model.nv).find_map(|dof| {
                let of_velocity = |value| Fault::of_dof(model, time, Quantity::Velocity, dof, value);
                let of_position = |(coordinate, position)| Some(Fault::of_coordinate(model, time, coordinate, beyond(position)?));
                beyond(after(dof)).map(of_velocity).or_else(|| moved(dof).and_then(of_position))
            })
        };
        let found = activation().map(|(actuator, value)| Fault::of_input(model, time, Input::Activation, actuator, value));
        let found = found.or_else(|| of_dof(Quantity::Acceleration, &|dof| accelerations[dof])).or_else(of_motion);
        faults[lane] = faults[lane].take().or(found);
    }
    faults.iter().flatten().next().map_or(Ok(()), |fault| Err(fault.clone()))
}

/// The coordinate that moves as fast as a dof; none for turns of balls and free bodies.
fn moved_coordinate(model: &Model, dof: usize) -> Option<usize> {
    let (joints, joint) = (&model.joints, model.dofs.joint[dof]);
    let axis = dof - joints.dof_address[joint];
    let moves = match joints.kind[joint] {
        JointKind::Hinge | JointKind::Slide => true,
        JointKind::Free => axis < 3,
        JointKind::Ball => false,
    };
    moves.then_some(joints.position_address[joint] + axis)
}

//! One step of a body.

use super::{
    Workspace, constrained,
    fault::{Fault, Quantity, is_sound},
    integrator::{self, implicit, runge_kutta},
    smooth::{inputs, motions, positions},
    state::State,
};
use crate::{
    model::{Integrator, Model},
    scalar::Real,
};

/// Everything up to the acceleration, constraints included, in MuJoCo's order.
///
/// # Errors
/// A state or acceleration that is not finite, or a constraint problem without solution, with its body, joint and time.
pub fn forward<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    check(model, state)?;
    positions(model, state, workspace);
    constrained::contacts(model, workspace);
    constrained::rows(model, state, workspace);
    motions(model, state, workspace);
    inputs(model, state, workspace);
    constrained::solve(model, state, workspace)
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
        Integrator::RungeKutta => runge_kutta::runge_kutta(model, state, workspace)?,
    }
    Ok(())
}

/// Refuses states and inputs that are not finite.
pub(crate) fn check<T: Real>(model: &Model, state: &State<T>) -> Result<(), Fault> {
    let unsound = |values: &[T]| {
        let lanes = |(index, value): (usize, &T)| (0..T::LANES).map(move |lane| (index, value.lane(lane))).collect::<Vec<_>>();
        // Only a faulty state pays for finding out where.
        if values.iter().all(|value| (0..T::LANES).all(|lane| is_sound(value.lane(lane)))) {
            return None;
        }
        values.iter().enumerate().flat_map(lanes).find(|(_, value)| !is_sound(*value))
    };
    let input = |input: &'static str, values: &[T]| {
        let fault = unsound(values).map(|(muscle, value)| {
            let muscle = model.actuators.name[muscle].clone();
            Fault::Input { time: state.time, input, muscle, value }
        });
        fault.map_or(Ok(()), Err)
    };
    if let Some((coordinate, value)) = unsound(&state.position) {
        return Err(Fault::of_coordinate(model, state.time, coordinate, value));
    }
    if let Some((dof, value)) = unsound(&state.velocity) {
        return Err(Fault::of_dof(model, state.time, Quantity::Velocity, dof, value));
    }
    input("activation", &state.activation)?;
    input("excitation", &state.control)
}

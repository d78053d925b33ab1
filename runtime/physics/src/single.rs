//! The simulator of one episode in `f64`.
//!
//! The stages are generic over [`Real`](crate::scalar::Real), so a crate that called them with `f64` would compile the whole simulator once
//! more. These functions are compiled here, once, and only linked elsewhere.

use crate::{Fault, State, Workspace, model::Model, stepping};

/// [`stepping::forward`] of one episode.
///
/// # Errors
/// As there.
#[inline(never)]
pub fn forward(model: &Model, state: &State<f64>, workspace: &mut Workspace<f64>) -> Result<(), Fault> {
    stepping::forward(model, state, workspace)
}

/// [`stepping::motion`] of one episode.
///
/// # Errors
/// As there.
#[inline(never)]
pub fn motion(model: &Model, state: &State<f64>, workspace: &mut Workspace<f64>) -> Result<(), Fault> {
    stepping::motion(model, state, workspace)
}

/// [`stepping::integrate`] of one episode.
///
/// # Errors
/// As there.
#[inline(never)]
pub fn integrate(model: &Model, state: &mut State<f64>, workspace: &mut Workspace<f64>) -> Result<(), Fault> {
    stepping::integrate(model, state, workspace)
}

/// [`stepping::step`] of one episode.
///
/// # Errors
/// As there.
pub fn step(model: &Model, state: &mut State<f64>, workspace: &mut Workspace<f64>) -> Result<(), Fault> {
    forward(model, state, workspace)?;
    integrate(model, state, workspace)
}

/// [`smooth::smooth`](mod@crate::smooth) of one episode.
#[inline(never)]
pub fn smooth(model: &Model, state: &State<f64>, workspace: &mut Workspace<f64>) {
    crate::smooth::smooth(model, state, workspace);
}

/// [`smooth::unconstrained`](crate::smooth::unconstrained) of one episode.
#[inline(never)]
pub fn unconstrained(model: &Model, state: &State<f64>, workspace: &mut Workspace<f64>) {
    crate::smooth::unconstrained(model, state, workspace);
}

/// [`smooth::excite`](mod@crate::smooth) of one episode.
#[inline(never)]
pub fn excite(model: &Model, state: &State<f64>, workspace: &mut Workspace<f64>) {
    crate::smooth::excite(model, state, workspace);
}

/// [`step`] with a call of `lap` after each of the [`STAGES`](stepping::STAGES): for clocks.
///
/// # Errors
/// As for [`step`].
#[inline(never)]
pub fn step_by_stage(
    model: &Model,
    state: &mut State<f64>,
    workspace: &mut Workspace<f64>,
    mut lap: &mut dyn FnMut(),
) -> Result<(), Fault> {
    stepping::forward_by_stage(model, state, workspace, &mut lap)?;
    integrate(model, state, workspace)?;
    lap();
    Ok(())
}

//! The constrained half of a step: contacts, rows, solver.

use super::{
    Plan, Workspace,
    constraint::Constraints,
    fault::{Fault, Quantity, is_valid},
    rotation::MINIMUM,
    solver::{Newton, Problem},
    state::State,
};
use crate::{model::Model, scalar::Real};

/// Constraints and solver of one own.
#[derive(Debug, Clone)]
pub struct ConstraintState {
    /// Contacts and constraint rows.
    pub constraints: Constraints,
    /// The solver and what it found.
    pub newton: Newton,
    gathered: Gathered,
}

/// One lane of what the solver reads.
#[derive(Debug, Clone, Default)]
struct Gathered {
    mass: Vec<f64>,
    force: Vec<f64>,
    smooth: Vec<f64>,
    warm_start: Vec<f64>,
}

impl ConstraintState {
    /// Memory for `model`.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &Plan::new(model))
    }

    pub(crate) fn of(model: &Model, plan: &Plan) -> Self {
        let constraints = Constraints::of(model, &plan.pairs, &plan.rows);
        Self { constraints, newton: Newton::of(model, &plan.coupled), gathered: Gathered::default() }
    }
}

fn gather<T: Real>(to: &mut Vec<f64>, from: &[T], lane: usize) {
    to.clear();
    to.extend(from.iter().map(|value| value.lane(lane)));
}

/// Detects the contacts of all lanes. Needs positions.
pub fn contacts<T: Real>(model: &Model, workspace: &mut Workspace<T>) {
    each_lane(workspace, |workspace, own, lane| own.constraints.detect(model, workspace, lane));
}

/// Builds the constraint rows of all lanes. Needs contacts, velocities and the bias of forces.
pub fn rows<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    each_lane(workspace, |workspace, own, lane| own.constraints.build(model, state, workspace, lane));
}

/// Solves for the constrained accelerations of all lanes. Needs rows and the acceleration without constraints.
///
/// # Errors
/// The first lane whose Hessian has no positive pivot or whose acceleration is not finite.
pub fn solve<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    let mut fault = None;
    each_lane(workspace, |workspace, own, lane| {
        let ConstraintState { constraints, newton, gathered } = own;
        gather(&mut gathered.mass, &workspace.inertia.matrix, lane);
        gather(&mut gathered.force, &workspace.forces.smooth, lane);
        gather(&mut gathered.smooth, &workspace.forces.smooth_acceleration, lane);
        gather(&mut gathered.warm_start, &state.warm_start, lane);
        let Gathered { mass, force, smooth, warm_start } = &*gathered;
        let outcome = newton.solve(model, &Problem { mass, force, smooth, warm_start }, constraints);
        constraints.share_forces();
        // An acceleration that is not a number also spoils pivots: it names the origin better.
        let invalid = newton.acceleration.iter().chain(smooth).position(|value| !is_valid(*value)).map(|index| index % model.nv);
        // A joint that moves nothing spoils all above it: it is eliminated first, so the last bad pivot is the origin.
        let pivot = |row: &core::ops::Range<usize>| workspace.inertia.factor[row.end - 1].lane(lane);
        let weightless = invalid.and_then(|_| model.dofs.row.iter().rposition(|row| pivot(row).is_nan() || pivot(row) < MINIMUM));
        if let Some(dof) = weightless {
            fault = fault.take().or(Some(Fault::of_pivot(model, state.time, dof)));
        } else if let Some(dof) = invalid {
            let value = [newton.acceleration[dof], smooth[dof]].into_iter().find(|value| !is_valid(*value)).unwrap_or(f64::NAN);
            fault = fault.take().or(Some(Fault::of_dof(model, state.time, Quantity::Acceleration, dof, value)));
        } else if let Err(dof) = outcome {
            fault = fault.take().or(Some(Fault::of_pivot(model, state.time, dof)));
        }
    });
    for dof in 0..model.nv {
        for (lane, own) in workspace.lanes.iter().enumerate() {
            workspace.acceleration[dof].set_lane(lane, own.newton.acceleration[dof]);
            workspace.constraint_force[dof].set_lane(lane, own.newton.constraint_force[dof]);
        }
    }
    fault.map_or(Ok(()), Err)
}

/// Runs `work` on every lane while the rest of the workspace can be read.
fn each_lane<T: Real>(workspace: &mut Workspace<T>, mut work: impl FnMut(&Workspace<T>, &mut ConstraintState, usize)) {
    let mut lanes = core::mem::take(&mut workspace.lanes);
    for (lane, own) in lanes.iter_mut().enumerate() {
        work(workspace, own, lane);
    }
    workspace.lanes = lanes;
}

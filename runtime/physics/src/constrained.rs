//! The constrained half of a step: contacts, rows, solver.

use super::{
    Plan, Workspace,
    constraint::Constraints,
    fault::{Fault, Quantity, is_valid},
    rotation::MINIMUM,
    smooth::unconstrained,
    solver::{Newton, Problem},
    state::State,
};
use crate::{model::Model, scalar::Real};
use pulp::{Simd, WithSimd};

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

/// Solves for the constrained accelerations of all lanes and notes their faults: a Hessian without a positive pivot, an
/// acceleration that is not finite. Needs rows and forces.
pub fn solve<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    // Where rows exist Newton's method starts from the last acceleration: only a free body needs the factor of its mass matrix.
    let free = workspace.lanes.iter().any(|own| own.constraints.rows.is_empty());
    if free {
        unconstrained(model, state, workspace);
    }
    let mut outcomes = [Ok(()); MOST_LANES];
    each_lane(workspace, |workspace, own, lane| {
        let ConstraintState { constraints, newton, gathered } = own;
        if constraints.rows.is_empty() {
            gather(&mut gathered.smooth, &workspace.forces.smooth_acceleration, lane);
            newton.accept(&gathered.smooth);
        } else {
            gather(&mut gathered.mass, &workspace.inertia.matrix, lane);
            gather(&mut gathered.force, &workspace.forces.smooth, lane);
            gather(&mut gathered.warm_start, &state.warm_start, lane);
            let Gathered { mass, force, warm_start, .. } = &*gathered;
            let problem = Problem { mass, force, warm_start };
            outcomes[lane] = workspace.arch.dispatch(Solve { newton, model, problem, constraints });
        }
        constraints.share_forces();
    });
    let failed = |lane: usize| {
        let newton = &workspace.lanes[lane].newton;
        workspace.lives(lane) && (outcomes[lane].is_err() || newton.acceleration.iter().any(|value| !is_valid(*value)))
    };
    if (0..T::LANES).any(failed) {
        // The factor of the mass matrix names the origin.
        if !free {
            unconstrained(model, state, workspace);
        }
        for (lane, outcome) in outcomes.into_iter().enumerate().take(T::LANES) {
            if workspace.lives(lane) {
                workspace.faults[lane] = fault_of(model, state, workspace, outcome, lane);
            }
        }
    }
    for dof in 0..model.nv {
        for (lane, own) in workspace.lanes.iter().enumerate() {
            workspace.acceleration[dof].set_lane(lane, own.newton.acceleration[dof]);
            workspace.constraint_force[dof].set_lane(lane, own.newton.constraint_force[dof]);
        }
    }
}

/// Lanes that a number may have at most.
const MOST_LANES: usize = 8;

/// What is wrong with the solution of a lane.
fn fault_of<T: Real>(
    model: &Model,
    state: &State<T>,
    workspace: &Workspace<T>,
    outcome: Result<(), usize>,
    lane: usize,
) -> Option<Fault> {
    let time = state.time.lane(lane);
    let newton = &workspace.lanes[lane].newton;
    let smooth = |dof: usize| workspace.forces.smooth_acceleration[dof].lane(lane);
    // An acceleration that is not a number also spoils pivots: it names the origin better.
    let dofs = || 0..model.nv;
    let invalid = dofs().find(|&dof| !is_valid(newton.acceleration[dof])).or_else(|| dofs().find(|&dof| !is_valid(smooth(dof))));
    // A joint that moves nothing spoils all above it: it is eliminated first, so the last bad pivot is the origin.
    let pivot = |row: &core::ops::Range<usize>| workspace.inertia.factor[row.end - 1].lane(lane);
    let weightless = invalid.and_then(|_| model.dofs.row.iter().rposition(|row| pivot(row).is_nan() || pivot(row) < MINIMUM));
    if let Some(dof) = weightless {
        return Some(Fault::of_pivot(model, time, dof));
    }
    if let Some(dof) = invalid {
        let value = [newton.acceleration[dof], smooth(dof)].into_iter().find(|value| !is_valid(*value)).unwrap_or(f64::NAN);
        return Some(Fault::of_dof(model, time, Quantity::Acceleration, dof, value));
    }
    outcome.err().map(|dof| Fault::of_pivot(model, time, dof))
}

/// One solve, compiled for each set of instructions.
struct Solve<'a> {
    newton: &'a mut Newton,
    model: &'a Model,
    problem: Problem<'a>,
    constraints: &'a mut Constraints,
}

impl WithSimd for Solve<'_> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.newton.solve(self.model, &self.problem, self.constraints)
    }
}

/// Runs `work` on every lane that is stepped while the rest of the workspace can be read.
fn each_lane<T: Real>(workspace: &mut Workspace<T>, mut work: impl FnMut(&Workspace<T>, &mut ConstraintState, usize)) {
    let mut lanes = core::mem::take(&mut workspace.lanes);
    for (lane, own) in lanes.iter_mut().enumerate().filter(|(lane, _)| workspace.lives(*lane)) {
        work(workspace, own, lane);
    }
    workspace.lanes = lanes;
}

//! The constrained half of a step: contacts, rows, solver.

use super::{
    Plan, Workspace,
    batch::PerLane,
    collision::{Contact, Memory, NearPairs},
    constraint::{Constraints, Extent},
    fault::{Fault, Quantity, is_valid},
    kinematics::Kinematics,
    rotation::MINIMUM,
    smooth::unconstrained,
    solver::{
        Newton, Problem,
        no_slip::{NoSlip, Unconstrained},
        slots::Source,
        together::{self, Together},
    },
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
    no_slip: NoSlip,
    gathered: Gathered,
}

/// One lane of what the solver reads.
#[derive(Debug, Clone, Default)]
struct Gathered {
    mass: Vec<f64>,
    force: Vec<f64>,
    smooth: Vec<f64>,
    warm_start: Vec<f64>,
    factor: Vec<f64>,
}

impl ConstraintState {
    /// Memory for `model`.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &Plan::new(model))
    }

    pub(crate) fn of(model: &Model, plan: &Plan) -> Self {
        let constraints = Constraints::of(model, &plan.pairs, &plan.rows);
        Self { constraints, newton: Newton::of(model, &plan.coupled), no_slip: NoSlip::default(), gathered: Gathered::default() }
    }
}

fn gather<T: Real>(to: &mut Vec<f64>, from: &[T], lane: usize) {
    to.clear();
    to.extend(from.iter().map(|value| value.lane(lane)));
}

/// Detects the contacts of all lanes. Needs positions.
pub fn contacts<T: Real>(model: &Model, workspace: &mut Workspace<T>) {
    let mut contacts: PerLane<&mut Vec<Contact>> = Default::default();
    let Workspace { arch, kinematics, near, memory, lanes, masked, faults, .. } = workspace;
    let living = masked.iter().zip(&*faults).map(|(masked, fault)| !masked && fault.is_none());
    for ((list, own), lives) in contacts.iter_mut().zip(lanes).zip(living) {
        *list = lives.then_some(&mut own.constraints.contacts);
    }
    arch.dispatch(FindContacts { model, kinematics, near, contacts, memory });
}

/// Builds the constraint rows of all lanes. Needs contacts, velocities and the bias of forces.
pub fn rows<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    let Some(mut solver) = workspace.together.take() else {
        return each_lane(workspace, |workspace, own, lane| own.constraints.build(model, state, workspace, lane));
    };
    each_lane(workspace, |workspace, own, lane| {
        own.constraints.build_extent(model, state, workspace, lane, Extent::Unshared);
    });
    if let Some(own) = workspace.lanes.first() {
        let living = T::mask(|lane| workspace.lives(lane));
        let (plan, pairs) = (&*own.constraints.fixed, &*own.constraints.plan);
        let source = Source { model, plan, pairs, state, kinematics: &workspace.kinematics, lanes: &workspace.lanes, living };
        workspace.arch.dispatch(BuildTogether { solver: &mut solver, source });
    }
    workspace.together = Some(solver);
}

/// Gives lanes that have been solved together all of their rows, and the forces of these and of their contacts: of those for which
/// `wanted` holds. Needs what [`rows`] and [`solve`] have left.
pub(crate) fn complete<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>, wanted: impl Fn(usize) -> bool) {
    let Some(mut solver) = workspace.together.take() else { return };
    each_lane(workspace, |workspace, own, lane| {
        if wanted(lane) && own.constraints.extent == Extent::Unshared {
            own.constraints.build(model, state, workspace, lane);
            solver.scatter_forces(own, lane);
            own.constraints.share_forces();
        }
    });
    workspace.together = Some(solver);
}

/// Solves for the constrained accelerations of all lanes and notes their faults: a Hessian without a positive pivot, an
/// acceleration that is not finite. Needs rows and forces.
pub fn solve<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    // Where rows exist Newton's method starts from the last acceleration: only a free body and the second pass over friction need the
    // factor of the mass matrix.
    let second = model.options.no_slip_iterations > 0;
    let free = second || (0..T::LANES).any(|lane| workspace.lives(lane) && !has_rows(workspace, lane));
    if free {
        unconstrained(model, state, workspace);
    }
    let together = solve_together(model, state, workspace);
    let mut outcomes = [Ok(()); MOST_LANES];
    each_lane(workspace, |workspace, own, lane| {
        let ConstraintState { constraints, newton, no_slip, gathered } = own;
        if together[lane] {
            return;
        }
        if constraints.extent == Extent::Unshared {
            constraints.build(model, state, workspace, lane);
        }
        if constraints.rows.is_empty() {
            gather(&mut gathered.smooth, &workspace.forces.smooth_acceleration, lane);
            newton.accept(&gathered.smooth);
        } else {
            gather(&mut gathered.mass, &workspace.inertia.matrix, lane);
            gather(&mut gathered.force, &workspace.forces.smooth, lane);
            gather(&mut gathered.warm_start, &state.warm_start, lane);
            if second {
                gather(&mut gathered.smooth, &workspace.forces.smooth_acceleration, lane);
                gather(&mut gathered.factor, &workspace.inertia.factor, lane);
            }
            let Gathered { mass, force, warm_start, smooth, factor } = &*gathered;
            let problem = Problem { mass, force, warm_start };
            let unconstrained = Unconstrained { factor, acceleration: smooth };
            let no_slip = second.then_some((no_slip, unconstrained));
            outcomes[lane] = workspace.arch.dispatch(Solve { newton, no_slip, model, problem, constraints });
        }
        constraints.share_forces();
    });
    for (lane, own) in workspace.lanes.iter().enumerate().filter(|(lane, _)| !together[*lane]) {
        for dof in 0..model.nv {
            workspace.acceleration[dof].set_lane(lane, own.newton.acceleration[dof]);
            workspace.constraint_force[dof].set_lane(lane, own.newton.constraint_force[dof]);
        }
    }
    let failed = |lane: usize| {
        let invalid = |value: &T| !is_valid(value.lane(lane));
        workspace.lives(lane) && (outcomes[lane].is_err() || !together[lane] && workspace.acceleration.iter().any(invalid))
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
}

/// Solves the lanes that have rows together, as far as that goes, and returns which have been.
fn solve_together<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) -> [bool; MOST_LANES] {
    let Some(mut solver) = workspace.together.take() else { return [false; MOST_LANES] };
    let wanted = T::and(solver.occupied(), T::mask(|lane| workspace.lives(lane)));
    let mut solved = [false; MOST_LANES];
    if T::any(wanted) && solver.prepare(model, &workspace.lanes) {
        let problem =
            together::Problem { mass: &workspace.inertia.matrix, force: &workspace.forces.smooth, warm_start: &state.warm_start };
        let mask = workspace.arch.dispatch(SolveTogether { solver: &mut solver, model, problem, wanted });
        solved = core::array::from_fn(|lane| lane < T::LANES && T::holds(mask, lane));
        workspace.acceleration.copy_from_slice(&solver.acceleration);
        workspace.constraint_force.copy_from_slice(&solver.constraint_force);
        for (lane, own) in workspace.lanes.iter_mut().enumerate().filter(|(lane, _)| solved[*lane]) {
            solver.scatter(own, lane);
        }
    }
    workspace.together = Some(solver);
    solved
}

/// Whether anything is constrained in a lane.
fn has_rows<T: Real>(workspace: &Workspace<T>, lane: usize) -> bool {
    match &workspace.together {
        Some(solver) => T::holds(solver.occupied(), lane),
        None => !workspace.lanes[lane].constraints.rows.is_empty(),
    }
}

/// Lanes that a number may have at most.
const MOST_LANES: usize = crate::lanes::WIDTH;

/// What is wrong with the solution of a lane.
fn fault_of<T: Real>(
    model: &Model,
    state: &State<T>,
    workspace: &Workspace<T>,
    outcome: Result<(), usize>,
    lane: usize,
) -> Option<Fault> {
    let time = state.time.lane(lane);
    let acceleration = |dof: usize| workspace.acceleration[dof].lane(lane);
    let smooth = |dof: usize| workspace.forces.smooth_acceleration[dof].lane(lane);
    // An acceleration that is not a number also spoils pivots: it names the origin better.
    let dofs = || 0..model.nv;
    let invalid = dofs().find(|&dof| !is_valid(acceleration(dof))).or_else(|| dofs().find(|&dof| !is_valid(smooth(dof))));
    // A joint that moves nothing spoils all above it: it is eliminated first, so the last bad pivot is the origin.
    let pivot = |row: &core::ops::Range<usize>| workspace.inertia.factor[row.end - 1].lane(lane);
    let weightless = invalid.and_then(|_| model.dofs.row.iter().rposition(|row| pivot(row).is_nan() || pivot(row) < MINIMUM));
    if let Some(dof) = weightless {
        return Some(Fault::of_pivot(model, time, dof));
    }
    if let Some(dof) = invalid {
        let value = [acceleration(dof), smooth(dof)].into_iter().find(|value| !is_valid(*value)).unwrap_or(f64::NAN);
        return Some(Fault::of_dof(model, time, Quantity::Acceleration, dof, value));
    }
    outcome.err().map(|dof| Fault::of_pivot(model, time, dof))
}

/// The search for near pairs and their contacts, compiled for each set of instructions.
struct FindContacts<'a, T: Real> {
    model: &'a Model,
    kinematics: &'a Kinematics<T>,
    near: &'a mut NearPairs<T>,
    contacts: PerLane<&'a mut Vec<Contact>>,
    memory: &'a mut Memory<T>,
}

impl<T: Real> WithSimd for FindContacts<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { model, kinematics, near, mut contacts, memory } = self;
        near.update(model, kinematics);
        near.detect(model, kinematics, &mut contacts, memory);
    }
}

/// One solve, compiled for each set of instructions.
struct Solve<'a> {
    newton: &'a mut Newton,
    no_slip: Option<(&'a mut NoSlip, Unconstrained<'a>)>,
    model: &'a Model,
    problem: Problem<'a>,
    constraints: &'a mut Constraints,
}

impl WithSimd for Solve<'_> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { newton, model, constraints, .. } = self;
        newton.solve(model, &self.problem, constraints)?;
        if let Some((no_slip, unconstrained)) = self.no_slip {
            newton.iterations += no_slip.run(model, &unconstrained, constraints);
            newton.take_forces(model, &unconstrained, constraints);
        }
        Ok(())
    }
}

/// The rows of all lanes, compiled for each set of instructions.
struct BuildTogether<'a, T: Real> {
    solver: &'a mut Together<T>,
    source: Source<'a, T>,
}

impl<T: Real> WithSimd for BuildTogether<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.solver.build(&self.source);
    }
}

/// One solve of all lanes, compiled for each set of instructions.
struct SolveTogether<'a, T: Real> {
    solver: &'a mut Together<T>,
    model: &'a Model,
    problem: together::Problem<'a, T>,
    wanted: T::Mask,
}

impl<T: Real> WithSimd for SolveTogether<'_, T> {
    type Output = T::Mask;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> T::Mask {
        self.solver.solve(self.model, &self.problem, self.wanted)
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

//! Inverse dynamics in independent coordinates.

use super::allocation::Columns;
use super::coordinates::{Coordinates, Slopes};
use core::ops::Range;
use msk_physics::model::{Model, Muscle};
use msk_physics::path_matrix::PathPattern;
use msk_physics::scalar::Real;
use msk_physics::spatial::Spatial;
use msk_physics::tendons::TendonPaths;
use msk_physics::{MomentPlan, State, Workspace, inertia};

/// The equations of motion of one control step, E ẇ + load = Σ activation · arm · strength + contact forces.
#[derive(Debug, Clone)]
pub(super) struct Dynamics<T> {
    /// E = P'M P + T P'D P: inertia, and what damping takes over a hold of T (see [`update`](Self::update)); with
    /// [`COMMON_INERTIA`] on its diagonal. On the pattern.
    pub inertia: Vec<T>,
    /// Coordinates that bodies or muscles couple lie on one path of it.
    pub pattern: PathPattern,
    /// Everything but active muscle force and contact, on the left-hand side: N and N m.
    pub load: Vec<T>,
    moments: MomentPlan,
    screws: Vec<Spatial<T>>,
    crossing: Vec<Crossing>,
    projected: Vec<Projected>,
    /// Scratch of `nv` entries.
    full: Vec<T>,
    /// Moment arms of the muscles, one column each.
    arms: Columns<T>,
    /// Of each muscle: its damping within the hold, N s²/m, and minus its passive force, N.
    held: Vec<T>,
    resistance: Vec<T>,
}

/// A muscle, and what it moves.
#[derive(Debug, Clone)]
struct Crossing {
    actuator: usize,
    muscle: Muscle,
    /// The independent coordinates that it moves, ascending.
    rows: Vec<usize>,
    /// Its entries among those of all columns.
    values: Range<usize>,
}

/// An entry of the mass matrix, and where it goes.
#[derive(Debug, Clone, Copy)]
struct Projected {
    from: usize,
    to: usize,
    dofs: [usize; 2],
    factor: f64,
}

/// Inertia added to every coordinate, kg m². It keeps errors of the fingers, whose inertia is a thousandth of a leg's, from
/// counting a thousand times as much.
const COMMON_INERTIA: f64 = 0.01;

impl<T: Real> Dynamics<T> {
    /// Memory for `model`, whose tendons have these paths.
    pub fn new(model: &Model, paths: &TendonPaths<T>, coordinates: &Coordinates) -> Self {
        let moments = MomentPlan::new(model, paths, |dof| coordinates.of(dof));
        let mut entries = 0;
        let crossing = |(actuator, muscle): (usize, Muscle)| {
            let rows: Vec<usize> = moments.coordinates(muscle.tendon).collect();
            let values = entries..entries + rows.len();
            entries = values.end;
            Crossing { actuator, muscle, rows, values }
        };
        let crossing: Vec<Crossing> = model.actuators.muscles().map(crossing).collect();
        let mut pattern = PathPattern::default();
        let bodies = coupled_by_bodies(model, coordinates);
        let coupled = bodies.iter().map(|pair| &pair[..]).chain(crossing.iter().map(|crossing| &crossing.rows[..]));
        pattern.rebuild(&vec![None; coordinates.len()], coupled);
        let mut arms = Columns::default();
        for Crossing { rows, .. } in &crossing {
            arms.push(&pattern, rows.iter().map(|&row| (row, T::splat(0.0))));
        }
        let zeros = vec![T::splat(0.0); crossing.len()];
        Self {
            projected: projected(model, coordinates, &pattern),
            moments,
            screws: Vec::new(),
            crossing,
            inertia: vec![T::splat(0.0); pattern.column.len()],
            pattern,
            load: vec![T::splat(0.0); coordinates.len()],
            full: vec![T::splat(0.0); model.nv],
            arms,
            held: zeros.clone(),
            resistance: zeros,
        }
    }

    /// Number of muscles.
    pub fn muscles(&self) -> usize {
        self.crossing.len()
    }

    /// Columns of zeros for the muscles, where theirs have entries.
    pub fn columns(&self) -> Columns<T> {
        self.arms.clone()
    }

    /// Fills the equations for forces held over `hold` (T, s), and the generalised force of each muscle at full activation, in
    /// [columns](Self::columns).
    ///
    /// Joint damping and the force-velocity curves act within the hold: a joint of small inertia is stopped by them in less
    /// than 10 ms. With the damping taken implicitly, M (v₁ - v₀)/T = force - D v₁ and hence (M + T D) v̇ = force - D v₀, where
    /// v̇ is the mean acceleration over the hold. D holds the joints' damping and, at the present activation, the slopes of the
    /// force-velocity curves.
    #[inline(always)]
    pub fn update(
        &mut self,
        (model, state, workspace): (&Model, &State<T>, &Workspace<T>),
        (coordinates, slopes): (&Coordinates, &Slopes<T>),
        hold: f64,
        columns: &mut Columns<T>,
    ) {
        self.project_inertia(workspace, slopes);
        self.fill_load(model, workspace, (coordinates, slopes));
        self.moments.update(&workspace.kinematics, slopes.all(), &mut self.screws);
        for index in 0..self.crossing.len() {
            self.fill_muscle(index, (state, workspace), slopes, hold, columns.values_mut());
        }
        self.arms.add_scaled(&self.resistance, &mut self.load);
        self.arms.add_squares(&self.held, &self.pattern, &mut self.inertia);
        let hold = T::splat(hold);
        for (dof, &damping) in state.damping.iter().enumerate() {
            if let Some(column) = coordinates.of(dof) {
                let slope = slopes.of(dof);
                self.inertia[self.pattern.row[column].end - 1] += hold * damping * slope * slope;
            }
        }
        for row in &self.pattern.row {
            self.inertia[row.end - 1] += T::splat(COMMON_INERTIA);
        }
    }

    /// The generalised force that muscles and contacts have to make for `accelerations`.
    #[inline(always)]
    pub fn required_force(&self, accelerations: &[T], out: &mut [T]) {
        self.pattern.layout().multiply(&self.inertia, accelerations, out);
        for ((force, &load), &acceleration) in out.iter_mut().zip(&self.load).zip(accelerations) {
            T::apart();
            *force += load - T::splat(COMMON_INERTIA) * acceleration;
        }
    }

    /// P'M P
    #[inline(always)]
    fn project_inertia(&mut self, workspace: &Workspace<T>, slopes: &Slopes<T>) {
        self.inertia.fill(T::splat(0.0));
        for &Projected { from, to, dofs: [dof, other], factor } in &self.projected {
            T::apart();
            self.inertia[to] += T::splat(factor) * slopes.of(dof) * slopes.of(other) * workspace.inertia.matrix[from];
        }
    }

    /// P'(M d + bias - passive); passive muscle forces follow with the muscles.
    #[inline(always)]
    fn fill_load(&mut self, model: &Model, workspace: &Workspace<T>, (coordinates, slopes): (&Coordinates, &Slopes<T>)) {
        inertia::multiply(model, &workspace.inertia.matrix, &slopes.drift, &mut self.full);
        for ((total, &bias), &passive) in self.full.iter_mut().zip(&workspace.forces.bias).zip(&workspace.forces.passive) {
            T::apart();
            *total += bias - passive;
        }
        slopes.project(coordinates, &self.full, &mut self.load);
    }

    #[inline(always)]
    fn fill_muscle(
        &mut self,
        index: usize,
        (state, workspace): (&State<T>, &Workspace<T>),
        slopes: &Slopes<T>,
        hold: f64,
        columns: &mut [T],
    ) {
        let Crossing { actuator, muscle, values, .. } = &self.crossing[index];
        let gear = T::splat(muscle.gear);
        let (strength, passive) = (gear * workspace.actuation.gain[*actuator], gear * workspace.actuation.bias[*actuator]);
        let moments = self.moments.row(&workspace.tendons, (&self.screws, slopes.all()), muscle.tendon);
        let entries = self.arms.values_mut()[values.clone()].iter_mut().zip(&mut columns[values.clone()]);
        for ((arm, value), moment) in entries.zip(moments) {
            T::apart();
            (*arm, *value) = (moment, moment * strength);
        }
        let activation = state.activation[muscle.activation];
        let damping = gear * gear * activation * workspace.actuation.active_damping(state, *actuator);
        let zero = T::splat(0.0);
        self.held[index] = T::splat(hold) * T::select(zero.less(damping), damping, zero);
        self.resistance[index] = -passive;
    }
}

/// Where P'M P takes the entries of the mass matrix.
fn projected(model: &Model, coordinates: &Coordinates, pattern: &PathPattern) -> Vec<Projected> {
    let entry = |dof: usize, from: usize| {
        let other = model.dofs.column[from];
        let (a, b) = (coordinates.of(dof)?, coordinates.of(other)?);
        let to = pattern.row[a.max(b)].start + pattern.depth(a.min(b));
        // An entry off the diagonal stands for two, which meet on the diagonal if one coordinate moves both dofs.
        let factor = if a == b && dof != other { 2.0 } else { 1.0 };
        Some(Projected { from, to, dofs: [dof, other], factor })
    };
    (0..model.nv).flat_map(|dof| model.dofs.row[dof].clone().filter_map(move |from| entry(dof, from))).collect()
}

/// The pairs of independent coordinates that the inertia of a body couples, ascending.
fn coupled_by_bodies(model: &Model, coordinates: &Coordinates) -> Vec<[usize; 2]> {
    let of = |dof: usize| {
        let others = model.dofs.column[model.dofs.row[dof].clone()].iter();
        others.map(move |&other| (coordinates.of(dof), coordinates.of(other)))
    };
    let ascending = |pair: (Option<usize>, Option<usize>)| match pair {
        (Some(a), Some(b)) if a != b => Some([a.min(b), a.max(b)]),
        _ => None,
    };
    let mut pairs: Vec<[usize; 2]> = (0..model.nv).flat_map(of).filter_map(ascending).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

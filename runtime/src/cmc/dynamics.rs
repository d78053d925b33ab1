//! Inverse dynamics in independent coordinates.

use super::{View, allocation::Columns, coordinates::Coordinates, support::Point};
use msk_physics::model::{Model, Muscle};
use msk_physics::path_matrix::PathPattern;
use msk_physics::{Workspace, center_of_mass_jacobian, each_moment_arm, inertia, moment_dofs, moving_dofs, point_jacobian};
use nalgebra::Vector3;

/// The equations of motion of one control step, E ẇ + load = Σ activation · arm · strength + contact forces.
#[derive(Debug, Clone)]
pub(super) struct Dynamics {
    /// E = P'M P + T P'D P: inertia, and what damping takes over a hold of T (see [`update`](Self::update)); with
    /// [`COMMON_INERTIA`] on its diagonal. On the pattern.
    pub inertia: Vec<f64>,
    /// Coordinates that bodies or muscles couple lie on one path of it.
    pub pattern: PathPattern,
    /// Everything but active muscle force and contact, on the left-hand side: N and N m.
    pub load: Vec<f64>,
    /// Generalised force of each muscle at full activation.
    pub muscles: Columns<f64>,
    crossing: Vec<Crossing>,
    /// Scratch of `nv` entries.
    full: Vec<f64>,
    row: Vec<f64>,
}

/// A muscle, and what it moves.
#[derive(Debug, Clone)]
struct Crossing {
    actuator: usize,
    muscle: Muscle,
    /// Ascending.
    dofs: Vec<usize>,
    /// The independent coordinates that move these, ascending.
    rows: Vec<usize>,
}

/// Inertia added to every coordinate, kg m². It keeps errors of the fingers, whose inertia is a thousandth of a leg's, from
/// counting a thousand times as much.
const COMMON_INERTIA: f64 = 0.01;

impl Dynamics {
    /// Memory for `model`.
    pub fn new(model: &Model, workspace: &Workspace<f64>, coordinates: &Coordinates) -> Self {
        let crossing = |(actuator, muscle): (usize, Muscle)| {
            let dofs = moment_dofs(model, &workspace.tendons, muscle.tendon);
            let mut rows: Vec<usize> = dofs.iter().filter_map(|&dof| Some(coordinates.entry(dof)?.0)).collect();
            rows.sort_unstable();
            rows.dedup();
            Crossing { actuator, muscle, dofs, rows }
        };
        let crossing: Vec<Crossing> = model.actuators.muscles().map(crossing).collect();
        let mut pattern = PathPattern::default();
        let bodies = coupled_by_bodies(model, coordinates);
        let coupled = bodies.iter().map(|pair| &pair[..]).chain(crossing.iter().map(|crossing| &crossing.rows[..]));
        pattern.rebuild(&vec![None; coordinates.len()], coupled);
        Self {
            crossing,
            inertia: vec![0.0; pattern.column.len()],
            pattern,
            load: vec![0.0; coordinates.len()],
            muscles: Columns::default(),
            full: vec![0.0; model.nv],
            row: vec![0.0; coordinates.len()],
        }
    }

    /// Adds to the entry of E at (`row`, `column`), `column` <= `row`.
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.inertia[self.pattern.row[row].start + self.pattern.depth(column)] += value;
    }

    /// Fills the equations for forces held over T = `view.hold`.
    ///
    /// Joint damping and the force-velocity curves act within the hold: a joint of small inertia is stopped by them in less
    /// than 10 ms. With the damping taken implicitly, M (v₁ - v₀)/T = force - D v₁ and hence (M + T D) v̇ = force - D v₀, where
    /// v̇ is the mean acceleration over the hold. D holds the joints' damping and, at the present activation, the slopes of the
    /// force-velocity curves.
    pub fn update(&mut self, view: &View<'_>) {
        let View { state, coordinates, hold, .. } = *view;
        self.project_inertia(view);
        self.fill_load(view);
        self.muscles.truncate(0);
        let crossing = core::mem::take(&mut self.crossing);
        crossing.iter().for_each(|crossing| self.add_muscle(view, crossing));
        self.crossing = crossing;
        for (dof, &damping) in state.damping.iter().enumerate() {
            if let Some((column, slope)) = coordinates.entry(dof) {
                self.add(column, column, hold * damping * slope * slope);
            }
        }
        for coordinate in 0..coordinates.len() {
            self.add(coordinate, coordinate, COMMON_INERTIA);
        }
    }

    /// The generalised force that muscles and contacts have to make for `accelerations`.
    pub fn required_force(&self, accelerations: &[f64], out: &mut [f64]) {
        self.pattern.layout().multiply(&self.inertia, accelerations, out);
        for ((force, load), acceleration) in out.iter_mut().zip(&self.load).zip(accelerations) {
            *force += load - COMMON_INERTIA * acceleration;
        }
    }

    /// P'M P
    fn project_inertia(&mut self, view: &View<'_>) {
        let View { model, coordinates, workspace, .. } = *view;
        self.inertia.fill(0.0);
        for dof in 0..model.nv {
            let Some((a, slope_a)) = coordinates.entry(dof) else { continue };
            for index in model.dofs.row[dof].clone() {
                let other = model.dofs.column[index];
                let Some((b, slope_b)) = coordinates.entry(other) else { continue };
                // An entry off the diagonal stands for two, which meet on the diagonal if one coordinate moves both dofs.
                let twice = if a == b && dof != other { 2.0 } else { 1.0 };
                self.add(a.max(b), a.min(b), twice * slope_a * slope_b * workspace.inertia.matrix[index]);
            }
        }
    }

    /// P'(M d + bias - passive); passive muscle forces follow with the muscles.
    fn fill_load(&mut self, view: &View<'_>) {
        let View { model, coordinates, workspace, .. } = *view;
        inertia::multiply(model, &workspace.inertia.matrix, &coordinates.drift, &mut self.full);
        for ((total, bias), passive) in self.full.iter_mut().zip(&workspace.forces.bias).zip(&workspace.forces.passive) {
            *total += bias - passive;
        }
        coordinates.project(&self.full, &mut self.load);
    }

    fn add_muscle(&mut self, view: &View<'_>, crossing: &Crossing) {
        let View { model, coordinates, state, workspace, hold, .. } = *view;
        let Crossing { actuator, muscle, dofs, rows } = crossing;
        let (full, row, pattern) = (&mut self.full, &mut self.row, &self.pattern);
        dofs.iter().for_each(|&dof| full[dof] = 0.0);
        each_moment_arm(model, &workspace.kinematics, &workspace.tendons, muscle.tendon, |dof, part| full[dof] += part);
        rows.iter().for_each(|&coordinate| row[coordinate] = 0.0);
        for &dof in dofs {
            if let Some((coordinate, slope)) = coordinates.entry(dof) {
                row[coordinate] += slope * full[dof];
            }
        }
        let strength = muscle.gear * workspace.actuation.gain[*actuator];
        let arms = rows.iter().map(|&coordinate| (coordinate, row[coordinate]));
        self.muscles.push(arms.clone().map(|(coordinate, arm)| (coordinate, arm * strength)));
        let passive = muscle.gear * workspace.actuation.bias[*actuator];
        for (coordinate, arm) in arms.clone() {
            self.load[coordinate] -= arm * passive;
        }
        let activation = state.activation[muscle.activation];
        let damping = muscle.gear * muscle.gear * activation * workspace.actuation.active_damping(state, *actuator);
        if damping > 0.0 {
            for (count, (coordinate, arm)) in arms.clone().enumerate() {
                for (earlier, other) in arms.clone().take(count + 1) {
                    self.inertia[pattern.row[coordinate].start + pattern.depth(earlier)] += hold * damping * arm * other;
                }
            }
        }
    }
}

/// The pairs of independent coordinates that the inertia of a body couples, ascending.
fn coupled_by_bodies(model: &Model, coordinates: &Coordinates) -> Vec<[usize; 2]> {
    let place = |dof: usize| coordinates.entry(dof).map(|(coordinate, _)| coordinate);
    let of = |dof: usize| model.dofs.column[model.dofs.row[dof].clone()].iter().map(move |&other| (place(dof), place(other)));
    let ascending = |pair: (Option<usize>, Option<usize>)| match pair {
        (Some(a), Some(b)) if a != b => Some([a.min(b), a.max(b)]),
        _ => None,
    };
    let mut pairs: Vec<[usize; 2]> = (0..model.nv).flat_map(of).filter_map(ascending).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// How a point moves with the independent coordinates.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    /// Velocity (m/s, world axes) per unit velocity of each coordinate, as far as it moves the point; ascending.
    pub columns: Vec<(usize, Vector3<f64>)>,
}

impl Motion {
    /// From the Jacobian of the point with respect to `dofs`, those that can move it.
    fn new(coordinates: &Coordinates, dofs: impl Iterator<Item = usize>, jacobian: &[Vector3<f64>]) -> Self {
        let mut columns: Vec<(usize, Vector3<f64>)> =
            dofs.filter_map(|dof| coordinates.entry(dof).map(|(column, slope)| (column, slope * jacobian[dof]))).collect();
        columns.sort_by_key(|(column, _)| *column);
        // Coupled dofs move with one coordinate.
        columns.dedup_by(|(column, motion), (kept, sum)| {
            let same = column == kept;
            if same {
                *sum += *motion;
            }
            same
        });
        Self { columns }
    }

    /// Of a point of the feet.
    pub fn of_point(view: &View<'_>, point: &Point) -> Self {
        let (mut translation, mut rotation) = (vec![Vector3::zeros(); view.model.nv], vec![Vector3::zeros(); view.model.nv]);
        let (model, kinematics) = (view.model, &view.workspace.kinematics);
        point_jacobian(model, kinematics, point.body, &point.position, &mut translation, &mut rotation);
        Self::new(view.coordinates, moving_dofs(model, point.body).iter().copied(), &translation)
    }

    /// Of the common centre of mass of `body` and all that hangs on it.
    pub fn of_com(view: &View<'_>, body: usize) -> Self {
        let mut translation = vec![Vector3::zeros(); view.model.nv];
        let workspace = view.workspace;
        center_of_mass_jacobian(view.model, &workspace.kinematics, &workspace.inertia, body, &mut translation);
        Self::new(view.coordinates, 0..view.model.nv, &translation)
    }

    /// Velocity of the point, m/s, at those velocities of the independent coordinates.
    pub fn velocity(&self, velocities: &[f64]) -> Vector3<f64> {
        self.columns.iter().map(|(column, motion)| motion * velocities[*column]).sum()
    }

    /// The generalised force of a `force` (N, world axes) at the point.
    pub fn force(&self, force: Vector3<f64>) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.columns.iter().map(move |(column, motion)| (*column, motion.dot(&force)))
    }
}

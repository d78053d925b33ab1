//! Friction that does not creep: MuJoCo's second pass over the forces of friction (`noslip_iterations`).
//!
//! The regularised problem of [`Newton`](super::Newton) lets a resting contact creep. Where a model asks for it, the forces of
//! friction alone are then found again without regularisation, all other forces as they are: projected Gauss-Seidel (manual,
//! chapter Computation, "Noslip solver") on the dual problem
//!
//! ```text
//! minimise over f   1/2 f' A f + f' (J a_smooth - a_ref),   A = J M^-1 J'
//! ```
//!
//! with friction losses between their bounds, the edges of a pyramid in opposing pairs of constant sum, and the friction of an
//! elliptic contact in the ellipse that its normal force leaves it (`ellipse`).
//!
//! A itself is never formed. The acceleration a = a_smooth + M^-1 J' f follows every change of a force, which costs one response
//! M^-1 j per direction j of friction, and a row's residual is j a - a_ref.
//!
//! Trees that constraints connect are an island; each ends on its own, when a sweep over it improves the cost, divided by the mean
//! inertia and the number of dofs, by less than the tolerance.

mod ellipse;
mod islands;

use crate::{
    constraint::{
        Constraints, RowKind, Rows,
        jacobian::{Block, Jacobian, MOST_BASE_ROWS, Shape},
    },
    inertia,
    model::Model,
    rotation::MINIMUM,
    scalar::Real,
};
use ellipse::{MOST_FRICTIONS, minimum_in_ellipse};
use islands::Islands;

/// A change that raises the cost by more than this is taken back.
const MOST_RISE: f64 = 1e-10;

/// The body without constraints.
pub(crate) struct Unconstrained<'a> {
    /// Factor of the mass matrix ([`inertia::factor`]).
    pub factor: &'a [f64],
    /// Acceleration without constraints.
    pub acceleration: &'a [f64],
}

/// Memory of the pass.
#[derive(Debug, Clone, Default)]
pub(crate) struct NoSlip {
    /// a_smooth + M^-1 J' f.
    acceleration: Vec<f64>,
    /// M^-1 j of every direction of friction, `nv` entries each.
    responses: Vec<f64>,
    /// The first response of each block.
    first: Vec<usize>,
    islands: Islands,
}

impl NoSlip {
    /// Changes the forces of friction, and returns the sweeps of the island that took most.
    #[inline(always)]
    pub fn run(&mut self, model: &Model, unconstrained: &Unconstrained<'_>, constraints: &mut Constraints) -> usize {
        if model.nv == 0 {
            return 0;
        }
        let Constraints { jacobian, rows, .. } = constraints;
        self.islands.find(model, jacobian);
        self.respond(model, unconstrained, jacobian, rows);
        self.acceleration.clear();
        self.acceleration.resize(model.nv, 0.0);
        accelerate(model, unconstrained, jacobian, rows, &mut self.acceleration);
        let scale = 1.0 / (model.mean_inertia * model.nv as f64);
        let mut most = 0;
        for island in 0..self.islands.count() {
            for sweep in 1..=model.options.no_slip_iterations {
                most = most.max(sweep);
                let improvement = scale * self.sweep(jacobian, rows, island, sweep == 1);
                if improvement < model.options.no_slip_tolerance || improvement.is_nan() {
                    break;
                }
            }
        }
        most
    }

    /// Finds the responses to all directions of friction.
    #[inline(always)]
    fn respond(&mut self, model: &Model, unconstrained: &Unconstrained<'_>, jacobian: &Jacobian, rows: &Rows) {
        let count = model.nv;
        self.responses.clear();
        self.first.clear();
        for block in &jacobian.blocks {
            self.first.push(self.responses.len() / count);
            for row in frictions(block, rows) {
                let start = self.responses.len();
                self.responses.resize(start + count, 0.0);
                let response = &mut self.responses[start..];
                for (&dof, value) in jacobian.columns_of(block).iter().zip(jacobian.base_row(block, row)) {
                    response[dof] = *value;
                }
                inertia::solve(model, unconstrained.factor, response);
            }
        }
    }

    /// Passes over the friction of an island once and returns by how much the cost has fallen, in the first pass with that of the
    /// regularisation, which is dropped.
    #[inline(always)]
    fn sweep(&mut self, jacobian: &Jacobian, rows: &mut Rows, island: usize, first: bool) -> f64 {
        let mut improvement = 0.0;
        for (index, block) in jacobian.blocks.iter().enumerate().filter(|(index, _)| self.islands.of(*index) == island) {
            if first {
                let cost = |row: usize| 0.5 * rows.force[row] * rows.force[row] * rows.regularization[row];
                improvement += block.rows.clone().map(cost).sum::<f64>();
            }
            let count = self.acceleration.len();
            let responses = &self.responses[self.first[index] * count..];
            let mut directions = Directions { jacobian, block, responses, acceleration: &mut self.acceleration };
            improvement -= match (rows.kind[block.rows.start], block.shape) {
                (RowKind::DofFriction(_) | RowKind::TendonFriction(_), _) => directions.rub(rows),
                (RowKind::Contact(_), Shape::Pyramid) => directions.tilt(rows),
                (RowKind::Contact(_), Shape::Cone(_)) => directions.slide(rows),
                _ => 0.0,
            };
        }
        improvement
    }
}

/// acceleration = a_smooth + M^-1 J' f.
#[inline(always)]
pub(crate) fn accelerate(
    model: &Model,
    unconstrained: &Unconstrained<'_>,
    jacobian: &Jacobian,
    rows: &Rows,
    acceleration: &mut [f64],
) {
    acceleration.fill(0.0);
    jacobian.add_transposed(&rows.force, acceleration);
    inertia::solve(model, unconstrained.factor, acceleration);
    for (value, smooth) in acceleration.iter_mut().zip(unconstrained.acceleration) {
        *value += smooth;
    }
}

/// The base rows of a block along which friction acts.
fn frictions(block: &Block, rows: &Rows) -> core::ops::Range<usize> {
    match rows.kind[block.rows.start] {
        RowKind::DofFriction(_) | RowKind::TendonFriction(_) => 0..1,
        RowKind::Contact(_) => 1..block.dimension,
        _ => 0..0,
    }
}

/// The directions of a block's friction.
struct Directions<'a> {
    jacobian: &'a Jacobian,
    block: &'a Block,
    /// Begins with those of the block.
    responses: &'a [f64],
    acceleration: &'a mut [f64],
}

impl Directions<'_> {
    /// Base row `row` times x.
    #[inline(always)]
    fn along(&self, row: usize, x: &[f64]) -> f64 {
        let columns = self.jacobian.columns_of(self.block);
        self.jacobian.base_row(self.block, row).iter().zip(columns).map(|(value, &dof)| value * x[dof]).sum()
    }

    #[inline(always)]
    fn response(&self, direction: usize) -> &[f64] {
        let count = self.acceleration.len();
        &self.responses[direction * count..][..count]
    }

    /// Adds a force along a direction to the acceleration.
    #[inline(always)]
    fn push(&mut self, direction: usize, force: f64) {
        let count = self.acceleration.len();
        let response = &self.responses[direction * count..][..count];
        for (value, change) in self.acceleration.iter_mut().zip(response) {
            *value += force * change;
        }
    }

    /// Friction loss of a joint or tendon, between its bounds. Returns the change of the cost, as all of these.
    #[inline(always)]
    fn rub(&mut self, rows: &mut Rows) -> f64 {
        let row = self.block.rows.start;
        let residual = self.along(0, self.acceleration) - rows.reference[row];
        let inertia = self.along(0, self.response(0)).at_least(MINIMUM);
        let before = rows.force[row];
        rows.force[row] = (before - residual / inertia).at_least(rows.lower[row]).at_most(rows.upper[row]);
        let change = rows.force[row] - before;
        self.push(0, change);
        change * (residual + 0.5 * change * inertia)
    }

    /// The edges of a pyramid, pair by pair: (m + y, m - y) with m as it is, so that the normal force stays.
    #[inline(always)]
    fn tilt(&mut self, rows: &mut Rows) -> f64 {
        let mut change = 0.0;
        for (direction, row) in self.block.rows.clone().step_by(2).enumerate() {
            let reach = 2.0 * self.block.friction[direction];
            let pull = reach * self.along(direction + 1, self.acceleration);
            let slope = pull - (rows.reference[row] - rows.reference[row + 1]);
            let curvature = reach * reach * self.along(direction + 1, self.response(direction));
            let [mean, before] = [1.0, -1.0].map(|sign| 0.5 * (rows.force[row] + sign * rows.force[row + 1]));
            let half = if curvature < MINIMUM { 0.0 } else { (before - slope / curvature).at_least(-mean).at_most(mean) };
            (rows.force[row], rows.force[row + 1]) = (mean + half, mean - half);
            let step = half - before;
            self.push(direction, reach * step);
            change += step * (slope + 0.5 * step * curvature);
        }
        change
    }

    /// The friction of an elliptic contact, all directions at once.
    #[inline(always)]
    fn slide(&mut self, rows: &mut Rows) -> f64 {
        let (normal, count) = (self.block.rows.start, self.block.dimension - 1);
        let mut matrix = [[0.0; MOST_FRICTIONS]; MOST_FRICTIONS];
        let (mut residual, mut before) = ([0.0; MOST_FRICTIONS], [0.0; MOST_FRICTIONS]);
        for direction in 0..count {
            let row = normal + 1 + direction;
            residual[direction] = self.along(direction + 1, self.acceleration) - rows.reference[row];
            before[direction] = rows.force[row];
            for (other, entry) in matrix[direction][..count].iter_mut().enumerate() {
                *entry = self.along(direction + 1, self.response(other));
            }
        }
        let product = |vector: &[f64; MOST_FRICTIONS], row: usize| -> f64 {
            matrix[row].iter().zip(vector).take(count).map(|(entry, value)| entry * value).sum()
        };
        let offset = core::array::from_fn(|row| residual[row] - product(&before, row));
        let strength = rows.force[normal];
        let found = match strength < MINIMUM {
            true => [0.0; MOST_FRICTIONS],
            false => minimum_in_ellipse(&matrix, &offset, &self.block.friction, strength, count),
        };
        let step: [f64; MOST_FRICTIONS] = core::array::from_fn(|row| found[row] - before[row]);
        let change: f64 = (0..count).map(|row| step[row] * (residual[row] + 0.5 * product(&step, row))).sum();
        if change > MOST_RISE {
            return 0.0;
        }
        for direction in 0..count {
            rows.force[normal + 1 + direction] = found[direction];
            self.push(direction, step[direction]);
        }
        change
    }
}

const _: () = assert!(MOST_FRICTIONS + 1 == MOST_BASE_ROWS);

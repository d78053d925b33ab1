//! The constrained acceleration: Newton's method on MuJoCo's reduced primal problem.
//!
//! Minimises over accelerations a, with f the force without constraints and s the cost of the rows' clipped springs (manual,
//! "Reduced primal problem", but for a constant, so that M^-1 f is not needed),
//!
//! ```text
//! 1/2 a' M a - a' f + s(J a - a_ref)
//! ```
//!
//! whose minimum is that of the convex problem of E. Todorov, "Convex and analytically-invertible dynamics with contacts and
//! constraints" (ICRA 2014), whichever method finds it: a model that asks for one of MuJoCo's other solvers (`CG`, `PGS`) gets
//! the same optimum from this one.
//!
//! 1. start from the last step's acceleration;
//! 2. factor the Hessian M + J'DJ of the active set, on the tree's own sparsity ([`path_matrix`](crate::path_matrix));
//! 3. step along Newton's direction to the exact minimum (`line_search`);
//! 4. rows that entered or left the active set change the factor by rank-one updates where that is cheaper than factoring again;
//!    contacts that slide on elliptic cones change their weight at every step, and the matrix is then factored anew.
//!
//! It ends when the improvement, the gradient or the predicted improvement (Newton's decrement), divided by the trace of M,
//! falls below the tolerance, when the line search finds nothing better, or at the iteration limit. The problem is strictly
//! convex, so every iterate is usable.
//!
//! Where rounding spoils the Hessian (stiffnesses many orders apart), so that a pivot is not positive or its direction does not
//! descend, a multiple of its diagonal is added to it and grows until it serves (K. Levenberg, "A method for the solution of
//! certain non-linear problems in least squares", 1944; with a multiple as large as the number of dofs it is diagonally
//! dominant). The multiple has an upper end, and every attempt counts as an iteration, so this ends, with the best
//! acceleration found or, if the diagonal itself is not positive and finite, with an error.

mod hessian;
mod line_search;
pub(crate) mod no_slip;
mod outer;
pub(crate) mod slots;
pub(crate) mod together;

use super::{
    constraint::{
        Constraints, CrossCoupling, Rows,
        cone::{Cone, Zone},
        jacobian::Jacobian,
    },
    fault::is_valid,
    inertia,
    path_matrix::PathPattern,
};
use crate::model::Model;
use crate::scalar::Real;
use line_search::Line;
use no_slip::{Unconstrained, accelerate};
use std::sync::Arc;

/// The unconstrained problem of one episode.
pub(super) struct Problem<'a> {
    /// Mass matrix in the model's layout.
    pub mass: &'a [f64],
    /// Generalised force without constraints.
    pub force: &'a [f64],
    /// Acceleration of the last step.
    pub warm_start: &'a [f64],
}

/// Memory of the solver, and what it found.
#[derive(Debug, Clone, Default)]
pub struct Newton {
    /// Constrained acceleration (`qacc`).
    pub acceleration: Vec<f64>,
    /// J' force (`qfrc_constraint`).
    pub constraint_force: Vec<f64>,
    /// Iterations taken (`solver_niter`).
    pub iterations: usize,
    /// Norm of the gradient at the end, divided by the trace of the mass matrix.
    pub gradient_norm: f64,
    pattern: PathPattern,
    /// Dofs of the joints that couplings join, ascending.
    coupled: Arc<[[usize; 2]]>,
    /// What the pattern was built for.
    cross_couplings: Option<Vec<CrossCoupling>>,
    factor: Vec<f64>,
    /// M a.
    momentum: Vec<f64>,
    /// J a - a_ref.
    residual: Vec<f64>,
    gradient: Vec<f64>,
    search: Vec<f64>,
    search_momentum: Vec<f64>,
    search_rate: Vec<f64>,
    /// D of the active set, zero for the others.
    active: Vec<f64>,
    /// The same when the factor was last changed.
    factored: Vec<f64>,
    /// Whether a contact slides on its elliptic cone now, and did when the factor was last changed.
    sliding: [bool; 2],
    /// Multiple of its own diagonal that is added to the Hessian.
    damping: f64,
    vector: Vec<f64>,
}

impl Newton {
    /// Memory for `model`.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &coupled_dofs(model))
    }

    pub(crate) fn of(model: &Model, coupled: &Arc<[[usize; 2]]>) -> Self {
        let zeros = vec![0.0; model.nv];
        Self {
            coupled: Arc::clone(coupled),
            acceleration: zeros.clone(),
            constraint_force: zeros.clone(),
            momentum: zeros.clone(),
            gradient: zeros.clone(),
            search: zeros.clone(),
            search_momentum: zeros.clone(),
            vector: zeros,
            ..Self::default()
        }
    }

    /// Takes the acceleration of a body without constraints.
    pub(super) fn accept(&mut self, acceleration: &[f64]) {
        self.iterations = 0;
        self.gradient_norm = 0.0;
        self.constraint_force.fill(0.0);
        self.acceleration.copy_from_slice(acceleration);
    }

    /// Takes the acceleration that the forces of the rows as they now are cause.
    #[inline(always)]
    pub(super) fn take_forces(&mut self, model: &Model, unconstrained: &Unconstrained<'_>, constraints: &Constraints) {
        let Constraints { jacobian, rows, .. } = constraints;
        self.constraint_force.fill(0.0);
        jacobian.add_transposed(&rows.force, &mut self.constraint_force);
        accelerate(model, unconstrained, jacobian, rows, &mut self.acceleration);
        self.settle_zeros();
    }

    /// Of two zeros always the positive one, whichever zeros were added on the way.
    #[inline(always)]
    fn settle_zeros(&mut self) {
        for value in self.acceleration.iter_mut().chain(&mut self.constraint_force) {
            *value += 0.0;
        }
    }

    /// Solves for the acceleration and the forces of all rows, of which there is one at least.
    ///
    /// # Errors
    /// The dof at which the Hessian has no positive pivot.
    #[inline(always)]
    pub(super) fn solve(&mut self, model: &Model, problem: &Problem<'_>, constraints: &mut Constraints) -> Result<(), usize> {
        self.iterations = 0;
        self.gradient_norm = 0.0;
        self.prepare(model, constraints);
        let Constraints { jacobian, rows, cones, .. } = constraints;
        let parts = &mut Parts { jacobian, rows, cones };
        let scale = 1.0 / trace(model, problem.mass).at_least(1e-15);
        let mut cost = self.start(model, problem, parts);
        self.update_forces_and_gradient(problem, parts);
        self.damping = 0.0;
        self.factor_all(model, problem.mass, parts)?;
        let tolerance = model.options.tolerance;
        while self.iterations < model.options.iterations {
            self.search.copy_from_slice(&self.gradient);
            self.pattern.layout().solve(&self.factor, &mut self.search);
            // Newton's decrement predicts what the next step gains. Where that is nothing the step is still taken: its
            // direction is known, and if no row changes it ends at the exact optimum.
            let decrement = 0.5 * dot(&self.gradient, &self.search);
            let last = scale * decrement < tolerance;
            let (step, gain) = self.advance(model, problem.mass, parts, scale);
            if step <= 0.0 {
                // Nothing better along a direction that promised much: it was spoilt by rounding.
                let spoilt = !last && decrement > 1e-10 * (cost + self.inertial_cost(problem)).abs();
                if !spoilt || !self.damp() {
                    break;
                }
                self.iterations += 1;
                self.factor_all(model, problem.mass, parts)?;
                continue;
            }
            self.iterations += 1;
            let before = core::mem::replace(&mut cost, constraint_cost(parts, &self.residual));
            let improvement = gain + (before - cost);
            self.update_forces_and_gradient(problem, parts);
            self.gradient_norm = scale * norm(&self.gradient);
            if last || scale * improvement < tolerance || self.gradient_norm < tolerance {
                break;
            }
            self.refresh_factor(model, problem.mass, parts)?;
        }
        self.settle_zeros();
        Ok(())
    }

    /// Sizes the row arrays and, if other chains are coupled than last time, lays out the Hessian's pattern anew.
    #[inline(always)]
    fn prepare(&mut self, model: &Model, constraints: &Constraints) {
        for array in [&mut self.residual, &mut self.search_rate, &mut self.active] {
            array.clear();
            array.resize(constraints.rows.len(), 0.0);
        }
        if self.cross_couplings.as_ref() == Some(&constraints.cross_couplings) {
            return;
        }
        let cross_couplings = constraints.cross_couplings.iter().map(|&coupling| constraints.columns_of(coupling));
        self.pattern.rebuild(&model.dofs.parent, self.coupled.iter().map(|pair| &pair[..]).chain(cross_couplings));
        self.factor.clear();
        self.factor.resize(self.pattern.column.len(), 0.0);
        self.cross_couplings.get_or_insert_default().clone_from(&constraints.cross_couplings);
    }

    /// Starts from the acceleration of the last step, from zero where that is not finite, and returns the cost of the
    /// constraints.
    #[inline(always)]
    fn start(&mut self, model: &Model, problem: &Problem<'_>, parts: &Parts<'_>) -> f64 {
        let Parts { jacobian, rows, .. } = parts;
        if problem.warm_start.iter().all(|value| is_valid(*value)) {
            self.acceleration.copy_from_slice(problem.warm_start);
        } else {
            self.acceleration.fill(0.0);
        }
        inertia::multiply(model, problem.mass, &self.acceleration, &mut self.momentum);
        residuals(jacobian, rows, &self.acceleration, &mut self.residual);
        constraint_cost(parts, &self.residual)
    }

    /// Forces, rows of the active set and gradient at the current acceleration.
    #[inline(always)]
    fn update_forces_and_gradient(&mut self, problem: &Problem<'_>, parts: &mut Parts<'_>) {
        let Parts { jacobian, rows, cones } = parts;
        for row in 0..rows.len() {
            let force = row_force(rows, row, self.residual[row]);
            rows.force[row] = force;
            self.active[row] = if force > rows.lower[row] && force < rows.upper[row] { rows.weight[row] } else { 0.0 };
        }
        self.sliding[0] = false;
        for cone in cones.iter() {
            let zone = cone.push(&self.residual, &rows.weight, &mut rows.force);
            self.sliding[0] |= zone == Zone::Sliding;
            if zone == Zone::Sticking {
                self.active[cone.rows.clone()].copy_from_slice(&rows.weight[cone.rows.clone()]);
            }
        }
        self.constraint_force.fill(0.0);
        jacobian.add_transposed(&rows.force, &mut self.constraint_force);
        let forces = problem.force.iter().zip(&self.constraint_force);
        for ((gradient, momentum), (force, constraint)) in self.gradient.iter_mut().zip(&self.momentum).zip(forces) {
            *gradient = momentum - force - constraint;
        }
    }

    /// The part of the cost that is not the constraints', up to a constant, without cancellation.
    fn inertial_cost(&self, problem: &Problem<'_>) -> f64 {
        0.5 * dot(&self.acceleration, &self.momentum).abs() + dot(&self.acceleration, problem.force).abs()
    }

    /// Goes to the least cost against the search direction. Returns the length of the step, zero if nothing is better, and by how
    /// much it lowers the quadratic part of the cost.
    #[inline(always)]
    fn advance(&mut self, model: &Model, mass: &[f64], parts: &Parts<'_>, scale: f64) -> (f64, f64) {
        let Parts { jacobian, rows, cones } = parts;
        for value in &mut self.search {
            *value = -*value;
        }
        inertia::multiply(model, mass, &self.search, &mut self.search_momentum);
        jacobian.multiply(&self.search, &mut self.search_rate);
        // The gradient holds the springs' part too: the quadratic part's slope is what is left without it.
        let slope = dot(&self.search, &self.gradient) + dot(&self.search, &self.constraint_force);
        let curvature = dot(&self.search, &self.search_momentum);
        let line = Line {
            slope,
            curvature,
            residual: &self.residual,
            rate: &self.search_rate,
            weight: &rows.weight,
            lower: &rows.lower,
            upper: &rows.upper,
            cones,
        };
        let options = &model.options;
        let tolerance = options.tolerance * options.line_search_tolerance * norm(&self.search) / scale;
        let step = line.minimize(tolerance, options.line_search_iterations);
        add_scaled(&mut self.acceleration, step, &self.search);
        add_scaled(&mut self.momentum, step, &self.search_momentum);
        add_scaled(&mut self.residual, step, &self.search_rate);
        (step, -step * (slope + 0.5 * step * curvature))
    }
}

/// The dofs of the joints that couplings join, ascending.
pub(crate) fn coupled_dofs(model: &Model) -> Arc<[[usize; 2]]> {
    let leaders = model.couplings.joint.iter().zip(&model.couplings.leader);
    let coupled = leaders.filter_map(|(&dependent, &leader)| {
        let [a, b] = [dependent, leader?].map(|joint| model.joints.dof_address[joint]);
        Some([a.min(b), a.max(b)])
    });
    coupled.collect()
}

/// The constraints as the solver uses them.
struct Parts<'a> {
    jacobian: &'a Jacobian,
    rows: &'a mut Rows,
    cones: &'a [Cone],
}

/// J a - a_ref.
#[inline(always)]
fn residuals(jacobian: &Jacobian, rows: &Rows, acceleration: &[f64], out: &mut [f64]) {
    jacobian.multiply(acceleration, out);
    for (residual, reference) in out.iter_mut().zip(&rows.reference) {
        *residual -= reference;
    }
}

/// Cost of all constraints at their residuals.
#[inline(always)]
fn constraint_cost(parts: &Parts<'_>, residual: &[f64]) -> f64 {
    let springs = spring_cost(parts.rows, residual);
    parts.cones.iter().fold(springs, |sum, cone| sum + cone.cost(residual, &parts.rows.weight))
}

/// Cost of the rows' springs: quadratic while a force is free, linear beyond its bounds.
#[inline(always)]
fn spring_cost(rows: &Rows, residual: &[f64]) -> f64 {
    let cost = |(row, residual): (usize, &f64)| {
        let force = row_force(rows, row, *residual);
        -force * (residual + 0.5 * force * rows.regularization[row])
    };
    residual.iter().enumerate().map(cost).sum()
}

/// A row's force at a residual J a - a_ref.
#[inline(always)]
fn row_force(rows: &Rows, row: usize, residual: f64) -> f64 {
    (-rows.weight[row] * residual).at_least(rows.lower[row]).at_most(rows.upper[row])
}

#[inline(always)]
fn trace(model: &Model, mass: &[f64]) -> f64 {
    model.dofs.row.iter().map(|row| mass[row.end - 1]).sum()
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[inline(always)]
fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[inline(always)]
fn add_scaled(to: &mut [f64], scale: f64, what: &[f64]) {
    for (value, change) in to.iter_mut().zip(what) {
        *value += scale * change;
    }
}

//! Newton's method on all lanes at once.
//!
//! The same problem, start, steps and ends as in [`Newton`](super::Newton), operation by operation, on the constraints of all lanes
//! in their slots. A lane that is done keeps its solution while its neighbours go on. What a lane takes in from slots and
//! entries that only its neighbours need are zeros, which change no sum; so each lane comes to the bits that it comes to alone.
//! A lane that meets what is rare (a pivot that is not positive, a direction spoilt by rounding, numbers that are not finite) is left
//! out, and its episode is solved alone, from the start.

use super::{
    PathPattern,
    slots::{Slots, Source},
};
use crate::{
    constrained::ConstraintState, constraint::CrossCoupling, fault::valid, inertia, model::Model, scalar::Real,
    tree_matrix::Layout,
};
use std::sync::Arc;

/// Slots that couple chains, beyond which lanes are solved one by one: each makes the common pattern longer.
const MOST_CROSS_COUPLINGS: usize = 24;

/// The problem of all lanes.
pub(crate) struct Problem<'a, T> {
    pub mass: &'a [T],
    pub force: &'a [T],
    pub warm_start: &'a [T],
}

/// Memory of the solver, and what it found.
#[derive(Debug, Clone)]
pub(crate) struct Together<T: Real> {
    pub acceleration: Vec<T>,
    pub constraint_force: Vec<T>,
    iterations: Vec<usize>,
    gradient_norm: T,
    slots: Slots<T>,
    pattern: PathPattern,
    coupled: Arc<[[usize; 2]]>,
    cross_couplings: Option<Vec<CrossCoupling>>,
    factor: Vec<T>,
    /// Factors that some lanes take over.
    fresh: Vec<T>,
    momentum: Vec<T>,
    residual: Vec<T>,
    gradient: Vec<T>,
    search: Vec<T>,
    search_momentum: Vec<T>,
    search_rate: Vec<T>,
    active: Vec<T>,
    factored: Vec<T>,
    vector: Vec<T>,
}

impl<T: Real> Together<T> {
    pub fn of(model: &Model, coupled: &Arc<[[usize; 2]]>) -> Self {
        let zeros = vec![T::splat(0.0); model.nv];
        Self {
            acceleration: zeros.clone(),
            constraint_force: zeros.clone(),
            iterations: vec![0; T::LANES],
            gradient_norm: T::splat(0.0),
            slots: Slots::new(),
            pattern: PathPattern::default(),
            coupled: Arc::clone(coupled),
            cross_couplings: None,
            factor: Vec::new(),
            fresh: Vec::new(),
            momentum: zeros.clone(),
            residual: Vec::new(),
            gradient: zeros.clone(),
            search: zeros.clone(),
            search_momentum: zeros.clone(),
            search_rate: Vec::new(),
            active: Vec::new(),
            factored: Vec::new(),
            vector: zeros,
        }
    }

    /// Builds the rows of all lanes.
    #[inline(always)]
    pub fn build(&mut self, source: &Source<'_, T>) {
        self.slots.build(source);
    }

    /// The lanes that have rows.
    pub fn occupied(&self) -> T::Mask {
        self.slots.occupied
    }

    /// Makes room for what couples chains; whether the lanes can be solved together.
    pub fn prepare(&mut self, model: &Model, lanes: &[ConstraintState]) -> bool {
        if self.slots.cross_couplings.len() > MOST_CROSS_COUPLINGS {
            return false;
        }
        if self.cross_couplings.as_ref() != Some(&self.slots.cross_couplings) {
            // What a coupling couples is the same in every lane.
            let Some(constraints) = lanes.first().map(|own| &own.constraints) else { return false };
            let couplings = self.slots.cross_couplings.iter().map(|&coupling| constraints.columns_of(coupling));
            self.pattern.rebuild(&model.dofs.parent, self.coupled.iter().map(|pair| &pair[..]).chain(couplings));
            self.factor.resize(self.pattern.column.len(), T::splat(0.0));
            self.fresh.resize(self.pattern.column.len(), T::splat(0.0));
            self.cross_couplings.get_or_insert_default().clone_from(&self.slots.cross_couplings);
        }
        true
    }

    /// Notes iterations and gradient of a lane.
    pub fn scatter(&self, own: &mut ConstraintState, lane: usize) {
        own.newton.iterations = self.iterations[lane];
        own.newton.gradient_norm = self.gradient_norm.lane(lane);
    }

    /// Writes the forces of a lane to its rows, all of which it has.
    pub fn scatter_forces(&mut self, own: &mut ConstraintState, lane: usize) {
        self.slots.scatter_forces(&mut own.constraints, lane);
    }

    /// Solves for the lanes of the mask, after [`prepare`](Self::prepare). Returns the lanes that have been solved.
    #[inline(always)]
    pub fn solve(&mut self, model: &Model, problem: &Problem<'_, T>, wanted: T::Mask) -> T::Mask {
        let rows = self.slots.rows.len();
        for array in [&mut self.residual, &mut self.search_rate, &mut self.active, &mut self.factored] {
            array.clear();
            array.resize(rows, T::splat(0.0));
        }
        self.iterations.fill(0);
        self.gradient_norm = T::splat(0.0);
        let zero = T::splat(0.0);
        let mut sound = problem.warm_start.iter().fold(wanted, |sound, value| T::and(sound, valid(*value)));
        self.acceleration.copy_from_slice(problem.warm_start);
        inertia::multiply(model, problem.mass, &self.acceleration, &mut self.momentum);
        self.slots.multiply(&self.acceleration, &mut self.residual);
        for (residual, row) in self.residual.iter_mut().zip(&self.slots.rows) {
            T::apart();
            *residual -= row.reference;
        }
        let trace = model.dofs.row.iter().map(|row| problem.mass[row.end - 1]).fold(T::splat(-0.0), |sum, entry| sum + entry);
        let scale = T::splat(1.0) / trace.at_least(T::splat(1e-15));
        let mut cost = self.constraint_cost();
        self.update_forces_and_gradient(problem);
        self.assemble(model, problem.mass);
        Self::factor_into(&self.pattern.layout(), &mut self.fresh);
        sound = T::and(sound, self.positive());
        core::mem::swap(&mut self.factor, &mut self.fresh);
        let (options, mut going) = (&model.options, sound);
        let tolerance = T::splat(options.tolerance);
        let half = T::splat(0.5);
        for _ in 0..options.iterations {
            self.search.copy_from_slice(&self.gradient);
            self.pattern.layout().solve(&self.factor, &mut self.search);
            let decrement = half * dot(&self.gradient, &self.search);
            let last = (scale * decrement).less(tolerance);
            let (step, gain, searched) = self.advance(model, problem.mass, scale, going);
            sound = T::and(sound, T::or(searched, T::not(going)));
            going = T::and(going, searched);
            let stepped = T::and(going, zero.less(step));
            let stuck = T::and(going, T::not(stepped));
            let inertial = half * dot(&self.acceleration, &self.momentum).abs() + dot(&self.acceleration, problem.force).abs();
            let spoilt = T::and(T::not(last), (T::splat(1e-10) * (cost + inertial).abs()).less(decrement));
            sound = T::and(sound, T::not(T::and(stuck, spoilt)));
            going = stepped;
            for (lane, iterations) in self.iterations.iter_mut().enumerate() {
                *iterations += usize::from(T::holds(going, lane));
            }
            let before = core::mem::replace(&mut cost, self.constraint_cost());
            let improvement = gain + (before - cost);
            self.update_forces_and_gradient(problem);
            let norm = scale * dot(&self.gradient, &self.gradient).sqrt();
            self.gradient_norm = T::select(going, norm, self.gradient_norm);
            let done = T::or(last, T::or((scale * improvement).less(tolerance), self.gradient_norm.less(tolerance)));
            going = T::and(going, T::not(done));
            if !T::any(going) {
                break;
            }
            let refreshed = self.refresh_factor(model, problem.mass, going);
            sound = T::and(sound, T::or(refreshed, T::not(going)));
            going = T::and(going, refreshed);
        }
        for value in self.acceleration.iter_mut().chain(&mut self.constraint_force) {
            *value += zero;
        }
        self.acceleration.iter().fold(sound, |sound, value| T::and(sound, valid(*value)))
    }

    #[inline(always)]
    fn constraint_cost(&self) -> T {
        let mut sum = T::splat(-0.0);
        for (row, &residual) in self.slots.rows.iter().zip(&self.residual) {
            T::apart();
            let force = row.force_at(residual);
            sum += -force * (residual + T::splat(0.5) * force * row.regularization);
        }
        sum
    }

    #[inline(always)]
    fn update_forces_and_gradient(&mut self, problem: &Problem<'_, T>) {
        let zero = T::splat(0.0);
        for ((row, &residual), active) in self.slots.rows.iter_mut().zip(&self.residual).zip(&mut self.active) {
            T::apart();
            let force = row.force_at(residual);
            let inside = T::and(row.lower.less(force), force.less(row.upper));
            row.force = force;
            *active = T::select(inside, row.weight, zero);
        }
        self.constraint_force.fill(zero);
        self.slots.add_transposed(&mut self.constraint_force);
        for (dof, gradient) in self.gradient.iter_mut().enumerate() {
            T::apart();
            *gradient = self.momentum[dof] - problem.force[dof] - self.constraint_force[dof];
        }
    }

    /// Goes to the least cost against the search direction, in the lanes of the mask.
    #[inline(always)]
    fn advance(&mut self, model: &Model, mass: &[T], scale: T, going: T::Mask) -> (T, T, T::Mask) {
        for value in &mut self.search {
            T::apart();
            *value = -*value;
        }
        inertia::multiply(model, mass, &self.search, &mut self.search_momentum);
        self.slots.multiply(&self.search, &mut self.search_rate);
        let slope = dot(&self.search, &self.gradient) + dot(&self.search, &self.constraint_force);
        let curvature = dot(&self.search, &self.search_momentum);
        let options = &model.options;
        let size = dot(&self.search, &self.search).sqrt();
        let tolerance = T::splat(options.tolerance * options.line_search_tolerance) * size / scale;
        let (step, searched) = self.line_search([slope, curvature], tolerance, options.line_search_iterations, going);
        let moves = [
            (&mut self.acceleration, &self.search),
            (&mut self.momentum, &self.search_momentum),
            (&mut self.residual, &self.search_rate),
        ];
        for (values, changes) in moves {
            for (value, change) in values.iter_mut().zip(changes) {
                T::apart();
                *value = T::select(going, *value + step * *change, *value);
            }
        }
        (step, -step * (slope + T::splat(0.5) * step * curvature), searched)
    }

    /// The least cost along the search direction, as in [`line_search`](super::line_search), and the lanes whose slopes are finite.
    #[inline(always)]
    fn line_search(&self, quadratic: [T; 2], tolerance: T, iterations: usize, going: T::Mask) -> (T, T::Mask) {
        let (zero, half, one, two) = (T::splat(0.0), T::splat(0.5), T::splat(1.0), T::splat(2.0));
        let infinity = T::splat(f64::INFINITY);
        let [mut slope, mut curvature] = self.derivatives(quadratic, zero);
        let mut sound = slope.abs().less(infinity);
        let mut seeking = T::and(going, slope.less(zero));
        let (mut low, mut high, mut step) = (zero, infinity, zero);
        for _ in 0..iterations {
            if !T::any(seeking) {
                break;
            }
            let newton = step - slope / curvature;
            let outside = T::not(T::and(low.less(newton), newton.less(high)));
            let next = T::select(outside, half * (low + high.at_most(two * low + one)), newton);
            seeking = T::and(seeking, T::or(next.less(step), step.less(next)));
            step = T::select(seeking, next, step);
            let [rise, bend] = self.derivatives(quadratic, step);
            slope = T::select(seeking, rise, slope);
            curvature = T::select(seeking, bend, curvature);
            sound = T::and(sound, slope.abs().less(infinity));
            seeking = T::and(seeking, tolerance.less(slope.abs()));
            let falls = slope.less(zero);
            low = T::select(T::and(seeking, falls), step, low);
            high = T::select(T::and(seeking, T::not(falls)), step, high);
        }
        (step, sound)
    }

    #[inline(always)]
    fn derivatives(&self, [slope, curvature]: [T; 2], step: T) -> [T; 2] {
        let zero = T::splat(0.0);
        let (mut rise, mut bend) = (slope + step * curvature, curvature);
        for ((row, residual), rate) in self.slots.rows.iter().zip(&self.residual).zip(&self.search_rate) {
            T::apart();
            let free = -row.weight * (*residual + step * *rate);
            rise -= free.at_least(row.lower).at_most(row.upper) * *rate;
            let inside = T::and(row.lower.less(free), free.less(row.upper));
            bend += T::select(inside, row.weight * *rate * *rate, zero);
        }
        [rise, bend]
    }

    /// Writes M + J'DJ of the active sets over the fresh factor.
    #[inline(always)]
    fn assemble(&mut self, model: &Model, mass: &[T]) {
        let zero = T::splat(0.0);
        let Self { pattern, fresh, active, slots, .. } = self;
        for dof in 0..model.nv {
            let entries = &mass[model.dofs.row[dof].clone()];
            let row = &mut fresh[pattern.row[dof].clone()];
            if row.len() == entries.len() {
                row.copy_from_slice(entries);
            } else {
                row.fill(zero);
                for (entry, &column) in entries.iter().zip(&model.dofs.column[model.dofs.row[dof].clone()]) {
                    row[pattern.depth(column)] = *entry;
                }
            }
        }
        for slot in &slots.slots {
            let mut some = T::mask(|_| false);
            for weight in &active[slot.rows.clone()] {
                some = T::or(some, differ(*weight, zero));
            }
            if T::any(some) {
                slots.add_outer(pattern, fresh, slot, active);
            }
        }
        self.factored.clone_from(&self.active);
    }

    #[inline(always)]
    fn factor_into(layout: &Layout<'_>, values: &mut [T]) {
        layout.factor(values);
    }

    /// The lanes in which all pivots of the fresh factor are positive and finite.
    #[inline(always)]
    fn positive(&self) -> T::Mask {
        let (zero, infinity) = (T::splat(0.0), T::splat(f64::INFINITY));
        self.pattern.row.iter().fold(T::mask(|_| true), |sound, row| {
            let pivot = self.fresh[row.end - 1];
            T::and(sound, T::and(zero.less(pivot), pivot.less(infinity)))
        })
    }

    /// Brings the factors of the lanes of the mask up to date, each in the way that it takes alone. Returns the lanes where that
    /// went well.
    #[inline(always)]
    fn refresh_factor(&mut self, model: &Model, mass: &[T], going: T::Mask) -> T::Mask {
        let zero = T::splat(0.0);
        let mut cost = zero;
        for slot in &self.slots.slots {
            let update = update_cost(model, self.slots.columns_of(slot));
            for row in slot.rows.clone() {
                cost += T::select(differ(self.factored[row], self.active[row]), T::splat(update), zero);
            }
        }
        let anew = T::and(going, T::splat(factor_limit(model)).less(cost));
        let updated = T::and(going, T::not(anew));
        let mut sound = T::mask(|_| true);
        if T::any(updated) {
            sound = self.update_rows(updated);
        }
        if T::any(anew) {
            self.assemble(model, mass);
            Self::factor_into(&self.pattern.layout(), &mut self.fresh);
            sound = T::and(sound, T::or(T::not(anew), self.positive()));
            for (factor, fresh) in self.factor.iter_mut().zip(&self.fresh) {
                T::apart();
                *factor = T::select(anew, *fresh, *factor);
            }
        }
        self.factored.clone_from(&self.active);
        sound
    }

    /// Rank-one updates of the factors by the rows that entered or left the active sets, in the lanes of the mask.
    #[inline(always)]
    fn update_rows(&mut self, updated: T::Mask) -> T::Mask {
        let (zero, infinity) = (T::splat(0.0), T::splat(f64::INFINITY));
        let mut sound = T::mask(|_| true);
        let Self { slots, pattern, factor, vector, active, factored, .. } = self;
        for slot in &slots.slots {
            let Some(&last) = slots.columns_of(slot).last() else { continue };
            for (local, row) in slot.rows.clone().enumerate() {
                let changed = T::and(updated, differ(factored[row], active[row]));
                if !T::any(changed) {
                    continue;
                }
                let vector = &mut vector[..=pattern.depth(last)];
                vector.fill(zero);
                slots.each_value(slot, local, |dof, value| vector[pattern.depth(dof)] = T::select(changed, value, zero));
                let mut weight = T::select(changed, active[row] - factored[row], zero);
                for (place, &row) in pattern.columns(last).iter().enumerate().rev() {
                    let first = vector[place];
                    if !T::any(differ(first, zero)) {
                        continue;
                    }
                    let (above, diagonal) = factor[pattern.row[row].clone()].split_at_mut(place);
                    let old = diagonal[0];
                    let new = old + weight * first * first;
                    sound = T::and(sound, T::or(T::not(changed), T::and(zero.less(new), new.less(infinity))));
                    let change = weight * first / new;
                    weight *= old / new;
                    diagonal[0] = new;
                    for (entry, value) in above.iter_mut().zip(&mut vector[..place]) {
                        T::apart();
                        *value -= first * *entry;
                        *entry += change * *value;
                    }
                }
            }
        }
        sound
    }
}

/// The operations of a rank-one update of rows over these dofs: it passes over the path once, with two operations per entry of a
/// triangle. The path is the model's own, so that the way taken does not depend on what else is coupled.
pub(super) fn update_cost(model: &Model, columns: &[usize]) -> f64 {
    let depth = columns.last().map_or(0, |&dof| model.dofs.row[dof].len());
    ((depth + 1) * (depth + 1)) as f64
}

/// More operations of updates than this cost more than a new factor of the model's own tree.
pub(super) fn factor_limit(model: &Model) -> f64 {
    let operations: usize = model.dofs.row.iter().map(|row| row.len() * (row.len() + 1) / 2).sum();
    0.5 * operations as f64
}

/// The lanes in which two numbers differ.
#[inline(always)]
pub(super) fn differ<T: Real>(a: T, b: T) -> T::Mask {
    T::or(a.less(b), b.less(a))
}

#[inline(always)]
fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let mut sum = T::splat(-0.0);
    for (x, y) in a.iter().zip(b) {
        T::apart();
        sum += *x * *y;
    }
    sum
}

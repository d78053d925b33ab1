//! The allocation of calm states: Newton's method on the dual.
//!
//! With the multiplier y each xᵢ = clamp(aᵢ·y / rᵢ), and what remains is
//!
//! > F(y) = W⁻¹ y + A x(y) - b = 0,
//!
//! the gradient of a convex, once differentiable function. Newton's method on it with the generalised Hessian
//! W⁻¹ + Σ aᵢ aᵢ' / rᵢ over the columns between their bounds, and a line search on the piecewise linear derivative,
//! ends after finitely many steps (Qi & Sun, Math. Programming 58, 1993; Li & Swetits, SIAM J. Optim. 7, 1997). From the
//! previous control step's y it usually takes three to six.

use super::{Problem, largest};
use msk_physics::LaneWork;
use msk_physics::scalar::Real;

/// Memory of the method.
#[derive(Debug, Clone)]
pub(super) struct Newton<T> {
    /// aᵢ·y / rᵢ before clamping, and how it changes along the search direction.
    free: Vec<T>,
    slope: Vec<T>,
    /// One over the cost where an unknown is between its bounds.
    yields: Vec<T>,
    gradient: Vec<T>,
    direction: Vec<T>,
    hessian: Vec<T>,
}

/// When a search is given up, in each lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patience<T> {
    /// After so many steps.
    pub most: T,
    /// After so many already where the line search leaves less than [`LONG`] of a step: what goes from one piece of the answer to the next goes on
    /// like that, and other lanes wait for it.
    pub sure: T,
}

/// A step of which more than this is left is no short one. Near the answer steps are whole.
const LONG: f64 = 0.5;

/// A search from a multiplier on.
pub(super) struct Search<'a, T: Real> {
    pub newton: &'a mut Newton<T>,
    pub problem: &'a Problem<'a, T>,
    /// Relative size of F at which the answer is taken.
    pub tolerance: f64,
    pub patience: Patience<T>,
    /// The lanes that take steps; in others `x` is only evaluated.
    pub tries: T::Mask,
    pub multiplier: &'a mut [T],
    /// What the multiplier asks for, afterwards.
    pub x: &'a mut [T],
}

impl<T: Real> Newton<T> {
    /// Memory for systems of `rows` rows.
    pub fn new(rows: usize) -> Self {
        let zeros = || vec![T::splat(0.0); rows];
        Self {
            free: Vec::new(),
            slope: Vec::new(),
            yields: Vec::new(),
            gradient: zeros(),
            direction: zeros(),
            hessian: Vec::new(),
        }
    }

    /// Unknowns and gradient F at a multiplier.
    #[inline(always)]
    fn evaluate(&mut self, problem: &Problem<'_, T>, multiplier: &[T], x: &mut [T]) {
        let Problem { pattern, inertia, columns, unknowns, wanted, .. } = *problem;
        pattern.layout().multiply(inertia, multiplier, &mut self.gradient);
        for (total, &wanted) in self.gradient.iter_mut().zip(wanted) {
            T::apart();
            *total -= wanted;
        }
        columns.dots(multiplier, &mut self.free);
        for ((unknown, free), x) in unknowns.iter().zip(&mut self.free).zip(&mut *x) {
            T::apart();
            *free /= unknown.cost;
            *x = free.clip(unknown.low, unknown.high);
        }
        columns.add_scaled(x, &mut self.gradient);
    }

    #[inline(always)]
    fn find_direction(&mut self, problem: &Problem<'_, T>) {
        let Problem { pattern, inertia, columns, unknowns, .. } = *problem;
        self.hessian.copy_from_slice(inertia);
        for ((unknown, &free), yields) in unknowns.iter().zip(&self.free).zip(&mut self.yields) {
            T::apart();
            let between = T::and(unknown.low.less(free), free.less(unknown.high));
            *yields = T::select(between, T::splat(1.0) / unknown.cost, T::splat(0.0));
        }
        columns.add_squares(&self.yields, pattern, &mut self.hessian);
        for (direction, &gradient) in self.direction.iter_mut().zip(&self.gradient) {
            T::apart();
            *direction = -gradient;
        }
        pattern.layout().factor(&mut self.hessian);
        pattern.layout().solve(&self.hessian, &mut self.direction);
    }

    /// A length in (0, 1] at which the dual's derivative along the direction nearly vanishes, in the lanes of the mask. It is piecewise
    /// linear and rises.
    #[inline(always)]
    fn line_search(&mut self, problem: &Problem<'_, T>, multiplier: &[T], goes_on: T::Mask) -> T {
        let Problem { pattern, inertia, columns, unknowns, wanted, .. } = *problem;
        let mut falls = T::splat(0.0);
        for (&gradient, &direction) in self.gradient.iter().zip(&self.direction) {
            T::apart();
            falls += gradient * direction;
        }
        pattern.layout().multiply(inertia, &self.direction, &mut self.gradient);
        let mut start = T::splat(0.0);
        let mut curvature = T::splat(0.0);
        for row in 0..wanted.len() {
            T::apart();
            start += multiplier[row] * self.gradient[row] - self.direction[row] * wanted[row];
            curvature += self.direction[row] * self.gradient[row];
        }
        columns.dots(&self.direction, &mut self.slope);
        for (slope, unknown) in self.slope.iter_mut().zip(unknowns) {
            T::apart();
            *slope /= unknown.cost;
        }
        Line { start, curvature, problem, free: &self.free, slope: &self.slope }.root(T::splat(FLAT) * falls.abs(), goes_on)
    }
}

impl<T: Real> LaneWork for Search<'_, T> {
    /// The lanes that have the answer.
    type Output = T::Mask;

    #[inline(always)]
    fn run(self) -> T::Mask {
        let Self { newton, problem, tolerance, patience: Patience { most, sure }, mut tries, multiplier, x } = self;
        for values in [&mut newton.free, &mut newton.slope, &mut newton.yields] {
            values.resize(problem.unknowns.len(), T::splat(0.0));
        }
        newton.hessian.resize(problem.inertia.len(), T::splat(0.0));
        let tolerance = T::splat(tolerance) * problem.scale();
        let mut taken = T::splat(0.0);
        loop {
            // Lanes that take no step come to what they had.
            newton.evaluate(problem, multiplier, x);
            let found = T::not(tolerance.less(largest(&newton.gradient)));
            let goes_on = T::and(T::and(tries, T::not(found)), taken.less(most));
            if !T::any(goes_on) {
                return found;
            }
            newton.find_direction(problem);
            let length = newton.line_search(problem, multiplier, goes_on);
            for (y, &direction) in multiplier.iter_mut().zip(&newton.direction) {
                T::apart();
                *y = T::select(goes_on, *y + length * direction, *y);
            }
            taken += T::splat(1.0);
            tries = T::and(tries, T::or(taken.less(sure), T::not(length.less(T::splat(LONG)))));
        }
    }
}

/// The dual along a search direction.
struct Line<'a, T> {
    /// Its derivative at length 0 without the unknowns' part, and how that changes with the length.
    start: T,
    curvature: T,
    problem: &'a Problem<'a, T>,
    /// Each unknown before clamping, and how it changes with the length.
    free: &'a [T],
    slope: &'a [T],
}

/// Steps of a line search at most.
const TRIALS: usize = 40;
/// The derivative at which a step length is accepted, relative to that at its beginning: the strong Wolfe condition, which is enough for
/// descent from anywhere (Nocedal & Wright, Numerical Optimization, 2006, section 3.2). Near the answer the full step meets it.
const FLAT: f64 = 1e-2;

impl<T: Real> Line<'_, T> {
    /// The derivative at a length, and its own.
    #[inline(always)]
    fn derivatives(&self, length: T) -> [T; 2] {
        let (mut force, mut stiffness) = (T::splat(0.0), T::splat(0.0));
        for ((unknown, &free), &slope) in self.problem.unknowns.iter().zip(self.free).zip(self.slope) {
            T::apart();
            let weight = unknown.cost * slope;
            let x = free + length * slope;
            let between = T::and(unknown.low.less(x), x.less(unknown.high));
            force += weight * x.clip(unknown.low, unknown.high);
            stiffness += T::select(between, weight * slope, T::splat(0.0));
        }
        [self.start + length * self.curvature + force, self.curvature + stiffness]
    }

    /// Newton's method within a bracket, which is halved where it would leave that, until the derivative is `flat` in all lanes of the
    /// mask: in lanes that have their answer it never is, but for rounding.
    #[inline(always)]
    fn root(&self, flat: T, goes_on: T::Mask) -> T {
        let (zero, one, half) = (T::splat(0.0), T::splat(1.0), T::splat(0.5));
        let [mut low, mut high, mut length] = [zero, one, one];
        let [mut derivative, mut stiffness] = self.derivatives(one);
        // Where it still falls at 1 that is the longest step.
        let mut done = T::or(T::not(goes_on), T::not(flat.less(derivative)));
        for _ in 0..TRIALS {
            if T::all(done) {
                break;
            }
            let rises = zero.less(derivative);
            (low, high) = (T::select(rises, low, length), T::select(rises, length, high));
            let next = length - derivative / stiffness;
            let inside = T::and(low.less(next), next.less(high));
            let next = T::select(inside, next, half * (low + high));
            length = T::select(done, length, next);
            [derivative, stiffness] = self.derivatives(length);
            done = T::or(done, T::not(flat.less(derivative.abs())));
        }
        length
    }
}

//! Allocation: which muscles and ground forces together make the wanted generalised force.
//!
//! The problem is a bounded least-squares problem with a unique answer,
//!
//! > minimise ½ e' W e + ½ Σ rᵢ xᵢ²,   e = b - A x,   low ≤ x ≤ high,
//!
//! where W is the inverse of the effective inertia, so that an error counts by the accelerations that it causes (Gauss'
//! principle). The unknowns are many (416 muscles, some tens of contact forces) and the rows few and short, so it is solved in
//! its dual: with the multiplier y = W e, each xᵢ = clamp(aᵢ·y / rᵢ), and what remains is one small system
//!
//! > F(y) = W⁻¹ y + A x(y) - b = 0,
//!
//! the gradient of a convex, once differentiable function. Newton's method on it with the generalised Hessian
//! W⁻¹ + Σ aᵢ aᵢ' / rᵢ over the columns between their bounds, and an exact line search on the piecewise linear derivative,
//! ends after finitely many steps (Qi & Sun, Math. Programming 58, 1993; Li & Swetits, SIAM J. Optim. 7, 1997). From the
//! previous control step's y it usually takes three to six. Where it does not, because many unknowns change bounds, an
//! [`interior`](super::interior) point method finds the neighbourhood of the answer and Newton's method the rest.

use super::interior::{Interior, Target};
use super::{sparse::Columns, symmetric::Symmetric};
use msk_physics::lanes::{Lanes, WIDTH};
use msk_physics::scalar::Real;
use msk_physics::{Instructions, LaneWork};

/// Bounds and cost of one unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unknown {
    pub low: f64,
    pub high: f64,
    /// r, positive.
    pub cost: f64,
}

/// What is shared out, and among what.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    /// W⁻¹.
    pub inertia: &'a Symmetric,
    /// A, with one column for each of the unknowns.
    pub columns: &'a Columns,
    pub unknowns: &'a [Unknown],
    /// b.
    pub wanted: &'a [f64],
}

impl Problem<'_> {
    /// What errors are measured by: the largest of b, or 1.
    pub fn scale(&self) -> f64 {
        self.wanted.iter().fold(1.0, |largest: f64, value| largest.at_least(value.abs()))
    }
}

/// The solver, with the memory of its last answer.
#[derive(Debug, Clone)]
pub(super) struct Allocation {
    /// y: the acceleration that the remaining error would cause.
    multiplier: Vec<f64>,
    /// The unknowns, one per column.
    pub x: Vec<f64>,
    /// aᵢ·y / rᵢ before clamping, and how it changes along the search direction.
    free: Vec<f64>,
    slope: Vec<f64>,
    gradient: Vec<f64>,
    direction: Vec<f64>,
    hessian: Symmetric,
    interior: Interior,
    /// Whether Newton's method alone did not find the last answer.
    violent: bool,
    effort: Effort,
}

/// How closely an answer is searched for. Unknowns keep their bounds with any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Effort {
    /// Relative size of F at which the answer is taken.
    tolerance: f64,
    /// Newton steps from the last answer, after which the interior-point method is tried.
    first: usize,
    /// What that has to reach.
    target: Target,
    /// Newton steps at most after that; two are usual.
    last: usize,
}

/// Steps of the interior-point method that show a state in which Newton's method takes fewer.
const CALM: usize = 5;

impl Effort {
    /// For what is acted on.
    pub const EXACT: Self = Self { tolerance: 1e-7, first: 8, target: Target { gap: 1e-10, residual: 1e-7 }, last: 80 };
    /// For what is only imagined: the forces on the joints are right to a thousandth, while muscles that could stand in for each
    /// other share less evenly.
    pub const ROUGH: Self = Self { tolerance: 1e-5, first: 4, target: Target { gap: 1e-5, residual: 1e-4 }, last: 0 };
}

impl Allocation {
    /// Memory for systems of `rows` rows.
    pub fn new(rows: usize) -> Self {
        Self {
            multiplier: vec![0.0; rows],
            x: Vec::new(),
            free: Vec::new(),
            slope: Vec::new(),
            gradient: vec![0.0; rows],
            direction: vec![0.0; rows],
            hessian: Symmetric::new(rows),
            interior: Interior::new(rows),
            violent: false,
            effort: Effort::EXACT,
        }
    }

    /// The same memory with another effort from now on.
    pub fn set_effort(&mut self, effort: Effort) {
        self.effort = effort;
    }

    /// Fills `x`; gives whether the answer has the tolerance of the effort.
    pub fn solve(&mut self, problem: &Problem<'_>) -> bool {
        let count = problem.unknowns.len();
        self.x.resize(count, 0.0);
        self.free.resize(count, 0.0);
        self.slope.resize(count, 0.0);
        let Effort { first, target, last, .. } = self.effort;
        // What was violent a control step ago still is.
        if self.newton(problem, if self.violent { 0 } else { first }) {
            self.violent = false;
            return true;
        }
        let steps = self.interior.solve(problem, target, &mut self.x, &mut self.multiplier);
        self.violent = steps > CALM;
        last > 0 && self.newton(problem, last)
    }

    /// Newton steps, `most` at most, after which `x` is what the multiplier asks for; gives whether it is the answer.
    fn newton(&mut self, problem: &Problem<'_>, most: usize) -> bool {
        let tolerance = self.effort.tolerance * problem.scale();
        for step in 0..=most {
            self.evaluate(problem);
            let error = self.gradient.iter().fold(0.0, |largest: f64, value| largest.at_least(value.abs()));
            if error <= tolerance {
                return true;
            }
            if step == most {
                break;
            }
            self.newton_direction(problem);
            let length = self.line_search(problem);
            for (y, step) in self.multiplier.iter_mut().zip(&self.direction) {
                *y += length * step;
            }
        }
        false
    }

    /// Unknowns and gradient F at the present multiplier.
    fn evaluate(&mut self, problem: &Problem<'_>) {
        let Problem { inertia, columns, unknowns, wanted } = *problem;
        inertia.multiply(&self.multiplier, &mut self.gradient);
        for (total, wanted) in self.gradient.iter_mut().zip(wanted) {
            *total -= wanted;
        }
        for (index, unknown) in unknowns.iter().enumerate() {
            self.free[index] = columns.dot(index, &self.multiplier) / unknown.cost;
            self.x[index] = self.free[index].clip(unknown.low, unknown.high);
            columns.add_scaled(index, self.x[index], &mut self.gradient);
        }
    }

    fn newton_direction(&mut self, problem: &Problem<'_>) {
        let Problem { inertia, columns, unknowns, .. } = *problem;
        self.hessian.copy_from(inertia);
        for (index, unknown) in unknowns.iter().enumerate() {
            if unknown.low < self.free[index] && self.free[index] < unknown.high {
                columns.add_square(index, 1.0 / unknown.cost, &mut self.hessian);
            }
        }
        self.hessian.factor();
        for (direction, gradient) in self.direction.iter_mut().zip(&self.gradient) {
            *direction = -gradient;
        }
        self.hessian.solve(&mut self.direction);
    }

    /// The length in (0, 1] at which the dual's derivative along the direction vanishes. It is piecewise linear and rises.
    fn line_search(&mut self, problem: &Problem<'_>) -> f64 {
        let Problem { inertia, columns, unknowns, wanted } = *problem;
        inertia.multiply(&self.direction, &mut self.gradient);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let curvature = dot(&self.direction, &self.gradient);
        let start = dot(&self.multiplier, &self.gradient) - dot(&self.direction, wanted);
        for (index, unknown) in unknowns.iter().enumerate() {
            self.slope[index] = columns.dot(index, &self.direction) / unknown.cost;
        }
        let along = Along { start, curvature, unknowns, free: &self.free, slope: &self.slope };
        Instructions::default().run(along)
    }
}

/// The dual along a search direction.
struct Along<'a> {
    /// Its derivative at length 0 without the unknowns' part, and how that changes with the length.
    start: f64,
    curvature: f64,
    unknowns: &'a [Unknown],
    /// Each unknown before clamping, and how it changes with the length.
    free: &'a [f64],
    slope: &'a [f64],
}

/// Halvings of the range in which the best length lies.
const HALVINGS: usize = 40;

impl Along<'_> {
    /// The derivative at eight lengths.
    #[inline(always)]
    fn derivative(&self, length: Lanes) -> Lanes {
        let mut forces = Lanes::splat(0.0);
        for ((unknown, free), slope) in self.unknowns.iter().zip(self.free).zip(self.slope) {
            let x = Lanes::splat(*free) + length * Lanes::splat(*slope);
            forces += Lanes::splat(unknown.cost * slope) * x.clip(Lanes::splat(unknown.low), Lanes::splat(unknown.high));
        }
        Lanes::splat(self.start) + length * Lanes::splat(self.curvature) + forces
    }
}

impl LaneWork for Along<'_> {
    type Output = f64;

    /// Bisection: three halvings at once, from the derivatives at all seven lengths to which they can lead.
    #[inline(always)]
    fn run(self) -> f64 {
        let mut ends = Lanes::splat(0.0);
        ends.set_lane(1, 1.0);
        let at_ends = self.derivative(ends);
        if at_ends.lane(1) <= 1e-9 * at_ends.lane(0).abs() {
            return 1.0;
        }
        let [mut low, mut high] = [0.0, 1.0];
        let mut halvings = 0;
        while halvings < HALVINGS {
            // Lane 4 halves the range, lanes 2 and 6 its halves, the odd ones what is left.
            let mut lengths = [low; WIDTH + 1];
            lengths[WIDTH] = high;
            for width in [4, 2, 1] {
                for middle in (width..WIDTH).step_by(2 * width) {
                    lengths[middle] = 0.5 * (lengths[middle - width] + lengths[middle + width]);
                }
            }
            let mut lanes = Lanes::splat(low);
            for (lane, length) in lengths[..WIDTH].iter().enumerate() {
                lanes.set_lane(lane, *length);
            }
            let derivatives = self.derivative(lanes);
            let (mut first, mut last) = (0, WIDTH);
            while last - first > 1 && halvings < HALVINGS {
                let middle = (first + last) / 2;
                if derivatives.lane(middle) > 0.0 {
                    last = middle
                } else {
                    first = middle
                }
                halvings += 1;
            }
            (low, high) = (lengths[first], lengths[last]);
        }
        high
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ROWS: usize = 5;
    const COLUMNS: usize = 12;

    fn problem() -> impl Strategy<Value = (Vec<[f64; ROWS]>, Vec<Unknown>, [f64; ROWS])> {
        let column = prop::array::uniform5(prop_oneof![Just(0.0), -50.0..50.0]);
        let unknown = (0.0..0.5, 0.0..0.5, 0.01..1.0).prop_map(|(low, span, cost)| Unknown { low, high: low + span, cost });
        (prop::collection::vec(column, COLUMNS), prop::collection::vec(unknown, COLUMNS), prop::array::uniform5(-100.0..100.0))
    }

    fn cost(columns: &[[f64; ROWS]], unknowns: &[Unknown], wanted: &[f64; ROWS], x: &[f64]) -> f64 {
        let error = |row: usize| wanted[row] - columns.iter().zip(x).map(|(column, x)| column[row] * x).sum::<f64>();
        let errors: f64 = (0..ROWS).map(|row| error(row) * error(row) / inertia(row)).sum();
        errors + unknowns.iter().zip(x).map(|(unknown, x)| unknown.cost * x * x).sum::<f64>()
    }

    fn inertia(row: usize) -> f64 {
        0.5 + row as f64
    }

    /// Only by the interior-point method, to the last digits that matter.
    const INTERIOR: Effort = Effort { tolerance: 0.0, first: 0, target: Target { gap: 1e-10, residual: 1e-9 }, last: 0 };
    const EFFORTS: [Effort; 3] = [Effort::EXACT, Effort { first: 0, ..Effort::EXACT }, INTERIOR];

    fn solve(columns: &[[f64; ROWS]], unknowns: &[Unknown], wanted: &[f64; ROWS], effort: Effort) -> (Vec<f64>, bool) {
        let mut matrix = Symmetric::new(ROWS);
        (0..ROWS).for_each(|row| matrix.add(row, row, inertia(row)));
        let mut sparse = Columns::default();
        columns.iter().for_each(|column| sparse.push(column.iter().copied().enumerate()));
        let mut allocation = Allocation::new(ROWS);
        allocation.set_effort(effort);
        let exact = allocation.solve(&Problem { inertia: &matrix, columns: &sparse, unknowns, wanted });
        (allocation.x, exact)
    }

    proptest! {
        #[test]
        fn the_answer_keeps_its_bounds_and_no_neighbour_is_better((columns, unknowns, wanted) in problem(), effort in 0..3_usize) {
            let (x, exact) = solve(&columns, &unknowns, &wanted, EFFORTS[effort]);
            prop_assert!(exact || EFFORTS[effort] == INTERIOR);
            let best = cost(&columns, &unknowns, &wanted, &x);
            for (index, unknown) in unknowns.iter().enumerate() {
                prop_assert!(unknown.low <= x[index] && x[index] <= unknown.high);
                for change in [-1e-3, 1e-3] {
                    let mut neighbour = x.clone();
                    neighbour[index] = (x[index] + change).clip(unknown.low, unknown.high);
                    let other = cost(&columns, &unknowns, &wanted, &neighbour);
                    prop_assert!(best <= other + 1e-8 * (1.0 + best), "{best} is more than {other}, with {index} by {change}; {x:?}");
                }
            }
        }
    }

    #[test]
    fn unknowns_without_room_stay_where_they_are() {
        let columns = [[3.0; ROWS], [-2.0; ROWS]];
        let unknowns = [Unknown { low: 0.3, high: 0.3, cost: 0.01 }, Unknown { low: 0.0, high: 1.0, cost: 0.01 }];
        for effort in EFFORTS {
            let (x, _) = solve(&columns, &unknowns, &[-5.0; ROWS], effort);
            assert_eq!(x[0], 0.3);
            assert!((x[1] - 1.0).abs() < 1e-6, "{x:?}");
        }
    }

    #[test]
    fn a_single_muscle_meets_a_small_wish_and_saturates_at_a_large_one() {
        let column = [[100.0, 0.0, 0.0, 0.0, 0.0]];
        let unknown = [Unknown { low: 0.0, high: 1.0, cost: 1e-6 }];
        let (x, _) = solve(&column, &unknown, &[30.0, 0.0, 0.0, 0.0, 0.0], Effort::EXACT);
        assert!((x[0] - 0.3).abs() < 1e-6);
        let (x, _) = solve(&column, &unknown, &[1e4, 0.0, 0.0, 0.0, 0.0], Effort::EXACT);
        assert_eq!(x[0], 1.0);
    }
}

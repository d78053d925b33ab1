//! Allocation: which muscles and ground forces together make the wanted generalised force.
//!
//! The problem is a bounded least-squares problem with a unique answer,
//!
//! > minimise ½ e' W e + ½ Σ rᵢ xᵢ²,   e = b - A x,   low ≤ x ≤ high,
//!
//! where W is the inverse of the effective inertia, so that an error counts by the accelerations that it causes (Gauss'
//! principle). The unknowns are many (416 muscles, some tens of contact forces) and the rows few and short, so it is solved in
//! its dual, over the multiplier y = W e: by Newton's method ([`newton`]) from the previous control step's y. Where that takes
//! long, because many unknowns change bounds, an [`interior`] point method finds the neighbourhood of the answer and Newton's method the rest.
//!
//! W⁻¹ and the squares of the columns have entries only between coordinates on one path of the body's tree, or of one that its muscles have
//! made longer, so a factorisation takes a tenth of a dense one. All is written over [`Real`]: with lanes every operation serves
//! the problems of several episodes.

mod columns;
mod interior;
mod newton;

pub(super) use columns::Columns;

use interior::{Interior, Target};
use msk_physics::Instructions;
use msk_physics::path_matrix::PathPattern;
use msk_physics::scalar::Real;
use newton::{Newton, Patience, Search};

/// Bounds and cost of one unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unknown<T> {
    pub low: T,
    pub high: T,
    /// r, positive.
    pub cost: T,
}

/// What is shared out, and among what.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a, T> {
    /// Where W⁻¹, and the squares of the columns, have entries.
    pub pattern: &'a PathPattern,
    /// W⁻¹.
    pub inertia: &'a [T],
    /// A, with one column for each of the unknowns.
    pub columns: &'a Columns<T>,
    pub unknowns: &'a [Unknown<T>],
    /// b.
    pub wanted: &'a [T],
    /// Number of unknowns: a lane may lack some, whose columns are zero there.
    pub count: T,
}

impl<T: Real> Problem<'_, T> {
    /// What errors are measured by: the largest of b, or 1.
    #[inline(always)]
    fn scale(&self) -> T {
        largest(self.wanted).at_least(T::splat(1.0))
    }
}

/// The largest size among the values, or 0.
#[inline(always)]
fn largest<T: Real>(values: &[T]) -> T {
    let mut largest = T::splat(0.0);
    for value in values {
        T::apart();
        largest = largest.at_least(value.abs());
    }
    largest
}

/// What of an allocation the next one begins with.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Memory {
    /// y: the acceleration that the remaining error would cause.
    multiplier: Vec<f64>,
    /// How many allocations from here Newton's method is tried again, which did not find an answer a short time ago; 0 where it did.
    wait: f64,
    /// For how many it waits the next time that it does not.
    pause: f64,
}

impl Memory {
    /// That of a body of so many rows at rest.
    pub fn new(rows: usize) -> Self {
        Self { multiplier: vec![0.0; rows], wait: 0.0, pause: PAUSES[0] }
    }
}

/// The solver of one problem, or of those in lanes.
#[derive(Debug, Clone)]
pub(super) struct Allocation<T: Real> {
    multiplier: Vec<T>,
    wait: T,
    pause: T,
    /// The unknowns, one per column.
    x: Vec<T>,
    newton: Newton<T>,
    interior: Interior<T>,
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

/// The next try of Newton's method after one that found no answer is so many allocations later: a state that was violent a moment ago still is. With every
/// try in vain it waits twice as long, up to the second.
const PAUSES: [f64; 2] = [4.0, 19.0];
/// And it takes so many steps at most: what has calmed down takes three to six.
const RETRY: usize = 8;
/// So many steps are taken in any case, at first and when it is tried again.
const SURE: [usize; 2] = [8, 3];

impl Effort {
    /// For what is acted on. A body that is pushed takes up to seventeen Newton steps, which is less work than the other method.
    pub const EXACT: Self = Self { tolerance: 1e-7, first: 20, target: Target { gap: 1e-10, residual: 1e-7 }, last: 80 };
    /// For what is only imagined: the forces on the joints are right to a thousandth, while muscles that could stand in for each
    /// other share less evenly.
    pub const ROUGH: Self = Self { tolerance: 1e-5, first: 4, target: Target { gap: 1e-5, residual: 1e-4 }, last: 0 };
}

impl<T: Real> Allocation<T> {
    /// Memory for systems of `rows` rows.
    pub fn new(rows: usize) -> Self {
        Self {
            multiplier: vec![T::splat(0.0); rows],
            wait: T::splat(0.0),
            pause: T::splat(0.0),
            x: Vec::new(),
            newton: Newton::new(rows),
            interior: Interior::new(rows),
        }
    }

    /// Fills `x`, from the multiplier on, in the lanes `among` all; gives the lanes whose answer has the tolerance of the effort.
    pub fn search(&mut self, problem: &Problem<'_, T>, effort: Effort, among: T::Mask) -> T::Mask {
        let Effort { tolerance, first, target, last } = effort;
        self.x.clear();
        self.x.resize(problem.unknowns.len(), T::splat(0.0));
        let [zero, one, two] = [0.0, 1.0, 2.0].map(T::splat);
        let [shortest, longest] = PAUSES.map(T::splat);
        let waits = one.less(self.wait);
        let again = zero.less(self.wait);
        let steps = |counts: [usize; 2]| {
            let [at_first, again_at_most] = counts.map(|count| T::splat(count as f64));
            T::select(again, again_at_most, at_first)
        };
        let patience = Patience { most: steps([first, first.min(RETRY)]), sure: steps(SURE) };
        let found = self.newton(problem, tolerance, patience, T::and(among, T::not(waits)));
        let left = T::and(among, T::not(found));
        let wait = T::select(found, zero, T::select(waits, self.wait - one, self.pause));
        let pause = T::select(found, shortest, T::select(waits, self.pause, (two * self.pause).at_most(longest)));
        self.wait = T::select(among, wait, self.wait);
        self.pause = T::select(among, pause, self.pause);
        if !T::any(left) {
            return found;
        }
        self.interior.solve(problem, target, left, &mut self.x, &mut self.multiplier);
        if last == 0 {
            return found;
        }
        let last = T::splat(last as f64);
        T::or(found, self.newton(problem, tolerance, Patience { most: last, sure: last }, left))
    }

    /// Newton steps in the lanes that try, after which `x` is what the multiplier asks for; gives the lanes in which it is the answer.
    fn newton(&mut self, problem: &Problem<'_, T>, tolerance: f64, patience: Patience<T>, tries: T::Mask) -> T::Mask {
        let Self { newton, multiplier, x, .. } = self;
        Instructions::default().run(Search { newton, problem, tolerance, patience, tries, multiplier, x })
    }

    /// Begins a lane where `memory` has ended.
    pub fn recall(&mut self, lane: usize, memory: &Memory) {
        for (own, &value) in self.multiplier.iter_mut().zip(&memory.multiplier) {
            own.set_lane(lane, value);
        }
        self.wait.set_lane(lane, memory.wait);
        self.pause.set_lane(lane, memory.pause);
    }

    /// Ends a lane, whose first unknowns are written to `out`.
    pub fn remember(&self, lane: usize, memory: &mut Memory, out: &mut [f64]) {
        for (out, x) in out.iter_mut().zip(&self.x) {
            *out = x.lane(lane);
        }
        for (value, own) in memory.multiplier.iter_mut().zip(&self.multiplier) {
            *value = own.lane(lane);
        }
        memory.wait = self.wait.lane(lane);
        memory.pause = self.pause.lane(lane);
        // What is not finite would never become finite again.
        if !memory.multiplier.iter().all(|value| value.is_finite()) {
            memory.multiplier.fill(0.0);
        }
    }
}

#[cfg(test)]
mod tests;

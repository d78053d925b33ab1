//! The allocation of violent states: a primal-dual interior-point method.
//!
//! Newton's method on the dual (see [`newton`](super::newton)) follows one piece of the answer after the other, so it needs the more
//! steps the more unknowns change bounds: sixty and more while a body falls or cannot keep up with its reference. With a price λ on each
//! slack s = x - low and μ on t = high - x, the same optimum solves
//!
//! > r x - a·y - λ + μ = 0,   W⁻¹ y + A x = b,   s λ = 0,   t μ = 0,
//!
//! and Mehrotra's predictor-corrector method (SIAM J. Optim. 2, 1992) brings the products to zero together, through the inside of all
//! bounds, in some ten to twenty steps however many bounds change. A step takes one factorisation of the same size,
//! W⁻¹ + Σ aᵢ aᵢ' / (rᵢ + λᵢ/sᵢ + μᵢ/tᵢ), and two solutions with it.

use super::{Problem, Unknown, largest};
use msk_physics::scalar::Real;
use msk_physics::{Instructions, LaneWork};

/// How near to its bounds a step may go, as a share of the way.
const NEARLY: f64 = 0.995;
/// Distance from its bounds at which an unknown begins, as a share of what is between them, or of 1.
const INSET: f64 = 0.3;
/// What share of the cost of the force that is missing at the beginning the products of slacks and prices add up to at least: with
/// smaller ones the way to that force would lead along the bounds, and the steps would be short.
const OPENING: f64 = 0.3;
/// An unknown with no more than this between its bounds is fixed.
const FIXED: f64 = 1e-9;
/// Steps of a search at most; ten to twenty are usual down to a gap of 1e-5.
const STEPS: usize = 36;

/// How close an answer has to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Target {
    /// Mean product of a slack and its price, in units of the cost.
    pub gap: f64,
    /// Error of W⁻¹ y + A x = b, relative to the largest of b.
    pub residual: f64,
}

/// Memory of the method.
#[derive(Debug, Clone)]
pub(super) struct Interior<T: Real> {
    intervals: Vec<Interval<T>>,
    /// b - A x - W⁻¹ y.
    missing: Vec<T>,
    y: Vec<T>,
    change: Vec<T>,
    matrix: Vec<T>,
}

/// An unknown between its bounds.
#[derive(Debug, Clone, Copy)]
struct Interval<T> {
    x: T,
    /// Above the lower bound, and below the upper one.
    slack: [T; 2],
    /// Of these slacks.
    price: [T; 2],
    /// a·y
    pull: T,
    /// One over each slack, and how stiff its price makes it.
    inverse: [T; 2],
    stiffness: [T; 2],
    /// By how much x yields to a force; 0 where it is fixed.
    yields: T,
    /// What moves x at y as it is.
    push: T,
    /// The step: of x, of a·y and of the prices.
    change: T,
    pull_change: T,
    price_change: [T; 2],
}

impl<T: Real> Interval<T> {
    #[inline(always)]
    fn is_free(&self) -> T::Mask {
        T::splat(0.0).less(self.yields)
    }
}

impl<T: Real> Interior<T> {
    /// Memory for systems of `rows` rows.
    pub fn new(rows: usize) -> Self {
        let zeros = || vec![T::splat(0.0); rows];
        Self { intervals: Vec::new(), missing: zeros(), y: zeros(), change: zeros(), matrix: Vec::new() }
    }

    /// Improves the unknowns `x` and the multiplier `y` of the lanes that try from what they are. Both stay as they are where it
    /// leads nowhere.
    pub fn solve(&mut self, problem: &Problem<'_, T>, target: Target, tries: T::Mask, x: &mut [T], y: &mut [T]) {
        self.y.copy_from_slice(y);
        self.matrix.resize(problem.inertia.len(), T::splat(0.0));
        let mut waits = tries;
        for begins_anew in [false, true] {
            if !T::any(waits) {
                break;
            }
            if begins_anew {
                // From a multiplier that belongs to quite another problem the products may go round in a circle.
                Instructions::default().run(Forget { interior: self, problem, x });
            }
            let search = Search { interior: self, problem, target, tries: waits, x: &*x };
            let found = Instructions::default().run(search);
            self.keep(problem, T::and(waits, found), x, y);
            waits = T::and(waits, T::not(found));
        }
    }

    /// Writes what was found.
    fn keep(&self, problem: &Problem<'_, T>, found: T::Mask, x: &mut [T], y: &mut [T]) {
        for (y, &found_y) in y.iter_mut().zip(&self.y) {
            *y = T::select(found, found_y, *y);
        }
        for ((x, interval), unknown) in x.iter_mut().zip(&self.intervals).zip(problem.unknowns) {
            // Slacks stay positive, their sums with the bounds only nearly.
            *x = T::select(found, interval.x.clip(unknown.low, unknown.high), *x);
        }
    }

    /// Puts every unknown inside of its bounds, with prices that balance it as far as possible.
    #[inline(always)]
    fn begin(&mut self, problem: &Problem<'_, T>, x: &[T]) {
        let Problem { pattern, inertia, columns, unknowns, wanted, count } = *problem;
        let [zero, one, half] = [0.0, 1.0, 0.5].map(T::splat);
        let count = count.at_least(one);
        pattern.layout().multiply(inertia, &self.y, &mut self.missing);
        for (missing, &wanted) in self.missing.iter_mut().zip(wanted) {
            T::apart();
            *missing = wanted - *missing;
        }
        self.intervals.clear();
        let mut excess = zero;
        for (index, (unknown, &x)) in unknowns.iter().zip(x).enumerate() {
            let Unknown { low, high, cost } = *unknown;
            let free = T::splat(FIXED).less(high - low);
            let inset = T::splat(INSET) * (high - low).at_most(one);
            let x = T::select(free, x.clip(low + inset, high - inset), low);
            let slack = [T::select(free, x - low, one), T::select(free, high - x, one)];
            columns.add_scaled(index, -x, &mut self.missing);
            let pull = columns.dot(index, &self.y);
            excess += T::select(free, (cost * x - pull).abs() * slack[0].at_most(slack[1]), zero);
            let yields = T::select(free, one, zero);
            let none = [zero; 2];
            self.intervals.push(Interval {
                x,
                slack,
                pull,
                yields,
                price: none,
                inverse: none,
                stiffness: none,
                push: zero,
                change: zero,
                pull_change: zero,
                price_change: none,
            });
        }
        let opening = T::splat(OPENING) * self.missing_cost(problem);
        let mean = (excess.at_least(opening) / count).at_least(T::splat(1e-9));
        for (interval, unknown) in self.intervals.iter_mut().zip(unknowns) {
            // λ - μ = r x - a·y, and products about the mean.
            let difference = unknown.cost * interval.x - interval.pull;
            let product = mean * mean / (interval.slack[0] * interval.slack[1]);
            let larger = half * (difference.abs() + (difference * difference + T::splat(4.0) * product).sqrt());
            let (smaller, pulled) = (product / larger, zero.less(difference));
            let [below, above] = [T::select(pulled, larger, smaller), T::select(pulled, smaller, larger)];
            let free = interval.is_free();
            interval.price = [T::select(free, below, zero), T::select(free, above, zero)];
        }
    }

    /// ½ m' W m of the force m that is missing.
    #[inline(always)]
    fn missing_cost(&mut self, problem: &Problem<'_, T>) -> T {
        self.matrix.copy_from_slice(problem.inertia);
        problem.pattern.layout().factor(&mut self.matrix);
        self.change.copy_from_slice(&self.missing);
        problem.pattern.layout().solve(&self.matrix, &mut self.change);
        let mut cost = T::splat(0.0);
        for (&missing, &change) in self.missing.iter().zip(&self.change) {
            T::apart();
            cost += missing * change;
        }
        T::splat(0.5) * cost
    }

    /// The mean product of slacks and prices after `length` of the step.
    #[inline(always)]
    fn gap(&self, problem: &Problem<'_, T>, length: T) -> T {
        let mut sum = T::splat(0.0);
        for interval in &self.intervals {
            T::apart();
            let &Interval { slack, price, change, price_change, .. } = interval;
            sum += (slack[0] + length * change) * (price[0] + length * price_change[0]);
            sum += (slack[1] - length * change) * (price[1] + length * price_change[1]);
        }
        sum / (T::splat(2.0) * problem.count).at_least(T::splat(1.0))
    }

    #[inline(always)]
    fn factor(&mut self, problem: &Problem<'_, T>) {
        self.matrix.copy_from_slice(problem.inertia);
        for (index, (interval, unknown)) in self.intervals.iter_mut().zip(problem.unknowns).enumerate() {
            let free = interval.is_free();
            if T::any(free) {
                let Interval { slack, price, .. } = *interval;
                let inverse = [T::splat(1.0) / slack[0], T::splat(1.0) / slack[1]];
                (interval.inverse, interval.stiffness) = (inverse, [price[0] * inverse[0], price[1] * inverse[1]]);
                let yields = T::splat(1.0) / (unknown.cost + interval.stiffness[0] + interval.stiffness[1]);
                interval.yields = T::select(free, yields, T::splat(0.0));
                problem.columns.add_square(index, interval.yields, problem.pattern, &mut self.matrix);
            }
        }
        problem.pattern.layout().factor(&mut self.matrix);
    }

    /// Fills the step towards the products that `aim` gives for each pair of slack and price.
    #[inline(always)]
    fn step(&mut self, problem: &Problem<'_, T>, aim: impl Fn(&Interval<T>) -> [T; 2]) {
        let Problem { pattern, columns, unknowns, .. } = *problem;
        let zero = T::splat(0.0);
        self.change.copy_from_slice(&self.missing);
        for (index, (interval, unknown)) in self.intervals.iter_mut().zip(unknowns).enumerate() {
            let free = interval.is_free();
            if !T::any(free) {
                continue;
            }
            let aim = aim(interval);
            let Interval { x, inverse, price, pull, .. } = *interval;
            let aimed = [aim[0] * inverse[0], aim[1] * inverse[1]];
            interval.price_change = [T::select(free, aimed[0] - price[0], zero), T::select(free, aimed[1] - price[1], zero)];
            // With the prices that the aim asks for, r x - a·y - λ + μ is minus this.
            interval.push = pull - unknown.cost * x + aimed[0] - aimed[1];
            columns.add_scaled(index, -(interval.yields * interval.push), &mut self.change);
        }
        pattern.layout().solve(&self.matrix, &mut self.change);
        for (index, interval) in self.intervals.iter_mut().enumerate() {
            if !T::any(interval.is_free()) {
                continue;
            }
            let Interval { stiffness, push, yields, .. } = *interval;
            interval.pull_change = columns.dot(index, &self.change);
            interval.change = yields * (push + interval.pull_change);
            interval.price_change[0] -= stiffness[0] * interval.change;
            interval.price_change[1] += stiffness[1] * interval.change;
        }
    }

    /// The longest step, up to 1, that leaves slacks and prices at zero or above.
    #[inline(always)]
    fn length(&self) -> T {
        let mut length = T::splat(1.0);
        for interval in &self.intervals {
            let &Interval { slack, price, change, price_change, .. } = interval;
            let ways = [(slack[0], change), (slack[1], -change), (price[0], price_change[0]), (price[1], price_change[1])];
            for (value, change) in ways {
                let beyond = (value + length * change).less(T::splat(0.0));
                if T::any(beyond) {
                    length = T::select(beyond, -value / change, length);
                }
            }
        }
        length
    }

    /// Takes the step in the lanes that are `active`, and leaves the others where they are.
    #[inline(always)]
    fn advance(&mut self, length: T, active: T::Mask) {
        let stride = Stride { length, active };
        for interval in &mut self.intervals {
            T::apart();
            interval.x = stride.from(interval.x, interval.change);
            interval.slack = [stride.from(interval.slack[0], interval.change), stride.from(interval.slack[1], -interval.change)];
            interval.pull = stride.from(interval.pull, interval.pull_change);
            let Interval { price, price_change, .. } = *interval;
            interval.price = [stride.from(price[0], price_change[0]), stride.from(price[1], price_change[1])];
        }
        for (y, &change) in self.y.iter_mut().zip(&self.change) {
            T::apart();
            *y = stride.from(*y, change);
        }
        for missing in &mut self.missing {
            T::apart();
            // The equation is linear: the full step would leave nothing.
            *missing = stride.from(*missing, -*missing);
        }
    }
}

/// So much of a step, in these lanes. A type and no closure, which would be compiled for the least of all processors.
struct Stride<T: Real> {
    length: T,
    active: T::Mask,
}

impl<T: Real> Stride<T> {
    #[inline(always)]
    fn from(&self, from: T, change: T) -> T {
        T::select(self.active, from + self.length * change, from)
    }
}

/// Steps from `x` and the present multiplier on.
struct Search<'a, T: Real> {
    interior: &'a mut Interior<T>,
    problem: &'a Problem<'a, T>,
    target: Target,
    tries: T::Mask,
    x: &'a [T],
}

impl<T: Real> LaneWork for Search<'_, T> {
    /// The lanes in which the target was met.
    type Output = T::Mask;

    #[inline(always)]
    fn run(self) -> T::Mask {
        let Self { interior, problem, target, tries, x } = self;
        interior.begin(problem, x);
        let zero = T::splat(0.0);
        let residual = T::splat(target.residual) * problem.scale();
        let (mut active, mut found) = (tries, zero.less(zero));
        for taken in 0..=STEPS {
            let (gap, missing) = (interior.gap(problem, zero), largest(&interior.missing));
            let near = T::and(T::not(T::splat(target.gap).less(gap)), T::not(residual.less(missing)));
            let sound = T::and(is_finite(gap), is_finite(missing));
            active = T::and(active, sound);
            found = T::or(found, T::and(active, near));
            active = T::and(active, T::not(near));
            if taken == STEPS || !T::any(active) {
                break;
            }
            interior.factor(problem);
            interior.step(
                problem,
                #[inline(always)]
                |_| [zero; 2],
            );
            let expected = interior.gap(problem, interior.length()) / gap;
            let centre = expected * expected * expected * gap;
            interior.step(
                problem,
                #[inline(always)]
                |interval| {
                    let [below, above] = interval.price_change;
                    [centre - interval.change * below, centre + interval.change * above]
                },
            );
            interior.advance(T::splat(NEARLY) * interior.length(), active);
        }
        for &y in &interior.y {
            found = T::and(found, is_finite(y));
        }
        found
    }
}

/// Brings the multiplier to what belongs to `x`.
struct Forget<'a, T: Real> {
    interior: &'a mut Interior<T>,
    problem: &'a Problem<'a, T>,
    x: &'a [T],
}

impl<T: Real> LaneWork for Forget<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { interior: Interior { y, matrix, .. }, problem: Problem { pattern, inertia, columns, wanted, .. }, x } = self;
        y.copy_from_slice(wanted);
        x.iter().enumerate().for_each(|(index, &x)| columns.add_scaled(index, -x, y));
        matrix.copy_from_slice(inertia);
        pattern.layout().factor(matrix);
        pattern.layout().solve(matrix, y);
    }
}

#[inline(always)]
fn is_finite<T: Real>(value: T) -> T::Mask {
    value.abs().less(T::splat(f64::INFINITY))
}

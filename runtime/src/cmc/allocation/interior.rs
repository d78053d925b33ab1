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
/// How far above its lower bound an unknown begins at most; it does so in the middle between bounds that are nearer. Where the last answer has left
/// it is no better: most unknowns that change stand at a bound, and the steps away from there are short.
const INSET: f64 = 0.5;
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
    /// The mean product of a slack and its price.
    gap: T,
    /// Of each unknown: by how much x yields to a force, 0 where it is fixed; minus the step at no change of y; the change of a·y.
    yields: Vec<T>,
    pushes: Vec<T>,
    pulls: Vec<T>,
}

/// An unknown between its bounds. With lanes all of them together are larger than the cache next to the core, so nothing is in it that
/// takes less time to compute.
#[derive(Debug, Clone, Copy)]
struct Interval<T> {
    /// Of x above the lower bound, and below the upper one; 1 where it is fixed.
    slack: [T; 2],
    /// Of these slacks; 0 where it is fixed.
    price: [T; 2],
    /// One over each slack; 0 where it is fixed.
    inverse: [T; 2],
    /// 1, or 0 where it is fixed.
    moves: T,
    /// a·y - r x: what moves x.
    push: T,
    /// The step: of x and of the prices. One that is not taken yet, or none.
    change: T,
    price_change: [T; 2],
}

impl<T: Real> Interval<T> {
    /// Takes the step, with which a·y changes by `pull_change`.
    #[inline(always)]
    fn advance(&mut self, stride: &Stride<T>, cost: T, pull_change: T) {
        let Self { change, price_change, .. } = *self;
        self.slack = [stride.from(self.slack[0], change), stride.from(self.slack[1], -change)];
        self.price = [stride.from(self.price[0], price_change[0]), stride.from(self.price[1], price_change[1])];
        self.push = stride.from(self.push, pull_change - cost * change);
    }

    /// Fills the inverse slacks; gives by how much x yields to a force.
    #[inline(always)]
    fn stiffen(&mut self, cost: T) -> T {
        let Self { slack: [below, above], price: [low, high], moves, .. } = *self;
        // One division in place of three, each of which takes as long as sixteen products.
        let product = below * above;
        let stiff = cost * product + low * above + high * below;
        let shared = moves / (product * stiff);
        let inverse = shared * stiff;
        self.inverse = [above * inverse, below * inverse];
        product * product * shared
    }
}

impl<T: Real> Interior<T> {
    /// Memory for systems of `rows` rows.
    pub fn new(rows: usize) -> Self {
        let zeros = || vec![T::splat(0.0); rows];
        Self {
            intervals: Vec::new(),
            missing: zeros(),
            y: zeros(),
            change: zeros(),
            matrix: Vec::new(),
            gap: T::splat(0.0),
            yields: Vec::new(),
            pushes: Vec::new(),
            pulls: Vec::new(),
        }
    }

    /// Finds the unknowns `x` of the lanes that try, from their multiplier `y` on, and improves that. Both stay as they are where it leads nowhere.
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
            let search = Search { interior: self, problem, target, tries: waits };
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
            *x = T::select(found, (unknown.low + interval.moves * interval.slack[0]).clip(unknown.low, unknown.high), *x);
        }
    }

    /// Puts every unknown inside of its bounds, with prices that balance it as far as possible.
    #[inline(always)]
    fn begin(&mut self, problem: &Problem<'_, T>) {
        let Problem { pattern, inertia, columns, unknowns, wanted, count } = *problem;
        let [zero, one, half] = [0.0, 1.0, 0.5].map(T::splat);
        let count = count.at_least(one);
        pattern.layout().multiply(inertia, &self.y, &mut self.missing);
        for (missing, &wanted) in self.missing.iter_mut().zip(wanted) {
            T::apart();
            *missing = wanted - *missing;
        }
        for values in [&mut self.yields, &mut self.pushes, &mut self.pulls] {
            values.resize(unknowns.len(), zero);
        }
        for (push, &Unknown { low, high, .. }) in self.pushes.iter_mut().zip(unknowns) {
            T::apart();
            // Minus where it begins.
            *push = -low - T::select(T::splat(FIXED).less(high - low), (half * (high - low)).at_most(T::splat(INSET)), zero);
        }
        columns.add_scaled(&self.pushes, &mut self.missing);
        columns.dots(&self.y, &mut self.pulls);
        self.intervals.clear();
        let mut excess = zero;
        for ((&Unknown { low, high, cost }, &push), pull) in unknowns.iter().zip(&self.pushes).zip(&mut self.pulls) {
            T::apart();
            let (x, free) = (-push, T::splat(FIXED).less(high - low));
            let slack = [T::select(free, x - low, one), T::select(free, high - x, one)];
            let push = *pull - cost * x;
            excess += T::select(free, push.abs() * slack[0].at_most(slack[1]), zero);
            let (none, moves) = ([zero; 2], T::select(free, one, zero));
            self.intervals.push(Interval { slack, price: none, inverse: none, moves, push, change: zero, price_change: none });
            *pull = zero;
        }
        let opening = T::splat(OPENING) * self.missing_cost(problem);
        let mean = (excess.at_least(opening) / count).at_least(T::splat(1e-9));
        for interval in &mut self.intervals {
            T::apart();
            // λ - μ = r x - a·y, and products about the mean.
            let difference = -interval.push;
            let product = mean * mean / (interval.slack[0] * interval.slack[1]);
            let larger = half * (difference.abs() + (difference * difference + T::splat(4.0) * product).sqrt());
            let (smaller, pulled) = (product / larger, zero.less(difference));
            let [below, above] = [T::select(pulled, larger, smaller), T::select(pulled, smaller, larger)];
            interval.price = [interval.moves * below, interval.moves * above];
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

    /// The mean product of slacks and prices.
    #[inline(always)]
    fn gap(&self, problem: &Problem<'_, T>) -> T {
        let mut sum = T::splat(0.0);
        for Interval { slack, price, .. } in &self.intervals {
            T::apart();
            sum += slack[0] * price[0] + slack[1] * price[1];
        }
        sum / pairs(problem)
    }

    /// Takes the last step, factors the matrix there, and aims at products of zero.
    #[inline(always)]
    fn predict(&mut self, problem: &Problem<'_, T>, stride: &Stride<T>) {
        let Problem { pattern, inertia, columns, unknowns, .. } = *problem;
        self.matrix.copy_from_slice(inertia);
        self.advance(stride);
        self.change.copy_from_slice(&self.missing);
        let outputs = self.yields.iter_mut().zip(&mut self.pushes).zip(&self.pulls);
        for ((interval, unknown), ((yields, push), &pull_change)) in self.intervals.iter_mut().zip(unknowns).zip(outputs) {
            T::apart();
            interval.advance(stride, unknown.cost, pull_change);
            *yields = interval.stiffen(unknown.cost);
            *push = -(*yields * interval.push);
        }
        columns.add_scaled(&self.pushes, &mut self.change);
        columns.add_squares(&self.yields, pattern, &mut self.matrix);
        pattern.layout().factor(&mut self.matrix);
    }

    /// Aims at products of `centre`, and makes up for what the step just found would change in them at second order.
    #[inline(always)]
    fn correct(&mut self, problem: &Problem<'_, T>, centre: T) {
        self.change.copy_from_slice(&self.missing);
        for ((interval, &yields), push) in self.intervals.iter_mut().zip(&self.yields).zip(&mut self.pushes) {
            T::apart();
            let Interval { inverse, push: moving, change, price_change, .. } = *interval;
            let aim = [centre - change * price_change[0], centre + change * price_change[1]];
            let aimed = [aim[0] * inverse[0], aim[1] * inverse[1]];
            // With the prices that the aim asks for, r x - a·y - λ + μ is minus this.
            *push = -(yields * (moving + (aimed[0] - aimed[1])));
            interval.price_change = aimed;
        }
        problem.columns.add_scaled(&self.pushes, &mut self.change);
    }

    /// Fills the step towards the prices that stand in the place of their changes where it `AIMS` at some, else at none; gives how far it may go.
    #[inline(always)]
    fn step<const AIMS: bool>(&mut self, problem: &Problem<'_, T>) -> Way<T> {
        problem.pattern.layout().solve(&self.matrix, &mut self.change);
        let zero = T::splat(0.0);
        let mut way = Way { length: T::splat(1.0), products: [zero; 3] };
        problem.columns.dots(&self.change, &mut self.pulls);
        let inputs = self.yields.iter().zip(&self.pushes).zip(&self.pulls);
        for (interval, ((&yields, &push), &pull_change)) in self.intervals.iter_mut().zip(inputs) {
            T::apart();
            let Interval { slack, price, inverse, .. } = *interval;
            let aim = if AIMS { interval.price_change } else { [zero; 2] };
            let change = yields * pull_change - push;
            let price_change =
                [(aim[0] - price[0]) - price[0] * (inverse[0] * change), (aim[1] - price[1]) + price[1] * (inverse[1] * change)];
            (interval.change, interval.price_change) = (change, price_change);
            way.shorten([slack[0], slack[1], price[0], price[1]], [change, -change, price_change[0], price_change[1]]);
            way.products[0] += slack[0] * price[0] + slack[1] * price[1];
            way.products[1] += slack[0] * price_change[0] + slack[1] * price_change[1] + change * (price[0] - price[1]);
            way.products[2] += change * (price_change[0] - price_change[1]);
        }
        way
    }

    /// Takes the step of what all unknowns share.
    #[inline(always)]
    fn advance(&mut self, stride: &Stride<T>) {
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

/// Number of slacks with a price.
#[inline(always)]
fn pairs<T: Real>(problem: &Problem<'_, T>) -> T {
    (T::splat(2.0) * problem.count).at_least(T::splat(1.0))
}

/// How far a step may go.
struct Way<T> {
    /// The longest step, up to 1, that leaves slacks and prices at zero or above.
    length: T,
    /// The sum of the products of slacks and prices is a polynomial of the length.
    products: [T; 3],
}

impl<T: Real> Way<T> {
    /// Keeps the values from becoming negative. Few of all shorten the way, so they are looked at one by one where any does.
    #[inline(always)]
    fn shorten(&mut self, values: [T; 4], changes: [T; 4]) {
        let zero = T::splat(0.0);
        let mut least = values[0] + self.length * changes[0];
        for k in 1..4 {
            least = least.at_most(values[k] + self.length * changes[k]);
        }
        if T::any(least.less(zero)) {
            for k in 0..4 {
                let beyond = (values[k] + self.length * changes[k]).less(zero);
                self.length = T::select(beyond, -values[k] / changes[k], self.length);
            }
        }
    }

    /// The sum of the products after so much of the step.
    #[inline(always)]
    fn sum(&self, length: T) -> T {
        self.products[0] + length * (self.products[1] + length * self.products[2])
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

/// Steps from the present multiplier on.
struct Search<'a, T: Real> {
    interior: &'a mut Interior<T>,
    problem: &'a Problem<'a, T>,
    target: Target,
    tries: T::Mask,
}

impl<T: Real> LaneWork for Search<'_, T> {
    /// The lanes in which the target was met.
    type Output = T::Mask;

    #[inline(always)]
    fn run(self) -> T::Mask {
        let Self { interior, problem, target, tries } = self;
        interior.begin(problem);
        let zero = T::splat(0.0);
        let residual = T::splat(target.residual) * problem.scale();
        let (mut active, mut found) = (tries, zero.less(zero));
        interior.gap = interior.gap(problem);
        let mut stride = Stride { length: zero, active };
        for taken in 0..=STEPS {
            // Read back from memory, or the compiler takes the sums over all unknowns apart into the lanes of which it asks here whether any goes on.
            T::apart();
            let gap = interior.gap;
            let missing = (T::splat(1.0) - stride.length) * largest(&interior.missing);
            let near = T::and(T::not(T::splat(target.gap).less(gap)), T::not(residual.less(missing)));
            let sound = T::and(is_finite(gap), is_finite(missing));
            active = T::and(active, sound);
            found = T::or(found, T::and(active, near));
            active = T::and(active, T::not(near));
            if taken == STEPS || !T::any(active) {
                break;
            }
            interior.predict(problem, &stride);
            let way = interior.step::<false>(problem);
            let expected = way.sum(way.length) / way.products[0];
            let centre = expected * expected * expected * way.products[0] / pairs(problem);
            interior.correct(problem, centre);
            let way = interior.step::<true>(problem);
            stride = Stride { length: T::splat(NEARLY) * way.length, active };
            interior.gap = way.sum(stride.length) / pairs(problem);
        }
        interior.advance(&stride);
        for ((interval, unknown), &pull_change) in interior.intervals.iter_mut().zip(problem.unknowns).zip(&interior.pulls) {
            T::apart();
            interval.advance(&stride, unknown.cost, pull_change);
        }
        for &y in &interior.y {
            T::apart();
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
        let Self { interior: Interior { y, matrix, pushes, .. }, problem: Problem { pattern, inertia, columns, wanted, .. }, x } =
            self;
        y.copy_from_slice(wanted);
        for (push, &x) in pushes.iter_mut().zip(x) {
            T::apart();
            *push = -x;
        }
        columns.add_scaled(pushes, y);
        matrix.copy_from_slice(inertia);
        pattern.layout().factor(matrix);
        pattern.layout().solve(matrix, y);
    }
}

#[inline(always)]
fn is_finite<T: Real>(value: T) -> T::Mask {
    value.abs().less(T::splat(f64::INFINITY))
}

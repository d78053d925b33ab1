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
    /// How much of `change` a centre of 1 adds to it.
    centring: Vec<T>,
    /// The sum of the products of slacks and prices.
    products: T,
    /// Of each unknown: by how much x yields to a force, 0 where it is fixed; minus the step at no change of y, and what a centre of 1 adds to
    /// that; the change of a·y.
    yields: Vec<T>,
    pushes: Vec<T>,
    centrings: Vec<T>,
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
    /// The step: of x and of the prices. One that is not taken yet, or none. While a centre is not known yet, the prices that it would
    /// lead to at a centre of 0.
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
            centring: zeros(),
            products: T::splat(0.0),
            yields: Vec::new(),
            pushes: Vec::new(),
            centrings: Vec::new(),
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
                // The products may have gone round in a circle: from a multiplier that belongs to quite another problem, or by steps that are too long.
                Instructions::default().run(Forget { interior: self, problem, x });
            }
            let search = Search { interior: self, problem, target, tries: waits, lowers: begins_anew };
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
        for values in [&mut self.yields, &mut self.pushes, &mut self.centrings, &mut self.pulls] {
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

    /// Takes the last step, and fills what follows from the slacks and prices that it has led to.
    #[inline(always)]
    fn advance(&mut self, problem: &Problem<'_, T>, stride: &Stride<T>) {
        self.advance_shared(stride);
        self.products = T::splat(0.0);
        let outputs = self.yields.iter_mut().zip(&mut self.pushes).zip(&self.pulls);
        for ((interval, unknown), ((yields, push), &pull_change)) in self.intervals.iter_mut().zip(problem.unknowns).zip(outputs)
        {
            T::apart();
            interval.advance(stride, unknown.cost, pull_change);
            self.products += interval.slack[0] * interval.price[0] + interval.slack[1] * interval.price[1];
            *yields = interval.stiffen(unknown.cost);
            *push = -(*yields * interval.push);
        }
    }

    /// Factors the matrix, and finds the step of y towards products of zero.
    #[inline(always)]
    fn predict(&mut self, problem: &Problem<'_, T>) {
        let Problem { pattern, inertia, columns, .. } = *problem;
        self.matrix.copy_from_slice(inertia);
        self.change.copy_from_slice(&self.missing);
        columns.add_scaled(&self.pushes, &mut self.change);
        columns.add_squares(&self.yields, pattern, &mut self.matrix);
        pattern.layout().factor(&mut self.matrix);
        pattern.layout().solve(&self.matrix, &mut self.change);
        columns.dots(&self.change, &mut self.pulls);
    }

    /// Looks how far that step may go, aims at the products that this promises, and makes up for what the step would change in them at second
    /// order. With s Δλ + λ Δs = -s λ of each product their sum becomes (1 - length) of what it is, but for the products of the changes.
    ///
    /// Gives the centre: the product that is aimed at. What the step becomes is linear in it, so one pass over the unknowns is enough.
    #[inline(always)]
    fn correct(&mut self, problem: &Problem<'_, T>) -> T {
        let (one, zero) = (T::splat(1.0), T::splat(0.0));
        let (mut shortening, mut of_changes) = (one, zero);
        let parts = self.pushes.iter_mut().zip(&mut self.centrings).zip(self.yields.iter().zip(&self.pulls));
        for (interval, ((push, centring), (&yields, &pull_change))) in self.intervals.iter_mut().zip(parts) {
            T::apart();
            let Interval { price, inverse, .. } = *interval;
            let change = yields * pull_change - *push;
            // Δs / s of both slacks; Δλ / λ is -1 less that.
            let relative = [inverse[0] * change, -(inverse[1] * change)];
            let left = [one + relative[0], one + relative[1]];
            let lost = [price[0] * left[0], price[1] * left[1]];
            shortening = shortening.at_least((-relative[0]).at_least(-relative[1])).at_least(left[0].at_least(left[1]));
            of_changes += change * (lost[1] - lost[0]);
            let aimed = [relative[0] * lost[0], relative[1] * lost[1]];
            *push -= yields * (aimed[0] - aimed[1]);
            *centring = -(yields * (inverse[0] - inverse[1]));
            interval.price_change = aimed;
        }
        let length = one / shortening;
        let expected = one - length + length * length * (of_changes / self.products);
        let centre = expected * expected * expected * self.products / pairs(problem);
        self.change.copy_from_slice(&self.missing);
        self.centring.fill(zero);
        problem.columns.add_scaled_pair([&self.pushes, &self.centrings], [&mut self.change, &mut self.centring]);
        for (change, &centring) in self.change.iter_mut().zip(&self.centring) {
            T::apart();
            *change += centre * centring;
        }
        problem.pattern.layout().solve(&self.matrix, &mut self.change);
        problem.columns.dots(&self.change, &mut self.pulls);
        centre
    }

    /// Fills the step towards products of `centre`; gives the longest, up to 1, that leaves slacks and prices at zero or above.
    #[inline(always)]
    fn aim(&mut self, centre: T) -> T {
        let (one, zero) = (T::splat(1.0), T::splat(0.0));
        let (mut shortening, mut length) = (one, one);
        let inputs = self.yields.iter().zip(&self.pushes).zip(self.centrings.iter().zip(&self.pulls));
        for (interval, ((&yields, &push), (&centring, &pull_change))) in self.intervals.iter_mut().zip(inputs) {
            T::apart();
            let Interval { price, inverse, price_change: aimed, .. } = *interval;
            let change = yields * pull_change - (push + centre * centring);
            let relative = [inverse[0] * change, -(inverse[1] * change)];
            let price_change = [
                aimed[0] + centre * inverse[0] - price[0] * (one + relative[0]),
                aimed[1] + centre * inverse[1] - price[1] * (one + relative[1]),
            ];
            (interval.change, interval.price_change) = (change, price_change);
            shortening = shortening.at_least((-relative[0]).at_least(-relative[1]));
            // Few of all prices shorten the way, so they are looked at one by one where any does.
            let least = (price[0] + length * price_change[0]).at_most(price[1] + length * price_change[1]);
            if T::any(least.less(zero)) {
                for k in 0..2 {
                    let beyond = (price[k] + length * price_change[k]).less(zero);
                    length = T::select(beyond, -price[k] / price_change[k], length);
                }
            }
        }
        length.at_most(one / shortening)
    }

    /// The length of the step at which the sum of the products is lowest, up to 1: it is of second order in the length, and with steps of x and y of
    /// one length it may rise again before any of them meets a bound (which linear programs, where Δs Δλ adds up to 0, do not have). Steps that
    /// always lower it cannot lead back to where they were.
    #[inline(always)]
    fn lowest(&self) -> T {
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let (mut slope, mut curvature) = (zero, zero);
        for &Interval { slack, price, change, price_change, .. } in &self.intervals {
            T::apart();
            slope += slack[0] * price_change[0] + slack[1] * price_change[1] + change * (price[0] - price[1]);
            curvature += change * (price_change[0] - price_change[1]);
        }
        let turns = T::and(slope.less(zero), zero.less(curvature));
        T::select(turns, -slope / (curvature + curvature), one)
    }

    /// Takes the step of what all unknowns share.
    #[inline(always)]
    fn advance_shared(&mut self, stride: &Stride<T>) {
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
    /// Whether no step goes further than to the lowest products, which takes one more pass over the unknowns.
    lowers: bool,
}

impl<T: Real> LaneWork for Search<'_, T> {
    /// The lanes in which the target was met.
    type Output = T::Mask;

    #[inline(always)]
    fn run(self) -> T::Mask {
        let Self { interior, problem, target, tries, lowers } = self;
        interior.begin(problem);
        let zero = T::splat(0.0);
        let residual = T::splat(target.residual) * problem.scale();
        let (mut active, mut found) = (tries, zero.less(zero));
        let mut stride = Stride { length: zero, active };
        for taken in 0..=STEPS {
            interior.advance(problem, &stride);
            // Read back from memory, or the compiler takes the sums over all unknowns apart into the lanes of which it asks here whether any goes on.
            T::apart();
            let (gap, missing) = (interior.products / pairs(problem), largest(&interior.missing));
            let near = T::and(T::not(T::splat(target.gap).less(gap)), T::not(residual.less(missing)));
            let sound = T::and(is_finite(gap), is_finite(missing));
            active = T::and(active, sound);
            found = T::or(found, T::and(active, near));
            active = T::and(active, T::not(near));
            if taken == STEPS || !T::any(active) {
                break;
            }
            interior.predict(problem);
            let centre = interior.correct(problem);
            let inside = T::splat(NEARLY) * interior.aim(centre);
            stride = Stride { length: if lowers { inside.at_most(interior.lowest()) } else { inside }, active };
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

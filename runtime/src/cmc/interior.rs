//! The allocation of violent states: a primal-dual interior-point method.
//!
//! Newton's method on the dual (see [`allocation`](super::allocation)) follows one piece of the answer after the other, so it needs the more
//! steps the more unknowns change bounds: sixty and more while a body falls or cannot keep up with its reference. With a price λ on each
//! slack s = x - low and μ on t = high - x, the same optimum solves
//!
//! > r x - a·y - λ + μ = 0,   W⁻¹ y + A x = b,   s λ = 0,   t μ = 0,
//!
//! and Mehrotra's predictor-corrector method (SIAM J. Optim. 2, 1992) brings the products to zero together, through the inside of all
//! bounds, in some ten to twenty steps however many bounds change. A step takes one factorisation of the same size,
//! W⁻¹ + Σ aᵢ aᵢ' / (rᵢ + λᵢ/sᵢ + μᵢ/tᵢ), and two solutions with it.

use super::allocation::{Problem, Unknown};
use super::symmetric::Symmetric;
use msk_physics::scalar::Real;

/// How near to its bounds a step may go, as a share of the way.
const NEARLY: f64 = 0.995;
/// Distance from its bounds at which an unknown begins, as a share of what is between them, or of 1.
const INSET: f64 = 0.1;
/// An unknown with no more than this between its bounds is fixed.
const FIXED: f64 = 1e-9;
/// Steps of a search at most; sixteen to twenty are usual down to a gap of 1e-10.
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
pub(super) struct Interior {
    intervals: Vec<Interval>,
    /// b - A x - W⁻¹ y.
    missing: Vec<f64>,
    y: Vec<f64>,
    change: Vec<f64>,
    matrix: Symmetric,
}

/// An unknown between its bounds.
#[derive(Debug, Clone, Copy, Default)]
struct Interval {
    x: f64,
    /// Above the lower bound, and below the upper one.
    slack: [f64; 2],
    /// Of these slacks.
    price: [f64; 2],
    /// a·y
    pull: f64,
    /// One over each slack, and how stiff its price makes it.
    inverse: [f64; 2],
    stiffness: [f64; 2],
    /// By how much x yields to a force; 0 for one that is fixed.
    yields: f64,
    /// What moves x at y as it is.
    push: f64,
    /// The step: of x, of a·y and of the prices.
    change: f64,
    pull_change: f64,
    price_change: [f64; 2],
}

impl Interior {
    /// Memory for systems of `rows` rows.
    pub fn new(rows: usize) -> Self {
        let zeros = || vec![0.0; rows];
        Self { intervals: Vec::new(), missing: zeros(), y: zeros(), change: zeros(), matrix: Symmetric::new(rows) }
    }

    /// Improves the unknowns `x` and the multiplier `y` from what they are, and gives the steps that this took. Both stay as they are if it
    /// leads nowhere.
    pub fn solve(&mut self, problem: &Problem<'_>, target: Target, x: &mut [f64], y: &mut [f64]) -> usize {
        self.y.copy_from_slice(y);
        let (mut steps, mut found) = self.search(problem, target, x);
        if !found {
            // From a multiplier that belongs to quite another problem the products may go round in a circle.
            self.forget(problem, x);
            let (more, found_now) = self.search(problem, target, x);
            (steps, found) = (steps + more, found_now);
        }
        if found {
            y.copy_from_slice(&self.y);
            for ((x, interval), unknown) in x.iter_mut().zip(&self.intervals).zip(problem.unknowns) {
                // Slacks stay positive, their sums with the bounds only nearly.
                *x = interval.x.clip(unknown.low, unknown.high);
            }
        }
        steps
    }

    /// Steps from `x` and the present multiplier on; gives how many, and whether the target was met.
    fn search(&mut self, problem: &Problem<'_>, target: Target, x: &[f64]) -> (usize, bool) {
        self.begin(problem, x);
        let scale = problem.scale();
        for steps in 0..STEPS {
            let gap = self.gap(0.0);
            let residual = largest(&self.missing);
            if !gap.is_finite() || !residual.is_finite() {
                return (steps, false);
            }
            if gap <= target.gap && residual <= target.residual * scale {
                return (steps, self.y.iter().all(|value| value.is_finite()));
            }
            self.factor(problem);
            self.step(problem, |_| [0.0; 2]);
            let length = self.length();
            let expected = self.gap(length) / gap;
            let centre = expected * expected * expected * gap;
            self.step(problem, |interval| {
                let [below, above] = interval.price_change;
                [centre - interval.change * below, centre + interval.change * above]
            });
            self.advance(NEARLY * self.length());
        }
        (STEPS, false)
    }

    /// The multiplier that belongs to `x`.
    fn forget(&mut self, problem: &Problem<'_>, x: &[f64]) {
        self.y.copy_from_slice(problem.wanted);
        x.iter().enumerate().for_each(|(index, x)| problem.columns.add_scaled(index, -x, &mut self.y));
        self.matrix.copy_from(problem.inertia);
        self.matrix.factor();
        self.matrix.solve(&mut self.y);
    }

    /// Puts every unknown inside of its bounds, with prices that balance it as far as possible.
    fn begin(&mut self, problem: &Problem<'_>, x: &[f64]) {
        let Problem { inertia, columns, unknowns, wanted } = problem;
        inertia.multiply(&self.y, &mut self.missing);
        self.missing.iter_mut().zip(*wanted).for_each(|(missing, wanted)| *missing = wanted - *missing);
        self.intervals.clear();
        let mut excess = 0.0;
        for (index, (unknown, &x)) in unknowns.iter().zip(x).enumerate() {
            let Unknown { low, high, cost } = *unknown;
            let inset = INSET * (high - low).at_most(1.0);
            let fixed = high - low <= FIXED;
            let x = if fixed { low } else { x.clip(low + inset, high - inset) };
            let slack = if fixed { [1.0; 2] } else { [x - low, high - x] };
            columns.add_scaled(index, -x, &mut self.missing);
            let pull = columns.dot(index, &self.y);
            excess += if fixed { 0.0 } else { (cost * x - pull).abs() * slack[0].at_most(slack[1]) };
            self.intervals.push(Interval { x, slack, pull, yields: if fixed { 0.0 } else { 1.0 }, ..Interval::default() });
        }
        let mean = (excess / unknowns.len().max(1) as f64).at_least(1e-9);
        for (interval, unknown) in self.intervals.iter_mut().zip(*unknowns).filter(|(interval, _)| interval.yields > 0.0) {
            // λ - μ = r x - a·y, and products about the mean.
            let difference = unknown.cost * interval.x - interval.pull;
            let product = mean * mean / (interval.slack[0] * interval.slack[1]);
            let larger = 0.5 * (difference.abs() + (difference * difference + 4.0 * product).sqrt());
            let prices = [larger, product / larger];
            interval.price = if difference > 0.0 { prices } else { [prices[1], prices[0]] };
        }
    }

    /// The mean product of slacks and prices after `length` of the step.
    fn gap(&self, length: f64) -> f64 {
        let mut sum = 0.0;
        for interval in &self.intervals {
            let Interval { slack, price, change, price_change, .. } = interval;
            sum += (slack[0] + length * change) * (price[0] + length * price_change[0]);
            sum += (slack[1] - length * change) * (price[1] + length * price_change[1]);
        }
        sum / (2 * self.intervals.len()).max(1) as f64
    }

    fn factor(&mut self, problem: &Problem<'_>) {
        self.matrix.copy_from(problem.inertia);
        for (index, (interval, unknown)) in self.intervals.iter_mut().zip(problem.unknowns).enumerate() {
            if interval.yields > 0.0 {
                interval.inverse = interval.slack.map(|slack| 1.0 / slack);
                interval.stiffness = [0, 1].map(|side| interval.price[side] * interval.inverse[side]);
                interval.yields = 1.0 / (unknown.cost + interval.stiffness[0] + interval.stiffness[1]);
                problem.columns.add_square(index, interval.yields, &mut self.matrix);
            }
        }
        self.matrix.factor();
    }

    /// Fills the step towards the products that `aim` gives for each pair of slack and price.
    fn step(&mut self, problem: &Problem<'_>, aim: impl Fn(&Interval) -> [f64; 2]) {
        let Problem { columns, unknowns, .. } = problem;
        self.change.copy_from_slice(&self.missing);
        for (index, (interval, unknown)) in self.intervals.iter_mut().zip(*unknowns).enumerate() {
            if interval.yields == 0.0 {
                continue;
            }
            let aim = aim(interval);
            let Interval { x, inverse, price, pull, .. } = *interval;
            let aimed = [aim[0] * inverse[0], aim[1] * inverse[1]];
            interval.price_change = [aimed[0] - price[0], aimed[1] - price[1]];
            // With the prices that the aim asks for, r x - a·y - λ + μ is minus this.
            interval.push = pull - unknown.cost * x + aimed[0] - aimed[1];
            columns.add_scaled(index, -(interval.yields * interval.push), &mut self.change);
        }
        self.matrix.solve(&mut self.change);
        for (index, interval) in self.intervals.iter_mut().enumerate() {
            if interval.yields == 0.0 {
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
    fn length(&self) -> f64 {
        let mut length = 1.0;
        for interval in &self.intervals {
            let Interval { slack, price, change, price_change, .. } = interval;
            let ways = [(slack[0], *change), (slack[1], -change), (price[0], price_change[0]), (price[1], price_change[1])];
            for (value, change) in ways {
                if value + length * change < 0.0 {
                    length = -value / change;
                }
            }
        }
        length
    }

    fn advance(&mut self, length: f64) {
        for interval in self.intervals.iter_mut().filter(|interval| interval.yields > 0.0) {
            let step = length * interval.change;
            interval.x += step;
            interval.slack = [interval.slack[0] + step, interval.slack[1] - step];
            interval.pull += length * interval.pull_change;
            interval.price[0] += length * interval.price_change[0];
            interval.price[1] += length * interval.price_change[1];
        }
        self.y.iter_mut().zip(&self.change).for_each(|(y, change)| *y += length * change);
        // The equation is linear: the full step would leave nothing.
        self.missing.iter_mut().for_each(|missing| *missing *= 1.0 - length);
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest: f64, value| largest.at_least(value.abs()))
}

//! Interval analysis: between which bounds every lane of every node stays, from the ranges of what is measured.
//!
//! Bounds hold for the numbers of the run, rounding included. Sums, products, quotients and roots are rounded correctly, and so
//! never the wrong way: bounds that are computed by the same operation in the same order hold to the bit. What is not (functions
//! of `libm`, filters, motions) is widened outward. They serve lints, explanations and the proof that an index lies in its list,
//! never the run.

use super::operation::{Binary, Chance, Memory, Operation, Reduction, Unary};
use super::{Graph, NodeId};
use crate::extremes::{maximum, minimum};
use crate::frame::Sensor;

/// Bounds of one lane, both included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
}

impl Bounds {
    /// Nothing is known.
    pub const ANY: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
    /// Zero and above.
    pub const POSITIVE: Self = Self { low: 0.0, high: f64::INFINITY };
    /// A condition.
    pub const TRUTH: Self = Self { low: 0.0, high: 1.0 };

    /// Exactly `value`.
    pub fn point(value: f64) -> Self {
        if value.is_nan() { Self::ANY } else { Self { low: value, high: value } }
    }

    /// `low..high`; anything if a bound is no number.
    pub fn new(low: f64, high: f64) -> Self {
        if low.is_nan() || high.is_nan() { Self::ANY } else { Self { low, high } }
    }

    /// The one value, if there is only one.
    pub fn single(self) -> Option<f64> {
        (self.low == self.high).then_some(self.low)
    }

    /// Whether `value` lies within.
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    fn hull(self, other: Self) -> Self {
        Self { low: minimum(self.low, other.low), high: maximum(self.high, other.high) }
    }

    /// With room for an error of `parts` of the larger bound on either side: what is computed in several roundings.
    fn widened(self, parts: f64) -> Self {
        let room = parts * maximum(self.low.abs(), self.high.abs());
        if room.is_finite() { Self { low: self.low - room, high: self.high + room } } else { self }
    }

    /// With room for the errors of a function that is off by less than one unit in the last place, at either bound and within:
    /// two units outward, but not beyond `least` and `most`, which the function keeps to.
    fn outward(self, [least, most]: [f64; 2]) -> Self {
        let (low, high) = (self.low.next_down().next_down(), self.high.next_up().next_up());
        Self { low: maximum(low, minimum(least, self.low)), high: minimum(high, maximum(most, self.high)) }
    }

    fn of_corners(corners: &[f64]) -> Self {
        if corners.iter().any(|corner| corner.is_nan()) {
            return Self::ANY;
        }
        let low = corners.iter().copied().fold(f64::INFINITY, minimum);
        Self { low, high: corners.iter().copied().fold(f64::NEG_INFINITY, maximum) }
    }

    fn monotone(self, f: impl Fn(f64) -> f64) -> Self {
        Self::new(f(self.low), f(self.high))
    }
}

/// Bounds of what is measured, lane by lane.
pub trait Ranges {
    /// Bounds of lane `lane` of `sensor`.
    fn sensor(&self, sensor: Sensor, lane: usize) -> Bounds;
    /// Bounds of the control step number.
    fn step(&self) -> Bounds {
        Bounds::POSITIVE
    }
    /// Bounds of how many steps in a row something may have held.
    fn streak(&self) -> Bounds {
        Bounds::POSITIVE
    }
    /// Whether memories may be taken at their value in the first snapshot, because nothing has happened yet.
    fn at_reset(&self) -> bool {
        false
    }
}

/// Bounds of every lane of every node, by node.
pub fn analyse(graph: &Graph, ranges: &dyn Ranges) -> Vec<Vec<Bounds>> {
    let mut known: Vec<Vec<Bounds>> = Vec::with_capacity(graph.nodes().len());
    for node in graph.nodes() {
        let inputs: Vec<&[Bounds]> = node.inputs.iter().map(|input| known[input.index()].as_slice()).collect();
        let same = node.inputs.first() == node.inputs.get(1);
        let lanes = bounds_of(&node.operation, &inputs, node.width, same, ranges);
        debug_assert_eq!(lanes.len(), node.width, "bounds of every lane of {:?}", node.operation);
        known.push(lanes);
    }
    known
}

/// Bounds of the lanes of a node, from those of its inputs in `known`, which is by node.
pub fn of_node(graph: &Graph, id: NodeId, known: &[Vec<Bounds>], ranges: &dyn Ranges) -> Vec<Bounds> {
    let node = graph.node(id);
    let inputs: Vec<&[Bounds]> = node.inputs.iter().map(|input| known[input.index()].as_slice()).collect();
    let same = node.inputs.first() == node.inputs.get(1);
    bounds_of(&node.operation, &inputs, node.width, same, ranges)
}

/// Bounds of the lanes of one node, looking only at what it needs.
pub fn analyse_for(graph: &Graph, root: NodeId, ranges: &dyn Ranges) -> Vec<Bounds> {
    let mut known: Vec<Vec<Bounds>> = vec![Vec::new(); root.index() + 1];
    for id in graph.reachable([root]) {
        known[id.index()] = of_node(graph, id, &known, ranges);
    }
    known.swap_remove(root.index())
}

/// Bounds of the single lane of a node.
pub fn of_scalar(known: &[Vec<Bounds>], node: NodeId) -> Bounds {
    known[node.index()].iter().copied().reduce(Bounds::hull).unwrap_or(Bounds::ANY)
}

fn bounds_of(operation: &Operation, inputs: &[&[Bounds]], width: usize, same: bool, ranges: &dyn Ranges) -> Vec<Bounds> {
    let lane = |input: usize, index: usize| match inputs[input] {
        [only] => *only,
        lanes => lanes[index],
    };
    let each = |f: &dyn Fn(usize) -> Bounds| (0..width).map(f).collect::<Vec<_>>();
    match operation {
        Operation::Constant(lanes) => lanes.iter().map(|lane| Bounds::point(lane.value())).collect(),
        Operation::Sensors(sensors) => {
            let lanes = sensors.iter().flat_map(|&sensor| (0..sensor.size()).map(move |lane| (sensor, lane)));
            lanes.map(|(sensor, lane)| ranges.sensor(sensor, lane)).collect()
        }
        Operation::Step => vec![ranges.step()],
        Operation::Unary(function) => each(&|index| unary(*function, lane(0, index))),
        Operation::Binary(function) => each(&|index| binary(*function, lane(0, index), lane(1, index), same)),
        Operation::Choose => each(&|index| match lane(0, index).single() {
            Some(condition) => lane(if condition == 0.0 { 2 } else { 1 }, index),
            None => lane(1, index).hull(lane(2, index)),
        }),
        Operation::Select(lanes) => lanes.iter().map(|&from| inputs[0][from as usize]).collect(),
        Operation::Join => inputs.iter().copied().flatten().copied().collect(),
        Operation::Reduce(reduction, group) => {
            inputs[0].chunks_exact(*group as usize).map(|lanes| reduce(*reduction, lanes)).collect()
        }
        Operation::Quaternion => vec![Bounds::TRUTH, Bounds::new(-1.0, 1.0), Bounds::new(-1.0, 1.0), Bounds::new(-1.0, 1.0)],
        Operation::Memory(Memory::Smooth) => each(&|index| smoothed(lane(0, index), lane(1, index))),
        Operation::Memory(Memory::Streak) if !ranges.at_reset() => vec![ranges.streak(); width],
        Operation::Memory(memory) => each(&|index| remembered(*memory, lane(0, index), ranges.at_reset())),
        Operation::StateBefore(_) | Operation::StateAfter(_) => vec![Bounds::ANY; width],
        Operation::Noise(_, Chance::Uniform, _) => vec![Bounds::TRUTH; width],
        Operation::Noise(_, Chance::Normal, _) => vec![Bounds::ANY; width],
        // Whatever is taken was one of the tries.
        Operation::Drawn(_) | Operation::DrawnAfter(_) => inputs[0].to_vec(),
        Operation::Pick(lanes) => {
            let elements = inputs[0].chunks_exact((*lanes as usize).max(1));
            let hull = |lane: usize| elements.clone().map(|element| element[lane]).reduce(Bounds::hull).unwrap_or(Bounds::ANY);
            (0..width).map(hull).collect()
        }
        Operation::PhaseSuccess(_) => vec![Bounds::TRUTH],
        Operation::Follow(track) => match inputs[0][0].single() {
            Some(time) => {
                let mut values = vec![0.0; width];
                track.read(time, &mut values);
                values.into_iter().map(Bounds::point).collect()
            }
            None => {
                let bounds = |[low, high]: [f64; 2]| Bounds::new(low, high).widened(TRACK);
                track.ranges().map(|range| range.map_or(Bounds::ANY, bounds)).collect()
            }
        },
    }
}

/// Errors of a motion between its rows, as parts of its largest value.
const TRACK: f64 = 1e-14;

/// Errors of a filter's step, as parts of its largest value.
const FILTER: f64 = 1e-15;

/// Where a function keeps to nothing.
const ANYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

fn positive(x: Bounds) -> Bounds {
    Bounds { low: maximum(x.low, 0.0), high: maximum(x.high, 0.0) }
}

/// Of both signs without them, or without what is negative.
fn magnitude(x: Bounds, both: bool) -> Bounds {
    if both { unary(Unary::Absolute, x) } else { positive(x) }
}

/// To what a rising function with the values `[lowest, at, highest]` keeps, where its argument lies on one side of `place`.
fn split(x: Bounds, place: f64, [lowest, at, highest]: [f64; 3]) -> [f64; 2] {
    [if x.low >= place { at } else { lowest }, if x.high <= place { at } else { highest }]
}

fn unary(function: Unary, x: Bounds) -> Bounds {
    use std::f64::consts::{FRAC_PI_2, PI};
    let apply = |value| function.apply(value);
    if let Some(value) = x.single() {
        // The very number of the run.
        return Bounds::point(apply(value));
    }
    match function {
        Unary::Negate => Bounds::new(-x.high, -x.low),
        Unary::Absolute if x.contains(0.0) => Bounds::new(0.0, maximum(x.high, -x.low)),
        Unary::Absolute => Bounds::of_corners(&[x.low.abs(), x.high.abs()]),
        // The root of what is negative is no number, which no bound holds.
        Unary::SquareRoot => positive(x).monotone(apply),
        Unary::Floor | Unary::Sign => x.monotone(apply),
        // Each keeps to the side of its value at zero or one.
        Unary::Logarithm => positive(x).monotone(apply).outward(split(x, 1.0, [f64::NEG_INFINITY, 0.0, f64::INFINITY])),
        Unary::Exponential => x.monotone(apply).outward(split(x, 0.0, [0.0, 1.0, f64::INFINITY])),
        Unary::HyperbolicTangent => x.monotone(apply).outward(split(x, 0.0, [-1.0, 0.0, 1.0])),
        Unary::ArcSine => x.monotone(apply).outward(split(x, 0.0, [-FRAC_PI_2, 0.0, FRAC_PI_2])),
        Unary::ArcCosine => Bounds::new(apply(x.high), apply(x.low)).outward([0.0, PI]),
        Unary::Sine | Unary::Cosine => x.single().map_or(Bounds::new(-1.0, 1.0), |value| Bounds::point(apply(value))),
        Unary::Tangent if x.low > -FRAC_PI_2 && x.high < FRAC_PI_2 => x.monotone(apply).outward(ANYWHERE),
        Unary::Tangent => Bounds::ANY,
        Unary::Not if x.single().is_some() => Bounds::point(apply(x.low)),
        Unary::Not if !x.contains(0.0) => Bounds::point(0.0),
        Unary::Not => Bounds::TRUTH,
        Unary::Wrap if x.low > -PI && x.high <= PI => x,
        Unary::Wrap => Bounds::new(-PI, PI),
    }
}

fn binary(function: Binary, a: Bounds, b: Bounds, same: bool) -> Bounds {
    use std::f64::consts::PI;
    // Which zero it is decides what a division by it gives, and an angle.
    let zero = |x: f64, y: f64| y == 0.0 && function == Binary::Divide || x == 0.0 && function == Binary::ArcTangent2;
    if let (Some(x), Some(y)) = (a.single(), b.single())
        && !zero(x, y)
    {
        return Bounds::point(function.apply(x, y));
    }
    match function {
        Binary::Add => Bounds::new(a.low + b.low, a.high + b.high),
        Binary::Subtract if same => Bounds::point(0.0),
        Binary::Subtract => Bounds::new(a.low - b.high, a.high - b.low),
        Binary::Multiply if same => square(a),
        Binary::Multiply => multiply(a, b),
        Binary::Divide if b.contains(0.0) => Bounds::ANY,
        Binary::Divide => divide(a, b),
        Binary::Power => power(a, b),
        Binary::Minimum => Bounds::new(minimum(a.low, b.low), minimum(a.high, b.high)),
        Binary::Maximum => Bounds::new(maximum(a.low, b.low), maximum(a.high, b.high)),
        // Of minus zero it would be -pi.
        Binary::ArcTangent2 if a.low > 0.0 => Bounds::new(0.0, PI),
        Binary::ArcTangent2 => Bounds::new(-PI, PI),
        Binary::Hypotenuse => {
            let (x, y) = (unary(Unary::Absolute, a), unary(Unary::Absolute, b));
            Bounds::new(libm::hypot(x.low, y.low), libm::hypot(x.high, y.high)).outward([0.0, f64::INFINITY])
        }
        // A quotient beyond all numbers leaves no remainder that means anything.
        Binary::Modulo if b.low > 0.0 && (largest(a) / b.low).is_infinite() => Bounds::ANY,
        // Divided by a power of two, nothing is rounded.
        Binary::Modulo if b.single().is_some_and(is_power_of_two) => Bounds::new(0.0, b.high),
        // A quotient that is rounded up to a whole number leaves less than nothing.
        Binary::Modulo if b.low > 0.0 => {
            let room = 2.0 * f64::EPSILON * maximum(a.low.abs(), a.high.abs());
            if room.is_finite() { Bounds::new(-room, b.high + room) } else { Bounds::ANY }
        }
        Binary::Modulo => Bounds::ANY,
        Binary::Less => decided(a.high < b.low, a.low >= b.high),
        Binary::LessEqual => decided(a.high <= b.low, a.low > b.high),
        Binary::Equal => decided(false, a.high < b.low || a.low > b.high),
        Binary::And => decided(never_zero(a) && never_zero(b), a.single() == Some(0.0) || b.single() == Some(0.0)),
        Binary::Or => decided(never_zero(a) || never_zero(b), a.single() == Some(0.0) && b.single() == Some(0.0)),
    }
}

/// The largest size of a finite number within bounds.
fn largest(x: Bounds) -> f64 {
    minimum(maximum(x.low.abs(), x.high.abs()), f64::MAX)
}

fn is_power_of_two(value: f64) -> bool {
    value.is_normal() && value > 0.0 && value.to_bits().trailing_zeros() >= f64::MANTISSA_DIGITS - 1
}

fn never_zero(x: Bounds) -> bool {
    !x.contains(0.0)
}

fn decided(always: bool, never: bool) -> Bounds {
    match (always, never) {
        (true, _) => Bounds::point(1.0),
        (_, true) => Bounds::point(0.0),
        _ => Bounds::TRUTH,
    }
}

fn square(x: Bounds) -> Bounds {
    let magnitude = unary(Unary::Absolute, x);
    Bounds::new(magnitude.low * magnitude.low, magnitude.high * magnitude.high)
}

/// Of a quotient whose divisor is never zero; infinity by infinity is taken for what it is in the run, no number.
fn divide(a: Bounds, b: Bounds) -> Bounds {
    let quotient = |x: f64, y: f64| if y.is_infinite() { 0.0 } else { x / y };
    Bounds::of_corners(&[quotient(a.low, b.low), quotient(a.low, b.high), quotient(a.high, b.low), quotient(a.high, b.high)])
}

fn multiply(a: Bounds, b: Bounds) -> Bounds {
    // In interval arithmetic zero times unbounded is zero: the unbounded side is always finite.
    let product = |x: f64, y: f64| if x == 0.0 || y == 0.0 { 0.0 } else { x * y };
    Bounds::of_corners(&[product(a.low, b.low), product(a.low, b.high), product(a.high, b.low), product(a.high, b.high)])
}

fn power(base: Bounds, exponent: Bounds) -> Bounds {
    let Some(exponent) = exponent.single() else { return Bounds::ANY };
    let apply = |value: f64| Binary::Power.apply(value, exponent);
    let (whole, even) = (exponent.fract() == 0.0, exponent % 2.0 == 0.0);
    // The power of what is negative is no number but for whole exponents, and infinite of minus infinity.
    let base = if even || !whole && base.low > f64::NEG_INFINITY { magnitude(base, even) } else { base };
    let odd = whole && !even;
    if exponent > 0.0 && (odd || base.low >= 0.0) {
        let least = if base.low >= 0.0 { split(base, 1.0, [0.0, 1.0, f64::INFINITY]) } else { ANYWHERE };
        return base.monotone(apply).outward(least);
    }
    if exponent < 0.0 && base.low > 0.0 {
        return Bounds::new(apply(base.high), apply(base.low)).outward([0.0, f64::INFINITY]);
    }
    Bounds::ANY
}

fn reduce(reduction: Reduction, lanes: &[Bounds]) -> Bounds {
    let fold = |function: Binary| lanes.iter().copied().reduce(|a, b| binary(function, a, b, false)).unwrap_or(Bounds::ANY);
    // In the very order of the run, which sums long lists in columns.
    let ends = |lanes: &mut dyn Iterator<Item = Bounds>| {
        let (lows, highs): (Vec<f64>, Vec<f64>) = lanes.map(|lane| (lane.low, lane.high)).unzip();
        Bounds::new(reduction.apply(&lows), reduction.apply(&highs))
    };
    match reduction {
        Reduction::Sum => ends(&mut lanes.iter().copied()),
        Reduction::Norm => ends(&mut lanes.iter().map(|&lane| unary(Unary::Absolute, lane))),
        Reduction::Product => fold(Binary::Multiply),
        Reduction::Minimum => fold(Binary::Minimum),
        Reduction::Maximum => fold(Binary::Maximum),
        Reduction::ArgMinimum | Reduction::ArgMaximum => Bounds::new(0.0, lanes.len().saturating_sub(1) as f64),
    }
}

/// A filter moves by a part of the way, which is rounded: it may pass what it moves towards by as much, but nothing on the other
/// side of zero unless the part is the whole.
fn smoothed(x: Bounds, share: Bounds) -> Bounds {
    if x.single().is_some() {
        return x;
    }
    let wide = x.widened(FILTER);
    if share.high > 1.0 - 4.0 * f64::EPSILON {
        return wide;
    }
    Bounds {
        low: if x.low >= 0.0 { maximum(wide.low, 0.0) } else { wide.low },
        high: if x.high <= 0.0 { minimum(wide.high, 0.0) } else { wide.high },
    }
}

fn remembered(memory: Memory, x: Bounds, at_reset: bool) -> Bounds {
    match memory {
        Memory::Initial | Memory::Highest | Memory::Lowest | Memory::Sampled | Memory::Delay(_) => x,
        Memory::Smooth => smoothed(x, Bounds::TRUTH),
        Memory::SmoothAngle => Bounds::new(-std::f64::consts::PI, std::f64::consts::PI),
        Memory::Accumulate | Memory::Streak if at_reset => Bounds::point(0.0),
        Memory::Accumulate if x.low >= 0.0 => Bounds::POSITIVE,
        Memory::Accumulate => Bounds::ANY,
        Memory::Streak | Memory::StepsSince => Bounds::POSITIVE,
        Memory::Hysteresis => Bounds::TRUTH,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    struct Height(Bounds);

    impl Ranges for Height {
        fn sensor(&self, _: Sensor, _: usize) -> Bounds {
            self.0
        }
    }

    fn bounds(range: Bounds, formula: impl Fn(&mut Graph, NodeId) -> NodeId) -> Bounds {
        let mut graph = Graph::default();
        let x = graph.sensors(vec![Sensor::Time]);
        let node = formula(&mut graph, x);
        of_scalar(&analyse(&graph, &Height(range)), node)
    }

    #[test]
    fn an_exponential_of_a_cost_stays_between_zero_and_one() {
        let found = bounds(Bounds::ANY, |graph, x| {
            let size = graph.unary(Unary::Absolute, x);
            let cost = graph.unary(Unary::Negate, size);
            graph.unary(Unary::Exponential, cost)
        });
        assert_eq!(found, Bounds::TRUTH);
    }

    #[test]
    fn a_comparison_beyond_the_range_is_decided() {
        let beyond = |graph: &mut Graph, x| {
            let limit = graph.constant(3.0);
            graph.binary(Binary::Less, x, limit)
        };
        assert_eq!(bounds(Bounds::new(0.0, 2.0), beyond), Bounds::point(1.0));
        assert_eq!(bounds(Bounds::new(3.0, 4.0), beyond), Bounds::point(0.0));
        assert_eq!(bounds(Bounds::new(2.0, 4.0), beyond), Bounds::TRUTH);
    }

    #[test]
    fn a_difference_of_identical_operands_is_zero() {
        assert_eq!(bounds(Bounds::ANY, |graph, x| graph.binary(Binary::Subtract, x, x)), Bounds::point(0.0));
        assert_eq!(bounds(Bounds::new(-3.0, 2.0), |graph, x| graph.binary(Binary::Multiply, x, x)), Bounds::new(0.0, 9.0));
    }

    #[test]
    fn a_quotient_reaches_its_divisor() {
        // Counting to 49 and dividing by it: the reciprocal of 49, rounded, would stay below 1.
        let held = bounds(Bounds::new(0.0, 49.0), |graph, x| {
            let (steps, one) = (graph.constant(49.0), graph.constant(1.0));
            let share = graph.binary(Binary::Divide, x, steps);
            graph.binary(Binary::LessEqual, one, share)
        });
        assert_eq!(held, Bounds::TRUTH);
    }

    /// Numbers of all sizes, and those at which functions turn.
    fn numbers() -> impl Strategy<Value = f64> {
        let special =
            vec![0.0, -0.0, 1.0, -1.0, 0.5, 2.0, 49.0, 1e-300, 1e300, std::f64::consts::PI, -std::f64::consts::FRAC_PI_2];
        prop_oneof![
            prop::sample::select(special),
            -3.0_f64..3.0,
            -1e6_f64..1e6,
            any::<f64>().prop_filter("finite", |x| x.is_finite())
        ]
    }

    /// Bounds and numbers within them.
    fn within() -> impl Strategy<Value = (Bounds, f64)> {
        (numbers(), numbers(), numbers(), 0..3_u8).prop_map(|(a, b, c, narrow)| {
            let mut sorted = [a, b, c];
            sorted.sort_by(f64::total_cmp);
            match narrow {
                0 => (Bounds::point(a), a),
                1 => (Bounds::new(f64::NEG_INFINITY, sorted[2]), sorted[1]),
                _ => (Bounds::new(sorted[0], sorted[2]), sorted[1]),
            }
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]

        #[test]
        fn every_result_lies_within_its_bounds(x in within(), y in within(), more in prop::collection::vec(within(), 1..20)) {
            let holds = |operation: Operation, given: &[&[(Bounds, f64)]]| {
                let (bounds, values): (Vec<Vec<Bounds>>, Vec<Vec<f64>>) =
                    given.iter().map(|lanes| lanes.iter().copied().unzip()).unzip();
                let bounds: Vec<&[Bounds]> = bounds.iter().map(Vec::as_slice).collect();
                let values: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
                let found = bounds_of(&operation, &bounds, 1, false, &Height(Bounds::ANY))[0];
                let mut result = [0.0];
                crate::graph::fold::evaluate(&operation, &values, &mut result);
                // What is no number has no place among others.
                prop_assert!(
                    result[0].is_nan() || found.contains(result[0]),
                    "{operation:?} of {given:?} is {:e}, not within {:e} .. {:e}", result[0], found.low, found.high
                );
                Ok(())
            };
            for &function in Unary::ALL {
                holds(Operation::Unary(function), &[&[x]])?;
            }
            for &function in Binary::ALL {
                holds(Operation::Binary(function), &[&[x], &[y]])?;
            }
            for &reduction in Reduction::ALL {
                holds(Operation::Reduce(reduction, more.len() as u32), &[&more])?;
            }
            holds(Operation::Choose, &[&[x], &[y], &[more[0]]])?;
        }
    }
}

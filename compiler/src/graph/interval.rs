//! Interval analysis: between which bounds every lane of every node stays, from the ranges of what is measured.
//!
//! Bounds are those of exact arithmetic; they serve lints and explanations, never the run.

use super::operation::{Binary, Chance, Memory, Operation, Reduction, Unary};
use super::{Graph, NodeId};
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
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn of_corners(corners: &[f64]) -> Self {
        if corners.iter().any(|corner| corner.is_nan()) {
            return Self::ANY;
        }
        let low = corners.iter().copied().fold(f64::INFINITY, f64::min);
        Self { low, high: corners.iter().copied().fold(f64::NEG_INFINITY, f64::max) }
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
        known.push(lanes);
    }
    known
}

/// Bounds of the lanes of a node, from those of its inputs in `known`, which is by node.
pub(crate) fn of_node(graph: &Graph, id: NodeId, known: &[Vec<Bounds>], ranges: &dyn Ranges) -> Vec<Bounds> {
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
            None => track.ranges().map(|range| range.map_or(Bounds::ANY, |[low, high]| Bounds::new(low, high))).collect(),
        },
    }
}

fn unary(function: Unary, x: Bounds) -> Bounds {
    use std::f64::consts::{FRAC_PI_2, PI};
    let apply = |value| function.apply(value);
    match function {
        Unary::Negate => Bounds::new(-x.high, -x.low),
        Unary::Absolute if x.contains(0.0) => Bounds::new(0.0, x.high.max(-x.low)),
        Unary::Absolute => Bounds::of_corners(&[x.low.abs(), x.high.abs()]),
        Unary::SquareRoot => Bounds::new(x.low.max(0.0), x.high.max(0.0)).monotone(apply),
        Unary::Logarithm => Bounds::new(x.low.max(0.0), x.high.max(0.0)).monotone(apply),
        Unary::Exponential | Unary::HyperbolicTangent | Unary::Floor | Unary::Sign => x.monotone(apply),
        Unary::ArcSine => x.monotone(apply),
        Unary::ArcCosine => Bounds::new(apply(x.high), apply(x.low)),
        Unary::Sine | Unary::Cosine => x.single().map_or(Bounds::new(-1.0, 1.0), |value| Bounds::point(apply(value))),
        Unary::Tangent if x.low > -FRAC_PI_2 && x.high < FRAC_PI_2 => x.monotone(apply),
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
    if let (Some(x), Some(y)) = (a.single(), b.single()) {
        return Bounds::point(function.apply(x, y));
    }
    match function {
        Binary::Add => Bounds::new(a.low + b.low, a.high + b.high),
        Binary::Subtract if same => Bounds::point(0.0),
        Binary::Subtract => Bounds::new(a.low - b.high, a.high - b.low),
        Binary::Multiply if same => square(a),
        Binary::Multiply => multiply(a, b),
        Binary::Divide if b.contains(0.0) => Bounds::ANY,
        Binary::Divide => multiply(a, Bounds::new(1.0 / b.high, 1.0 / b.low)),
        Binary::Power => power(a, b),
        Binary::Minimum => Bounds::new(a.low.min(b.low), a.high.min(b.high)),
        Binary::Maximum => Bounds::new(a.low.max(b.low), a.high.max(b.high)),
        Binary::ArcTangent2 if a.low >= 0.0 => Bounds::new(0.0, PI),
        Binary::ArcTangent2 => Bounds::new(-PI, PI),
        Binary::Hypotenuse => {
            let (x, y) = (unary(Unary::Absolute, a), unary(Unary::Absolute, b));
            Bounds::new(libm::hypot(x.low, y.low), libm::hypot(x.high, y.high))
        }
        Binary::Modulo if b.low > 0.0 => Bounds::new(0.0, b.high),
        Binary::Modulo => Bounds::ANY,
        Binary::Less => decided(a.high < b.low, a.low >= b.high),
        Binary::LessEqual => decided(a.high <= b.low, a.low > b.high),
        Binary::Equal => decided(false, a.high < b.low || a.low > b.high),
        Binary::And => decided(never_zero(a) && never_zero(b), a.single() == Some(0.0) || b.single() == Some(0.0)),
        Binary::Or => decided(never_zero(a) || never_zero(b), a.single() == Some(0.0) && b.single() == Some(0.0)),
    }
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

fn multiply(a: Bounds, b: Bounds) -> Bounds {
    // In interval arithmetic zero times unbounded is zero: the unbounded side is always finite.
    let product = |x: f64, y: f64| if x == 0.0 || y == 0.0 { 0.0 } else { x * y };
    Bounds::of_corners(&[product(a.low, b.low), product(a.low, b.high), product(a.high, b.low), product(a.high, b.high)])
}

fn power(base: Bounds, exponent: Bounds) -> Bounds {
    let Some(exponent) = exponent.single() else { return Bounds::ANY };
    let apply = |value: f64| Binary::Power.apply(value, exponent);
    let even = exponent % 2.0 == 0.0;
    if exponent > 0.0 && even {
        return unary(Unary::Absolute, base).monotone(apply);
    }
    if exponent > 0.0 && (exponent % 2.0 == 1.0 || base.low >= 0.0) {
        return base.monotone(apply);
    }
    if exponent < 0.0 && base.low > 0.0 {
        return Bounds::new(apply(base.high), apply(base.low));
    }
    Bounds::ANY
}

fn reduce(reduction: Reduction, lanes: &[Bounds]) -> Bounds {
    let fold = |function: Binary| lanes.iter().copied().reduce(|a, b| binary(function, a, b, false)).unwrap_or(Bounds::ANY);
    match reduction {
        Reduction::Sum => fold(Binary::Add),
        Reduction::Product => fold(Binary::Multiply),
        Reduction::Minimum => fold(Binary::Minimum),
        Reduction::Maximum => fold(Binary::Maximum),
        Reduction::Norm => {
            let sum = lanes.iter().map(|&lane| square(lane)).reduce(|a, b| binary(Binary::Add, a, b, false));
            unary(Unary::SquareRoot, sum.unwrap_or(Bounds::ANY))
        }
        Reduction::ArgMinimum | Reduction::ArgMaximum => Bounds::new(0.0, lanes.len().saturating_sub(1) as f64),
    }
}

fn remembered(memory: Memory, x: Bounds, at_reset: bool) -> Bounds {
    match memory {
        Memory::Initial | Memory::Highest | Memory::Lowest | Memory::Smooth | Memory::Sampled | Memory::Delay(_) => x,
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
}

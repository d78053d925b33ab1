//! Which way a formula goes when some of what it reads grows: by the signs of ranges, without computing any value.

use crate::frame::Sensor;
use crate::graph::interval::{self, Bounds};
use crate::graph::operation::{Binary, Memory, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use std::collections::BTreeMap;

/// How a value answers to growth of what is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trend {
    /// Not at all.
    Unmoved,
    /// It grows, or stays.
    Rising,
    /// It falls, or stays.
    Falling,
    /// Both, or unknown.
    Unclear,
}

impl Trend {
    fn reversed(self) -> Self {
        match self {
            Self::Rising => Self::Falling,
            Self::Falling => Self::Rising,
            other => other,
        }
    }

    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unmoved, trend) | (trend, Self::Unmoved) => trend,
            (a, b) if a == b => a,
            _ => Self::Unclear,
        }
    }

    /// Multiplied by something within `factor`.
    fn times(self, factor: Bounds) -> Self {
        match self {
            Self::Unmoved => Self::Unmoved,
            trend if factor.low >= 0.0 => trend,
            trend if factor.high <= 0.0 => trend.reversed(),
            _ => Self::Unclear,
        }
    }
}

/// How a value answers to growth of the sensors that `grows` takes. `bounds` are those of every node.
pub(super) fn of(graph: &Graph, bounds: &[Vec<Bounds>], root: NodeId, grows: impl Fn(Sensor) -> bool) -> Trend {
    let mut known: BTreeMap<NodeId, Trend> = BTreeMap::new();
    for id in graph.reachable([root]) {
        let node = graph.node(id);
        let trend = |input: usize| node.inputs.get(input).and_then(|id| known.get(id)).copied().unwrap_or(Trend::Unmoved);
        let range = |input: usize| node.inputs.get(input).map_or(Bounds::ANY, |id| interval::of_scalar(bounds, *id));
        let all = || (0..node.inputs.len()).map(trend).fold(Trend::Unmoved, Trend::with);
        let found = match &node.operation {
            Operation::Sensors(sensors) if sensors.iter().all(|sensor| grows(*sensor)) => Trend::Rising,
            Operation::Sensors(sensors) if sensors.iter().any(|sensor| grows(*sensor)) => Trend::Unclear,
            _ if all() == Trend::Unmoved => Trend::Unmoved,
            Operation::Select(_) | Operation::Join => all(),
            Operation::Unary(function) => of_unary(*function, trend(0), range(0)),
            Operation::Binary(function) => match function {
                Binary::Add | Binary::Minimum | Binary::Maximum | Binary::And | Binary::Or => all(),
                Binary::Subtract | Binary::LessEqual | Binary::Less => {
                    let rising = trend(0).with(trend(1).reversed());
                    if *function == Binary::Subtract { rising } else { rising.reversed() }
                }
                Binary::Multiply => trend(0).times(range(1)).with(trend(1).times(range(0))),
                Binary::Divide if trend(1) == Trend::Unmoved => trend(0).times(range(1)),
                Binary::Power if trend(1) == Trend::Unmoved && range(0).low >= 0.0 => trend(0).times(range(1)),
                Binary::Hypotenuse if range(0).low >= 0.0 && range(1).low >= 0.0 => all(),
                _ => Trend::Unclear,
            },
            Operation::Reduce(Reduction::Sum | Reduction::Minimum | Reduction::Maximum, _) => trend(0),
            Operation::Reduce(Reduction::Norm | Reduction::Product, _) => trend(0).times(range(0)),
            Operation::Memory(Memory::Highest | Memory::Lowest | Memory::Delay(_) | Memory::Smooth | Memory::Accumulate) => all(),
            Operation::Choose if trend(0) == Trend::Unmoved => trend(1).with(trend(2)),
            _ => Trend::Unclear,
        };
        known.insert(id, found);
    }
    known.get(&root).copied().unwrap_or(Trend::Unmoved)
}

fn of_unary(function: Unary, trend: Trend, range: Bounds) -> Trend {
    match function {
        Unary::Negate | Unary::ArcCosine | Unary::Not => trend.reversed(),
        Unary::Absolute => trend.times(range),
        Unary::SquareRoot
        | Unary::Exponential
        | Unary::Logarithm
        | Unary::HyperbolicTangent
        | Unary::ArcSine
        | Unary::Floor
        | Unary::Sign => trend,
        Unary::Sine | Unary::Cosine | Unary::Tangent | Unary::Wrap => Trend::Unclear,
    }
}

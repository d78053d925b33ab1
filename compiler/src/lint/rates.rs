//! Velocities with their sign: numbers that are proportional to how fast something moves one way, and fall below zero as it
//! moves back.

use super::summands::is_change;
use crate::extremes::{maximum, minimum};
use crate::frame::Sensor;
use crate::graph::interval::{self, Bounds};
use crate::graph::operation::{Binary, Memory, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use crate::vocabulary::{JointKind, Vocabulary};
use std::collections::BTreeMap;

/// A number that is proportional to a velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rate {
    /// By how much it grows with the velocity: for each m/s, or rad/s where `turns` is set.
    pub per: f64,
    /// Whether the velocity is that of an angle.
    pub turns: bool,
}

/// What a node has to do with velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Known {
    /// It reads none.
    Still,
    Rate(Rate),
    Other,
}

/// Nodes below a root that are velocities with their sign. `bounds` are those of every node, `interval` is the control step.
pub(super) fn below(
    graph: &Graph,
    vocabulary: &Vocabulary,
    bounds: &[Vec<Bounds>],
    interval: f64,
    root: NodeId,
) -> BTreeMap<NodeId, Rate> {
    let mut known: BTreeMap<NodeId, Known> = BTreeMap::new();
    for id in graph.reachable([root]) {
        let node = graph.node(id);
        let of = |input: usize| node.inputs.get(input).and_then(|id| known.get(id)).copied().unwrap_or(Known::Still);
        let all = || (0..node.inputs.len()).map(of);
        let zero =
            |input: usize| graph.constant_lanes(node.inputs[input]).is_some_and(|lanes| lanes.iter().all(|lane| *lane == 0.0));
        // Each is a velocity, or nothing at all.
        let together = || {
            let rates = (0..node.inputs.len()).filter(|input| !zero(*input)).map(of);
            rates.reduce(|a, b| match (a, b) {
                (Known::Rate(a), Known::Rate(b)) if a.turns == b.turns => {
                    Known::Rate(Rate { per: maximum(a.per, b.per), turns: a.turns })
                }
                (Known::Still, Known::Still) => Known::Still,
                _ => Known::Other,
            })
        };
        let found = match &node.operation {
            Operation::Sensors(sensors) => measured(vocabulary, sensors),
            Operation::Binary(Binary::Subtract) if is_change(graph, node.inputs[0], node.inputs[1]) => {
                change(graph, vocabulary, node.inputs[0])
                    .map_or(Known::Other, |rate| Known::Rate(Rate { per: rate.per * interval, ..rate }))
            }
            _ if all().all(|input| input == Known::Still) => Known::Still,
            Operation::Unary(Unary::Negate | Unary::Wrap)
            | Operation::Select(_)
            | Operation::Join
            | Operation::Binary(Binary::Add | Binary::Subtract)
            | Operation::Reduce(Reduction::Sum, _) => together().unwrap_or(Known::Still),
            Operation::Memory(Memory::Smooth | Memory::Delay(_)) => of(0),
            Operation::Choose => match [1, 2].map(|branch| if zero(branch) { Known::Still } else { of(branch) }) {
                [Known::Rate(rate), Known::Still] if zero(2) => Known::Rate(rate),
                [Known::Still, Known::Rate(rate)] if zero(1) => Known::Rate(rate),
                [Known::Rate(a), Known::Rate(b)] if a.turns == b.turns => {
                    Known::Rate(Rate { per: maximum(a.per, b.per), turns: a.turns })
                }
                _ => Known::Other,
            },
            Operation::Binary(Binary::Multiply) => match (of(0), of(1)) {
                (Known::Rate(rate), Known::Still) => times(rate, size(graph, bounds, node.inputs[1], 0)),
                (Known::Still, Known::Rate(rate)) => times(rate, size(graph, bounds, node.inputs[0], 0)),
                _ => Known::Other,
            },
            Operation::Binary(Binary::Divide) => match (of(0), graph.constant_value(node.inputs[1])) {
                (Known::Rate(rate), Some(by)) if by != 0.0 => times(rate, Some(1.0 / by.abs())),
                _ => Known::Other,
            },
            _ => Known::Other,
        };
        known.insert(id, found);
    }
    let rates = known.into_iter().filter_map(|(id, known)| match known {
        Known::Rate(rate) => Some((id, rate)),
        _ => None,
    });
    rates.collect()
}

fn times(rate: Rate, by: Option<f64>) -> Known {
    by.filter(|by| *by > 0.0 && by.is_finite()).map_or(Known::Other, |by| Known::Rate(Rate { per: rate.per * by, ..rate }))
}

fn measured(vocabulary: &Vocabulary, sensors: &[Sensor]) -> Known {
    let turns = |sensor: &Sensor| match *sensor {
        Sensor::LandmarkVelocity(_) | Sensor::ComVelocity | Sensor::RootVelocity => Some(Some(false)),
        Sensor::JointVelocity(joint) => Some(vocabulary.joints.get(joint).map(|joint| joint.kind == JointKind::Hinge)),
        _ => None,
    };
    let found: Vec<Option<Option<bool>>> = sensors.iter().map(turns).collect();
    match found.as_slice() {
        [Some(Some(first)), rest @ ..] if rest.iter().all(|other| *other == Some(Some(*first))) => {
            Known::Rate(Rate { per: 1.0, turns: *first })
        }
        found if found.iter().all(Option::is_none) => Known::Still,
        _ => Known::Other,
    }
}

/// How large a factor becomes: by its bounds, or as a component of a direction.
fn size(graph: &Graph, bounds: &[Vec<Bounds>], node: NodeId, depth: usize) -> Option<f64> {
    let known = interval::of_scalar(bounds, node);
    let most = maximum(known.low.abs(), known.high.abs());
    if most.is_finite() {
        return Some(most);
    }
    let inner = graph.node(node);
    match inner.operation {
        _ if depth > 16 => None,
        Operation::Select(_) | Operation::Unary(Unary::Negate) => size(graph, bounds, inner.inputs[0], depth + 1),
        Operation::Join => {
            let sizes = inner.inputs.iter().map(|part| size(graph, bounds, *part, depth + 1));
            sizes.reduce(|a, b| Some(maximum(a?, b?))).flatten()
        }
        Operation::Binary(Binary::Divide) if is_length(graph, inner.inputs[1]) => Some(1.0),
        _ => None,
    }
}

/// The length by which `normalize` divides.
fn is_length(graph: &Graph, divisor: NodeId) -> bool {
    let node = graph.node(divisor);
    match node.operation {
        Operation::Select(_) => is_length(graph, node.inputs[0]),
        Operation::Choose => node.inputs.last().is_some_and(|length| is_length(graph, *length)),
        Operation::Reduce(Reduction::Norm, _) => true,
        _ => false,
    }
}

/// What `rate` is taken of: a coordinate or a distance, by which factor. What only ever grows is no velocity with a sign.
fn change(graph: &Graph, vocabulary: &Vocabulary, of: NodeId) -> Option<Rate> {
    let (mut node, mut per) = (of, 1.0);
    loop {
        let known = graph.node(node);
        let constant = |input: usize| known.inputs.get(input).and_then(|id| graph.constant_value(*id));
        let offset = |input: usize| known.inputs.get(input).is_some_and(|id| graph.constant_lanes(*id).is_some());
        match &known.operation {
            Operation::Unary(Unary::Negate) | Operation::Select(_) => node = known.inputs[0],
            Operation::Binary(Binary::Add | Binary::Subtract) if offset(1) => node = known.inputs[0],
            Operation::Binary(Binary::Add | Binary::Subtract) if offset(0) => node = known.inputs[1],
            Operation::Binary(Binary::Divide) if constant(1).is_some_and(|by| by != 0.0) => {
                per /= constant(1)?.abs();
                node = known.inputs[0];
            }
            Operation::Binary(Binary::Multiply) if constant(1).is_some() => {
                per *= constant(1)?.abs();
                node = known.inputs[0];
            }
            Operation::Binary(Binary::Multiply) if constant(0).is_some() => {
                per *= constant(0)?.abs();
                node = known.inputs[1];
            }
            Operation::Reduce(Reduction::Norm, _) => return Some(Rate { per, turns: false }).filter(|_| placed(graph, node)),
            Operation::Sensors(sensors) => {
                let hinge = |joint: usize| vocabulary.joints.get(joint).is_some_and(|joint| joint.kind == JointKind::Hinge);
                return match sensors.first()? {
                    Sensor::LandmarkPosition(_) | Sensor::ComPosition | Sensor::RootPosition => Some(Rate { per, turns: false }),
                    Sensor::JointPosition(joint) => Some(Rate { per, turns: hinge(*joint) }),
                    _ => None,
                };
            }
            _ => return None,
        }
    }
}

/// Whether a node reads where something is.
fn placed(graph: &Graph, node: NodeId) -> bool {
    graph.reachable([node]).iter().any(|id| match &graph.node(*id).operation {
        Operation::Sensors(sensors) => sensors
            .iter()
            .any(|sensor| matches!(sensor, Sensor::LandmarkPosition(_) | Sensor::ComPosition | Sensor::RootPosition)),
        _ => false,
    })
}

/// The speeds at which a bound of a velocity stands, m/s or rad/s, lowest first.
pub(super) fn speeds(rate: Rate, bounds: [f64; 2]) -> [f64; 2] {
    let [low, high] = bounds.map(|bound| bound / rate.per);
    [minimum(low, high), maximum(low, high)]
}

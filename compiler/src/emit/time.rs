//! Time, clocks, and how an episode ends.

use crate::graph::operation::{Binary, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};

/// Control steps since reset, or since the present phase of a sequence began.
pub(crate) fn step(graph: &mut Graph) -> NodeId {
    graph.add(Operation::Step, &[])
}

/// The same in seconds.
pub(crate) fn time(graph: &mut Graph, interval: f64) -> NodeId {
    let (step, interval) = (step(graph), graph.constant(interval));
    graph.binary(Binary::Multiply, step, interval)
}

/// A clock of this frequency: 2 pi f t in (-pi, pi].
pub(crate) fn clock(graph: &mut Graph, frequency: NodeId, interval: f64) -> NodeId {
    let time = time(graph, interval);
    let turns = graph.binary(Binary::Multiply, frequency, time);
    let turn = graph.constant(std::f64::consts::TAU);
    let angle = graph.binary(Binary::Multiply, turn, turns);
    graph.unary(Unary::Wrap, angle)
}

/// Whether a condition holds, after so many control steps.
pub(crate) fn after(graph: &mut Graph, grace: f64, condition: NodeId) -> NodeId {
    let (step, grace) = (step(graph), graph.constant(grace));
    let past = graph.binary(Binary::Less, grace, step);
    graph.binary(Binary::And, past, condition)
}

/// Whether one of these conditions holds.
pub(crate) fn any(graph: &mut Graph, conditions: &[NodeId]) -> NodeId {
    if conditions.is_empty() {
        return graph.constant(0.0);
    }
    let joined = graph.join(conditions);
    graph.reduce(Reduction::Maximum, conditions.len(), joined)
}

/// Whether the horizon has come.
pub(crate) fn complete(graph: &mut Graph, horizon: u32) -> NodeId {
    let (step, horizon) = (step(graph), graph.constant(f64::from(horizon)));
    graph.binary(Binary::LessEqual, horizon, step)
}

/// Whether the horizon has come and nothing else has ended the episode.
pub(crate) fn complete_without(graph: &mut Graph, horizon: u32, ends: NodeId) -> NodeId {
    let complete = complete(graph, horizon);
    let none = graph.unary(Unary::Not, ends);
    graph.binary(Binary::And, complete, none)
}

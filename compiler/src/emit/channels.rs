//! What lies between a value and what a policy sees of it.

use crate::graph::operation::Binary;
use crate::graph::{Graph, NodeId};

/// The value in units of another.
pub(crate) fn scaled(graph: &mut Graph, value: NodeId, unit: f64) -> NodeId {
    let unit = graph.constant(unit);
    graph.binary(Binary::Divide, value, unit)
}

/// The value kept within bounds.
pub(crate) fn clipped(graph: &mut Graph, value: NodeId, [low, high]: [f64; 2]) -> NodeId {
    let [low, high] = [low, high].map(|bound| graph.constant(bound));
    let raised = graph.binary(Binary::Maximum, value, low);
    graph.binary(Binary::Minimum, raised, high)
}

//! Vectors and places expressed along the axes of a frame.

use super::vectors::unit_vector;
use crate::graph::operation::{Binary, Reduction, Unary};
use crate::graph::{Graph, NodeId};

/// `count` places relative to an origin.
pub(crate) fn from_origin(graph: &mut Graph, places: NodeId, count: usize, origin: NodeId) -> NodeId {
    let repeated = graph.select((0..count).flat_map(|_| 0..3), origin);
    graph.binary(Binary::Subtract, places, repeated)
}

/// World components of `count` vectors as components along axes, nine lanes.
pub(crate) fn along_axes(graph: &mut Graph, vectors: NodeId, count: usize, axes: NodeId) -> NodeId {
    // Component i of vector k is dot(vector k, axis i): three products each, nine per vector.
    let repeated = graph.select((0..count).flat_map(|place| (0..9).map(move |lane| 3 * place + lane % 3)), vectors);
    let tiled = graph.select((0..count).flat_map(|_| 0..9), axes);
    let products = graph.binary(Binary::Multiply, repeated, tiled);
    graph.reduce(Reduction::Sum, 3, products)
}

/// Axes of the yaw of these axes: forward and left level, up the world's.
pub(crate) fn heading(graph: &mut Graph, axes: NodeId) -> NodeId {
    let level = graph.select([0, 1], axes);
    let ahead = unit_vector(graph, level, 2);
    let (x, y) = (graph.select([0], ahead), graph.select([1], ahead));
    let minus_y = graph.unary(Unary::Negate, y);
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    graph.join(&[x, y, zero, minus_y, x, zero, zero, zero, one])
}

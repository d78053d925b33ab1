//! What is read of places, velocities and axes.

use crate::graph::operation::{Binary, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};

/// Lanes of each of `count` elements of `size` lanes.
pub(crate) fn components(graph: &mut Graph, node: NodeId, count: usize, size: usize, lanes: &[usize]) -> NodeId {
    graph.select((0..count).flat_map(|place| lanes.iter().map(move |lane| size * place + lane)), node)
}

/// The yaws of `count` orientations. Turned by yaw y, then pitch p, then roll r, forward is (cos y cos p, sin y cos p, -sin p).
pub(crate) fn yaw(graph: &mut Graph, axes: NodeId, count: usize) -> NodeId {
    let [y, x] = [1, 0].map(|lane| components(graph, axes, count, 9, &[lane]));
    graph.binary(Binary::ArcTangent2, y, x)
}

/// Their pitches.
pub(crate) fn pitch(graph: &mut Graph, axes: NodeId, count: usize) -> NodeId {
    let [x, y, z] = [0, 1, 2].map(|lane| components(graph, axes, count, 9, &[lane]));
    let level = graph.binary(Binary::Hypotenuse, x, y);
    let down = graph.unary(Unary::Negate, z);
    graph.binary(Binary::ArcTangent2, down, level)
}

/// Their rolls.
pub(crate) fn roll(graph: &mut Graph, axes: NodeId, count: usize) -> NodeId {
    let [left, up] = [5, 8].map(|lane| components(graph, axes, count, 9, &[lane]));
    graph.binary(Binary::ArcTangent2, left, up)
}

/// Orientations as quaternions, four lanes each.
pub(crate) fn quaternions(graph: &mut Graph, axes: NodeId, count: usize) -> NodeId {
    let one = |place: usize| {
        let own = graph.select(9 * place..9 * (place + 1), axes);
        graph.add(Operation::Quaternion, &[own])
    };
    let parts: Vec<NodeId> = (0..count).map(one).collect();
    graph.join(&parts)
}

/// The sum of `count` vectors.
pub(crate) fn total(graph: &mut Graph, vectors: NodeId, count: usize) -> NodeId {
    let by_axis = graph.select((0..3).flat_map(|axis| (0..count).map(move |place| 3 * place + axis)), vectors);
    graph.reduce(Reduction::Sum, count, by_axis)
}

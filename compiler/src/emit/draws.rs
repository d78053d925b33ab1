//! What chance draws: formulas of raw numbers, and the randoms that hold what they give.

use crate::graph::operation::{Binary, Chance, Operation, Unary};
use crate::graph::{Graph, NodeId};

/// Raw numbers that the random of this index draws at each try.
pub(crate) fn noise(graph: &mut Graph, index: usize, chance: Chance, lanes: usize) -> NodeId {
    graph.add(Operation::Noise(number(index), chance, number(lanes)), &[])
}

/// `low + width u`, a whole number of the width where `low` is one.
pub(crate) fn uniform(graph: &mut Graph, low: NodeId, width: NodeId, whole: bool, u: NodeId) -> NodeId {
    let mut share = graph.binary(Binary::Multiply, width, u);
    if whole {
        share = graph.unary(Unary::Floor, share);
    }
    graph.binary(Binary::Add, low, share)
}

/// `middle + size z`, lane by lane.
pub(crate) fn scaled(graph: &mut Graph, middle: NodeId, size: NodeId, z: NodeId) -> NodeId {
    let away = graph.binary(Binary::Multiply, size, z);
    graph.binary(Binary::Add, middle, away)
}

/// One of `length` elements of `lanes` lanes, each as likely.
pub(crate) fn choice(graph: &mut Graph, list: NodeId, length: usize, lanes: usize, u: NodeId) -> NodeId {
    let count = graph.constant(length as f64);
    let place = graph.binary(Binary::Multiply, count, u);
    let place = graph.unary(Unary::Floor, place);
    graph.add(Operation::Pick(number(lanes)), &[list, place])
}

/// The random of this index before its redraw: what a try gives, and, if there is one, the condition on which it is taken.
pub(crate) fn held(graph: &mut Graph, index: usize, inputs: &[NodeId]) -> NodeId {
    graph.add(Operation::Drawn(number(index)), inputs)
}

/// The same random after its redraw.
pub(crate) fn redrawn(graph: &mut Graph, index: usize, held: NodeId) -> NodeId {
    let inputs = graph.node(held).inputs.clone();
    graph.add(Operation::DrawnAfter(number(index)), &inputs)
}

pub(crate) fn number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

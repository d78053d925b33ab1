//! Functions that make one value of a list.

use super::Arguments;
use super::layout::wrapped;
use crate::graph::operation::{Binary, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use crate::hir::types::ElementType;

/// The sum over elements, lane by lane.
fn sum_elements(graph: &mut Graph, node: NodeId, length: usize, lanes: usize) -> NodeId {
    if lanes == 1 {
        return graph.reduce(Reduction::Sum, length, node);
    }
    let by_lane = (0..lanes).flat_map(|lane| (0..length).map(move |place| place * lanes + lane));
    let turned = graph.select(by_lane, node);
    graph.reduce(Reduction::Sum, length, turned)
}

/// The direction of the sum of so many angles as directions on the circle.
fn mean_direction(graph: &mut Graph, node: NodeId, length: usize) -> NodeId {
    let [ahead, left] = [Unary::Cosine, Unary::Sine].map(|function| {
        let components = graph.unary(function, node);
        graph.reduce(Reduction::Sum, length, components)
    });
    graph.binary(Binary::ArcTangent2, left, ahead)
}

fn mean_of_list(graph: &mut Graph, of: &Arguments) -> NodeId {
    let (list, length) = (of.nodes[0], of.length);
    if of.subject.element() == Some(ElementType::WrappingAngle) {
        return mean_direction(graph, list, length);
    }
    let total = sum_elements(graph, list, length, of.lanes);
    let count = graph.constant(length as f64);
    graph.binary(Binary::Divide, total, count)
}

pub(crate) fn sum(graph: &mut Graph, of: &Arguments) -> NodeId {
    sum_elements(graph, of.nodes[0], of.length, of.lanes)
}

pub(crate) fn mean(graph: &mut Graph, of: &Arguments) -> NodeId {
    mean_of_list(graph, of)
}

pub(crate) fn std(graph: &mut Graph, of: &Arguments) -> NodeId {
    let (list, length) = (of.nodes[0], of.length);
    let middle = mean_of_list(graph, of);
    let away = graph.binary(Binary::Subtract, list, middle);
    let away = wrapped(graph, away, &of.subject);
    let spread = graph.reduce(Reduction::Norm, length, away);
    let root = graph.constant((length as f64).sqrt());
    graph.binary(Binary::Divide, spread, root)
}

/// The length of each vector.
pub(crate) fn length(graph: &mut Graph, of: &Arguments) -> NodeId {
    graph.reduce(Reduction::Norm, of.lanes, of.nodes[0])
}

/// The extreme of several arguments, from the first to the last.
fn extreme(graph: &mut Graph, of: &Arguments, function: Binary) -> NodeId {
    let (first, rest) = (of.nodes[0], &of.nodes[1..]);
    rest.iter().fold(first, |best, next| graph.binary(function, best, *next))
}

pub(crate) fn lowest(graph: &mut Graph, of: &Arguments) -> NodeId {
    extreme(graph, of, Binary::Minimum)
}

pub(crate) fn highest(graph: &mut Graph, of: &Arguments) -> NodeId {
    extreme(graph, of, Binary::Maximum)
}

fn element_at(graph: &mut Graph, of: &Arguments, place: usize) -> NodeId {
    let lanes = of.lanes;
    graph.select(place * lanes..(place + 1) * lanes, of.nodes[0])
}

pub(crate) fn first(graph: &mut Graph, of: &Arguments) -> NodeId {
    element_at(graph, of, 0)
}

pub(crate) fn last(graph: &mut Graph, of: &Arguments) -> NodeId {
    element_at(graph, of, of.length - 1)
}

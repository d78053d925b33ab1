//! Functions that make one value of a list.

use super::apply::Bound;
use crate::check::context::{Checked, Checker};
use crate::check::types::ElementType;
use crate::graph::operation::{Binary, Reduction, Unary};
use crate::graph::{Graph, NodeId};

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

fn mean_of_list(graph: &mut Graph, bound: &Bound<'_>) -> NodeId {
    let (list, length) = (bound.nodes[0], bound.length());
    if bound.subject.element() == Some(ElementType::WrappingAngle) {
        return mean_direction(graph, list, length);
    }
    let total = sum_elements(graph, list, length, bound.lanes());
    let count = graph.constant(length as f64);
    graph.binary(Binary::Divide, total, count)
}

pub(super) fn sum<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(sum_elements(&mut checker.graph, bound.nodes[0], bound.length(), bound.lanes()))
}

pub(super) fn mean<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(mean_of_list(&mut checker.graph, bound))
}

pub(super) fn std<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let (list, length) = (bound.nodes[0], bound.length());
    let middle = mean_of_list(&mut checker.graph, bound);
    let away = checker.graph.binary(Binary::Subtract, list, middle);
    let away = checker.wrapped(away, &bound.subject);
    let spread = checker.graph.reduce(Reduction::Norm, length, away);
    let root = checker.graph.constant((length as f64).sqrt());
    Ok(checker.graph.binary(Binary::Divide, spread, root))
}

/// The length of each vector.
pub(super) fn length<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(checker.graph.reduce(Reduction::Norm, bound.lanes(), bound.nodes[0]))
}

/// The extreme of several arguments, from the first to the last.
fn extreme(checker: &mut Checker<'_>, bound: &Bound<'_>, function: Binary) -> NodeId {
    let (first, rest) = (bound.nodes[0], &bound.nodes[1..]);
    rest.iter().fold(first, |best, next| checker.graph.binary(function, best, *next))
}

pub(super) fn lowest<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(extreme(checker, bound, Binary::Minimum))
}

pub(super) fn highest<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(extreme(checker, bound, Binary::Maximum))
}

fn element_at(checker: &mut Checker<'_>, bound: &Bound<'_>, place: usize) -> NodeId {
    let lanes = bound.lanes();
    checker.graph.select(place * lanes..(place + 1) * lanes, bound.nodes[0])
}

pub(super) fn first<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(element_at(checker, bound, 0))
}

pub(super) fn last<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(element_at(checker, bound, bound.length() - 1))
}

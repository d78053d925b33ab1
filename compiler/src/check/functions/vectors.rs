//! Functions of vectors and places, and values of the standing pose.

use super::apply::Bound;
use crate::check::context::{Checked, Checker};
use crate::check::ranges::{NeutralRange, Shaken};
use crate::diagnostics::codes;
use crate::graph::NodeId;
use crate::graph::interval;
use crate::graph::operation::{Binary, Reduction, Unary};

fn dot_nodes(checker: &mut Checker<'_>, a: NodeId, b: NodeId, size: usize) -> NodeId {
    let products = checker.graph.binary(Binary::Multiply, a, b);
    checker.graph.reduce(Reduction::Sum, size, products)
}

pub(super) fn dot<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [a, b] = bound.take();
    Ok(dot_nodes(checker, a, b, bound.lanes()))
}

fn cross_nodes(checker: &mut Checker<'_>, a: NodeId, b: NodeId) -> NodeId {
    let count = checker.graph.width(a).max(checker.graph.width(b)) / 3;
    // (a x b)_i = a_(i+1) b_(i+2) - a_(i+2) b_(i+1)
    let turned = |checker: &mut Checker<'_>, node: NodeId, by: usize| {
        checker.graph.select((0..count).flat_map(|place| (0..3).map(move |lane| 3 * place + (lane + by) % 3)), node)
    };
    let (a1, a2, b1, b2) = (turned(checker, a, 1), turned(checker, a, 2), turned(checker, b, 1), turned(checker, b, 2));
    let first = checker.graph.binary(Binary::Multiply, a1, b2);
    let second = checker.graph.binary(Binary::Multiply, a2, b1);
    checker.graph.binary(Binary::Subtract, first, second)
}

pub(super) fn cross<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [a, b] = bound.take();
    Ok(cross_nodes(checker, a, b))
}

pub(super) fn unit<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(checker.unit_vector(bound.nodes[0], bound.lanes()))
}

pub(super) fn angle_between<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [a, b] = bound.take();
    // atan2(|a x b|, a.b) keeps its digits where acos loses them: near 0 and near half a turn.
    let turned = cross_nodes(checker, a, b);
    let across = checker.graph.reduce(Reduction::Norm, 3, turned);
    let along = dot_nodes(checker, a, b, 3);
    Ok(checker.graph.binary(Binary::ArcTangent2, across, along))
}

pub(super) fn distance<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [from, to] = bound.take();
    let between = checker.graph.binary(Binary::Subtract, from, to);
    Ok(checker.graph.reduce(Reduction::Norm, 3, between))
}

pub(super) fn neutral<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let standing = NeutralRange { vocabulary: checker.vocabulary, reset: false, shaken: Shaken::default() };
    let known = interval::analyse_for(&checker.graph, bound.nodes[0], &standing);
    let lanes: Option<Vec<f64>> = known.iter().map(|bounds| bounds.single()).collect();
    let Some(lanes) = lanes else {
        let diagnostic = checker
            .diagnostic(codes::types::NOT_CONSTANT, bound.exprs[0].span, "the standing pose does not determine this value")
            .help("places, axes, joint coordinates and velocities are known in the standing pose; forces and muscle lengths are not");
        return Err(checker.report(diagnostic));
    };
    Ok(checker.graph.constants(&lanes))
}

/// From one angle to another the short way.
pub(super) fn turn<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [from, to] = bound.take();
    let between = checker.graph.binary(Binary::Subtract, to, from);
    Ok(checker.graph.unary(Unary::Wrap, between))
}

/// From one orientation to another.
pub(super) fn turn_of_axes<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [from, to] = bound.take();
    let count = checker.graph.width(from) / 9;
    // The trace of A'B is 1 + 2 cos, the length of its skew part 2 sin: together they keep their digits everywhere.
    let crossed = [0, 1, 2].map(|axis| {
        let of_axis = move || (0..count).flat_map(move |place| (0..3).map(move |lane| 9 * place + 3 * axis + lane));
        let (one, other) = (checker.graph.select(of_axis(), from), checker.graph.select(of_axis(), to));
        cross_nodes(checker, one, other)
    });
    let skew = checker.graph.binary(Binary::Add, crossed[0], crossed[1]);
    let skew = checker.graph.binary(Binary::Add, skew, crossed[2]);
    let across = checker.graph.reduce(Reduction::Norm, 3, skew);
    let along = dot_nodes(checker, from, to, 9);
    let one = checker.graph.constant(1.0);
    let along = checker.graph.binary(Binary::Subtract, along, one);
    Ok(checker.graph.binary(Binary::ArcTangent2, across, along))
}

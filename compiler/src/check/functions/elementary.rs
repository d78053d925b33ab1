//! Functions of one number after the other.

use super::apply::Bound;
use crate::check::context::{Checked, Checker};
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Operation, Unary};

pub(super) fn abs<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    checker.warn_folded(bound.nodes[0], bound.span);
    checker.warn_cancelling(bound.nodes[0], bound.span);
    Ok(checker.graph.unary(Unary::Absolute, bound.nodes[0]))
}

pub(super) fn clip<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [x, low, high] = bound.take();
    let raised = checker.graph.binary(Binary::Maximum, x, low);
    Ok(checker.graph.binary(Binary::Minimum, raised, high))
}

pub(super) fn between<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [x, low, high] = bound.take();
    let above = checker.graph.binary(Binary::LessEqual, low, x);
    let below = checker.graph.binary(Binary::LessEqual, x, high);
    Ok(checker.graph.binary(Binary::And, above, below))
}

/// `a + share (b - a)`, where the difference of angles that wrap is the short way.
pub(super) fn lerp<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [from, to, share] = bound.take();
    let way = checker.graph.binary(Binary::Subtract, to, from);
    let way = checker.wrapped(way, &bound.subject);
    let part = checker.graph.binary(Binary::Multiply, share, way);
    Ok(checker.graph.binary(Binary::Add, from, part))
}

/// How far x is on its way from low to high, clipped to 0..1.
fn share_between(checker: &mut Checker<'_>, [x, low, high]: [NodeId; 3]) -> NodeId {
    let (zero, one) = (checker.graph.constant(0.0), checker.graph.constant(1.0));
    let above = checker.graph.binary(Binary::Subtract, x, low);
    let width = checker.graph.binary(Binary::Subtract, high, low);
    let share = checker.graph.binary(Binary::Divide, above, width);
    let share = checker.graph.binary(Binary::Maximum, share, zero);
    checker.graph.binary(Binary::Minimum, share, one)
}

pub(super) fn smoothstep<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let share = share_between(checker, bound.take());
    let (two, three) = (checker.graph.constant(2.0), checker.graph.constant(3.0));
    let square = checker.graph.binary(Binary::Multiply, share, share);
    let twice = checker.graph.binary(Binary::Multiply, two, share);
    let rest = checker.graph.binary(Binary::Subtract, three, twice);
    Ok(checker.graph.binary(Binary::Multiply, square, rest))
}

pub(super) fn tolerance<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [value, bottom, top, width] = bound.take();
    let graph = &mut checker.graph;
    let (below, above) = (graph.binary(Binary::Subtract, bottom, value), graph.binary(Binary::Subtract, value, top));
    let outside = graph.binary(Binary::Maximum, below, above);
    let zero = graph.constant(0.0);
    let outside = graph.binary(Binary::Maximum, outside, zero);
    let relative = graph.binary(Binary::Divide, outside, width);
    let square = graph.binary(Binary::Multiply, relative, relative);
    // ln 0.1: the bell is 0.1 at the margin.
    let steepness = graph.constant(-std::f64::consts::LN_10);
    let exponent = graph.binary(Binary::Multiply, steepness, square);
    let bell = graph.unary(Unary::Exponential, exponent);
    let inside = graph.binary(Binary::LessEqual, outside, zero);
    let one = graph.constant(1.0);
    Ok(graph.add(Operation::Choose, &[inside, one, bell]))
}

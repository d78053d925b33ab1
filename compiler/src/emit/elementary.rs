//! Functions of one number after the other.

use super::Arguments;
use super::layout::wrapped;
use crate::graph::operation::{Binary, Operation, Unary};
use crate::graph::{Graph, NodeId};

pub(crate) fn clip(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [x, low, high] = of.take();
    let raised = graph.binary(Binary::Maximum, x, low);
    graph.binary(Binary::Minimum, raised, high)
}

pub(crate) fn between(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [x, low, high] = of.take();
    let above = graph.binary(Binary::LessEqual, low, x);
    let below = graph.binary(Binary::LessEqual, x, high);
    graph.binary(Binary::And, above, below)
}

/// `a + share (b - a)`, where the difference of angles that wrap is the short way.
pub(crate) fn lerp(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [from, to, share] = of.take();
    let way = graph.binary(Binary::Subtract, to, from);
    let way = wrapped(graph, way, &of.subject);
    let part = graph.binary(Binary::Multiply, share, way);
    graph.binary(Binary::Add, from, part)
}

/// How far x is on its way from low to high, clipped to 0..1.
fn share_between(graph: &mut Graph, [x, low, high]: [NodeId; 3]) -> NodeId {
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    let above = graph.binary(Binary::Subtract, x, low);
    let width = graph.binary(Binary::Subtract, high, low);
    let share = graph.binary(Binary::Divide, above, width);
    let share = graph.binary(Binary::Maximum, share, zero);
    graph.binary(Binary::Minimum, share, one)
}

pub(crate) fn smoothstep(graph: &mut Graph, of: &Arguments) -> NodeId {
    let share = share_between(graph, of.take());
    let (two, three) = (graph.constant(2.0), graph.constant(3.0));
    let square = graph.binary(Binary::Multiply, share, share);
    let twice = graph.binary(Binary::Multiply, two, share);
    let rest = graph.binary(Binary::Subtract, three, twice);
    graph.binary(Binary::Multiply, square, rest)
}

pub(crate) fn tolerance(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [value, bottom, top, width] = of.take();
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
    graph.add(Operation::Choose, &[inside, one, bell])
}

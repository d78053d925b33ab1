//! Functions of vectors and places.

use super::Arguments;
use crate::graph::operation::{Binary, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};

fn dot_nodes(graph: &mut Graph, a: NodeId, b: NodeId, size: usize) -> NodeId {
    let products = graph.binary(Binary::Multiply, a, b);
    graph.reduce(Reduction::Sum, size, products)
}

pub(crate) fn dot(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [a, b] = of.take();
    dot_nodes(graph, a, b, of.lanes)
}

fn cross_nodes(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    let count = graph.width(a).max(graph.width(b)) / 3;
    // (a x b)_i = a_(i+1) b_(i+2) - a_(i+2) b_(i+1)
    let turned = |graph: &mut Graph, node: NodeId, by: usize| {
        graph.select((0..count).flat_map(|place| (0..3).map(move |lane| 3 * place + (lane + by) % 3)), node)
    };
    let (a1, a2, b1, b2) = (turned(graph, a, 1), turned(graph, a, 2), turned(graph, b, 1), turned(graph, b, 2));
    let first = graph.binary(Binary::Multiply, a1, b2);
    let second = graph.binary(Binary::Multiply, a2, b1);
    graph.binary(Binary::Subtract, first, second)
}

pub(crate) fn cross(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [a, b] = of.take();
    cross_nodes(graph, a, b)
}

pub(crate) fn unit(graph: &mut Graph, of: &Arguments) -> NodeId {
    unit_vector(graph, of.nodes[0], of.lanes)
}

pub(crate) fn angle_between(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [a, b] = of.take();
    // atan2(|a x b|, a.b) keeps its digits where acos loses them: near 0 and near half a turn.
    let turned = cross_nodes(graph, a, b);
    let across = graph.reduce(Reduction::Norm, 3, turned);
    let along = dot_nodes(graph, a, b, 3);
    graph.binary(Binary::ArcTangent2, across, along)
}

pub(crate) fn distance(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [from, to] = of.take();
    let between = graph.binary(Binary::Subtract, from, to);
    graph.reduce(Reduction::Norm, 3, between)
}

/// From one angle to another the short way.
pub(crate) fn turn(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [from, to] = of.take();
    let between = graph.binary(Binary::Subtract, to, from);
    graph.unary(Unary::Wrap, between)
}

/// From one orientation to another.
pub(crate) fn turn_of_axes(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [from, to] = of.take();
    let count = graph.width(from) / 9;
    // The trace of A'B is 1 + 2 cos, the length of its skew part 2 sin: together they keep their digits everywhere.
    let crossed = [0, 1, 2].map(|axis| {
        let of_axis = move || (0..count).flat_map(move |place| (0..3).map(move |lane| 9 * place + 3 * axis + lane));
        let (one, other) = (graph.select(of_axis(), from), graph.select(of_axis(), to));
        cross_nodes(graph, one, other)
    });
    let skew = graph.binary(Binary::Add, crossed[0], crossed[1]);
    let skew = graph.binary(Binary::Add, skew, crossed[2]);
    let across = graph.reduce(Reduction::Norm, 3, skew);
    let along = dot_nodes(graph, from, to, 9);
    let one = graph.constant(1.0);
    let along = graph.binary(Binary::Subtract, along, one);
    graph.binary(Binary::ArcTangent2, across, along)
}

/// Each group of `size` lanes divided by its length; zero stays zero.
pub(crate) fn unit_vector(graph: &mut Graph, vector: NodeId, size: usize) -> NodeId {
    let count = graph.width(vector) / size;
    let length = graph.reduce(Reduction::Norm, size, vector);
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    let is_zero = graph.binary(Binary::Equal, length, zero);
    let divisor = graph.add(Operation::Choose, &[is_zero, one, length]);
    let repeated =
        if count == 1 { divisor } else { graph.select((0..count).flat_map(|place| std::iter::repeat_n(place, size)), divisor) };
    graph.binary(Binary::Divide, vector, repeated)
}

//! Functions of vectors and places, and values of the standing pose.

use super::Call;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::ranges::Standing;
use crate::check::types::{Frame, Type};
use crate::check::value::{Data, Form, Value};
use crate::diagnostics::codes;
use crate::graph::NodeId;
use crate::graph::interval;
use crate::graph::operation::{Binary, Reduction, Unary};
use crate::syntax::tree::Expr;

/// A vector, or a list of vectors.
fn vector<'a>(checker: &mut Checker<'a>, call: &Call<'a>, expr: &'a Expr) -> Checked<Data> {
    let data = match checker.value(expr)? {
        Value::Data(data) => checker.as_vector(data, Frame::World),
        other => return Err(checker.not_numbers(&other, expr.span)),
    };
    if matches!(data.kind.element(), Type::Vector { .. }) {
        return Ok(data);
    }
    let found = data.kind.described(checker.vocabulary);
    let message = format!("`{}` takes vectors", call.name);
    let diagnostic = checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
    Err(checker.report(diagnostic))
}

/// Two vectors in the same axes, laid out alike: nodes, components, dimensions, type of the first.
fn two_vectors<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<(NodeId, NodeId, usize, [Dimension; 2], Type)> {
    let [a, b] = call.take(checker, ["a", "b"])?;
    let (left, right) = (vector(checker, call, a), vector(checker, call, b));
    let (left, right) = (left?, right?);
    let (Type::Vector { size, dimension: first, frame }, Type::Vector { size: other, dimension: second, frame: own }) =
        (left.kind.element().clone(), right.kind.element().clone())
    else {
        return Err(call.wrong_arguments(checker));
    };
    if (size, frame) != (other, own) {
        let (expected, found) = (left.kind.described(checker.vocabulary), right.kind.described(checker.vocabulary));
        let diagnostic = checker
            .diagnostic(codes::types::FRAMES_DIFFER, call.span, "these vectors are counted in different axes")
            .expected(expected)
            .found(found)
            .help(format!("express the second in the axes of the first: `(... in {})`", frame.name(checker.vocabulary)));
        return Err(checker.report(diagnostic));
    }
    let length = checker.common_length(&left.kind, &right.kind, b.span)?;
    let (x, y) = (checker.spread(&left, length.unwrap_or(1), size), checker.spread(&right, length.unwrap_or(1), size));
    let kind = if left.kind.length().is_some() { left.kind } else { right.kind };
    Ok((x, y, size, [first, second], kind))
}

fn product_dimension<'a>(checker: &mut Checker<'a>, call: &Call<'a>, [a, b]: [Dimension; 2]) -> Checked<Dimension> {
    match a.times(b) {
        Some(dimension) => Ok(dimension),
        None => Err(checker.error(codes::types::POWER, call.span, "the unit of this product is beyond reason")),
    }
}

fn dot_nodes(checker: &mut Checker<'_>, a: NodeId, b: NodeId, size: usize) -> NodeId {
    let products = checker.graph.binary(Binary::Multiply, a, b);
    checker.graph.reduce(Reduction::Sum, size, products)
}

pub(super) fn dot<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let (a, b, size, dimensions, kind) = two_vectors(checker, call)?;
    let dimension = product_dimension(checker, call, dimensions)?;
    let node = dot_nodes(checker, a, b, size);
    Ok(Data::new(node, kind.with_element(Type::Number(dimension))))
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

pub(super) fn cross<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let (a, b, size, dimensions, kind) = two_vectors(checker, call)?;
    let (Type::Vector { frame, .. }, 3) = (kind.element().clone(), size) else {
        return Err(checker.error(codes::types::WRONG_TYPE, call.span, "`cross` takes vectors of three components"));
    };
    let dimension = product_dimension(checker, call, dimensions)?;
    let node = cross_nodes(checker, a, b);
    Ok(Data::new(node, kind.with_element(Type::Vector { size: 3, dimension, frame })))
}

pub(super) fn unit<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["v"])?;
    let data = vector(checker, call, x)?;
    let Type::Vector { size, frame, .. } = data.kind.element().clone() else {
        return Err(call.wrong_arguments(checker));
    };
    let node = checker.unit_vector(data.node, size);
    Ok(Data::new(node, data.kind.with_element(Type::Vector { size, dimension: Dimension::NONE, frame })))
}

pub(super) fn angle_between<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let (a, b, size, dimensions, kind) = two_vectors(checker, call)?;
    if size != 3 {
        return Err(checker.error(codes::types::WRONG_TYPE, call.span, "`angle_between` takes vectors of three components"));
    }
    product_dimension(checker, call, dimensions)?;
    // atan2(|a x b|, a.b) keeps its digits where acos loses them: near 0 and near half a turn.
    let turned = cross_nodes(checker, a, b);
    let across = checker.graph.reduce(Reduction::Norm, 3, turned);
    let along = dot_nodes(checker, a, b, 3);
    let node = checker.graph.binary(Binary::ArcTangent2, across, along);
    Ok(Data::new(node, kind.with_element(Type::Number(Dimension::ANGLE))))
}

/// A place, read from a part of the body where one is named: `distance(palm_l, head)`.
fn place<'a>(checker: &mut Checker<'a>, call: &Call<'a>, expr: &'a Expr) -> Checked<Data> {
    let data = match checker.value(expr)? {
        Value::Data(data) => data,
        value => checker.positions(&value, expr.span)?,
    };
    let bracket = data.is_bracket()
        && matches!(checker.as_vector(data.clone(), Frame::World).kind, Type::Vector { size: 3, dimension, .. } if dimension == Dimension::LENGTH);
    if bracket {
        return Ok(Data::new(data.node, Type::Place(Frame::World)));
    }
    if matches!(data.kind.element(), Type::Place(_)) {
        return Ok(data);
    }
    let found = data.kind.described(checker.vocabulary);
    let message = format!("`{}` takes places", call.name);
    let diagnostic = checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
    Err(checker.report(diagnostic))
}

pub(super) fn distance<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [a, b] = call.take(checker, ["a", "b"])?;
    let (from, to) = (place(checker, call, a), place(checker, call, b));
    let (x, y, kind) = {
        let (from, to) = (from?, to?);
        checker.agree("measure between", (from, a), (to, b))?
    };
    let between = checker.graph.binary(Binary::Subtract, x, y);
    let node = checker.graph.reduce(Reduction::Norm, 3, between);
    Ok(Data::new(node, kind.with_element(Type::Number(Dimension::LENGTH))))
}

pub(super) fn neutral<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["x"])?;
    let data = checker.data(x)?;
    let known = interval::analyse_for(&checker.graph, data.node, &Standing { vocabulary: checker.vocabulary, reset: false });
    let lanes: Option<Vec<f64>> = known.iter().map(|bounds| bounds.single()).collect();
    let Some(lanes) = lanes else {
        let diagnostic = checker
            .diagnostic(codes::types::NOT_CONSTANT, x.span, "the standing pose does not settle this value")
            .help("places, axes, joint coordinates and velocities are known there; forces and muscle lengths are not");
        return Err(checker.report(diagnostic));
    };
    let node = checker.graph.constants(&lanes);
    Ok(Data { node, ..data })
}

/// From one angle to another the short way, or from one orientation to another.
pub(super) fn turn<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [a, b] = call.take(checker, ["a", "b"])?;
    let (from, to) = (checker.data(a), checker.data(b));
    let (from, to) = (from?, to?);
    if from.kind == Type::Rotation && to.kind == Type::Rotation {
        // The trace of A'B is 1 + 2 cos, the length of its skew part 2 sin: together they keep their digits everywhere.
        let mut crossed = Vec::new();
        for axis in 0..3 {
            let (one, other) =
                (checker.graph.select(3 * axis..3 * axis + 3, from.node), checker.graph.select(3 * axis..3 * axis + 3, to.node));
            crossed.push(cross_nodes(checker, one, other));
        }
        let skew = checker.graph.binary(Binary::Add, crossed[0], crossed[1]);
        let skew = checker.graph.binary(Binary::Add, skew, crossed[2]);
        let across = checker.graph.reduce(Reduction::Norm, 3, skew);
        let along = dot_nodes(checker, from.node, to.node, 9);
        let one = checker.graph.constant(1.0);
        let along = checker.graph.binary(Binary::Subtract, along, one);
        let node = checker.graph.binary(Binary::ArcTangent2, across, along);
        return Ok(Data::new(node, Type::Number(Dimension::ANGLE)));
    }
    let (x, y, kind) = checker.agree("turn between", (from, a), (to, b))?;
    if kind.dimension() != Some(Dimension::ANGLE) || !matches!(kind.element(), Type::Number(_)) {
        let found = kind.described(checker.vocabulary);
        let diagnostic =
            checker.diagnostic(codes::types::WRONG_TYPE, call.span, "`turn` takes two angles or two orientations").found(found);
        return Err(checker.report(diagnostic));
    }
    let between = checker.graph.binary(Binary::Subtract, y, x);
    let node = checker.graph.unary(Unary::Wrap, between);
    Ok(Data::new(node, kind).with_form(Form::Wrapping))
}

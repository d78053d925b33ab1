//! Functions of one number after the other; lists map.

use super::Call;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::{Dimension, Rational};
use crate::check::types::Type;
use crate::check::value::{Data, Form};
use crate::diagnostics::codes;
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Operation, Unary};
use crate::syntax::tree::Expr;

/// A function from one dimension to another.
fn map<'a>(checker: &mut Checker<'a>, call: &Call<'a>, function: Unary, from: Dimension, to: Dimension) -> Checked<Data> {
    let [x] = call.take(checker, ["x"])?;
    let data = checker.number_of(x, from, &format!("`{}`", call.name))?;
    let node = checker.graph.unary(function, data.node);
    Ok(Data::new(node, data.kind.with_element(Type::Number(to))))
}

pub(super) fn exp<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    map(checker, call, Unary::Exponential, Dimension::NONE, Dimension::NONE)
}

pub(super) fn log<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    map(checker, call, Unary::Logarithm, Dimension::NONE, Dimension::NONE)
}

pub(super) fn tanh<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    map(checker, call, Unary::HyperbolicTangent, Dimension::NONE, Dimension::NONE)
}

pub(super) fn sin<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    map(checker, call, Unary::Sine, Dimension::ANGLE, Dimension::NONE)
}

pub(super) fn cos<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    map(checker, call, Unary::Cosine, Dimension::ANGLE, Dimension::NONE)
}

pub(super) fn tan<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    map(checker, call, Unary::Tangent, Dimension::ANGLE, Dimension::NONE)
}

pub(super) fn asin<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    map(checker, call, Unary::ArcSine, Dimension::NONE, Dimension::ANGLE)
}

pub(super) fn acos<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    map(checker, call, Unary::ArcCosine, Dimension::NONE, Dimension::ANGLE)
}

pub(super) fn floor<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let floored = map(checker, call, Unary::Floor, Dimension::NONE, Dimension::NONE)?;
    Ok(Data { kind: floored.kind.with_element(Type::Int), ..floored })
}

/// A number or a list of numbers of any dimension.
fn any_number<'a>(checker: &mut Checker<'a>, call: &Call<'a>, expr: &'a Expr) -> Checked<(Data, Dimension)> {
    let data = checker.data(expr)?;
    match data.kind.element() {
        Type::Number(dimension) => Ok((data.clone(), *dimension)),
        Type::Int => Ok((data, Dimension::NONE)),
        _ => {
            let found = data.kind.described(checker.vocabulary);
            let message = format!("`{}` takes numbers", call.name);
            let diagnostic = checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
            Err(checker.report(diagnostic))
        }
    }
}

pub(super) fn abs<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["x"])?;
    let (data, _) = any_number(checker, call, x)?;
    checker.warn_folded(data.node, call.span);
    let node = checker.graph.unary(Unary::Absolute, data.node);
    Ok(Data::new(node, data.kind))
}

pub(super) fn sign<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["x"])?;
    let (data, _) = any_number(checker, call, x)?;
    let node = checker.graph.unary(Unary::Sign, data.node);
    Ok(Data::new(node, data.kind.with_element(Type::Int)))
}

pub(super) fn sqrt<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["x"])?;
    let (data, dimension) = any_number(checker, call, x)?;
    let half = Rational::new(1, 2).and_then(|half| dimension.power(half));
    let Some(dimension) = half else {
        return Err(checker.error(codes::types::POWER, x.span, "this unit has no root within reason"));
    };
    let node = checker.graph.unary(Unary::SquareRoot, data.node);
    Ok(Data::new(node, data.kind.with_element(Type::Number(dimension))))
}

/// A function of two numbers of one dimension; `to` makes the dimension of the result of theirs.
fn pair<'a>(
    checker: &mut Checker<'a>,
    call: &Call<'a>,
    names: [&str; 2],
    function: Binary,
    to: impl Fn(Dimension) -> Dimension,
) -> Checked<Data> {
    let [x, y] = call.take(checker, names)?;
    let (left, right) = (any_number(checker, call, x), any_number(checker, call, y));
    let (left, right) = (left?, right?);
    let (a, b, kind) = checker.agree("combine", (left.0, x), (right.0, y))?;
    let dimension = kind.dimension().unwrap_or(Dimension::NONE);
    let node = checker.graph.binary(function, a, b);
    Ok(Data::new(node, kind.with_element(Type::Number(to(dimension)))))
}

pub(super) fn atan2<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let angle = pair(checker, call, ["y", "x"], Binary::ArcTangent2, |_| Dimension::ANGLE)?;
    Ok(angle.with_form(Form::Wrapping))
}

pub(super) fn hypot<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    pair(checker, call, ["x", "y"], Binary::Hypotenuse, |dimension| dimension)
}

pub(super) fn modulo<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x, y] = call.take(checker, ["x", "y"])?;
    let (left, right) = (any_number(checker, call, x), any_number(checker, call, y));
    let (left, right) = (left?, right?);
    // The remainder of whole numbers is whole, and so may be an index.
    let whole = *left.0.kind.element() == Type::Int && *right.0.kind.element() == Type::Int;
    let (a, b, kind) = checker.agree("combine", (left.0, x), (right.0, y))?;
    let dimension = kind.dimension().unwrap_or(Dimension::NONE);
    let node = checker.graph.binary(Binary::Modulo, a, b);
    Ok(Data::new(node, kind.with_element(if whole { Type::Int } else { Type::Number(dimension) })))
}

/// Three numbers of one dimension laid out alike.
fn three<'a>(checker: &mut Checker<'a>, call: &Call<'a>, exprs: [&'a Expr; 3]) -> Checked<([NodeId; 3], Type)> {
    let values = exprs.map(|expr| any_number(checker, call, expr));
    let [(x, _), (low, _), (high, _)] = {
        let [a, b, c] = values;
        [a?, b?, c?]
    };
    let (_, low_node, kind) = checker.agree("compare", (x.clone(), exprs[0]), (low, exprs[1]))?;
    let model = Data { node: x.node, kind: kind.clone(), form: x.form };
    let (x_node, high_node, kind) = checker.agree("compare", (model, exprs[0]), (high, exprs[2]))?;
    Ok(([x_node, low_node, high_node], kind))
}

pub(super) fn clip<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let (x, low, high, []) = call.take_bounded(checker, [])?;
    let ([x, low, high], kind) = three(checker, call, [x, low, high])?;
    let raised = checker.graph.binary(Binary::Maximum, x, low);
    let node = checker.graph.binary(Binary::Minimum, raised, high);
    Ok(Data::new(node, kind))
}

pub(super) fn between<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let (x, low, high, []) = call.take_bounded(checker, [])?;
    let ([x, low, high], kind) = three(checker, call, [x, low, high])?;
    let above = checker.graph.binary(Binary::LessEqual, low, x);
    let below = checker.graph.binary(Binary::LessEqual, x, high);
    let node = checker.graph.binary(Binary::And, above, below);
    Ok(Data::new(node, kind.with_element(Type::Bool)))
}

pub(super) fn lerp<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [a, b, share] = call.take(checker, ["a", "b", "share"])?;
    let (from, to) = (any_number(checker, call, a), any_number(checker, call, b));
    let share = checker.number_of(share, Dimension::NONE, "`lerp`'s share");
    let (from, to, share) = (from?, to?, share?);
    let (from, to, kind) = checker.agree("blend", (from.0, a), (to.0, b))?;
    let way = checker.graph.binary(Binary::Subtract, to, from);
    let part = checker.graph.binary(Binary::Multiply, share.node, way);
    let node = checker.graph.binary(Binary::Add, from, part);
    Ok(Data::new(node, kind))
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

pub(super) fn smoothstep<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let (x, low, high, []) = call.take_bounded(checker, [])?;
    let (nodes, kind) = three(checker, call, [x, low, high])?;
    let share = share_between(checker, nodes);
    let (two, three) = (checker.graph.constant(2.0), checker.graph.constant(3.0));
    let square = checker.graph.binary(Binary::Multiply, share, share);
    let twice = checker.graph.binary(Binary::Multiply, two, share);
    let rest = checker.graph.binary(Binary::Subtract, three, twice);
    let node = checker.graph.binary(Binary::Multiply, square, rest);
    Ok(Data::new(node, kind.with_element(Type::PLAIN)))
}

pub(super) fn tolerance<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let (x, low, high, [margin]) = call.take_bounded(checker, ["margin"])?;
    let ([value, bottom, top], kind) = three(checker, call, [x, low, high])?;
    let (width, _) = any_number(checker, call, margin)?;
    let model = Data::new(value, kind.clone());
    let (_, width, _) = checker.agree("compare", (model, x), (width, margin))?;
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
    let node = graph.add(Operation::Choose, &[inside, one, bell]);
    Ok(Data::new(node, kind.with_element(Type::PLAIN)))
}

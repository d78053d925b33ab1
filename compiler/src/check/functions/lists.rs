//! Functions that make one value of a list.

use super::Call;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::{Dimension, Rational};
use crate::check::types::{Frame, Type};
use crate::check::value::{Data, Value};
use crate::diagnostics::codes;
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Reduction};
use crate::syntax::tree::Expr;

/// A list whose elements are of one kind.
fn list<'a>(checker: &mut Checker<'a>, call: &Call<'a>, expr: &'a Expr) -> Checked<(Data, Type, usize)> {
    let data = checker.data(expr)?;
    match &data.kind {
        Type::List(element, length) => Ok((data.clone(), (**element).clone(), *length)),
        Type::Mixed(_) => {
            let found = data.kind.described(checker.vocabulary);
            let message = format!("`{}` cannot mix different dimensions", call.name);
            let diagnostic = checker
                .diagnostic(codes::types::MIXED, expr.span, message)
                .found(found)
                .help("take the hinges or the slides alone: `hinges.q`, `slides.q`, `independent.q`");
            Err(checker.report(diagnostic))
        }
        other => {
            let found = other.described(checker.vocabulary);
            let message = format!("`{}` takes a list", call.name);
            let diagnostic = checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
            Err(checker.report(diagnostic))
        }
    }
}

fn list_of_numbers<'a>(checker: &mut Checker<'a>, call: &Call<'a>, expr: &'a Expr) -> Checked<(Data, Dimension, usize)> {
    let (data, element, length) = list(checker, call, expr)?;
    match element {
        Type::Number(dimension) => Ok((data, dimension, length)),
        Type::Int | Type::Bool => Ok((data, Dimension::NONE, length)),
        _ => {
            let found = data.kind.described(checker.vocabulary);
            let message = format!("`{}` takes a list of numbers", call.name);
            let diagnostic = checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
            Err(checker.report(diagnostic))
        }
    }
}

/// The sum over elements, lane by lane.
fn sum_elements(checker: &mut Checker<'_>, node: NodeId, length: usize, lanes: usize) -> NodeId {
    if lanes == 1 {
        return checker.graph.reduce(Reduction::Sum, length, node);
    }
    let by_lane = (0..lanes).flat_map(|lane| (0..length).map(move |place| place * lanes + lane));
    let turned = checker.graph.select(by_lane, node);
    checker.graph.reduce(Reduction::Sum, length, turned)
}

pub(super) fn sum<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["list"])?;
    let (data, element, length) = list(checker, call, x)?;
    let kind = match element {
        Type::Bool | Type::Int => Type::Int,
        Type::Number(_) | Type::Vector { .. } => element.clone(),
        _ => return Err(no_sum(checker, call, x, &data)),
    };
    let node = sum_elements(checker, data.node, length, element.element_lanes());
    Ok(Data::new(node, kind))
}

fn no_sum<'a>(checker: &mut Checker<'a>, call: &Call<'a>, expr: &'a Expr, data: &Data) -> crate::check::context::Reported {
    let found = data.kind.described(checker.vocabulary);
    let message = format!("`{}` has no meaning here", call.name);
    let code = if matches!(data.kind.element(), Type::Place(_)) { codes::types::PLACES } else { codes::types::WRONG_TYPE };
    let diagnostic = checker.diagnostic(code, expr.span, message).found(found).help("`mean` of places is a place");
    checker.report(diagnostic)
}

pub(super) fn mean<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["list"])?;
    let (data, element, length) = list(checker, call, x)?;
    let kind = match element {
        Type::Bool | Type::Int => Type::PLAIN,
        Type::Number(_) | Type::Vector { .. } | Type::Place(_) => element.clone(),
        _ => return Err(no_sum(checker, call, x, &data)),
    };
    let total = sum_elements(checker, data.node, length, element.element_lanes());
    let count = checker.graph.constant(length as f64);
    let node = checker.graph.binary(Binary::Divide, total, count);
    Ok(Data::new(node, kind))
}

pub(super) fn std<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["list"])?;
    let (data, dimension, length) = list_of_numbers(checker, call, x)?;
    let graph = &mut checker.graph;
    let count = graph.constant(length as f64);
    let total = graph.reduce(Reduction::Sum, length, data.node);
    let middle = graph.binary(Binary::Divide, total, count);
    let away = graph.binary(Binary::Subtract, data.node, middle);
    let spread = graph.reduce(Reduction::Norm, length, away);
    let root = graph.constant((length as f64).sqrt());
    let node = graph.binary(Binary::Divide, spread, root);
    Ok(Data::new(node, Type::Number(dimension)))
}

pub(super) fn prod<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["list"])?;
    let (data, dimension, length) = list_of_numbers(checker, call, x)?;
    let power = i32::try_from(length).ok().and_then(|length| dimension.power(Rational::whole(length)));
    let Some(dimension) = power else {
        return Err(checker.error(codes::types::POWER, x.span, "the unit of this product is beyond reason"));
    };
    let node = checker.graph.reduce(Reduction::Product, length, data.node);
    Ok(Data::new(node, Type::Number(dimension)))
}

pub(super) fn norm<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["v"])?;
    let data = match checker.value(x)? {
        Value::Data(data) => checker.as_vector(data, Frame::World),
        other => return Err(checker.not_numbers(&other, x.span)),
    };
    if let Type::Vector { size, dimension, .. } = data.kind.element() {
        let node = checker.graph.reduce(Reduction::Norm, *size, data.node);
        return Ok(Data::new(node, data.kind.with_element(Type::Number(*dimension))));
    }
    let (data, dimension, length) = list_of_numbers(checker, call, x)?;
    let node = checker.graph.reduce(Reduction::Norm, length, data.node);
    Ok(Data::new(node, Type::Number(dimension)))
}

/// The extreme of a list, or of several arguments.
fn extreme<'a>(checker: &mut Checker<'a>, call: &Call<'a>, reduction: Reduction, function: Binary) -> Checked<Data> {
    match call.arguments {
        [] => Err(call.wrong_arguments(checker)),
        [only] => {
            let (data, dimension, length) = list_of_numbers(checker, call, &only.value)?;
            let node = checker.graph.reduce(reduction, length, data.node);
            Ok(Data::new(node, if dimension.is_none() { data.kind.element().clone() } else { Type::Number(dimension) }))
        }
        [first, rest @ ..] => {
            let mut best = checker.data(&first.value);
            for argument in rest {
                let next = checker.data(&argument.value);
                best = match (best, next) {
                    (Ok(best), Ok(next)) => {
                        lower_or_higher(checker, call, function, (best, &first.value), (next, &argument.value))
                    }
                    (Err(reported), _) | (_, Err(reported)) => Err(reported),
                };
            }
            best
        }
    }
}

fn lower_or_higher<'a>(
    checker: &mut Checker<'a>,
    call: &Call<'a>,
    function: Binary,
    left: (Data, &'a Expr),
    right: (Data, &'a Expr),
) -> Checked<Data> {
    for (data, expr) in [&left, &right] {
        if !matches!(data.kind.element(), Type::Number(_) | Type::Int | Type::Steps) {
            let found = data.kind.described(checker.vocabulary);
            let message = format!("`{}` takes numbers", call.name);
            let diagnostic = checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
            return Err(checker.report(diagnostic));
        }
    }
    let (a, b, kind) = checker.agree("compare", left, right)?;
    let node = checker.graph.binary(function, a, b);
    Ok(Data::new(node, kind))
}

pub(super) fn min<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    extreme(checker, call, Reduction::Minimum, Binary::Minimum)
}

pub(super) fn max<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    extreme(checker, call, Reduction::Maximum, Binary::Maximum)
}

fn conditions<'a>(checker: &mut Checker<'a>, call: &Call<'a>, reduction: Reduction) -> Checked<Data> {
    let [x] = call.take(checker, ["list"])?;
    let data = checker.condition(x)?;
    let Some(length) = data.kind.length() else {
        return Ok(data);
    };
    let node = checker.graph.reduce(reduction, length, data.node);
    Ok(Data::new(node, Type::Bool))
}

pub(super) fn any<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    conditions(checker, call, Reduction::Maximum)
}

pub(super) fn all<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    conditions(checker, call, Reduction::Minimum)
}

fn element_at<'a>(checker: &mut Checker<'a>, call: &Call<'a>, last: bool) -> Checked<Data> {
    let [x] = call.take(checker, ["list"])?;
    let (data, element, length) = list(checker, call, x)?;
    let lanes = element.element_lanes();
    let place = if last { length - 1 } else { 0 };
    let node = checker.graph.select(place * lanes..(place + 1) * lanes, data.node);
    Ok(Data::new(node, element))
}

pub(super) fn first<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    element_at(checker, call, false)
}

pub(super) fn last<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    element_at(checker, call, true)
}

fn place_of<'a>(checker: &mut Checker<'a>, call: &Call<'a>, reduction: Reduction) -> Checked<Data> {
    let [x] = call.take(checker, ["list"])?;
    let (data, _, length) = list_of_numbers(checker, call, x)?;
    let node = checker.graph.reduce(reduction, length, data.node);
    Ok(Data::new(node, Type::Int))
}

pub(super) fn argmin<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    place_of(checker, call, Reduction::ArgMinimum)
}

pub(super) fn argmax<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    place_of(checker, call, Reduction::ArgMaximum)
}

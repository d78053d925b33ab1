//! Operators that remember. Their arguments are read before states are updated, wherever they stand.

use super::Call;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::types::Type;
use crate::check::value::{Data, Form};
use crate::diagnostics::codes;
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Memory, Unary};
use crate::syntax::tree::Expr;

/// Longest delay or hold, control steps.
const LONGEST: f64 = 100_000.0;

/// The argument of an operator: read in the step itself, also inside `observe`.
fn argument<'a>(checker: &mut Checker<'a>, expr: &'a Expr) -> Checked<Data> {
    let after = std::mem::replace(&mut checker.after, false);
    let data = checker.data(expr);
    checker.after = after;
    data
}

fn condition<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [c] = call.take(checker, ["c"])?;
    condition_at(checker, c)
}

fn condition_at<'a>(checker: &mut Checker<'a>, expr: &'a Expr) -> Checked<Data> {
    let after = std::mem::replace(&mut checker.after, false);
    let data = checker.condition(expr);
    checker.after = after;
    data
}

/// An operator that keeps the type of its argument.
fn keep<'a>(checker: &mut Checker<'a>, call: &Call<'a>, memory: Memory) -> Checked<Data> {
    let [x] = call.take(checker, ["x"])?;
    let data = argument(checker, x)?;
    let node = checker.graph.memory(memory, &[data.node]);
    Ok(Data { node, kind: data.kind, form: keep_form(data.form) })
}

fn keep_form(form: Form) -> Form {
    if form == Form::Wrapping { form } else { Form::Plain }
}

/// An operator that orders its argument's values.
fn order<'a>(checker: &mut Checker<'a>, call: &Call<'a>, memory: Memory) -> Checked<Data> {
    let [x] = call.take(checker, ["x"])?;
    let data = argument(checker, x)?;
    numbers(checker, call, x, &data)?;
    let node = checker.graph.memory(memory, &[data.node]);
    Ok(Data::new(node, data.kind))
}

fn numbers<'a>(checker: &mut Checker<'a>, call: &Call<'a>, expr: &'a Expr, data: &Data) -> Checked<Dimension> {
    match data.kind.element() {
        Type::Number(dimension) => Ok(*dimension),
        Type::Int => Ok(Dimension::NONE),
        _ => {
            let found = data.kind.described(checker.vocabulary);
            let message = format!("`{}` takes numbers", call.name);
            let diagnostic = checker.diagnostic(codes::types::WRONG_TYPE, expr.span, message).found(found);
            Err(checker.report(diagnostic))
        }
    }
}

fn interval(checker: &mut Checker<'_>) -> NodeId {
    let interval = checker.timing.interval;
    checker.graph.constant(interval)
}

pub(super) fn prev<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    keep(checker, call, Memory::Delay(1))
}

pub(super) fn initial<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    keep(checker, call, Memory::Initial)
}

pub(super) fn highest<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    order(checker, call, Memory::Highest)
}

pub(super) fn lowest<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    order(checker, call, Memory::Lowest)
}

pub(super) fn rate<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["x"])?;
    let data = argument(checker, x)?;
    let (dimension, element) = match data.kind.element() {
        Type::Number(dimension) => (*dimension, None),
        Type::Int => (Dimension::NONE, None),
        Type::Vector { size, dimension, frame } => (*dimension, Some((*size, *frame))),
        Type::Place(frame) => (Dimension::LENGTH, Some((3, *frame))),
        _ => return Err(numbers(checker, call, x, &data).err().unwrap_or_else(|| call.wrong_arguments(checker))),
    };
    let Some(dimension) = dimension.per(Dimension::TIME) else {
        return Err(checker.error(codes::types::POWER, x.span, "the unit of this rate is beyond reason"));
    };
    let before = checker.graph.memory(Memory::Delay(1), &[data.node]);
    let mut change = checker.graph.binary(Binary::Subtract, data.node, before);
    if data.form == Form::Wrapping {
        change = checker.graph.unary(Unary::Wrap, change);
    }
    let interval = interval(checker);
    let node = checker.graph.binary(Binary::Divide, change, interval);
    let kind = match element {
        Some((size, frame)) => Type::Vector { size, dimension, frame },
        None => Type::Number(dimension),
    };
    Ok(Data::new(node, data.kind.with_element(kind)))
}

pub(super) fn count<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let held = condition(checker, call)?;
    let node = checker.graph.memory(Memory::Accumulate, &[held.node]);
    Ok(Data::new(node, held.kind.with_element(Type::Int)))
}

/// c and not prev(c), or the reverse.
fn edge<'a>(checker: &mut Checker<'a>, call: &Call<'a>, rising: bool) -> Checked<Data> {
    let now = condition(checker, call)?;
    let before = checker.graph.memory(Memory::Delay(1), &[now.node]);
    let (yes, no) = if rising { (now.node, before) } else { (before, now.node) };
    let no = checker.graph.unary(Unary::Not, no);
    let node = checker.graph.binary(Binary::And, yes, no);
    Ok(Data::new(node, now.kind))
}

pub(super) fn rising<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    edge(checker, call, true)
}

pub(super) fn falling<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    edge(checker, call, false)
}

pub(super) fn hysteresis<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x, low, high] = call.take(checker, ["x", "low", "high"])?;
    let (value, bottom, top) = (argument(checker, x), argument(checker, low), argument(checker, high));
    let (value, bottom, top) = (value?, bottom?, top?);
    numbers(checker, call, x, &value)?;
    let (_, bottom, kind) = checker.agree("compare", (value.clone(), x), (bottom, low))?;
    let (value, top, _) = checker.agree("compare", (Data { kind, ..value }, x), (top, high))?;
    let width = checker.graph.width(value);
    let node = checker.graph.memory(Memory::Hysteresis, &[value, bottom, top]);
    Ok(Data::new(node, if width == 1 { Type::Bool } else { Type::List(Box::new(Type::Bool), width) }))
}

pub(super) fn once<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let held = condition(checker, call)?;
    let times = checker.graph.memory(Memory::Accumulate, &[held.node]);
    let one = checker.graph.constant(1.0);
    let first = checker.graph.binary(Binary::Equal, times, one);
    let node = checker.graph.binary(Binary::And, held.node, first);
    Ok(Data::new(node, held.kind))
}

pub(super) fn ever<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let held = condition(checker, call)?;
    let node = checker.graph.memory(Memory::Highest, &[held.node]);
    Ok(Data::new(node, held.kind))
}

pub(super) fn always<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let held = condition(checker, call)?;
    let node = checker.graph.memory(Memory::Lowest, &[held.node]);
    Ok(Data::new(node, held.kind))
}

pub(super) fn held<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [c, duration] = call.take(checker, ["c", "duration"])?;
    let (condition, steps) = (condition_at(checker, c), steps(checker, duration));
    let (condition, steps) = (condition?, steps?);
    let streak = checker.graph.memory(Memory::Streak, &[condition.node]);
    let limit = checker.graph.constant(steps);
    let node = checker.graph.binary(Binary::LessEqual, limit, streak);
    Ok(Data::new(node, condition.kind))
}

/// A count of control steps times their length.
fn as_time(checker: &mut Checker<'_>, steps: NodeId, kind: &Type) -> Data {
    let interval = interval(checker);
    let node = checker.graph.binary(Binary::Multiply, steps, interval);
    Data::new(node, kind.with_element(Type::Number(Dimension::TIME)))
}

pub(super) fn since<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let held = condition(checker, call)?;
    let steps = checker.graph.memory(Memory::StepsSince, &[held.node]);
    Ok(as_time(checker, steps, &held.kind))
}

pub(super) fn timer<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let held = condition(checker, call)?;
    let steps = checker.graph.memory(Memory::Streak, &[held.node]);
    Ok(as_time(checker, steps, &held.kind))
}

pub(super) fn smooth<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x, tau] = call.take(checker, ["x", "tau"])?;
    let (data, time) = (argument(checker, x), checker.number_of(tau, Dimension::TIME, "`smooth`'s time constant"));
    let (data, time) = (data?, time?);
    let Some(time) = checker.graph.constant_value(time.node).filter(|time| *time > 0.0) else {
        return Err(checker.error(
            codes::types::NOT_CONSTANT,
            tau.span,
            "the time constant must be known while compiling and positive",
        ));
    };
    if !matches!(data.kind.element(), Type::Number(_) | Type::Int | Type::Vector { .. } | Type::Place(_)) {
        numbers(checker, call, x, &data)?;
    }
    // The exact step response of a first-order low pass over one control step.
    let share = checker.graph.constant(-libm::expm1(-checker.timing.interval / time));
    let node = checker.graph.memory(Memory::Smooth, &[data.node, share]);
    let element = if *data.kind.element() == Type::Int { Type::PLAIN } else { data.kind.element().clone() };
    Ok(Data::new(node, data.kind.with_element(element)))
}

pub(super) fn integral<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x] = call.take(checker, ["x"])?;
    let data = argument(checker, x)?;
    let dimension = numbers(checker, call, x, &data)?;
    let Some(dimension) = dimension.times(Dimension::TIME) else {
        return Err(checker.error(codes::types::POWER, x.span, "the unit of this integral is beyond reason"));
    };
    let total = checker.graph.memory(Memory::Accumulate, &[data.node]);
    let interval = interval(checker);
    let node = checker.graph.binary(Binary::Multiply, total, interval);
    Ok(Data::new(node, data.kind.with_element(Type::Number(dimension))))
}

pub(super) fn sampled<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x, c] = call.take(checker, ["x", "c"])?;
    let after = std::mem::replace(&mut checker.after, false);
    let (data, when) = (checker.data(x), checker.single_condition(c));
    checker.after = after;
    let (data, when) = (data?, when?);
    let node = checker.graph.memory(Memory::Sampled, &[data.node, when.node]);
    Ok(Data { node, kind: data.kind, form: keep_form(data.form) })
}

pub(super) fn delay<'a>(checker: &mut Checker<'a>, call: &Call<'a>) -> Checked<Data> {
    let [x, duration] = call.take(checker, ["x", "duration"])?;
    let (data, steps) = (argument(checker, x), steps(checker, duration));
    let (data, steps) = (data?, steps?);
    if steps == 0.0 {
        return Ok(data);
    }
    checker.hold(steps as usize * checker.graph.width(data.node), duration.span)?;
    let node = checker.graph.memory(Memory::Delay(steps as u32), &[data.node]);
    Ok(Data { node, kind: data.kind, form: keep_form(data.form) })
}

fn steps<'a>(checker: &mut Checker<'a>, expr: &'a Expr) -> Checked<f64> {
    let steps = checker.steps(expr)?;
    if steps > LONGEST {
        let message = format!("this is longer than {LONGEST} control steps");
        return Err(checker.error(codes::types::DURATION, expr.span, message));
    }
    Ok(steps)
}

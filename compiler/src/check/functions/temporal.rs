//! Operators that remember. Their arguments are read before states are updated, wherever they stand.

use super::apply::Bound;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::diagnostics::codes;
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Memory, Unary};
use crate::syntax::tree::Expr;

/// Longest delay or hold, control steps.
const LONGEST: f64 = 100_000.0;

fn interval(checker: &mut Checker<'_>) -> NodeId {
    let interval = checker.timing.interval;
    checker.graph.constant(interval)
}

pub(super) fn rate<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [now] = bound.take();
    let before = checker.graph.memory(Memory::Delay(1), &[now]);
    let change = checker.graph.binary(Binary::Subtract, now, before);
    let change = checker.wrapped(change, &bound.subject);
    let interval = interval(checker);
    Ok(checker.graph.binary(Binary::Divide, change, interval))
}

/// c and not prev(c), or the reverse.
fn edge(checker: &mut Checker<'_>, now: NodeId, rising: bool) -> NodeId {
    let before = checker.graph.memory(Memory::Delay(1), &[now]);
    let (yes, no) = if rising { (now, before) } else { (before, now) };
    let no = checker.graph.unary(Unary::Not, no);
    checker.graph.binary(Binary::And, yes, no)
}

pub(super) fn rising<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(edge(checker, bound.nodes[0], true))
}

pub(super) fn falling<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    Ok(edge(checker, bound.nodes[0], false))
}

pub(super) fn once<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [held] = bound.take();
    let times = checker.graph.memory(Memory::Accumulate, &[held]);
    let one = checker.graph.constant(1.0);
    let first = checker.graph.binary(Binary::Equal, times, one);
    Ok(checker.graph.binary(Binary::And, held, first))
}

pub(super) fn held<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [condition, steps] = bound.take();
    let streak = checker.graph.memory(Memory::Streak, &[condition]);
    Ok(checker.graph.binary(Binary::LessEqual, steps, streak))
}

/// A count of control steps times their length.
fn as_time(checker: &mut Checker<'_>, steps: NodeId) -> NodeId {
    let interval = interval(checker);
    checker.graph.binary(Binary::Multiply, steps, interval)
}

pub(super) fn since<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let steps = checker.graph.memory(Memory::StepsSince, &bound.nodes);
    Ok(as_time(checker, steps))
}

pub(super) fn timer<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let steps = checker.graph.memory(Memory::Streak, &bound.nodes);
    Ok(as_time(checker, steps))
}

pub(super) fn smooth<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [x, time] = bound.take();
    let time = checker.graph.constant_value(time).unwrap_or(f64::INFINITY);
    // The exact step response of a first-order low pass over one control step.
    let share = checker.graph.constant(-libm::expm1(-checker.timing.interval / time));
    Ok(checker.by_wrapping(x, &bound.subject, |graph, x, wraps| {
        graph.memory(if wraps { Memory::SmoothAngle } else { Memory::Smooth }, &[x, share])
    }))
}

pub(super) fn integral<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let total = checker.graph.memory(Memory::Accumulate, &bound.nodes);
    let interval = interval(checker);
    Ok(checker.graph.binary(Binary::Multiply, total, interval))
}

pub(super) fn delay<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let [x, steps] = bound.take();
    let steps = checker.graph.constant_value(steps).unwrap_or(0.0);
    if steps == 0.0 {
        return Ok(x);
    }
    checker.hold(steps as usize * checker.graph.width(x), bound.exprs[1].span)?;
    Ok(checker.graph.memory(Memory::Delay(steps as u32), &[x]))
}

impl<'a> Checker<'a> {
    /// A duration in control steps, within what operators remember.
    pub(super) fn bounded_steps(&mut self, expr: &'a Expr) -> Checked<f64> {
        let steps = self.steps(expr)?;
        if steps > LONGEST {
            let message = format!("this is longer than {LONGEST} control steps");
            return Err(self.error(codes::types::DURATION, expr.span, message));
        }
        Ok(steps)
    }

    /// A positive time known while compiling, s.
    pub(super) fn time_constant(&mut self, expr: &'a Expr) -> Checked<f64> {
        let time = self.number_of(expr, Dimension::TIME, "`smooth`'s time constant")?;
        self.graph.constant_value(time.node).filter(|time| *time > 0.0).ok_or_else(|| {
            let message = "the time constant must be positive and a compile-time constant";
            self.error(codes::types::NOT_CONSTANT, expr.span, message)
        })
    }
}

//! Operators that remember. Their arguments are read before states are updated, wherever they stand.

use super::Arguments;
use super::layout::{by_wrapping, wrapped};
use crate::graph::operation::{Binary, Memory, Unary};
use crate::graph::{Graph, NodeId};

pub(crate) fn rate(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [now] = of.take();
    let before = graph.memory(Memory::Delay(1), &[now]);
    let change = graph.binary(Binary::Subtract, now, before);
    let change = wrapped(graph, change, &of.subject);
    let interval = graph.constant(of.interval);
    graph.binary(Binary::Divide, change, interval)
}

/// c and not prev(c), or the reverse.
fn edge(graph: &mut Graph, now: NodeId, rising: bool) -> NodeId {
    let before = graph.memory(Memory::Delay(1), &[now]);
    let (yes, no) = if rising { (now, before) } else { (before, now) };
    let no = graph.unary(Unary::Not, no);
    graph.binary(Binary::And, yes, no)
}

pub(crate) fn rising(graph: &mut Graph, of: &Arguments) -> NodeId {
    edge(graph, of.nodes[0], true)
}

pub(crate) fn falling(graph: &mut Graph, of: &Arguments) -> NodeId {
    edge(graph, of.nodes[0], false)
}

pub(crate) fn once(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [held] = of.take();
    let times = graph.memory(Memory::Accumulate, &[held]);
    let one = graph.constant(1.0);
    let first = graph.binary(Binary::Equal, times, one);
    graph.binary(Binary::And, held, first)
}

pub(crate) fn held(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [condition, steps] = of.take();
    let streak = graph.memory(Memory::Streak, &[condition]);
    graph.binary(Binary::LessEqual, steps, streak)
}

/// A count of control steps times their length.
fn as_time(graph: &mut Graph, steps: NodeId, of: &Arguments) -> NodeId {
    let interval = graph.constant(of.interval);
    graph.binary(Binary::Multiply, steps, interval)
}

pub(crate) fn since(graph: &mut Graph, of: &Arguments) -> NodeId {
    let steps = graph.memory(Memory::StepsSince, &of.nodes);
    as_time(graph, steps, of)
}

pub(crate) fn timer(graph: &mut Graph, of: &Arguments) -> NodeId {
    let steps = graph.memory(Memory::Streak, &of.nodes);
    as_time(graph, steps, of)
}

pub(crate) fn smooth(graph: &mut Graph, of: &Arguments) -> NodeId {
    let [x, time] = of.take();
    // The signature takes a constant; with none the value would stay what it was.
    let time = graph.constant_value(time).unwrap_or(f64::INFINITY);
    // The exact step response of a first-order low pass over one control step.
    let share = graph.constant(-libm::expm1(-of.interval / time));
    by_wrapping(graph, x, &of.subject, |graph, x, wraps| {
        graph.memory(if wraps { Memory::SmoothAngle } else { Memory::Smooth }, &[x, share])
    })
}

pub(crate) fn integral(graph: &mut Graph, of: &Arguments) -> NodeId {
    let total = graph.memory(Memory::Accumulate, &of.nodes);
    as_time(graph, total, of)
}

/// x as it was so many control steps ago.
pub(crate) fn delayed(graph: &mut Graph, x: NodeId, steps: u32) -> NodeId {
    if steps == 0 { x } else { graph.memory(Memory::Delay(steps), &[x]) }
}

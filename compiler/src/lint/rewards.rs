//! Lints on contributions: how much, how often, and what it costs to end.

use super::amount::Amount;
use super::at;
use crate::check::reward::RewardTerm;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::extremes::maximum;
use crate::frame::Sensor;
use crate::graph::events::is_event;
use crate::graph::interval::Bounds;
use crate::graph::operation::{Memory, Operation};
use crate::graph::{Graph, NodeId};
use crate::numbers::for_people;

/// How many times as much as all others a term may contribute.
const MOST: f64 = 100.0;
/// The share of the possible reward that costs may have, if ending early ends them.
const SMALL: f64 = 0.5;

/// Lints on the amounts of all terms.
pub(super) fn of(task: &CheckedTask<'_>, amounts: &[Amount], diagnostics: &mut Vec<Diagnostic>) {
    let ranges: Vec<Bounds> = amounts.iter().map(|amount| amount.contribution).collect();
    let size = |range: &Bounds| maximum(range.high.abs(), range.low.abs());
    for (index, term) in task.terms.iter().enumerate() {
        let others = || ranges.iter().enumerate().filter(move |(other, _)| *other != index).map(|(_, range)| range);
        let rest: f64 = others().map(size).sum();
        // An event contributes in one step, the others in all.
        let steps = if is_event(&task.graph, term.node) { f64::from(task.timing.horizon) } else { 1.0 };
        if rest > 0.0 && size(&ranges[index]) > MOST * rest * steps && size(&ranges[index]).is_finite() {
            let message =
                format!("the term `{}` can contribute more than {MOST} times as much as all others together", term.name);
            let diagnostic = at(codes::intent::OUTWEIGHS, term, message)
                .expected(format!("at most {MOST} times {}", for_people(rest)))
                .found(for_people(size(&ranges[index])))
                .help("the other terms have almost no effect; a weight that is also part of the formula is applied twice");
            diagnostics.push(diagnostic);
        }
        let gains: f64 = others().map(|range| maximum(range.high, 0.0)).sum();
        let lasting = ranges[index].high > 0.0 && lasts(&task.graph, term.node);
        if term.condition
            && (lasting || gains > 0.0 && ranges[index].high > gains)
            && !is_event(&task.graph, term.node)
            && !reads_ends(task, term)
        {
            let message = format!("the term `{}` contributes its whole weight at every step at which it holds", term.name);
            let diagnostic = at(codes::intent::REWARDED_EVERY_STEP, term, message);
            let diagnostic = match lasting {
                true => diagnostic.help("`ever` stays true: the reward is given at every later step"),
                false => diagnostic
                    .expected(format!("at most {} per step, as all others together", for_people(gains)))
                    .found(for_people(ranges[index].high)),
            };
            let diagnostic = diagnostic.help("reward an event once, `once(...)`, or each time that it starts, `rising(...)`");
            diagnostics.push(diagnostic);
        }
        if ranges[index].high == f64::INFINITY && jumps(&task.graph, term.node) {
            let message = format!("the term `{}` is unbounded in a signal that has peaks at contacts", term.name);
            let diagnostic = at(codes::intent::SPIKE, term, message)
                .help("bound it: `clip(x, 0, 1)`, `tanh(x)`, or use a speed or a height instead");
            diagnostics.push(diagnostic);
        }
    }
    ending(task, &ranges, diagnostics);
}

/// Whether a condition goes on holding once it has held: `ever(c)`.
fn lasts(graph: &Graph, node: NodeId) -> bool {
    graph.node(node).operation == Operation::Memory(Memory::Highest)
}

/// Where each step can cost and no term knows of the end, ending early can earn most.
fn ending(task: &CheckedTask<'_>, ranges: &[Bounds], diagnostics: &mut Vec<Diagnostic>) {
    // What is written as a cost; a rewarding term that may sink below zero is none.
    let charged = task.terms.iter().zip(ranges).filter(|(term, _)| term.weight < 0.0);
    let costs: f64 = charged.map(|(_, range)| maximum(-range.low, 0.0)).sum();
    let gains: f64 = ranges.iter().map(|range| maximum(range.high, 0.0)).sum();
    let Some(first) = task.terminations.first() else { return };
    if costs <= SMALL * gains || task.terms.iter().any(|term| reads_ends(task, term)) {
        return;
    }
    let message = format!("failing, for example by `{}`, costs nothing, although steps can cost", first.name);
    let diagnostic = Diagnostic::new(codes::intent::FREE_FAILURE, first.file, first.span, message)
        .help("a policy may learn to fail early: reward staying alive (`5 alive = not terminated`) or charge failing (`-100 failed = terminated`)");
    diagnostics.push(diagnostic);
}

/// Whether a term depends on how the episode ends.
fn reads_ends(task: &CheckedTask<'_>, term: &RewardTerm<'_>) -> bool {
    let read = task.graph.reachable([term.node]);
    task.terminations.iter().any(|end| read.contains(&end.node))
}

/// Whether a node reads what a contact makes jump within one step.
fn jumps(graph: &Graph, node: NodeId) -> bool {
    graph.reachable([node]).iter().any(|id| match &graph.node(*id).operation {
        Operation::Sensors(sensors) => sensors.iter().any(|sensor| {
            matches!(
                sensor,
                Sensor::LandmarkAcceleration(_)
                    | Sensor::JointAcceleration(_)
                    | Sensor::JointReactionForce(_)
                    | Sensor::JointReactionTorque(_)
                    | Sensor::ComAcceleration
                    | Sensor::GroundForce(_)
                    | Sensor::ContactForce(..)
            )
        }),
        _ => false,
    })
}

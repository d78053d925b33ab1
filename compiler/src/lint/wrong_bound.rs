//! Bounds on the wrong side: `max(x, 1)` where at most 1 was meant.

use super::growth::{GROWN, exponents};
use super::linear::Linear;
use super::{at, named_in, summands};
use crate::check::context::Checker;
use crate::check::reward::RewardTerm;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::extremes::{maximum, minimum};
use crate::graph::operation::{Binary, Operation, Unary};
use crate::graph::{Graph, NodeId};
use crate::hir::{Hir, Resolution};
use crate::numbers::for_people;

/// Terms that are bounded where they need no bound, and not where they do.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    for term in &task.terms {
        diagnostics.extend(constant_below(checker, task, term).or_else(|| grows(checker, task, term)));
    }
}

/// `max(x, 1)` of what goes on without bound: the same for all that is slow, and without bound for what is fast.
fn constant_below(checker: &Checker<'_>, task: &CheckedTask<'_>, term: &RewardTerm<'_>) -> Option<Diagnostic> {
    let graph = &task.graph;
    let summands = summands::of(task, term.node, term.weight);
    let (bound, name) = summands.iter().filter(|found| !found.bent && found.bounds[1].is_infinite()).find_map(|found| {
        let node = graph.node(found.node);
        if node.operation != Operation::Binary(Binary::Maximum) {
            return None;
        }
        let (bound, inner) = bounded(graph, found.node)?;
        let linear = Linear::of(graph, inner, 0)?;
        let (_, [_, open]) = linear.reach(checker.vocabulary)?;
        // A body at rest is below the bound, and the bound is no zero, which cuts a sign off.
        let [(measured, factor)] = linear.parts.as_slice() else { return None };
        let rests = bound > 0.0 && linear.offset < bound && open;
        let (name, unit, scale) = measured.described(checker.vocabulary);
        let met = measured.root((bound - linear.offset) / factor) * scale;
        let side = if *factor > 0.0 { "below" } else { "above" };
        rests.then(|| (bound, format!("{name} is {side} {}", format!("{} {unit}", for_people(met)).trim_end())))
    })?;
    let message = format!(
        "the bound of the term `{}` is on the wrong side: it is {} wherever {name}, and unbounded beyond",
        term.name,
        for_people(bound)
    );
    Some(exchanged(&task.hir, term, "max", "min", at(codes::exploits::WRONG_BOUND, term, message)))
}

/// `exp(-k * min(0, x))`: with the other bound it would not grow.
fn grows(checker: &Checker<'_>, task: &CheckedTask<'_>, term: &RewardTerm<'_>) -> Option<Diagnostic> {
    let graph = &task.graph;
    exponents(graph, term.node).into_iter().find_map(|exponent| {
        let (factor, node) = unscaled(graph, exponent);
        let (bound, inner) = bounded(graph, node)?;
        let (reach, _) = Linear::of(graph, inner, 0)?.reach(checker.vocabulary)?;
        let most = |lowest: bool| {
            let ends = [reach.low, reach.high].map(|end| if lowest { maximum(bound, end) } else { minimum(bound, end) });
            maximum(factor * ends[0], factor * ends[1])
        };
        let lowest = graph.node(node).operation == Operation::Binary(Binary::Maximum);
        if most(lowest) <= GROWN || most(!lowest) > 0.0 {
            return None;
        }
        let peak = for_people(libm::exp(most(lowest)));
        let message = format!("the bound of the term `{}` is on the wrong side: `exp` grows to {peak}", term.name);
        let (written, meant) = if lowest { ("max", "min") } else { ("min", "max") };
        Some(exchanged(&task.hir, term, written, meant, at(codes::exploits::WRONG_BOUND, term, message)))
    })
}

/// The constant of a bound, and what it bounds.
fn bounded(graph: &Graph, node: NodeId) -> Option<(f64, NodeId)> {
    let known = graph.node(node);
    let (Operation::Binary(Binary::Minimum | Binary::Maximum), [a, b]) = (&known.operation, known.inputs.as_slice()) else {
        return None;
    };
    match (graph.constant_value(*a), graph.constant_value(*b)) {
        (Some(bound), None) => Some((bound, *b)),
        (None, Some(bound)) => Some((bound, *a)),
        _ => None,
    }
}

/// A node without its constant factors, and their product.
fn unscaled(graph: &Graph, mut node: NodeId) -> (f64, NodeId) {
    let mut factor = 1.0;
    loop {
        let known = graph.node(node);
        let constant = |input: usize| known.inputs.get(input).and_then(|id| graph.constant_value(*id));
        match known.operation {
            Operation::Unary(Unary::Negate) => (factor, node) = (-factor, known.inputs[0]),
            Operation::Binary(Binary::Multiply) => match (constant(0), constant(1)) {
                (Some(by), _) => (factor, node) = (factor * by, known.inputs[1]),
                (_, Some(by)) => (factor, node) = (factor * by, known.inputs[0]),
                _ => return (factor, node),
            },
            Operation::Binary(Binary::Divide) => match constant(1) {
                Some(by) => (factor, node) = (factor / by, known.inputs[0]),
                None => return (factor, node),
            },
            _ => return (factor, node),
        }
    }
}

/// Offers the other bound, where a formula has only one of the kind.
fn exchanged(hir: &Hir, term: &RewardTerm<'_>, written: &'static str, meant: &'static str, diagnostic: Diagnostic) -> Diagnostic {
    let diagnostic = diagnostic.help("`min(x, 1)` is at most 1, `max(x, 1)` at least 1");
    let calls = named_in(hir, term, |to| matches!(to, Resolution::Function(name) if name == written));
    match calls.as_slice() {
        [(file, only)] if *file == term.file => diagnostic.suggest(format!("write `{meant}`"), *only, meant),
        _ => diagnostic,
    }
}

//! Lints: what compiles, but is probably not what was meant. Each can be allowed in place by its name.

use super::context::Checker;
use super::ranges::Working;
use super::reward::PaidTerm;
use super::scope::Definition;
use super::task::CheckedTask;
use crate::diagnostics::{Code, Diagnostic, codes};
use crate::graph::interval::{self, Bounds};
use crate::graph::operation::Operation;
use crate::graph::{Graph, NodeId};
use crate::syntax::tree::{BinaryOperator, Expr, ExprKind};
use std::collections::BTreeMap;

/// Names that a task declares and nothing reads.
pub(crate) fn unused(checker: &Checker<'_>, diagnostics: &mut Vec<Diagnostic>) {
    for (name, declared) in checker.names.of_task() {
        if !checker.used.contains(name) && !matches!(declared.definition, Definition::Observation(_)) {
            let span = declared.definition.span();
            let message = format!("nothing reads `{name}`");
            push(checker, "unused", Diagnostic::new(codes::lints::UNUSED, declared.file, span, message), diagnostics);
        }
    }
}

/// Lints on a task that compiles; the result is between which values each term stays.
pub(crate) fn task(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) -> Vec<Bounds> {
    let ranges = Working { vocabulary: checker.vocabulary, horizon: task.timing.horizon, interval: task.timing.interval };
    let bounds = interval::analyse(&task.graph, &ranges);
    for term in &task.terms {
        let found = interval::of_scalar(&bounds, term.node);
        constant_term(checker, term, found, diagnostics);
        doubled_sign(checker, term, found, diagnostics);
        factor_in_term(checker, term, diagnostics);
    }
    decided_ends(checker, task, &bounds, diagnostics);
    twice_observed(checker, task, diagnostics);
    unobserved(checker, task, diagnostics);
    task.terms.iter().map(|term| interval::of_scalar(&bounds, term.node)).collect()
}

fn push(checker: &Checker<'_>, lint: &str, diagnostic: Diagnostic, diagnostics: &mut Vec<Diagnostic>) {
    if !checker.allowed.contains(lint) {
        diagnostics.push(diagnostic);
    }
}

fn at(checker: &Checker<'_>, code: &'static Code, term: &PaidTerm<'_>, message: String) -> Diagnostic {
    Diagnostic::new(code, checker.task_place.file, term.formula.span, message)
}

/// A term that is the same at every step pays nothing for anything.
fn constant_term(checker: &Checker<'_>, term: &PaidTerm<'_>, bounds: Bounds, diagnostics: &mut Vec<Diagnostic>) {
    let Some(value) = bounds.single() else { return };
    let (lint, code) =
        if value == 0.0 { ("dead_term", codes::lints::DEAD_TERM) } else { ("constant_term", codes::lints::CONSTANT_TERM) };
    let message = format!("the term `{}` is {value} whatever the body does", term.name);
    let diagnostic =
        at(checker, code, term, message).help("what it reads cannot change it: look for a swapped side or a saturated bound");
    push(checker, lint, diagnostic, diagnostics);
}

/// A negative weight on a term that is never positive pays for what was to be a cost.
fn doubled_sign(checker: &Checker<'_>, term: &PaidTerm<'_>, bounds: Bounds, diagnostics: &mut Vec<Diagnostic>) {
    if term.weight < 0.0 && bounds.high <= 0.0 && bounds.low < 0.0 {
        let message = format!("the term `{}` is never positive and its weight is negative: the cost becomes pay", term.name);
        let diagnostic = at(checker, codes::lints::DOUBLED_SIGN, term, message).help("keep one of the two signs");
        push(checker, "doubled_sign", diagnostic, diagnostics);
    }
    if term.weight > 0.0 && bounds.high <= 0.0 && bounds.low < 0.0 {
        let message = format!("the term `{}` is never positive; its sign is hidden in the formula", term.name);
        let help = "write the formula positive and its weight negative, so that the column of weights tells what is a cost";
        push(checker, "hidden_sign", at(checker, codes::lints::HIDDEN_SIGN, term, message).help(help), diagnostics);
    }
}

/// `10 x = 0.5 * f`: the factor belongs in the weight.
fn factor_in_term(checker: &Checker<'_>, term: &PaidTerm<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let mut expr: &Expr = term.formula;
    loop {
        match &expr.kind {
            ExprKind::Paren(inner) => expr = inner,
            ExprKind::Binary { operator: BinaryOperator::Multiply | BinaryOperator::Divide, left, .. } => expr = left,
            ExprKind::Number(number) if number.unit.is_none() && !std::ptr::eq(expr, term.formula) => break,
            _ => return,
        }
    }
    let message = format!("the term `{}` begins with a plain factor", term.name);
    let diagnostic = Diagnostic::new(codes::lints::FACTOR_IN_TERM, checker.task_place.file, expr.span, message)
        .help("it belongs in the weight, where people and tuners look for it");
    push(checker, "factor_in_term", diagnostic, diagnostics);
}

/// Terminations and success that can never hold or never fail.
fn decided_ends(checker: &Checker<'_>, task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    let ends = task.terminations.iter().map(|(name, node)| (format!("the termination `{name}`"), *node));
    let success = std::iter::once(("success".to_owned(), task.success));
    for (what, node) in ends.chain(success) {
        if let Some(value) = interval::of_scalar(bounds, node).single() {
            let verdict = if value == 0.0 { "can never hold" } else { "always holds" };
            let span = span_of_end(checker, task, node);
            let diagnostic = Diagnostic::new(codes::lints::DECIDED, checker.task_place.file, span, format!("{what} {verdict}"))
                .help("the ranges of what it reads decide it; compare `msk explain`");
            push(checker, "decided", diagnostic, diagnostics);
        }
    }
}

fn span_of_end(checker: &Checker<'_>, task: &CheckedTask<'_>, node: NodeId) -> crate::diagnostics::Span {
    use crate::syntax::tree::{Entry, TaskStatement};
    let named = task.terminations.iter().find(|(_, own)| *own == node).map(|(name, _)| name);
    let reasons = checker.statements.iter().filter_map(|statement| match statement {
        TaskStatement::Terminate(ends) => Some(ends.reasons.iter()),
        _ => None,
    });
    let reason = reasons.flatten().find_map(|entry| match entry {
        Entry::Item(reason) if Some(&reason.name.text) == named => Some(reason.condition.span),
        _ => None,
    });
    let success = checker.statements.iter().find_map(|statement| match statement {
        TaskStatement::Success(expr) => Some(expr.span),
        _ => None,
    });
    reason.or(success).unwrap_or_default()
}

/// Two channels that carry the same numbers.
fn twice_observed(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let mut first: BTreeMap<NodeId, &str> = BTreeMap::new();
    for channel in &task.channels {
        if let Some(known) = first.insert(channel.node, &channel.name) {
            let message = format!("the channels `{known}` and `{}` carry the same numbers", channel.name);
            let diagnostic = Diagnostic::new(codes::lints::TWICE_OBSERVED, checker.task_place.file, channel.span, message);
            push(checker, "twice_observed", diagnostic, diagnostics);
        }
    }
}

/// Memory that the pay depends on and the policy cannot see.
fn unobserved(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let paid = states_read(&task.graph, task.terms.iter().map(|term| term.node).chain(task.updates.iter().copied()));
    let seen = states_read(&task.graph, task.channels.iter().map(|channel| channel.node));
    for index in paid.into_iter().filter(|index| !seen.contains(index)) {
        let Some(state) = task.states.get(index as usize) else { continue };
        let declared = checker.names.of_task().find(|(name, _)| *name == state.name).map(|(_, declared)| declared);
        let span = declared.map(|declared| declared.definition.span()).unwrap_or_default();
        let message = format!("the reward depends on the state `{}`, which the policy cannot observe", state.name);
        let diagnostic = Diagnostic::new(codes::lints::UNOBSERVED, checker.task_place.file, span, message)
            .help("add it to `observe`, or the same observation will be paid differently");
        push(checker, "unobserved", diagnostic, diagnostics);
    }
}

fn states_read(graph: &Graph, roots: impl Iterator<Item = NodeId>) -> Vec<u32> {
    let nodes = graph.reachable(roots);
    let states = nodes.iter().filter_map(|id| match graph.node(*id).operation {
        Operation::StateBefore(index) | Operation::StateAfter(index) => Some(index),
        _ => None,
    });
    let mut found: Vec<u32> = states.collect();
    found.sort_unstable();
    found.dedup();
    found
}

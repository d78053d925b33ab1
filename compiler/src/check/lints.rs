//! Lints: what compiles, but is probably not what was meant. Each can be allowed in place by its name.

use super::context::Checker;
use super::ranges::{Standing, Working};
use super::reward::PaidTerm;
use super::scope::Definition;
use super::task::CheckedTask;
use crate::diagnostics::{Code, Diagnostic, codes, nearest};
use crate::explain::short;
use crate::graph::interval::{self, Bounds};
use crate::graph::operation::Operation;
use crate::graph::{Graph, NodeId};
use crate::syntax::tree::{Allow, BinaryOperator, Expr, ExprKind};
use crate::task::RootPlacement;
use std::collections::{BTreeMap, BTreeSet};

/// Every lint by the name under which it is allowed.
const LINTS: [&str; 14] = [
    "constant_term",
    "dead_at_reset",
    "dead_term",
    "decided",
    "doubled_sign",
    "factor_in_term",
    "hidden_sign",
    "holds_at_reset",
    "identical",
    "idle_mass",
    "repeats_scene",
    "twice_observed",
    "unobserved",
    "unused",
];

impl<'a> Checker<'a> {
    /// The lint that an `allow` names; one that does not exist is an error, or the next slip would go unseen.
    pub(crate) fn lint(&mut self, allow: &'a Allow) -> Option<&'a str> {
        let name = allow.lint.text.as_str();
        if LINTS.contains(&name) {
            return Some(name);
        }
        let diagnostic = self.diagnostic(codes::tasks::UNKNOWN_SETTING, allow.lint.span, format!("there is no lint `{name}`"));
        let near = nearest(name, LINTS);
        let diagnostic = if near.is_empty() { diagnostic.help(format!("there is {}", LINTS.join(", "))) } else { diagnostic };
        let offer = |diagnostic: Diagnostic, name| diagnostic.suggest(format!("did you mean `{name}`?"), allow.lint.span, name);
        self.diagnostics.push(near.into_iter().fold(diagnostic, offer));
        None
    }

    /// Allows a lint in the whole task.
    pub(crate) fn allow(&mut self, allow: &'a Allow) {
        let name = self.lint(allow);
        self.allowed.extend(name.map(str::to_owned));
    }
}

/// Names that a task declares and nothing reads.
pub(crate) fn unused(checker: &Checker<'_>, diagnostics: &mut Vec<Diagnostic>) {
    checker.scene_lints(diagnostics);
    for (name, declared) in checker.names.of_task() {
        if !checker.used.contains(name) && !matches!(declared.definition, Definition::State(_)) {
            let span = declared.definition.span();
            let message = format!("nothing reads `{name}`");
            push(checker, "unused", Diagnostic::new(codes::lints::UNUSED, declared.file, span, message), diagnostics);
        }
    }
}

/// Lints on a task that compiles; the result is between which values each term stays.
pub(crate) fn task(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) -> Vec<Bounds> {
    let ranges = Working {
        vocabulary: checker.vocabulary,
        horizon: task.timing.horizon,
        interval: task.timing.interval,
        queries: &task.queries,
    };
    let bounds = interval::analyse(&task.graph, &ranges);
    for term in &task.terms {
        let found = interval::of_scalar(&bounds, term.node);
        constant_term(checker, term, found, diagnostics);
        doubled_sign(checker, term, found, diagnostics);
        factor_in_term(checker, term, diagnostics);
    }
    decided_ends(checker, task, &bounds, diagnostics);
    twice_observed(checker, task, diagnostics);
    states(checker, task, diagnostics);
    at_reset(checker, task, &bounds, diagnostics);
    task.terms.iter().map(|term| interval::of_scalar(&bounds, term.node)).collect()
}

fn push(checker: &Checker<'_>, lint: &str, diagnostic: Diagnostic, diagnostics: &mut Vec<Diagnostic>) {
    if !checker.allowed.contains(lint) {
        diagnostics.push(diagnostic);
    }
}

/// The same for a lint on a term, which may allow it for itself.
fn push_term(checker: &Checker<'_>, term: &PaidTerm<'_>, lint: &str, diagnostic: Diagnostic, diagnostics: &mut Vec<Diagnostic>) {
    if !term.allowed.contains(&lint) {
        push(checker, lint, diagnostic, diagnostics);
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
    push_term(checker, term, lint, diagnostic, diagnostics);
}

/// A negative weight on a term that is never positive pays for what was to be a cost.
fn doubled_sign(checker: &Checker<'_>, term: &PaidTerm<'_>, bounds: Bounds, diagnostics: &mut Vec<Diagnostic>) {
    if term.weight < 0.0 && bounds.high <= 0.0 && bounds.low < 0.0 {
        let message = format!("the term `{}` is never positive and its weight is negative: the cost becomes pay", term.name);
        let diagnostic = at(checker, codes::lints::DOUBLED_SIGN, term, message).help("keep one of the two signs");
        push_term(checker, term, "doubled_sign", diagnostic, diagnostics);
    }
    if term.weight > 0.0 && bounds.high <= 0.0 && bounds.low < 0.0 {
        let message = format!("the term `{}` is never positive; its sign is hidden in the formula", term.name);
        let help = "write the formula positive and its weight negative, so that the column of weights tells what is a cost";
        push_term(checker, term, "hidden_sign", at(checker, codes::lints::HIDDEN_SIGN, term, message).help(help), diagnostics);
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
    push_term(checker, term, "factor_in_term", diagnostic, diagnostics);
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

/// What holds in the very first snapshot, where the task begins in the standing pose: ends that hold there, and paid terms
/// that pay less than a twentieth of what they can.
fn at_reset(checker: &Checker<'_>, task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    let standing = checker.vocabulary.joints.iter().filter(|joint| !joint.of_scene).map(|joint| joint.neutral);
    let own =
        task.init.coordinates.iter().copied().take(checker.vocabulary.joints.iter().filter(|joint| !joint.of_scene).count());
    let level = task.scene.ground.is_some() && !task.scene.objects.iter().any(|object| object.surface.walkable);
    if !own.eq(standing) || task.init.root != RootPlacement::default() || task.init.settle.is_some() || !level {
        return;
    }
    let reset = interval::analyse(&task.graph, &Standing { vocabulary: checker.vocabulary, reset: true });
    let ends = task.terminations.iter().map(|(name, node)| (format!("the termination `{name}`"), *node));
    for (what, node) in ends.chain(std::iter::once(("success".to_owned(), task.success))) {
        let decided = interval::of_scalar(bounds, node).single().is_some();
        if interval::of_scalar(&reset, node).single() == Some(1.0) && !decided {
            let span = span_of_end(checker, task, node);
            let message = format!("{what} holds before anything has happened, in the pose in which the task begins");
            let diagnostic = Diagnostic::new(codes::lints::HOLDS_AT_RESET, checker.task_place.file, span, message);
            push(checker, "holds_at_reset", diagnostic, diagnostics);
        }
    }
    for term in &task.terms {
        let (range, start) = (interval::of_scalar(bounds, term.node), interval::of_scalar(&reset, term.node));
        let Some(value) = start.single().filter(|_| term.weight > 0.0 && range.single().is_none()) else { continue };
        if range.low >= 0.0 && range.high.is_finite() && value < 0.05 * range.high && !gated(term.formula) {
            let message = format!("the term `{}` pays almost nothing in the pose in which the task begins", term.name);
            let diagnostic = at(checker, codes::lints::DEAD_AT_RESET, term, message)
                .expected(format!("more than a twentieth of its highest value, {}", short(range.high)))
                .found(short(value))
                .help("look for a wrong axis, side or sign; if it is to be earned later, say `allow dead_at_reset \"...\"`");
            push_term(checker, term, "dead_at_reset", diagnostic, diagnostics);
        }
    }
}

/// Whether a formula says itself that it does not always pay.
fn gated(formula: &Expr) -> bool {
    match &formula.kind {
        ExprKind::When { .. } | ExprKind::If { .. } | ExprKind::Compare { .. } | ExprKind::EndedBy(_) => true,
        ExprKind::Paren(inner) => gated(inner),
        ExprKind::Call { function, .. } => {
            matches!(&function.kind, ExprKind::Name(name) if matches!(name.text.as_str(), "once" | "rising" | "ever" | "held"))
        }
        _ => false,
    }
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

/// States that nothing reads, and states that the pay depends on and the policy cannot see.
fn states(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let terms = || task.terms.iter().map(|term| term.node);
    let channels = || task.channels.iter().map(|channel| channel.node);
    let ends = task.terminations.iter().map(|(_, node)| *node).chain([task.success]);
    let paid = states_behind(task, terms());
    let seen = states_behind(task, channels());
    let read = states_behind(task, terms().chain(channels()).chain(ends));
    for (index, state) in task.states.iter().enumerate() {
        let index = u32::try_from(index).unwrap_or(u32::MAX);
        let declared = checker.names.of_task().find(|(name, _)| *name == state.name).map(|(_, declared)| declared);
        let span = declared.map(|declared| declared.definition.span()).unwrap_or_default();
        let file = checker.task_place.file;
        if !read.contains(&index) {
            let message = format!("nothing reads `{}`", state.name);
            push(checker, "unused", Diagnostic::new(codes::lints::UNUSED, file, span, message), diagnostics);
        } else if paid.contains(&index) && !seen.contains(&index) {
            let message = format!("the reward depends on the state `{}`, which the policy cannot observe", state.name);
            let diagnostic = Diagnostic::new(codes::lints::UNOBSERVED, file, span, message)
                .help("add it to `observe`, or the same observation will be paid differently");
            push(checker, "unobserved", diagnostic, diagnostics);
        }
    }
}

/// The states that nodes read, directly or through the updates of other states.
fn states_behind(task: &CheckedTask<'_>, roots: impl Iterator<Item = NodeId>) -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    let mut pending = states_read(&task.graph, roots);
    while let Some(index) = pending.pop() {
        if found.insert(index) {
            pending.extend(states_read(&task.graph, task.updates.get(index as usize).copied().into_iter()));
        }
    }
    found
}

fn states_read(graph: &Graph, roots: impl Iterator<Item = NodeId>) -> Vec<u32> {
    let nodes = graph.reachable(roots);
    let states = nodes.iter().filter_map(|id| match graph.node(*id).operation {
        Operation::StateBefore(index) | Operation::StateAfter(index) => Some(index),
        _ => None,
    });
    states.collect()
}

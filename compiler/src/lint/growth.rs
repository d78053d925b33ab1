//! Exponentials that grow: without bound, or on one side of a target that was to be met.

use super::at;
use super::linear::{Linear, Measured};
use crate::check::context::Checker;
use crate::check::reward::RewardTerm;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::graph::interval::{self, Bounds};
use crate::graph::operation::{Binary, Memory, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use crate::numbers::for_people;
use crate::syntax::tree::walk::{Visitor, walk_expression};
use crate::syntax::tree::{BinaryOperator, Expr, ExprKind};
use std::collections::BTreeSet;

/// The exponent from which on an exponential counts as more than the 1 that it has at its target.
pub(super) const GROWN: f64 = 0.3;

/// Lints on exponentials in terms.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    for term in &task.terms {
        let found = exponents(&task.graph, term.node)
            .into_iter()
            .filter(|&exponent| interval::of_scalar(bounds, exponent).high > GROWN)
            .find_map(|exponent| grown(checker, &task.graph, term, exponent));
        match found {
            Some(diagnostic) => diagnostics.push(diagnostic),
            None => one_sided_cost(checker, &task.graph, term, diagnostics),
        }
    }
}

/// The exponents that a value follows wherever they go: those of what is bounded, compared or put into a logarithm are left out.
pub(super) fn exponents(graph: &Graph, root: NodeId) -> Vec<NodeId> {
    let (mut pending, mut seen, mut found) = (vec![root], BTreeSet::new(), Vec::new());
    while let Some(id) = pending.pop() {
        if !seen.insert(id) {
            continue;
        }
        let node = graph.node(id);
        match &node.operation {
            Operation::Unary(Unary::Exponential) => found.push(node.inputs[0]),
            Operation::Binary(Binary::Divide) => pending.push(node.inputs[0]),
            Operation::Choose => pending.extend(&node.inputs[1..]),
            Operation::Unary(Unary::Negate | Unary::Absolute)
            | Operation::Binary(Binary::Add | Binary::Subtract | Binary::Multiply)
            | Operation::Select(_)
            | Operation::Join
            | Operation::Reduce(Reduction::Sum | Reduction::Norm | Reduction::Product, _)
            | Operation::Memory(Memory::Smooth | Memory::Highest | Memory::Delay(_)) => pending.extend(&node.inputs),
            _ => {}
        }
    }
    found
}

/// What is wrong with an exponential, if its exponent is seen to grow.
fn grown(checker: &Checker<'_>, graph: &Graph, term: &RewardTerm<'_>, exponent: NodeId) -> Option<Diagnostic> {
    let linear = Linear::of(graph, exponent, 0)?;
    let (reach, [_, open]) = linear.reach(checker.vocabulary)?;
    if reach.high <= GROWN {
        return None;
    }
    // The part that makes it grow most, where it does so.
    let growth = |(measured, factor): &(Measured, f64)| {
        let of = measured.reach(checker.vocabulary)?;
        let at = if *factor > 0.0 { of.bounds.high } else { of.bounds.low };
        Some((*measured, *factor, at, of.open))
    };
    let grows = linear.parts.iter().filter_map(growth).filter(|part| !open || part.3);
    let (measured, _, end, _) = grows.max_by(|a, b| (a.1 * a.2).total_cmp(&(b.1 * b.2)))?;
    let (name, unit, scale) = measured.described(checker.vocabulary);
    let shown = |value: f64| format!("{} {unit}", for_people(value * scale)).trim_end().to_owned();
    let peak = for_people(libm::exp(reach.high));
    let size = matches!(measured, Measured::Size { .. });
    if open {
        let message = format!(
            "the term `{}` grows without bound: `exp` is {peak} where {name} is {}",
            term.name,
            shown(measured.root(end))
        );
        let diagnostic = at(codes::incentive::RUNAWAY, term, message);
        return Some(match sign(term) {
            Some((span, written)) if size => diagnostic
                .help("an `exp` that rewards small values has a negative exponent")
                .suggest(format!("write `-{written}`"), span, format!("-{written}")),
            _ => diagnostic.help(
                "a fall reaches 4 m/s: charge both signs, `exp(-k * abs(x))`, or bound the term, `clip(x, 0, 1)`, `tanh(x)`",
            ),
        });
    }
    let [(_, only)] = linear.parts.as_slice() else { return None };
    let target = -linear.offset / only;
    // Without a target it is no error.
    if size || linear.offset == 0.0 || reach.low >= -GROWN {
        return None;
    }
    let message = format!(
        "the term `{}` rewards one side of an error: 1 where {name} is {}, {peak} where it is {}",
        term.name,
        shown(target),
        shown(end)
    );
    let help = "use the absolute value of an error, `abs(x)`, or its square; to ignore one side, use `max(0, x)`";
    Some(at(codes::incentive::SIGNED_ERROR, term, message).help(help))
}

/// The number that begins the only exponent of a formula, where a sign may be missing.
fn sign(term: &RewardTerm<'_>) -> Option<(Span, String)> {
    let mut exponents = Exponents(Vec::new());
    exponents.expression(term.formula);
    let [argument] = exponents.0.as_slice() else { return None };
    let mut expr: &Expr = argument;
    loop {
        match &expr.kind {
            ExprKind::Binary { operator: BinaryOperator::Multiply | BinaryOperator::Divide, left, .. } => expr = left,
            ExprKind::Number(number) => {
                let unit = number.unit.as_ref().map_or(String::new(), |unit| format!(" {}", unit.text));
                return Some((expr.span, format!("{}{unit}", crate::numbers::exact(number.value))));
            }
            _ => return None,
        }
    }
}

/// What stands in `exp(...)` in a formula.
struct Exponents<'a>(Vec<&'a Expr>);

impl<'a> Visitor<'a> for Exponents<'a> {
    fn expression(&mut self, expression: &'a Expr) {
        if let ExprKind::Call { function, arguments } = &expression.kind
            && let ExprKind::Name(name) = &function.kind
            && name.text == "exp"
        {
            self.0.extend(arguments.first().map(|argument| &argument.value));
        }
        walk_expression(self, expression);
    }
}

/// A cost that is an error with its sign, and so is rewarded on one side of the target.
fn one_sided_cost(checker: &Checker<'_>, graph: &Graph, term: &RewardTerm<'_>, diagnostics: &mut Vec<Diagnostic>) {
    if term.weight >= 0.0 {
        return;
    }
    let Some(linear) = Linear::of(graph, term.node, 0) else { return };
    let [(measured @ Measured::Lane(..), factor)] = linear.parts.as_slice() else { return };
    let Some(reach) = measured.reach(checker.vocabulary) else { return };
    let target = -linear.offset / factor;
    let within = |part: f64| reach.bounds.low + part * (reach.bounds.high - reach.bounds.low);
    // Without a target it is a direction, which may well be unwanted as such.
    if linear.offset == 0.0 || !(within(0.1)..within(0.9)).contains(&target) {
        return;
    }
    let (name, unit, scale) = measured.described(checker.vocabulary);
    let shown = |value: f64| format!("{} {unit}", for_people(value * scale)).trim_end().to_owned();
    let side = if *factor > 0.0 { "below" } else { "above" };
    let message =
        format!("the cost `{}` rewards one side of an error: it is negative where {name} is {side} {}", term.name, shown(target));
    let help = "use the absolute value of an error, `abs(x)`, or its square; to ignore one side, use `max(0, x)`";
    diagnostics.push(at(codes::incentive::SIGNED_ERROR, term, message).help(help));
}

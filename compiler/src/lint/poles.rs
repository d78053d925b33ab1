//! Divisions, logarithms and powers that reach what they have no finite value for.

use super::at;
use super::linear::{Linear, Measured};
use crate::check::context::Checker;
use crate::check::reward::RewardTerm;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::interval::{self, Bounds};
use crate::graph::operation::{Binary, Memory, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use std::collections::BTreeSet;

/// Lints on terms that are infinite or no number somewhere within reach.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    for term in &task.terms {
        diagnostics.extend(pole(checker, &task.graph, bounds, term));
    }
}

/// Where a formula leaves the numbers.
enum Pole {
    /// A divisor that is zero.
    Divisor,
    /// A logarithm of zero or less.
    Logarithm,
    /// A root or a broken power of what is negative.
    Root,
    /// A negative power of zero.
    Power,
}

fn pole(checker: &Checker<'_>, graph: &Graph, bounds: &[Vec<Bounds>], term: &RewardTerm<'_>) -> Option<Diagnostic> {
    // Each with whether a bound keeps it finite.
    let (mut pending, mut seen) = (vec![(term.node, false)], BTreeSet::new());
    while let Some((id, bounded)) = pending.pop() {
        if !seen.insert((id, bounded)) {
            continue;
        }
        let node = graph.node(id);
        let found = match node.operation {
            Operation::Binary(Binary::Divide) => Some((Pole::Divisor, node.inputs[1], 0.0)),
            Operation::Unary(Unary::Logarithm) => Some((Pole::Logarithm, node.inputs[0], 0.0)),
            Operation::Unary(Unary::SquareRoot) => Some((Pole::Root, node.inputs[0], f64::MIN_POSITIVE)),
            Operation::Binary(Binary::Power) => match graph.constant_value(node.inputs[1]) {
                Some(power) if power < 0.0 => Some((Pole::Power, node.inputs[0], 0.0)),
                Some(power) if power.fract() != 0.0 => Some((Pole::Root, node.inputs[0], f64::MIN_POSITIVE)),
                _ => None,
            },
            _ => None,
        };
        if let Some((pole, of, margin)) = found
            && let Some((measured, reach)) = met(checker, graph, bounds, of)
        {
            let zero = reach.low <= 0.0 && reach.high >= 0.0;
            let meets = match pole {
                // Bounded, it jumps from one bound to the other where the divisor changes its sign.
                Pole::Divisor if bounded => reach.low < 0.0 && reach.high > 0.0,
                Pole::Divisor | Pole::Power if !bounded => zero,
                Pole::Divisor | Pole::Power => false,
                Pole::Logarithm | Pole::Root => reach.low <= -margin,
            };
            if meets {
                return Some(described(checker, term, &pole, measured));
            }
        }
        match node.operation {
            // What stands behind a condition may well be guarded by it.
            Operation::Unary(Unary::Negate | Unary::Absolute | Unary::SquareRoot | Unary::Logarithm)
            | Operation::Binary(Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide | Binary::Power)
            | Operation::Select(_)
            | Operation::Join
            | Operation::Reduce(Reduction::Sum | Reduction::Norm | Reduction::Product, _)
            | Operation::Memory(Memory::Smooth | Memory::Highest | Memory::Lowest | Memory::Delay(_)) => {
                pending.extend(node.inputs.iter().map(|input| (*input, bounded)));
            }
            Operation::Unary(Unary::HyperbolicTangent) | Operation::Binary(Binary::Minimum | Binary::Maximum) => {
                pending.extend(node.inputs.iter().map(|input| (*input, true)));
            }
            _ => {}
        }
    }
    None
}

/// What a node measures and between which values that is met, where its bounds do not keep it from zero.
fn met(checker: &Checker<'_>, graph: &Graph, bounds: &[Vec<Bounds>], node: NodeId) -> Option<(Measured, Bounds)> {
    if interval::of_scalar(bounds, node).low > 0.0 || interval::of_scalar(bounds, node).high < 0.0 {
        return None;
    }
    let linear = Linear::of(graph, node, 0)?;
    let (measured, _) = linear.parts.first()?;
    Some((*measured, linear.reach(checker.vocabulary)?.0))
}

fn described(checker: &Checker<'_>, term: &RewardTerm<'_>, pole: &Pole, measured: Measured) -> Diagnostic {
    let (name, ..) = measured.described(checker.vocabulary);
    let (what, help) = match pole {
        Pole::Divisor => (
            "has a divisor that can be 0",
            "keep the divisor away from 0, as in `x / max(y, 0.1 m/s)` or `x / (abs(y) + 0.1 m/s)`",
        ),
        Pole::Logarithm => {
            ("has a logarithm whose argument can be 0 or less", "keep the argument away from 0, as in `log(0.01 + x)`")
        }
        Pole::Root => {
            ("has a root whose argument can be negative", "keep the argument non-negative: `sqrt(max(0, x))`, `sqrt(abs(x))`")
        }
        Pole::Power => ("has a negative power whose base can be 0", "keep the base away from 0, as in `max(x, 0.1)^-1`"),
    };
    let message = format!("the term `{}` {what}: it reads {name}", term.name);
    at(codes::incentive::POLE, term, message)
        .help(help)
        .help("a value that is not finite ends the episode in a fault; one that is nearly infinite dominates all others")
}

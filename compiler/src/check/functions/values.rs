//! Calls of which type checking looks at the values of arguments, not only at their types.

use super::apply::Bound;
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::check::ranges::{NeutralRange, Shaken};
use crate::diagnostics::codes;
use crate::emit::temporal;
use crate::graph::operation::Unary;
use crate::graph::{NodeId, interval};
use crate::syntax::tree::Expr;

/// Longest delay or hold, control steps.
const LONGEST: f64 = 100_000.0;

/// An absolute value, which may hide a sign that tells something.
pub(super) fn abs<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let x = bound.arguments.nodes[0];
    checker.warn_folded(x, bound.span);
    checker.warn_cancelling(x, bound.span);
    Ok(checker.graph.unary(Unary::Absolute, x))
}

/// The numbers of the standing pose.
pub(super) fn neutral<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let standing = NeutralRange { vocabulary: checker.vocabulary, reset: false, shaken: Shaken::default() };
    let known = interval::analyse_for(&checker.graph, bound.arguments.nodes[0], &standing);
    let lanes: Option<Vec<f64>> = known.iter().map(|bounds| bounds.single()).collect();
    let Some(lanes) = lanes else {
        let diagnostic = checker
            .diagnostic(codes::types::NOT_CONSTANT, bound.exprs[0].span, "the standing pose does not determine this value")
            .help("places, axes, joint coordinates and velocities are known in the standing pose; forces and muscle lengths are not");
        return Err(checker.report(diagnostic));
    };
    Ok(checker.graph.constants(&lanes))
}

/// A delay, for which there must be room.
pub(super) fn delay<'a>(checker: &mut Checker<'a>, bound: &Bound<'a>) -> Checked<NodeId> {
    let x = bound.arguments.nodes[0];
    // Its signature takes a whole number of steps, at most the longest.
    let steps = checker.graph.constant_value(bound.arguments.nodes[1]).unwrap_or(0.0) as u32;
    checker.hold(steps as usize * checker.graph.width(x), bound.exprs[1].span)?;
    Ok(temporal::delayed(&mut checker.graph, x, steps))
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

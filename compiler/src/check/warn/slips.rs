//! Formulas that compute something, but hardly what was meant: targets out of reach, errors that cancel, conditions that decide
//! each other.

use crate::check::context::Checker;
use crate::check::observe::spoken_unit;
use crate::diagnostics::{Span, codes};
use crate::frame::Sensor;
use crate::graph::operation::{Binary, Operation, Reduction};
use crate::graph::{Graph, NodeId};
use crate::hir::types::Type;
use crate::quantity::dimension::Dimension;
use crate::spoken::SpokenUnit;
use crate::syntax::tree::Expr;

impl Checker<'_> {
    /// Warns of the difference between joints and a number that none of them ever has.
    pub(crate) fn warn_beyond_range(&mut self, [a, b]: [NodeId; 2], subtract: bool, ty: &Type, written: [&Expr; 2]) {
        let sides = [(a, b), (b, a)].into_iter().find_map(|(joints, number)| {
            let Operation::Sensors(sensors) = &self.graph.node(joints).operation else { return None };
            Some((sensors.clone(), self.graph.constant_value(number)?))
        });
        let Some((sensors, number)) = sides.filter(|(_, number)| *number != 0.0) else { return };
        let target = if subtract { number } else { -number };
        let mut ranges = sensors.iter().map(|sensor| match sensor {
            Sensor::JointPosition(joint) => {
                self.vocabulary.joints.get(*joint).and_then(|joint| Some((&joint.name, joint.range?)))
            }
            _ => None,
        });
        let Some(Some((name, [low, high]))) = ranges.next() else { return };
        let beyond = |[low, high]: [f64; 2]| target < low - 1e-9 || target > high + 1e-9;
        if !beyond([low, high]) || !ranges.all(|joint| joint.is_some_and(|(_, range)| beyond(range))) {
            return;
        }
        let (range, found) = spoken_unit(ty, written).tell_beside([low, high], target);
        let message = format!("`{name}` never reaches {found}");
        let span = written[0].span.to(written[1].span);
        let diagnostic = self.diagnostic(codes::slips::BEYOND_RANGE, span, message).expected(range).found(found);
        let people = SpokenUnit::of(ty.dimension().unwrap_or(Dimension::NONE));
        let diagnostic = match people.tell_beside([low, high], target).0 {
            shown if diagnostic.expected.as_ref() == Some(&shown) => diagnostic,
            shown => diagnostic.help(format!("its range is {shown}")),
        };
        self.diagnostics.push(diagnostic.help("check the sign, and degrees written as radians"));
    }

    /// Warns of a sum or mean of several errors of which only the size is taken.
    pub(crate) fn warn_cancelling(&mut self, node: NodeId, span: Span) {
        if !sums_errors(&self.graph, node) {
            return;
        }
        let message = "errors of opposite sign cancel before the absolute value or square is taken";
        let diagnostic = self
            .diagnostic(codes::slips::ERRORS_CANCEL, span, message)
            .help("take it of each error first: `mean((x - target)^2)`, `mean(abs(x - target))`");
        self.diagnostics.push(diagnostic);
    }

    /// Warns of two comparisons of one number that decide each other: `x > 1 or x < 2`, `x > 2 and x < 1`.
    pub(crate) fn warn_decided(&mut self, function: Binary, sides: [NodeId; 2], span: Span) {
        let [Some((x, first)), Some((y, second))] = sides.map(|side| bound(&self.graph, side)) else { return };
        let (Some(low), Some(high)) = (first.above.or(second.above), first.below.or(second.below)) else { return };
        if x != y {
            return;
        }
        let verdict = match function {
            Binary::Or if low < high => "always holds: every number is above the one or below the other",
            Binary::And if low > high => "can never hold: no number is above the one and below the other",
            _ => return,
        };
        let instead = if function == Binary::Or { "`and`" } else { "`or`" };
        let diagnostic = self.diagnostic(codes::lints::DECIDED, span, format!("this {verdict}"));
        self.diagnostics.push(diagnostic.help(format!("did you mean {instead}, or is a comparison inverted?")));
    }
}

/// Between what a comparison of a number keeps that number.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Kept {
    above: Option<f64>,
    below: Option<f64>,
}

/// Which node a condition compares with a number, and how.
fn bound(graph: &Graph, condition: NodeId) -> Option<(NodeId, Kept)> {
    let node = graph.node(condition);
    let (Operation::Binary(Binary::Less | Binary::LessEqual), [left, right]) = (&node.operation, node.inputs.as_slice()) else {
        return None;
    };
    match (graph.constant_value(*left), graph.constant_value(*right)) {
        (Some(above), None) => Some((*right, Kept { above: Some(above), below: None })),
        (None, Some(below)) => Some((*left, Kept { above: None, below: Some(below) })),
        _ => None,
    }
}

/// Whether a node is the sum or the mean of several differences from a number.
fn sums_errors(graph: &Graph, node: NodeId) -> bool {
    let known = graph.node(node);
    match (&known.operation, known.inputs.as_slice()) {
        (Operation::Binary(Binary::Divide), [sum, count]) => graph.constant_value(*count).is_some() && sums_errors(graph, *sum),
        (Operation::Reduce(Reduction::Sum, _), [list]) => {
            let list = graph.node(*list);
            let several = list.width > 1 && list.operation == Operation::Binary(Binary::Subtract);
            several && list.inputs.get(1).is_some_and(|&number| graph.constant_value(number).is_some())
        }
        _ => false,
    }
}

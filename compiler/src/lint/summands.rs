//! What a term adds up, followed from its value down to what is measured: through sums, constant factors, bounds, branches and
//! functions that rise, but not into products of what varies, which weigh and gate rather than earn.

use crate::check::task::CheckedTask;
use crate::extremes::{maximum, minimum};
use crate::graph::events::is_event;
use crate::graph::operation::{Binary, Memory, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use std::collections::BTreeSet;

/// Nodes of one term that are looked at.
const MOST: usize = 512;

/// A node that a term adds up, itself or something computed from it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Summand {
    pub node: NodeId,
    /// By which factor it counts in the contribution of the term; only the sign means something where `bent` is set.
    pub factor: f64,
    /// Below and above which values of the node nothing changes.
    pub bounds: [f64; 2],
    /// Whether a function stands between that is no constant factor.
    pub bent: bool,
}

impl Summand {
    fn part(self, node: NodeId) -> Self {
        Self { node, ..self }
    }

    /// What is added to something else, whose bounds do not describe it alone.
    fn unbounded(self, node: NodeId, factor: f64) -> Self {
        Self { node, factor, bounds: OPEN, ..self }
    }

    /// Of what is multiplied by a constant.
    fn scaled(self, node: NodeId, by: f64) -> Self {
        let [a, b] = self.bounds.map(|bound| bound / by);
        Self { node, factor: self.factor * by, bounds: [minimum(a, b), maximum(a, b)], ..self }
    }

    fn bent(self, node: NodeId) -> Self {
        Self { node, bounds: OPEN, bent: true, ..self }
    }
}

const OPEN: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// All summands of a value that is weighted by `weight`, the value itself first.
pub(super) fn of(task: &CheckedTask<'_>, root: NodeId, weight: f64) -> Vec<Summand> {
    let graph = &task.graph;
    let ends: BTreeSet<NodeId> = task.terminations.iter().chain(&task.finishes).map(|end| end.node).collect();
    let mut pending = vec![Summand { node: root, factor: weight, bounds: OPEN, bent: false }];
    let mut found: Vec<Summand> = Vec::new();
    while let Some(summand) = pending.pop().filter(|_| found.len() < MOST) {
        found.push(summand);
        let node = graph.node(summand.node);
        let constant = |input: NodeId| graph.constant_value(input).filter(|value| *value != 0.0);
        match (&node.operation, node.inputs.as_slice()) {
            (Operation::Unary(Unary::Negate), [inner]) => pending.push(summand.scaled(*inner, -1.0)),
            (Operation::Unary(function), [inner]) if rises(*function) => pending.push(summand.bent(*inner)),
            (Operation::Binary(Binary::Add), [a, b]) => {
                pending.extend([*a, *b].map(|part| summand.unbounded(part, summand.factor)));
            }
            (Operation::Binary(Binary::Subtract), [a, b]) if !is_change(graph, *a, *b) => {
                pending.extend([(*a, 1.0), (*b, -1.0)].map(|(part, sign)| summand.unbounded(part, sign * summand.factor)));
            }
            (Operation::Binary(Binary::Multiply), [a, b]) => match (constant(*a), constant(*b)) {
                (Some(by), _) => pending.push(summand.scaled(*b, by)),
                (_, Some(by)) => pending.push(summand.scaled(*a, by)),
                _ => {}
            },
            (Operation::Binary(Binary::Divide), [a, b]) => {
                pending.extend(constant(*b).map(|by| summand.scaled(*a, 1.0 / by)));
            }
            (Operation::Binary(function @ (Binary::Minimum | Binary::Maximum)), [a, b]) => {
                let bounded = |inner: NodeId, by: f64| {
                    let [low, high] = summand.bounds;
                    let lowest = function == &Binary::Maximum;
                    let bounds = if lowest { [maximum(low, by), high] } else { [low, minimum(high, by)] };
                    Summand { node: inner, bounds, ..summand }
                };
                match (graph.constant_value(*a), graph.constant_value(*b)) {
                    (Some(by), _) => pending.push(bounded(*b, by)),
                    (_, Some(by)) => pending.push(bounded(*a, by)),
                    _ => {}
                }
            }
            // What holds at single steps, or where the episode ends, is rewarded once.
            (Operation::Choose, [condition, yes, no])
                if !is_event(graph, *condition) && !at_the_end(graph, *condition, &ends) =>
            {
                pending.extend([*yes, *no].map(|branch| summand.part(branch)));
            }
            (Operation::Reduce(Reduction::Sum, _), [list]) if node.width == 1 => {
                let joined = graph.node(*list);
                if joined.operation == Operation::Join && joined.inputs.len() == joined.width {
                    pending.extend(joined.inputs.iter().map(|part| summand.unbounded(*part, summand.factor)));
                }
            }
            (Operation::Memory(Memory::Smooth), [inner, _]) => pending.push(summand.unbounded(*inner, summand.factor)),
            _ => {}
        }
    }
    found
}

/// Functions that rise wherever they are defined.
fn rises(function: Unary) -> bool {
    matches!(
        function,
        Unary::Exponential | Unary::Logarithm | Unary::HyperbolicTangent | Unary::SquareRoot | Unary::ArcSine | Unary::Floor
    )
}

/// `x - prev(x)`: what one step adds.
pub(super) fn is_change(graph: &Graph, now: NodeId, before: NodeId) -> bool {
    let node = graph.node(before);
    matches!(node.operation, Operation::Memory(Memory::Delay(_))) && node.inputs.first() == Some(&now)
}

fn at_the_end(graph: &Graph, condition: NodeId, ends: &BTreeSet<NodeId>) -> bool {
    graph.reachable([condition]).iter().any(|id| ends.contains(id) || graph.node(*id).operation == Operation::Step)
}

//! What holds at single steps only, and what does not always contribute, read off the graph: whatever functions and names of
//! the text it is hidden behind.

use super::operation::{Binary, Memory, Operation, Unary};
use super::{Graph, NodeId};
use std::collections::BTreeSet;

/// Whether a condition holds at single steps only: `once(c)`, `rising(c)`, `falling(c)`, and such together with others.
pub fn is_event(graph: &Graph, node: NodeId) -> bool {
    let edge = |yes: NodeId, no: NodeId| {
        negated(graph, no).is_some_and(|no| before(graph, no) == Some(yes) || before(graph, yes) == Some(no))
    };
    let (mut pending, mut seen) = (vec![node], BTreeSet::new());
    while let Some(next) = pending.pop() {
        let Operation::Binary(Binary::And) = graph.node(next).operation else { continue };
        if !seen.insert(next) {
            continue;
        }
        let inputs = &graph.node(next).inputs;
        let single =
            |input: NodeId| is_first(graph, input) || negated(graph, input).is_some_and(|no| before(graph, no).is_some());
        if inputs.iter().any(|&yes| single(yes) || inputs.iter().any(|&no| edge(yes, no))) {
            return true;
        }
        pending.extend(inputs);
    }
    false
}

/// The first condition within a formula that holds at single steps only; what is remembered lasts, and is not looked into.
pub fn single_event(graph: &Graph, node: NodeId) -> Option<NodeId> {
    let mut pending = vec![node];
    let mut seen = BTreeSet::new();
    while let Some(next) = pending.pop() {
        if is_event(graph, next) {
            return Some(next);
        }
        if seen.insert(next) && !graph.node(next).operation.remembers() {
            pending.extend(&graph.node(next).inputs);
        }
    }
    None
}

/// Whether a value is one of two, a comparison, or lasts from when a condition first held: it shows by itself that it does not
/// always contribute. A term per second is looked at without the length of the step.
pub fn is_gated(graph: &Graph, node: NodeId) -> bool {
    let inputs = &graph.node(node).inputs;
    match graph.node(node).operation {
        Operation::Choose | Operation::Binary(Binary::Less | Binary::LessEqual | Binary::Equal) => true,
        Operation::Memory(Memory::Highest) => inputs.iter().any(|&input| is_condition(graph, input)),
        Operation::Binary(Binary::Multiply) => match inputs.as_slice() {
            [value, interval] if graph.constant_value(*interval).is_some() => is_gated(graph, *value),
            _ => false,
        },
        _ => is_event(graph, node),
    }
}

fn is_condition(graph: &Graph, node: NodeId) -> bool {
    use Binary as B;
    matches!(
        graph.node(node).operation,
        Operation::Binary(B::Less | B::LessEqual | B::Equal | B::And | B::Or) | Operation::Unary(Unary::Not)
    )
}

/// `count(c) == 1`
fn is_first(graph: &Graph, node: NodeId) -> bool {
    graph.node(node).operation == Operation::Binary(Binary::Equal)
        && graph.node(node).inputs.iter().any(|&counted| graph.node(counted).operation == Operation::Memory(Memory::Accumulate))
}

/// Of what a node is the negation.
fn negated(graph: &Graph, node: NodeId) -> Option<NodeId> {
    if graph.node(node).operation == Operation::Unary(Unary::Not) { graph.node(node).inputs.first().copied() } else { None }
}

/// Of what a node is the value one step ago.
fn before(graph: &Graph, node: NodeId) -> Option<NodeId> {
    if graph.node(node).operation == Operation::Memory(Memory::Delay(1)) {
        graph.node(node).inputs.first().copied()
    } else {
        None
    }
}

//! Formulas that compute something, but hardly what was meant: terms that are rewarded twice, counts of steps.

use super::at;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::operation::{Binary, Operation};
use crate::graph::{Graph, NodeId};
use crate::numbers::for_people;
use std::collections::BTreeMap;

/// How many events a state counts at most: what is compared with more counts steps on purpose.
const FEW: f64 = 20.0;

/// Two terms that compute the same number.
pub(super) fn duplicate_term(task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let mut first: BTreeMap<NodeId, &str> = BTreeMap::new();
    for term in task.terms.iter().filter(|term| task.graph.constant_lanes(term.node).is_none()) {
        if let Some(known) = first.insert(term.node, &term.name) {
            let message = format!("the terms `{known}` and `{}` have the same formula", term.name);
            let help = "their weights add up: probably one of them was meant to be different";
            let diagnostic = at(codes::slips::DUPLICATE_TERM, term, message).help(help);
            diagnostics.push(diagnostic);
        }
    }
}

/// States that grow at every step of a condition, and are compared with a few.
pub(super) fn counts_steps(task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let graph = &task.graph;
    for compared in &task.comparisons {
        let [a, b] = compared.sides;
        let counted = [(a, b), (b, a)].into_iter().find_map(|(state, number)| {
            let (Operation::StateBefore(index) | Operation::StateAfter(index)) = graph.node(state).operation else { return None };
            let number = graph.constant_value(number).filter(|number| *number > 1.0 && *number <= FEW)?;
            Some((index as usize, number))
        });
        let Some((index, number)) = counted else { continue };
        let (Some(state), Some(update)) = (task.states.get(index), task.updates.get(index)) else { continue };
        if !grows_at_every_step(graph, *update, index) {
            continue;
        }
        let time = for_people(number * task.timing.interval);
        let message = format!("`{}` counts control steps: it reaches {} after {time} s", state.name, for_people(number));
        let diagnostic = Diagnostic::new(codes::slips::COUNTS_STEPS, compared.file, compared.span, message).help(
            "it grows at every step at which its condition holds; `rising(...)` holds once each time the condition becomes true",
        );
        diagnostics.push(diagnostic);
    }
}

/// `n + 1 when c` where c may hold for many steps and does not look at n.
fn grows_at_every_step(graph: &Graph, update: NodeId, index: usize) -> bool {
    let own = |node: NodeId| matches!(graph.node(node).operation, Operation::StateBefore(state) if state as usize == index);
    let node = graph.node(update);
    let (Operation::Choose, [condition, grown, kept]) = (&node.operation, node.inputs.as_slice()) else { return false };
    let sum = graph.node(*grown);
    let counts = sum.operation == Operation::Binary(Binary::Add)
        && sum.inputs.iter().any(|&input| own(input))
        && sum.inputs.iter().any(|&input| graph.constant_value(input) == Some(1.0));
    let looks = graph.reachable([*condition]).into_iter().any(own);
    counts && own(*kept) && !looks && crate::graph::events::single_event(graph, *condition).is_none()
}

//! Totals that a term rewards at every step: what was gained once earns again for as long as the episode goes on.

use super::at;
use super::sight::is_condition;
use super::summands::{self, Summand};
use crate::check::reward::RewardTerm;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::interval::{self, Bounds};
use crate::graph::operation::{Binary, Memory, Operation};
use crate::graph::{Graph, NodeId};

/// Terms that reward a total as it stands.
pub(super) fn of(task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    for term in &task.terms {
        let summands = summands::of(task, term.node, term.weight);
        let Some(total) = summands.iter().find_map(|summand| total(task, bounds, term, summand)) else { continue };
        let message = format!(
            "the term `{}` rewards {total} at every step: a single gain is rewarded again at every later step",
            term.name
        );
        let help = "reward the increment, `rising(c)`, `rate(running_max(x))`, or the total once, `x when ended`";
        diagnostics.push(at(codes::exploits::RUNNING_TOTAL, term, message).help(help));
    }
}

/// The total that a summand is and is rewarded for, in words.
fn total(task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], term: &RewardTerm<'_>, summand: &Summand) -> Option<String> {
    let graph = &task.graph;
    let node = graph.node(summand.node);
    let input = || node.inputs.first().copied();
    let sign = |of: NodeId| {
        let range = interval::of_scalar(bounds, of);
        if range.low >= 0.0 {
            1.0
        } else if range.high <= 0.0 {
            -1.0
        } else {
            0.0
        }
    };
    match node.operation {
        Operation::Memory(Memory::Accumulate) => {
            let counts = is_condition(graph, input()?) || interval::of_scalar(bounds, input()?).high <= 1.0;
            let what = if counts { "a count" } else { "an integral" };
            (summand.factor * sign(input()?) > 0.0).then(|| what.to_owned())
        }
        // `ever` is an event that lasts, of which `rewarded_every_step` warns.
        Operation::Memory(extreme @ (Memory::Highest | Memory::Lowest)) if !is_condition(graph, input()?) => {
            let (name, rises) = if extreme == Memory::Highest { ("the highest value", 1.0) } else { ("the lowest value", -1.0) };
            let compared = reads_besides(graph, term.node, summand.node, input()?);
            (summand.factor * rises > 0.0 && !compared).then(|| format!("{name} so far"))
        }
        Operation::StateBefore(index) | Operation::StateAfter(index) => {
            let update = *task.updates.get(index as usize)?;
            let grows = grows(graph, bounds, update, index)?;
            (summand.factor * grows > 0.0).then(|| format!("the total `{}`", task.states[index as usize].name))
        }
        _ => None,
    }
}

/// Whether a formula reads `of` in another way than through `through`.
fn reads_besides(graph: &Graph, root: NodeId, through: NodeId, of: NodeId) -> bool {
    let mut pending = vec![root];
    let mut seen = std::collections::BTreeSet::from([through]);
    while let Some(id) = pending.pop() {
        if id == of {
            return true;
        }
        if seen.insert(id) {
            pending.extend(&graph.node(id).inputs);
        }
    }
    false
}

/// Which way a state goes that is added to and never set back: 1 up, -1 down.
fn grows(graph: &Graph, bounds: &[Vec<Bounds>], update: NodeId, index: u32) -> Option<f64> {
    let own = |node: NodeId| matches!(graph.node(node).operation, Operation::StateBefore(state) if state == index);
    let (mut pending, mut way) = (vec![update], 0.0);
    let mut looked_at = 0;
    while let Some(id) = pending.pop() {
        looked_at += 1;
        let node = graph.node(id);
        match (&node.operation, node.inputs.as_slice()) {
            _ if looked_at > 64 => return None,
            _ if own(id) => {}
            (Operation::Choose, [_, yes, no]) => pending.extend([*yes, *no]),
            (Operation::Binary(function @ (Binary::Add | Binary::Subtract)), [a, b]) => {
                let added = match (own(*a), own(*b)) {
                    (true, _) => *b,
                    (_, true) if *function == Binary::Add => *a,
                    _ => return None,
                };
                let range = interval::of_scalar(bounds, added);
                let up = if range.low >= 0.0 {
                    1.0
                } else if range.high <= 0.0 {
                    -1.0
                } else {
                    return None;
                };
                let up = if *function == Binary::Add { up } else { -up };
                if way != 0.0 && way != up {
                    return None;
                }
                way = up;
            }
            _ => return None,
        }
    }
    Some(way).filter(|way| *way != 0.0)
}

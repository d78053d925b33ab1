//! Terms on the muscles themselves: what effort costs, and how many of them are summed.

use super::amount::Amount;
use super::trend::{self, Trend};
use super::{at, named_in, suggest_weight};
use crate::check::context::Checker;
use crate::check::reward::RewardTerm;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::frame::Sensor;
use crate::graph::interval::Bounds;
use crate::graph::operation::{Binary, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use crate::hir::Resolution;
use crate::numbers::for_people;
use crate::signals::Read;

/// Elements from which on a sum is looked at.
const MANY: u32 = 32;

/// Lints on terms that read muscles.
pub(super) fn of(
    checker: &Checker<'_>,
    task: &CheckedTask<'_>,
    bounds: &[Vec<Bounds>],
    amounts: &[Amount],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let all = checker.vocabulary.muscles.len();
    for (index, term) in task.terms.iter().enumerate() {
        let read = task.graph.reachable([term.node]);
        let efforts = |id: &NodeId| match &task.graph.node(*id).operation {
            Operation::Sensors(sensors) => sensors.iter().filter(|sensor| is_effort(**sensor)).count(),
            _ => 0,
        };
        // What few muscles do may be what is asked for.
        let most = read.iter().map(efforts).max().unwrap_or(0);
        if most > 0 && 2 * most >= all {
            rewards_effort(task, (term, &amounts[index]), bounds, diagnostics);
        }
        rest_of_actions(task, term, &read, diagnostics);
        heavy_sum(task, term, &read, (index, amounts), diagnostics);
    }
}

fn is_effort(sensor: Sensor) -> bool {
    matches!(sensor, Sensor::MuscleActivation(_) | Sensor::MuscleExcitation(_) | Sensor::Action(_))
}

/// A term that contributes more the more the muscles work.
fn rewards_effort(
    task: &CheckedTask<'_>,
    (term, amount): (&RewardTerm<'_>, &Amount),
    bounds: &[Vec<Bounds>],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let rising = if term.weight > 0.0 { Trend::Rising } else { Trend::Falling };
    // `doubled_sign` warns of two signs that cancel.
    let doubled = term.weight < 0.0 && amount.value.high <= 0.0;
    if term.weight == 0.0 || doubled || trend::of(&task.graph, bounds, term.node, is_effort) != rising {
        return;
    }
    let message = format!("the term `{}` rewards effort: it increases with the activity of all muscles", term.name);
    let diagnostic = at(codes::incentive::REWARDS_EFFORT, term, message);
    let diagnostic = if term.weight > 0.0 {
        let diagnostic =
            diagnostic.found(format!("a weight of {}", for_people(term.weight))).help("effort is a cost: its weight is negative");
        suggest_weight(diagnostic, term, -term.weight)
    } else {
        diagnostic.help("the formula decreases with effort and its weight is negative: keep one of the two signs")
    };
    diagnostics.push(diagnostic);
}

/// A size of actions, which are -1 at rest.
fn rest_of_actions(task: &CheckedTask<'_>, term: &RewardTerm<'_>, read: &[NodeId], diagnostics: &mut Vec<Diagnostic>) {
    let graph = &task.graph;
    let sized = read.iter().any(|&id| {
        let node = graph.node(id);
        match &node.operation {
            Operation::Binary(Binary::Multiply) => node.inputs[0] == node.inputs[1] && are_actions(graph, node.inputs[0]),
            Operation::Binary(Binary::Power) | Operation::Unary(Unary::Absolute) | Operation::Reduce(Reduction::Norm, _) => {
                are_actions(graph, node.inputs[0])
            }
            _ => false,
        }
    });
    if !sized {
        return;
    }
    let message = format!("the term `{}` takes the size of actions, which are -1 at rest and 0 at half excitation", term.name);
    let diagnostic = at(codes::incentive::ACTION_AT_REST, term, message)
        .help("`excitation` is 0 at rest: `mean(muscles.excitation^2)`; doing nothing then costs nothing");
    let actions =
        named_in(&task.hir, term, |resolution| matches!(resolution, Resolution::Signal(signal) if signal.read == Read::Action));
    let diagnostic = match actions.as_slice() {
        // A name of another file is left as it is: other terms may read it.
        [(file, only)] if *file == term.file => diagnostic.suggest("write `excitation`", *only, "excitation"),
        _ => diagnostic,
    };
    diagnostics.push(diagnostic);
}

/// Whether all lanes of a node are raw actions.
fn are_actions(graph: &Graph, id: NodeId) -> bool {
    let node = graph.node(id);
    match &node.operation {
        Operation::Sensors(sensors) => sensors.iter().all(|sensor| matches!(sensor, Sensor::Action(_))),
        Operation::Select(_) => are_actions(graph, node.inputs[0]),
        _ => false,
    }
}

/// A long sum that outweighs all other terms, and would not as a mean.
fn heavy_sum(
    task: &CheckedTask<'_>,
    term: &RewardTerm<'_>,
    read: &[NodeId],
    (index, amounts): (usize, &[Amount]),
    diagnostics: &mut Vec<Diagnostic>,
) {
    let sums = named_in(&task.hir, term, |resolution| matches!(resolution, Resolution::Function("sum")));
    let longest = read.iter().filter_map(|id| match task.graph.node(*id).operation {
        Operation::Reduce(Reduction::Sum, count) if count >= MANY => Some(count),
        _ => None,
    });
    let (Some(count), Some((file, span))) = (longest.max(), sums.first()) else { return };
    let rest: f64 = amounts.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, other)| other.size()).sum();
    let size = amounts[index].size();
    if rest > 0.0 && size.is_finite() && size > rest && size <= rest * f64::from(count) {
        let message = format!("the term `{}` is a sum of {count} numbers that outweighs all other terms", term.name);
        let diagnostic = at(codes::incentive::HEAVY_SUM, term, message)
            .expected(format!("at most {} per step, as all others together", for_people(rest)))
            .found(for_people(size))
            .help("a mean does not grow with the number of muscles: `mean(...)`");
        // A sum of a library may be right elsewhere.
        let own = *file == term.file;
        diagnostics.push(if own { diagnostic.suggest("write `mean`", *span, "mean") } else { diagnostic });
    }
}

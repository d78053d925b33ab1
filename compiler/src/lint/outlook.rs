//! What going on, failing and finishing earn, by the signs and ranges of all terms.
//!
//! A term that reads how the episode ends is bounded anew with the conditions of the ends held or not; all others contribute
//! what they can at any step.

use super::amount::Amount;
use super::success::brings_success;
use super::{at, suggest_weight};
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::NodeId;
use crate::graph::events::is_event;
use crate::graph::interval::{self, Bounds, Ranges};
use crate::numbers::for_people;
use std::collections::BTreeSet;

/// The part of what remains to the horizon that finishing with success must earn at least.
const REST: f64 = 0.5;

/// Ends that are looked at: a task names few, and each is looked at with every term.
const ENDS: usize = 8;

/// What is known of the terms of a task.
struct Outlook<'t, 'a> {
    task: &'t CheckedTask<'a>,
    bounds: &'t [Vec<Bounds>],
    ranges: &'t dyn Ranges,
    amounts: &'t [Amount],
    /// The ends that each term reads.
    read: Vec<Vec<NodeId>>,
}

/// Lints on what ending an episode earns.
pub(super) fn of(
    task: &CheckedTask<'_>,
    bounds: &[Vec<Bounds>],
    ranges: &dyn Ranges,
    amounts: &[Amount],
    diagnostics: &mut Vec<Diagnostic>,
) {
    if task.terminations.is_empty() && task.finishes.is_empty() {
        return;
    }
    let ends: BTreeSet<NodeId> = task.terminations.iter().chain(&task.finishes).map(|end| end.node).collect();
    let ends_of = |node: NodeId| task.graph.reachable([node]).into_iter().filter(|id| ends.contains(id)).collect();
    let read = task.terms.iter().map(|term| ends_of(term.node)).collect();
    let outlook = Outlook { task, bounds, ranges, amounts, read };
    if !outlook.rewards_failure(diagnostics) {
        outlook.failing_is_cheap(diagnostics);
    }
    outlook.forfeits(diagnostics);
}

impl Outlook<'_, '_> {
    /// What a term contributes where conditions hold or fail.
    fn contribution(&self, index: usize, given: &[(NodeId, bool)]) -> Bounds {
        if !self.read[index].iter().any(|end| given.iter().any(|(known, _)| known == end)) {
            return self.amounts[index].contribution;
        }
        let term = &self.task.terms[index];
        let graph = &self.task.graph;
        let mut known: Vec<Vec<Bounds>> = vec![Vec::new(); term.node.index() + 1];
        let mut moved: BTreeSet<NodeId> = BTreeSet::new();
        for id in graph.reachable([term.node]) {
            known[id.index()] = if let Some((_, holds)) = given.iter().find(|(end, _)| *end == id) {
                moved.insert(id);
                vec![Bounds::point(f64::from(u8::from(*holds)))]
            } else if graph.node(id).inputs.iter().any(|input| moved.contains(input)) {
                moved.insert(id);
                interval::of_node(graph, id, &known, self.ranges)
            } else {
                self.bounds[id.index()].clone()
            };
        }
        Amount::new(term, interval::of_scalar(&known, term.node)).contribution
    }

    /// No end holds.
    fn going_on(&self) -> Vec<(NodeId, bool)> {
        self.task.terminations.iter().chain(&self.task.finishes).map(|end| (end.node, false)).collect()
    }

    /// Terms that contribute more in the step that fails than in any other; whether there are some.
    fn rewards_failure(&self, diagnostics: &mut Vec<Diagnostic>) -> bool {
        let mut found = false;
        for (index, term) in self.task.terms.iter().enumerate() {
            let going = self.contribution(index, &self.going_on());
            let read = self.task.terminations.iter().filter(|end| self.read[index].contains(&end.node)).take(ENDS);
            let failing = read
                .map(|end| (end, self.contribution(index, &[(end.node, true)])))
                .find(|(_, contribution)| contribution.low > going.high);
            let Some((end, contribution)) = failing else { continue };
            let message = format!(
                "the term `{}` rewards failing: {} in the step that `{}` ends, at most {} in any other",
                term.name,
                for_people(contribution.low),
                end.name,
                for_people(going.high)
            );
            let diagnostic = at(codes::incentive::REWARDS_FAILURE, term, message).label(end.file, end.span, "a failure");
            diagnostics.push(if term.condition {
                let help = "charge a failure with a negative weight, reward `not terminated` with a positive one";
                suggest_weight(diagnostic.help(help), term, -term.weight)
            } else {
                diagnostic.help("charge a failure: `-100 failed = terminated`")
            });
            found = true;
        }
        found
    }

    /// Steps that never earn and can cost more than failing does.
    fn failing_is_cheap(&self, diagnostics: &mut Vec<Diagnostic>) {
        if !self.read.iter().any(|read| self.task.terminations.iter().any(|end| read.contains(&end.node))) {
            // Then ending is free, of which `free_failure` warns where steps can cost.
            return;
        }
        let going = self.going_on();
        let steps: Vec<Bounds> = (0..self.task.terms.len()).map(|index| self.contribution(index, &going)).collect();
        let (worst, best) =
            steps.iter().fold((0.0, 0.0), |(low, high), contribution| (low + contribution.low, high + contribution.high));
        let whole = -worst * f64::from(self.task.timing.horizon);
        if best > 0.0 || worst >= 0.0 {
            return;
        }
        let charged = |end: NodeId| -> f64 {
            let reading = (0..steps.len()).filter(|index| self.read[*index].contains(&end));
            -reading.map(|index| self.contribution(index, &[(end, true)]).high).sum::<f64>()
        };
        let cheap = self.task.terminations.iter().take(ENDS).map(|end| (end, charged(end.node))).find(|(_, cost)| *cost < whole);
        let Some((end, cost)) = cheap else { return };
        let message = format!("failing by `{}` costs {}, going on never earns and can cost more", end.name, for_people(cost));
        let diagnostic = Diagnostic::new(codes::intent::FREE_FAILURE, end.file, end.span, message);
        let diagnostic = if whole.is_finite() {
            let steps = self.task.timing.horizon;
            let expected = format!("a failure that costs at least {}, as {steps} steps can", for_people(whole));
            let found = format!("{}, and steps that cost up to {} each", for_people(cost), for_people(-worst));
            diagnostic.expected(expected).found(found)
        } else {
            diagnostic.found(format!("{}, and steps that cost without bound", for_people(cost)))
        };
        let diagnostic = diagnostic
            .help("a policy may learn to fail at once: reward staying alive, `5 alive = not terminated`, or charge failing more");
        diagnostics.push(diagnostic);
    }

    /// Finishing with success ends what steps would still have earned.
    fn forfeits(&self, diagnostics: &mut Vec<Diagnostic>) {
        let horizon = f64::from(self.task.timing.horizon);
        let terms = || self.task.terms.iter().enumerate();
        // A learner that bootstraps loses nothing by finishing.
        let ends = self.task.finishes.iter().take(ENDS).filter(|end| !end.bootstraps);
        for end in ends.filter(|end| brings_success(self.task, end)) {
            let going = self.going_on();
            let lasting = terms().filter(|(_, term)| !is_event(&self.task.graph, term.node));
            let step: f64 = lasting.map(|(index, _)| self.contribution(index, &going).high).sum();
            let last: f64 = terms().map(|(index, _)| self.contribution(index, &[(end.node, true)]).high).sum();
            if !step.is_finite() || step <= 0.0 || last >= REST * step * horizon {
                continue;
            }
            let message = format!("finishing by `{}` succeeds, and forfeits the reward of all further steps", end.name);
            let diagnostic = Diagnostic::new(codes::incentive::FORFEITS, end.file, end.span, message)
                .expected(format!("a last step that earns about {}, as {horizon} steps can", for_people(step * horizon)))
                .found(format!("at most {}", for_people(last)))
                .help("waiting just before it earns more than finishing: use costs until then, reward progress, `rate(...)`, or reward the finish more");
            diagnostics.push(diagnostic);
        }
    }
}

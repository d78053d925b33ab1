//! Success that is judged at the last step alone, however that comes.

use super::success::may_hold_together;
use crate::check::task::{CheckedTask, InSequence};
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::operation::Operation;
use std::collections::BTreeSet;

/// A success that neither remembers nor asks how the episode ended. A phase is judged where its sequence leaves it.
pub(crate) fn last_step(task: &CheckedTask<'_>, sequence: InSequence<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let at_success = |diagnostic: &Diagnostic| (diagnostic.file(), diagnostic.span()) == task.success_at;
    // One warning about a condition is enough.
    if !sequence.phases.is_empty() || sequence.is_phase || diagnostics.iter().any(at_success) {
        return;
    }
    let graph = &task.graph;
    let ends: BTreeSet<_> = task.terminations.iter().chain(&task.finishes).map(|end| end.node).collect();
    let read = graph.reachable([task.success]);
    let measures = read.iter().any(|id| matches!(graph.node(*id).operation, Operation::Sensors(_)));
    let settled = read.iter().any(|id| {
        let operation = &graph.node(*id).operation;
        let held =
            matches!(operation, Operation::Memory(_) | Operation::StateBefore(_) | Operation::StateAfter(_) | Operation::Step);
        held || ends.contains(id)
    });
    if settled || !measures {
        return;
    }
    let failing = task.terminations.iter().find(|end| may_hold_together(graph, task.success, end.node));
    let message = match failing {
        Some(end) => format!("success depends on the last step only, even if `{}` ends the episode as a failure", end.name),
        None if task.terminations.is_empty() => "success depends on the last step only: earlier steps do not matter".to_owned(),
        // Whatever fails does not succeed, and at the end of the time it is asked for.
        None => return,
    };
    let (file, span) = task.success_at;
    let diagnostic = Diagnostic::new(codes::incentive::LAST_STEP, file, span, message)
        .help("use `ever(c)` for any earlier step, `survived and c` for the horizon");
    diagnostics.push(diagnostic);
}

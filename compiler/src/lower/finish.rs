//! From a checked task to a compiled one: program, layout, labels, hash.

use super::{Outputs, assemble};
use crate::body::BodyDescription;
use crate::check::Texts;
use crate::check::task::{CheckedTask, summary};
use crate::diagnostics::FileId;
use crate::explain::{mathematics, names_in};
use crate::syntax::tree::{Entry, Expr, Task, TaskStatement};
use crate::task::{Channel, CompiledTask, Meaning, Term, TermMeaning};
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Lowers a checked task.
pub(crate) fn finish(
    task: &Task,
    file: FileId,
    checked: CheckedTask<'_>,
    body: Arc<BodyDescription>,
    texts: &dyn Texts,
) -> CompiledTask {
    let written = |expr: &Expr| texts.text(file, expr.span).split_whitespace().collect::<Vec<_>>().join(" ");
    let outputs = Outputs {
        terms: checked.terms.iter().map(|term| term.node).collect(),
        terminations: checked.terminations.iter().map(|(_, node)| *node).collect(),
        success: Some(checked.success),
        channels: checked.channels.iter().map(|channel| channel.node).collect(),
        updates: checked.updates,
        beginning: checked.beginning,
        releases: checked.releases.iter().map(|(_, node)| *node).collect(),
        markers: checked.markers.iter().map(|(_, node)| *node).collect(),
    };
    let (program, frame) = assemble(&checked.graph, &outputs, &checked.queries);
    let mut channels = Vec::with_capacity(checked.channels.len());
    let mut offset = 0;
    for channel in checked.channels {
        let size = checked.graph.width(channel.node);
        channels.push(Channel { name: channel.name, offset, size, unit: channel.unit });
        offset += size;
    }
    let meaning =
        |formula: &Expr, condition| TermMeaning { mathematics: mathematics(formula), reads: names_in(formula), condition };
    let terms = checked.terms.iter().map(|term| Term {
        name: term.name.clone(),
        weight: term.weight,
        weight_range: term.range,
        fixed: term.fixed,
        source: written(term.formula),
    });
    let (conditions, success) = conditions(task);
    let mut compiled = CompiledTask {
        name: task.name.text.clone(),
        family: checked.family,
        summary: summary(task),
        body,
        control_frequency: checked.control_frequency,
        horizon: checked.timing.horizon,
        symmetric: checked.symmetric,
        scene: checked.scene,
        init: checked.init,
        disturbances: checked.disturbances,
        releases: checked.releases.iter().map(|(connection, _)| *connection).collect(),
        markers: checked.markers.into_iter().map(|(name, _)| name).collect(),
        channels,
        terms: terms.collect(),
        terminations: checked.terminations.into_iter().map(|(name, _)| name).collect(),
        frame,
        hash: String::new(),
        program,
        meaning: Meaning {
            terms: checked.terms.iter().map(|term| meaning(term.formula, term.condition)).collect(),
            terminations: conditions.into_iter().map(written).collect(),
            success: success.map(written).unwrap_or_default(),
            term_bounds: checked.term_bounds,
            graph: checked.graph,
            outputs,
        },
    };
    compiled.hash = hash(&compiled);
    compiled
}

fn conditions(task: &Task) -> (Vec<&Expr>, Option<&Expr>) {
    let mut conditions = Vec::new();
    let mut success = None;
    for statement in &task.statements {
        match statement {
            TaskStatement::Terminate(ends) => {
                conditions.extend(ends.reasons.iter().filter_map(|entry| match entry {
                    Entry::Item(reason) => Some(&reason.condition),
                    _ => None,
                }));
            }
            TaskStatement::Success(expr) => success = Some(expr),
            _ => {}
        }
    }
    (conditions, success)
}

/// SHA-256 of the canonical text of the task and of its body, where models lie on the disk left out.
fn hash(task: &CompiledTask) -> String {
    let mut body = BodyDescription::clone(&task.body);
    body.model = std::path::Path::new(&body.model).file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let mut hasher = Sha256::new();
    hasher.update(task.snapshot().as_bytes());
    // A description is plain data: writing it cannot fail, and its fields come in the order of their declaration.
    hasher.update(serde_json::to_vec(&body).unwrap_or_default());
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

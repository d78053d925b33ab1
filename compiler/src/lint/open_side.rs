//! One side of a corridor: an end that watches the way to the left and lets the way to the right go.

use super::linear::{Linear, Measured};
use super::surrogate::{Shift, Surrogate};
use crate::check::context::Checker;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::frame::Sensor;
use crate::graph::operation::{Binary, Operation};
use crate::graph::{Graph, NodeId};
use std::collections::BTreeSet;

/// Parts of a success that are looked at.
const MOST: usize = 256;

/// Ends by a place across the way that only one side has, on ground without anything beside it.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    if !task.scene.objects.is_empty() {
        return;
    }
    let graph = &task.graph;
    let surrogate = Surrogate::new(checker, task);
    let ends = || task.terminations.iter().chain(&task.finishes).map(|end| end.node);
    for end in &task.terminations {
        let Some((name, limit)) = across(checker, graph, end.node) else { continue };
        // Whatever else asks for a place across, or rewards going there, may well be why.
        let mut others: Vec<NodeId> = ends().filter(|other| *other != end.node).collect();
        others.extend(task.terms.iter().map(|term| term.node));
        others.extend(asked(graph, task.success, &ends().collect()));
        let sideways = others.iter().any(|other| goes_across(graph, *other));
        if sideways || surrogate.answers(&others, Shift::AlongY).contains(&true) {
            continue;
        }
        let (side, other) = if limit > 0.0 { ("left", "right") } else { ("right", "left") };
        let message = format!("`{}` ends the episode on the {side} of a line, but no termination covers the {other}", end.name);
        let diagnostic = Diagnostic::new(codes::exploits::OPEN_SIDE, end.file, end.span, message)
            .help(format!("both sides: `abs({name}.position.y) > ...`"));
        diagnostics.push(diagnostic);
    }
}

/// What a condition compares with a constant across the way, and with which: a part of the body that begins on the other side.
fn across<'v>(checker: &Checker<'v>, graph: &Graph, condition: NodeId) -> Option<(&'v str, f64)> {
    let node = graph.node(condition);
    let (Operation::Binary(Binary::Less | Binary::LessEqual), [a, b]) = (&node.operation, node.inputs.as_slice()) else {
        return None;
    };
    let (side, limit, above) = match (graph.constant_value(*a), graph.constant_value(*b)) {
        (Some(limit), None) => (*b, limit, true),
        (None, Some(limit)) => (*a, limit, false),
        _ => return None,
    };
    let linear = Linear::of(graph, side, 0)?;
    let [(Measured::Lane(sensor, 1), factor)] = linear.parts.as_slice() else { return None };
    let limit = (limit - linear.offset) / factor;
    let above = above == (*factor > 0.0);
    let name = match *sensor {
        Sensor::ComPosition => "com",
        Sensor::LandmarkPosition(index) => checker.vocabulary.landmarks.get(index)?.name.as_str(),
        _ => return None,
    };
    (limit != 0.0 && above == (limit > 0.0)).then_some((name, limit))
}

/// The comparisons that success itself makes, without those of ends.
fn asked(graph: &Graph, success: NodeId, ends: &BTreeSet<NodeId>) -> Vec<NodeId> {
    let (mut pending, mut seen, mut found) = (vec![success], BTreeSet::new(), Vec::new());
    while let Some(id) = pending.pop().filter(|_| seen.len() < MOST) {
        if ends.contains(&id) || !seen.insert(id) {
            continue;
        }
        let node = graph.node(id);
        match node.operation {
            Operation::Binary(Binary::Less | Binary::LessEqual) => found.push(id),
            _ => pending.extend(&node.inputs),
        }
    }
    found
}

/// Whether a formula reads a velocity across.
fn goes_across(graph: &Graph, root: NodeId) -> bool {
    let velocity = |measured: &Measured| {
        matches!(measured, Measured::Lane(Sensor::LandmarkVelocity(_) | Sensor::ComVelocity | Sensor::RootVelocity, 1))
    };
    let linear = |id: NodeId| Linear::of(graph, id, 0).is_some_and(|linear| linear.parts.iter().any(|(part, _)| velocity(part)));
    graph.reachable([root]).into_iter().filter(|id| graph.width(*id) == 1).any(linear)
}

//! Heights above the world's zero, where the ground is a slope, stairs, a field of heights or has things to walk on.

use super::linear::{Linear, Measured};
use crate::check::context::Checker;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::frame::Sensor;
use crate::graph::operation::{Binary, Operation, Unary};
use crate::graph::{Graph, Node, NodeId};
use crate::scene::{Motion, Shape};
use std::collections::BTreeSet;

/// A limit so much above where a body stands on level ground is meant for ground that lies higher, m.
const RAISED: f64 = 0.5;

/// Terms, failures and success that read a height as it is, on ground that is not level.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let objects = || task.scene.objects.iter();
    let terrain = objects().find(|object| matches!(object.shape, Some(Shape::Terrain(_))));
    let raised = || objects().find(|object| object.surface.walkable && object.motion == Motion::Fixed);
    let Some(ground) = terrain.or_else(raised) else { return };
    // What of a standing body is low is compared with the top of a thing: whether a foot is on it.
    let counts = |sensor: &Sensor| terrain.is_some() || stands(checker, *sensor) > RAISED;
    let terms = task.terms.iter().map(|term| (format!("the term `{}`", term.name), term.node, term.file, term.formula.span));
    let ends = task.terminations.iter().map(|end| (format!("the termination `{}`", end.name), end.node, end.file, end.span));
    let found: Vec<_> = terms.chain(ends).filter_map(|root| Some((height(checker, &task.graph, root.1)?, root))).collect();
    let (file, span) = task.success_at;
    let success = ("success".to_owned(), task.success, file, span);
    let success = standing(checker, task).map(|sensor| (sensor, success));
    for (sensor, (what, _, file, span)) in found.into_iter().chain(success).filter(|(sensor, _)| counts(sensor)) {
        let name = match sensor {
            Sensor::LandmarkPosition(index) => {
                checker.vocabulary.landmarks.get(index).map_or("", |landmark| landmark.name.as_str())
            }
            _ => "com",
        };
        let under = if name == "com" { "pelvis" } else { name };
        let message =
            format!("{what} reads the height of `{name}` above the world's zero, but the ground is not level: `{}`", ground.name);
        let diagnostic = Diagnostic::new(codes::incentive::ABSOLUTE_HEIGHT, file, span, message)
            .help(format!("`{name}.height - ground_height({under})` is the height above the ground"));
        diagnostics.push(diagnostic);
    }
}

/// The part of the body that success asks to be no higher than it is where a body stands on level ground. A greater height is a
/// place up there; what terminations ask is not asked by success.
fn standing(checker: &Checker<'_>, task: &CheckedTask<'_>) -> Option<Sensor> {
    let graph = &task.graph;
    let ends: BTreeSet<NodeId> = task.terminations.iter().chain(&task.finishes).map(|end| end.node).collect();
    let (mut pending, mut seen) = (vec![task.success], BTreeSet::new());
    while let Some(id) = pending.pop() {
        if ends.contains(&id) || !seen.insert(id) {
            continue;
        }
        let node = graph.node(id);
        pending.extend(&node.inputs);
        let (Operation::Binary(Binary::Less | Binary::LessEqual), [low, high]) = (&node.operation, node.inputs.as_slice()) else {
            continue;
        };
        let (Some(limit), Some(sensor)) = (graph.constant_value(*low), alone(checker, graph, *high)) else { continue };
        if limit < stands(checker, sensor) {
            return Some(sensor);
        }
    }
    None
}

/// The part of the body whose height a formula compares, bounds or bends by itself.
fn height(checker: &Checker<'_>, graph: &Graph, root: NodeId) -> Option<Sensor> {
    let decides = |node: &Node| match node.operation {
        Operation::Binary(Binary::Multiply) => node.inputs[0] == node.inputs[1],
        Operation::Binary(Binary::Less | Binary::LessEqual | Binary::Minimum | Binary::Maximum)
        | Operation::Unary(Unary::Absolute | Unary::Exponential | Unary::HyperbolicTangent) => true,
        _ => false,
    };
    // A body that stands on level ground is far below such a limit.
    let up_there = |node: &Node| match (&node.operation, node.inputs.as_slice()) {
        (Operation::Binary(Binary::Less | Binary::LessEqual), [low, high]) => {
            let sensor = alone(checker, graph, *low).zip(graph.constant_value(*high));
            sensor.is_some_and(|(sensor, limit)| limit > stands(checker, sensor) + RAISED)
        }
        _ => false,
    };
    let read = graph.reachable([root]).into_iter().map(|id| graph.node(id));
    let read = read.filter(|node| decides(node) && !up_there(node));
    read.flat_map(|node| &node.inputs).find_map(|&input| alone(checker, graph, input))
}

/// How high a part of the body is where that stands on level ground.
fn stands(checker: &Checker<'_>, sensor: Sensor) -> f64 {
    match sensor {
        Sensor::LandmarkPosition(index) => {
            checker.vocabulary.landmarks.get(index).map_or(0.0, |landmark| landmark.neutral_position[2])
        }
        _ => checker.vocabulary.neutral_com[2],
    }
}

/// The part of the body whose height a node is, by itself.
fn alone(checker: &Checker<'_>, graph: &Graph, node: NodeId) -> Option<Sensor> {
    let linear = Linear::of(graph, node, 0)?;
    match linear.parts.as_slice() {
        [(Measured::Lane(sensor @ Sensor::ComPosition, 2), _)] => Some(*sensor),
        [(Measured::Lane(sensor @ Sensor::LandmarkPosition(index), 2), _)] => {
            Some(*sensor).filter(|_| checker.vocabulary.landmarks.get(*index).is_some_and(|landmark| !landmark.of_scene))
        }
        _ => None,
    }
}

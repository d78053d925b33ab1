//! Heights above the world's zero, where the ground is a slope, stairs or a field of heights.

use super::linear::{Linear, Measured};
use crate::check::context::Checker;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::frame::Sensor;
use crate::graph::operation::{Binary, Operation, Unary};
use crate::graph::{Graph, Node, NodeId};
use crate::scene::Shape;

/// Terms and failures that read a height as it is, on ground that is not level. Success may well ask for a place up there.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let uneven = task.scene.objects.iter().find(|object| matches!(object.shape, Some(Shape::Terrain(_))));
    let Some(ground) = uneven else { return };
    let terms = task.terms.iter().map(|term| (format!("the term `{}`", term.name), term.node, term.file, term.formula.span));
    let ends = task.terminations.iter().map(|end| (format!("the end `{}`", end.name), end.node, end.file, end.span));
    for (what, node, file, span) in terms.chain(ends) {
        let Some(sensor) = height(checker, &task.graph, node) else { continue };
        let name = match sensor {
            Sensor::LandmarkPosition(index) => {
                checker.vocabulary.landmarks.get(index).map_or("", |landmark| landmark.name.as_str())
            }
            _ => "com",
        };
        let under = if name == "com" { "pelvis" } else { name };
        let message = format!("{what} takes the height of `{name}` above the world's zero, but `{}` is not level", ground.name);
        let diagnostic = Diagnostic::new(codes::incentive::ABSOLUTE_HEIGHT, file, span, message)
            .help(format!("`{name}.height - ground_height({under})` is the height above the ground under it"));
        diagnostics.push(diagnostic);
    }
}

/// The part of the body whose height a formula compares, bounds or bends by itself.
fn height(checker: &Checker<'_>, graph: &Graph, root: NodeId) -> Option<Sensor> {
    let alone = |node: NodeId| {
        let linear = Linear::of(graph, node, 0)?;
        match linear.parts.as_slice() {
            [(Measured::Lane(sensor @ Sensor::ComPosition, 2), _)] => Some(*sensor),
            [(Measured::Lane(sensor @ Sensor::LandmarkPosition(index), 2), _)] => {
                Some(*sensor).filter(|_| checker.vocabulary.landmarks.get(*index).is_some_and(|landmark| !landmark.of_scene))
            }
            _ => None,
        }
    };
    let decides = |node: &Node| match node.operation {
        Operation::Binary(Binary::Multiply) => node.inputs[0] == node.inputs[1],
        Operation::Binary(Binary::Less | Binary::LessEqual | Binary::Minimum | Binary::Maximum)
        | Operation::Unary(Unary::Absolute | Unary::Exponential | Unary::HyperbolicTangent) => true,
        _ => false,
    };
    let read = graph.reachable([root]).into_iter().map(|id| graph.node(id)).filter(|node| decides(node));
    read.flat_map(|node| &node.inputs).find_map(|&input| alone(input))
}

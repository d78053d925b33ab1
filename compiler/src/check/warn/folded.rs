//! Absolute values that make two opposite orientations the same.

use crate::check::context::Checker;
use crate::diagnostics::{Span, codes};
use crate::frame::Sensor;
use crate::graph::operation::{Binary, Operation, Unary};
use crate::graph::{Graph, NodeId};

/// The lane of `up.z` among the nine components of axes.
const UP_Z: usize = 8;

impl Checker<'_> {
    /// Warns of the absolute value of what tells upright from upside down, or forwards from backwards.
    pub(crate) fn warn_folded(&mut self, node: NodeId, span: Span) {
        let (same, instead) = if (0..self.graph.width(node)).any(|lane| traced(&self.graph, node, lane) == Some(UP_Z)) {
            ("upright and upside down are the same", "`max(0, torso.up.z)` is 0 upside down")
        } else if turns_right_round(&self.graph, node) {
            ("facing forwards and facing backwards are the same", "the angle distinguishes them: `abs(pelvis.yaw)`")
        } else {
            return;
        };
        let diagnostic = self.diagnostic(codes::intent::FOLDED, span, format!("in this absolute value {same}"));
        self.diagnostics.push(diagnostic.help(instead));
    }
}

/// Which component of its axes a lane is, if it is one.
fn traced(graph: &Graph, node: NodeId, lane: usize) -> Option<usize> {
    let known = graph.node(node);
    match &known.operation {
        Operation::Select(lanes) => traced(graph, *known.inputs.first()?, *lanes.get(lane)? as usize),
        Operation::Join => {
            let mut left = lane;
            for &input in &known.inputs {
                let width = graph.width(input);
                if left < width {
                    return traced(graph, input, left);
                }
                left -= width;
            }
            None
        }
        Operation::Sensors(sensors) => {
            let mut left = lane;
            for sensor in sensors {
                if left < sensor.size() {
                    return matches!(sensor, Sensor::LandmarkAxes(_) | Sensor::RootAxes).then_some(left);
                }
                left -= sensor.size();
            }
            None
        }
        _ => None,
    }
}

/// The sine of an angle that goes all the way round.
fn turns_right_round(graph: &Graph, node: NodeId) -> bool {
    let Operation::Unary(Unary::Sine) = graph.node(node).operation else { return false };
    let inputs = graph.node(node).inputs.iter();
    inputs.copied().any(|angle| {
        matches!(graph.node(angle).operation, Operation::Unary(Unary::Wrap) | Operation::Binary(Binary::ArcTangent2))
    })
}

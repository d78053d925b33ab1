//! Channels that tell where in the world a limb is, in tasks that nothing in the world has a part in.

use super::surrogate::{Shift, Surrogate};
use crate::check::context::Checker;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::frame::{Sensor, Subject};
use crate::graph::NodeId;
use crate::graph::operation::Operation;

/// Places of limbs in the world, where neither reward nor ends nor success depend on where the body stands.
///
/// The place of the trunk is what tells a policy where it is; that of anything else is meant to tell where it is on the body.
pub(super) fn of(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let shifts = [Shift::AlongX, Shift::AlongY];
    let limb = |node: NodeId| match &task.graph.node(node).operation {
        Operation::Sensors(sensors) => sensors.iter().find_map(|sensor| match (sensor, sensor.subject()) {
            (Sensor::LandmarkPosition(_), Subject::Landmark(index)) => {
                let landmark = checker.vocabulary.landmarks.get(index)?;
                (!landmark.of_scene && !TRUNK.contains(&landmark.name.as_str())).then_some(landmark.name.as_str())
            }
            _ => None,
        }),
        _ => None,
    };
    let placed: Vec<_> = task.observed().filter_map(|channel| Some((channel, limb(channel.node)?))).collect();
    if placed.is_empty() {
        return;
    }
    let decides = task.terms.iter().map(|term| term.node);
    let decides = decides.chain(task.terminations.iter().chain(&task.finishes).map(|end| end.node));
    let decides: Vec<NodeId> = decides.chain([task.success]).collect();
    let surrogate = Surrogate::new(checker, task);
    if shifts.into_iter().any(|shift| surrogate.answers(&decides, shift).contains(&true)) {
        return;
    }
    for (channel, limb) in placed {
        let message = format!("the channel `{}` is the world position of `{limb}`, which nothing depends on", channel.name);
        let diagnostic = Diagnostic::new(codes::incentive::WORLD_PLACE, channel.file, channel.span, message)
            .help("what is learnt at one place does not generalise to another")
            .help(format!("use the position relative to the body: `({limb}.position - pelvis.position) in heading(pelvis)`"));
        diagnostics.push(diagnostic);
    }
}

/// Landmarks whose place is that of the body.
const TRUNK: [&str; 5] = ["pelvis", "torso", "chest", "neck", "head"];

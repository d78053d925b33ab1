//! Channels that no policy can use, because noise or age leave nothing of the signal, and those that no policy can have.

use crate::body::Property;
use crate::check::observe::ObservedChannel;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Code, Diagnostic, codes};
use crate::frame::Sensor;
use crate::graph::NodeId;
use crate::graph::interval::Bounds;
use crate::graph::operation::Operation;
use crate::numbers::for_people;
use crate::task::Setting;
use std::collections::BTreeMap;

/// Lints on single channels.
pub(super) fn of(task: &CheckedTask<'_>, bounds: &[Vec<Bounds>], diagnostics: &mut Vec<Diagnostic>) {
    for channel in &task.channels {
        diagnostics.extend(drowned(channel, bounds));
        diagnostics.extend(outdated(task, channel));
    }
    let hidden = hidden(task);
    diagnostics.extend(task.observed().filter_map(|channel| privileged(task, channel, &hidden)));
}

fn warning(code: &'static Code, channel: &ObservedChannel, message: String) -> Diagnostic {
    Diagnostic::new(code, channel.file, channel.span, message)
}

/// Noise whose size is at least half of what the signal can be.
fn drowned(channel: &ObservedChannel, bounds: &[Vec<Bounds>]) -> Option<Diagnostic> {
    let range = |node: NodeId| {
        let widths = bounds[node.index()].iter().map(|lane| lane.high - lane.low);
        widths.fold(0.0, crate::extremes::maximum)
    };
    let (size, width) =
        channel.noise.iter().map(|noise| (noise.size, range(noise.signal))).find(|(size, width)| 2.0 * size >= *width)?;
    let message = format!("the noise of the channel `{}` is as large as its signal", channel.name);
    let [size, width] = [size, width].map(for_people);
    let help = format!("the noise has a size of {size}, while the signal varies by {width} at most, in SI units");
    Some(warning(codes::channels::DROWNED, channel, message).help(help))
}

/// Values from before the first step of every episode.
fn outdated(task: &CheckedTask<'_>, channel: &ObservedChannel) -> Option<Diagnostic> {
    let horizon = task.timing.horizon;
    if channel.past < horizon {
        return None;
    }
    let message = format!("the channel `{}` shows what was {} steps ago; an episode has {horizon}", channel.name, channel.past);
    let help = "values from before an episode repeat its first one: shorten the `delay` or the `history`";
    Some(warning(codes::channels::OUTDATED, channel, message).help(help))
}

/// The randoms that decide what no sensor measures, by their numbers, and what they decide.
fn hidden(task: &CheckedTask<'_>) -> BTreeMap<u32, String> {
    let variation = &task.init.variation;
    let object = |object: usize| task.scene.objects.get(object).map_or("an object", |object| &object.name);
    let decides = |setting: Setting| match setting {
        Setting::Strength(_) => Some("the strength of muscles".to_owned()),
        Setting::SegmentMass(_) => Some("the mass of segments".to_owned()),
        Setting::ObjectMass(row) => variation.masses.get(row).map(|known| format!("the mass of `{}`", object(known.object))),
        Setting::Friction(row) => variation.frictions.get(row).map(|known| match known.object {
            Some(index) => format!("the friction of `{}`", object(index)),
            None => "the friction of the ground".to_owned(),
        }),
        Setting::Damping(_) => Some("the damping of joints".to_owned()),
        Setting::Stiffness(_) => Some("the stiffness of joints".to_owned()),
        Setting::ObjectJoint(row) => variation.joints.get(row).map(|known| {
            let word = if known.property == Property::Stiffness { "stiffness" } else { "damping" };
            format!("the {word} of a joint of `{}`", object(known.object))
        }),
        _ => None,
    };
    let mut hidden = BTreeMap::new();
    for &(setting, value) in &task.init.drawn {
        let (Some(what), Some(&node)) = (decides(setting), task.initial_values.get(value)) else { continue };
        for id in task.graph.reachable([node]) {
            if let Operation::Drawn(random) = task.graph.node(id).operation {
                hidden.entry(random).or_insert_with(|| what.clone());
            }
        }
    }
    hidden
}

fn privileged(task: &CheckedTask<'_>, channel: &ObservedChannel, hidden: &BTreeMap<u32, String>) -> Option<Diagnostic> {
    let measures = |sensors: &[Sensor]| sensors.iter().any(|sensor| matches!(sensor, Sensor::MuscleStrength(_)));
    let what = task.graph.reachable([channel.node]).into_iter().find_map(|id| match &task.graph.node(id).operation {
        Operation::Drawn(random) | Operation::DrawnAfter(random) => hidden.get(random).cloned(),
        Operation::Sensors(sensors) if measures(sensors) => Some("the strength of muscles".to_owned()),
        _ => None,
    })?;
    let message = format!("the channel `{}` shows {what}, which no sensor measures", channel.name);
    let help = "put it into `critic { ... }`; a policy can observe what follows from it";
    Some(warning(codes::channels::PRIVILEGED, channel, message).help(help))
}

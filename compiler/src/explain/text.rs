//! `msk explain` as text for terminals.

use super::gather::{Options, task_report};
use super::report::*;
use crate::numbers::{exact, for_people};
use crate::task::CompiledTask;
use std::fmt::Write;

/// The text of a task report: scene, initial state, every term with its formula, weight, range, inputs and state; terminations;
/// channels.
pub fn text(task: &CompiledTask, options: &Options<'_>) -> String {
    let report = task_report(task, options);
    // Writing to a string cannot fail, here and below.
    let mut text = String::new();
    head(&report, &mut text);
    scene(&report, &mut text);
    initial_state(&report, &mut text);
    settings(&report, &mut text);
    for phase in &report.phases {
        if report.phases.len() > 1 {
            let until = phase.until.as_ref().map_or_else(String::new, |until| format!(", until {}", until.source));
            let _ = writeln!(text, "\nPhase {} of {} steps{until}", phase.name, phase.horizon);
        }
        let _ = writeln!(text, "\nReward, per control step: the sum of weight times term");
        phase.terms.iter().for_each(|term| explain_term(term, &mut text));
        if let (Some(reward), true) = (report.reward_at_reset, phase.terms.iter().any(|term| term.at_reset.is_some())) {
            let _ = writeln!(text, "\n  at reset the reward is {}", for_people(reward));
        }
        definitions(phase, &mut text);
        ends(phase, &mut text);
        if !phase.metrics.is_empty() {
            let _ = writeln!(text, "\nLogged, not part of the reward");
        }
        let width = phase.metrics.iter().map(|metric| metric.name.chars().count()).max().unwrap_or(0);
        for metric in &phase.metrics {
            let _ = writeln!(text, "  {:<width$}  = {}", metric.name, metric.formula.text);
        }
    }
    channels(&report, &mut text);
    action(&report, &mut text);
    let _ = writeln!(text, "\nhash {}", report.hash);
    text
}

fn head(report: &TaskReport, text: &mut String) {
    let family = if report.family.is_empty() { String::new() } else { format!(" ({})", report.family) };
    let _ = writeln!(text, "{}{family}", report.name);
    if !report.summary.is_empty() {
        let _ = writeln!(text, "{}", report.summary);
    }
    let _ = writeln!(
        text,
        "\nbody {}, control {} Hz, horizon {} steps ({} s){}",
        report.body,
        report.control_frequency,
        report.horizon,
        for_people(report.duration),
        if report.symmetric { ", symmetric" } else { "" }
    );
}

fn action(report: &TaskReport, text: &mut String) {
    let _ = writeln!(text, "\nAction, {}", report.action.in_words());
    for row in report.action.entries.chunks(8) {
        let _ = writeln!(text, "  {}", row.join(", "));
    }
}

fn scene(report: &TaskReport, text: &mut String) {
    let scene = &report.scene;
    if scene.ground && scene.objects.is_empty() && scene.connections.is_empty() && report.disturbances.is_empty() {
        return;
    }
    let _ = writeln!(text, "\nScene{}", if scene.ground { ", on level ground" } else { ", without ground" });
    let width = scene.objects.iter().map(|object| object.name.chars().count()).max().unwrap_or(0);
    for object in &scene.objects {
        let mut parts = vec![object.kind.clone()];
        parts.extend([&object.size].into_iter().filter(|size| !size.is_empty()).cloned());
        let on = if object.parent == "world" { String::new() } else { format!(" of {}", object.parent) };
        parts.push(format!("at [{}] m{on}", object.position.map(for_people).join(", ")));
        parts.extend((object.motion != "fixed").then(|| object.motion.clone()));
        parts.extend((object.mass > 0.0).then(|| format!("{} kg", for_people(object.mass))));
        parts.extend(object.walkable.then(|| "walkable".to_owned()));
        parts.extend((!object.solid).then(|| "not solid".to_owned()));
        let _ = writeln!(text, "  {:<width$}  {}", object.name, parts.join(", "));
    }
    for held in &scene.connections {
        let release = if held.released { ", can be released" } else { "" };
        let _ = writeln!(text, "  {} {} to {}{release}", held.kind, held.from, held.to);
    }
    for (name, members) in &scene.groups {
        let _ = writeln!(text, "  group {name}: {}", members.join(", "));
    }
    if !scene.markers.is_empty() {
        let _ = writeln!(text, "  marked: {}", scene.markers.join(", "));
    }
    for push in &report.disturbances {
        let (force, torque) = (push.force.map(for_people).join(", "), push.torque.map(for_people).join(", "));
        let _ = writeln!(
            text,
            "  disturbs {}: force [{force}] N, torque [{torque}] N m, at {} s for {} s{}",
            push.on,
            for_people(push.start),
            for_people(push.duration),
            push.varies()
        );
    }
}

fn initial_state(report: &TaskReport, text: &mut String) {
    let initial_state = &report.initial_state;
    let _ = writeln!(text, "\nInitial state: {}", initial_state.root);
    for row in initial_state.independent_joints().chunks(4) {
        let joints: Vec<String> = row.iter().map(|(name, joint)| format!("{name} {}", joint.angle())).collect();
        let _ = writeln!(text, "  {}", joints.join(", "));
    }
    for line in initial_state.noise.iter().map(|noise| format!("noise on {noise}")).chain(initial_state.objects.iter().cloned()) {
        let _ = writeln!(text, "  {line}");
    }
    for scaled in &initial_state.scaled {
        let _ = writeln!(text, "  {scaled}");
    }
    if !initial_state.drawn.is_empty() {
        let _ = writeln!(text, "  drawn: {}", initial_state.drawn.join(", "));
    }
    if !initial_state.settle.is_empty() {
        let _ = writeln!(text, "  settles for {}", initial_state.settle);
    }
}

/// Parameters and randoms.
fn settings(report: &TaskReport, text: &mut String) {
    if !report.parameters.is_empty() {
        let _ = writeln!(text, "\nParameters");
    }
    for parameter in &report.parameters {
        let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
        let range =
            parameter.range.map_or(String::new(), |[low, high]| format!(", {} .. {}{unit}", for_people(low), for_people(high)));
        let set = if parameter.value == parameter.default {
            String::new()
        } else {
            format!(", usually {}", for_people(parameter.default))
        };
        let per_episode = if parameter.per_episode { ", per episode" } else { "" };
        let _ = writeln!(text, "  {} = {}{unit}{range}{set}{per_episode}", parameter.name, for_people(parameter.value));
    }
    if !report.motions.is_empty() {
        let _ = writeln!(text, "\nFollows");
    }
    for motion in &report.motions {
        let _ = writeln!(text, "  {} = {}", motion.name, motion.in_words());
    }
    if !report.randoms.is_empty() {
        let _ = writeln!(text, "\nDrawn for each episode");
    }
    for random in &report.randoms {
        let clause = |word: &str, clause: &str| if clause.is_empty() { String::new() } else { format!(" {word} {clause}") };
        let (accept, redraw) = (clause("where", &random.accept), clause("redraw when", &random.redraw));
        let _ = writeln!(text, "  {} = {}{accept}{redraw}", random.name, random.source);
    }
}

fn explain_term(term: &TermReport, text: &mut String) {
    let bounds = match (term.fixed, term.weight_range) {
        (true, _) => " (fixed)".to_owned(),
        (_, Some([low, high])) => format!(" ({}..{})", exact(low), exact(high)),
        _ => String::new(),
    };
    let from = match term.weight_from == crate::task::Origin::Source.to_string() {
        true => String::new(),
        false => format!("   (weight from {}; {} in the source)", term.weight_from, for_people(term.weight_in_source)),
    };
    let weight = for_people(term.weight);
    let weight = match &term.schedule {
        None => weight,
        Some(schedule) => format!("{} -> {weight} {}", for_people(schedule.from), schedule.shares()),
    };
    let _ = writeln!(text, "\n  {weight:>7}{bounds} {}{from}", term.name);
    let _ = writeln!(text, "          = {}{}", term.formula.text, if term.per_second { ", per second" } else { "" });
    if !term.docs.is_empty() {
        let _ = writeln!(text, "          {}", term.docs);
    }
    let kind = if term.condition { "a condition, 0 or 1" } else { "dimensionless" };
    let _ = writeln!(text, "          is {kind}, {}", range(term.bounds));
    if !term.reads.is_empty() {
        let _ = writeln!(text, "          reads {}", term.reads.join(", "));
    }
    if !term.remembers.is_empty() {
        let _ = writeln!(text, "          remembers {}", term.remembers.join("; "));
    }
    if let Some(value) = term.at_reset {
        let _ = writeln!(text, "          at reset {}, contribution {}", for_people(value), for_people(value * term.weight));
    }
}

/// What formulas name.
fn definitions(phase: &PhaseReport, text: &mut String) {
    if !phase.definitions.is_empty() {
        let _ = writeln!(text, "\nWhere");
    }
    for definition in &phase.definitions {
        let arguments =
            if definition.parameters.is_empty() { String::new() } else { format!("({})", definition.parameters.join(", ")) };
        let mut line = format!("  {}{arguments}", definition.name);
        for (word, formula) in &definition.parts {
            line += &if word.is_empty() { format!(" = {}", formula.text) } else { format!(" {word} {}", formula.text) };
        }
        let _ = writeln!(text, "{line}");
    }
}

fn ends(phase: &PhaseReport, text: &mut String) {
    let write_end = |text: &mut String, end: &EndReport| {
        let after = if end.after.is_empty() { String::new() } else { format!(", after {}", end.after) };
        let holds = if end.holds_at_reset == Some(true) { "   (holds at reset!)" } else { "" };
        let bootstrap = if end.bootstrap { ", bootstraps" } else { "" };
        let _ = writeln!(text, "  {} when {}{after}{bootstrap}{holds}", end.name, end.condition.source);
    };
    let _ = writeln!(text, "\nTerminates as a failure");
    if phase.terminations.is_empty() {
        let _ = writeln!(text, "  never");
    }
    phase.terminations.iter().for_each(|end| write_end(text, end));
    if !phase.finishes.is_empty() {
        let _ = writeln!(text, "\nFinishes");
    }
    phase.finishes.iter().for_each(|end| write_end(text, end));
    if let Some(success) = &phase.success {
        let holds = if success.holds_at_reset == Some(true) { "   (holds at reset!)" } else { "" };
        let _ = writeln!(text, "\nSucceeds when {} at the last step{holds}", success.condition.source);
    }
}

fn channels(report: &TaskReport, text: &mut String) {
    let observation = &report.observation;
    let _ = writeln!(text, "\nObserves {} values", observation.size);
    group(&observation.channels, text);
    if !observation.critic.is_empty() {
        let size: usize = observation.critic.iter().map(|channel| channel.size).sum();
        let _ = writeln!(text, "\nA critic sees {size} values more");
        group(&observation.critic, text);
    }
}

fn group(channels: &[ChannelReport], text: &mut String) {
    let width = channels.iter().map(|channel| channel.name.chars().count()).max().unwrap_or(0);
    for channel in channels {
        let end = channel.offset + channel.size;
        let (name, unit, settings) = (&channel.name, &channel.unit, &channel.settings);
        let line = format!(
            "  {:>5}..{:<5} {name:<width$}  {unit}{}{settings}",
            channel.offset,
            end,
            if settings.is_empty() { "" } else { "  " }
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
}

fn range([low, high]: [Option<f64>; 2]) -> String {
    match (low, high) {
        (Some(low), Some(high)) => format!("between {} and {}", for_people(low), for_people(high)),
        (Some(low), None) => format!("never below {}", for_people(low)),
        (None, Some(high)) => format!("never above {}", for_people(high)),
        (None, None) => "unbounded".to_owned(),
    }
}

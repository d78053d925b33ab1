//! `msk explain` as text.

use crate::evaluation::Middle;
use crate::graph::NodeId;
use crate::graph::interval::Bounds;
use crate::graph::operation::{Memory, Operation};
use crate::task::{CompiledTask, FollowedMotion, Phase, Spread, StepReport, TaskState, Term};
use std::fmt::Write;

/// What an explanation may tell besides the source.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options<'a> {
    /// The frame of the reset snapshot, `task.frame.size()` values: adds the value of every term at reset.
    pub reset: Option<&'a [f64]>,
}

/// A task explained: every term with its formula, weight, range, what it reads and what it remembers; channels; ends.
pub fn text(task: &CompiledTask, options: &Options<'_>) -> String {
    let mut text = String::new();
    head(task, &mut text);
    let at_reset = options.reset.filter(|frame| frame.len() == task.frame.size()).and_then(|frame| {
        let (mut state, mut report) = (TaskState::default(), StepReport::default());
        // A random without a middle that fulfils its condition leaves nothing to show.
        task.reset(frame, &mut Middle, &mut state).ok()?;
        task.report(frame, &task.weights(), &state, &mut report);
        Some(report)
    });
    settings(task, &mut text);
    for (index, phase) in task.phases.iter().enumerate() {
        // Only the first phase has the reset as its first snapshot.
        let at_reset = at_reset.as_ref().filter(|_| index == 0);
        if task.phases.len() > 1 {
            let until = if phase.meaning.until.is_empty() { String::new() } else { format!(", until {}", phase.meaning.until) };
            let _ = writeln!(text, "\nPhase {} of {} steps{until}", phase.name, phase.horizon);
        }
        let _ = writeln!(text, "\nReward, per control step: the sum of weight times term");
        for (own, index) in phase.terms.clone().enumerate() {
            explain_term(task, phase, own, &task.terms[index], at_reset.map(|report| report.terms[index]), &mut text);
        }
        if let Some(report) = at_reset {
            let _ = writeln!(text, "\n  at reset the sum is {}", short(report.reward));
        }
        ends(task, phase, at_reset, &mut text);
    }
    channels(task, &mut text);
    metrics(task, &mut text);
    let _ = writeln!(text, "\nhash {}", task.hash);
    text
}

/// Parameters and randoms.
fn settings(task: &CompiledTask, text: &mut String) {
    if !task.parameters.is_empty() {
        let _ = writeln!(text, "\nParameters");
    }
    for parameter in &task.parameters {
        let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
        let range = parameter.range.map_or(String::new(), |[low, high]| format!(", {} .. {}{unit}", short(low), short(high)));
        let set =
            if parameter.value == parameter.default { String::new() } else { format!(", usually {}", short(parameter.default)) };
        let _ = writeln!(text, "  {} = {}{unit}{range}{set}", parameter.name, short(parameter.value));
    }
    if !task.motions.is_empty() {
        let _ = writeln!(text, "\nFollows");
    }
    for FollowedMotion { name, motion, start } in &task.motions {
        let kind = if motion.cycle { "a cycle" } else { "a motion" };
        let start = start.map_or("at a phase drawn for each episode".to_owned(), |phase| format!("at phase {}", short(phase)));
        let (title, duration) = (&motion.name, short(motion.duration));
        let _ = writeln!(text, "  {name} = {title}, {kind} of {duration} s, {} joints, from {start}", motion.joints().count());
    }
    if !task.randoms.is_empty() {
        let _ = writeln!(text, "\nDrawn for each episode");
    }
    for random in &task.randoms {
        let clause = |word: &str, clause: &str| if clause.is_empty() { String::new() } else { format!(" {word} {clause}") };
        let (accept, redraw) = (clause("where", &random.accept), clause("redraw when", &random.redraw));
        let _ = writeln!(text, "  {} = {}{accept}{redraw}", random.name, random.source);
    }
}

fn metrics(task: &CompiledTask, text: &mut String) {
    if !task.metrics.is_empty() {
        let names: Vec<&str> = task.metrics.iter().map(|metric| metric.name.as_str()).collect();
        let _ = writeln!(text, "\nLogs, never paid: {}", names.join(", "));
    }
}

fn head(task: &CompiledTask, text: &mut String) {
    let _ = writeln!(text, "{}{}", task.name, if task.family.is_empty() { String::new() } else { format!(" ({})", task.family) });
    if !task.summary.is_empty() {
        let _ = writeln!(text, "{}", task.summary);
    }
    let seconds = f64::from(task.horizon) / task.control_frequency;
    let _ = writeln!(
        text,
        "\nbody {}, control {} Hz, horizon {} steps ({} s){}",
        task.body.name,
        task.control_frequency,
        task.horizon,
        short(seconds),
        if task.symmetric { ", symmetric" } else { "" }
    );
    let root = task.init.root.height.map_or("standing on the ground".to_owned(), |height| format!("root at {height} m"));
    let widest = |spreads: &[Spread]| {
        let widths = spreads.iter().map(|spread| match spread {
            Spread::None => 0.0,
            Spread::Normal(deviation) => *deviation,
            Spread::Uniform(low, high) => low.abs().max(high.abs()),
        });
        widths.fold(0.0, f64::max)
    };
    let _ = writeln!(
        text,
        "begins {root}, noise {} rad on joints, {} rad/s on velocities",
        short(widest(&task.init.coordinate_noise)),
        short(widest(&task.init.velocity_noise))
    );
}

fn explain_term(task: &CompiledTask, phase: &Phase, own: usize, term: &Term, at_reset: Option<f64>, text: &mut String) {
    let meaning = &phase.meaning.terms[own];
    let bounds = match (term.fixed, term.weight_range) {
        (true, _) => " (fixed)".to_owned(),
        (_, Some([low, high])) => format!(" ({low}..{high})"),
        _ => String::new(),
    };
    let _ = writeln!(text, "\n  {:>7}{bounds} {}", short(term.weight), term.name);
    let _ = writeln!(text, "          = {}", meaning.mathematics);
    let kind = if meaning.condition { "a condition, counted 0 or 1" } else { "a plain number" };
    let _ = writeln!(text, "          is {kind}, {}", range(phase.meaning.term_bounds[own]));
    if !meaning.reads.is_empty() {
        let _ = writeln!(text, "          reads {}", meaning.reads.join(", "));
    }
    let owned = memories(task, phase, phase.meaning.outputs.terms[own]);
    if !owned.is_empty() {
        let _ = writeln!(text, "          remembers {}", owned.join(", "));
    }
    if let Some(value) = at_reset {
        let _ = writeln!(text, "          at reset {}, pays {}", short(value), short(value * term.weight));
    }
}

/// The memories that a node depends on, in words.
fn memories(task: &CompiledTask, phase: &Phase, node: NodeId) -> Vec<String> {
    let graph = &phase.meaning.graph;
    let nodes = graph.reachable([node]);
    let told = nodes.iter().filter_map(|id| {
        let node = graph.node(*id);
        Some(match &node.operation {
            Operation::Memory(Memory::Delay(steps)) => format!("{} value(s) {steps} step(s) ago", node.width),
            Operation::Memory(memory) => format!("{} value(s), {}", node.width, format!("{memory:?}").to_lowercase()),
            Operation::StateBefore(index) | Operation::StateAfter(index) => format!("state {index}"),
            Operation::Drawn(index) => format!("random {}", task.randoms[phase.streams[*index as usize]].name),
            _ => return None,
        })
    });
    told.collect()
}

fn ends(task: &CompiledTask, phase: &Phase, at_reset: Option<&StepReport>, text: &mut String) {
    let told = |text: &mut String, name: &str, condition: &str, holds: bool| {
        let _ = writeln!(text, "  {name} when {condition}{}", if holds { "   (holds at reset!)" } else { "" });
    };
    let _ = writeln!(text, "\nEnds as a failure");
    if phase.terminations.is_empty() {
        let _ = writeln!(text, "  never");
    }
    for (index, condition) in phase.terminations.clone().zip(&phase.meaning.terminations) {
        let holds = at_reset.is_some_and(|report| report.terminations.get(index) == Some(&true));
        told(text, &task.terminations[index], condition, holds);
    }
    if !phase.finishes.is_empty() {
        let _ = writeln!(text, "\nFinishes");
    }
    for (index, condition) in phase.finishes.clone().zip(&phase.meaning.finishes) {
        let holds = at_reset.is_some_and(|report| report.finishes.get(index) == Some(&true));
        told(text, &task.finishes[index], condition, holds);
    }
    let holds = at_reset.is_some_and(|report| report.success);
    let _ = writeln!(
        text,
        "\nSucceeds when {} at the last step{}",
        phase.meaning.success,
        if holds { "   (holds at reset!)" } else { "" }
    );
}

fn channels(task: &CompiledTask, text: &mut String) {
    let _ = writeln!(text, "\nObserves {} values", task.observation_size());
    let width = task.channels.iter().map(|channel| channel.name.chars().count()).max().unwrap_or(0);
    for channel in &task.channels {
        let end = channel.offset + channel.size;
        let _ = writeln!(text, "  {:>5}..{:<5} {:<width$}  {}", channel.offset, end, channel.name, channel.unit);
    }
}

fn range(bounds: Bounds) -> String {
    match (bounds.low.is_finite(), bounds.high.is_finite()) {
        (true, true) => format!("between {} and {}", short(bounds.low), short(bounds.high)),
        (true, false) => format!("never below {}", short(bounds.low)),
        (false, true) => format!("never above {}", short(bounds.high)),
        (false, false) => "unbounded".to_owned(),
    }
}

/// At most six significant digits; far from one as a power of ten.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 {
        // Nothing times a negative weight is plain nothing to a reader.
        return "0".to_owned();
    }
    if !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..9).contains(&exponent) {
        return format!("{value:.2e}");
    }
    let digits = (5 - exponent).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

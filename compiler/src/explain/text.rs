//! `msk explain` as text.

use crate::graph::NodeId;
use crate::graph::interval::Bounds;
use crate::graph::operation::{Memory, Operation};
use crate::task::{CompiledTask, Spread, StepReport, TaskState, Term};
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
    let at_reset = options.reset.filter(|frame| frame.len() == task.frame.size()).map(|frame| {
        let (mut state, mut report) = (TaskState::default(), StepReport::default());
        task.reset(frame, &mut state);
        task.report(frame, &task.weights(), &state, &mut report);
        report
    });
    let _ = writeln!(text, "\nReward, per control step: the sum of weight times term");
    for (index, term) in task.terms.iter().enumerate() {
        explain_term(task, index, term, at_reset.as_ref(), &mut text);
    }
    if let Some(report) = &at_reset {
        let _ = writeln!(text, "\n  at reset the sum is {}", short(report.reward));
    }
    ends(task, at_reset.as_ref(), &mut text);
    channels(task, &mut text);
    let _ = writeln!(text, "\nhash {}", task.hash);
    text
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

fn explain_term(task: &CompiledTask, index: usize, term: &Term, at_reset: Option<&StepReport>, text: &mut String) {
    let meaning = &task.meaning.terms[index];
    let bounds = match (term.fixed, term.weight_range) {
        (true, _) => " (fixed)".to_owned(),
        (_, Some([low, high])) => format!(" ({low}..{high})"),
        _ => String::new(),
    };
    let _ = writeln!(text, "\n  {:>7}{bounds} {}", short(term.weight), term.name);
    let _ = writeln!(text, "          = {}", meaning.mathematics);
    let kind = if meaning.condition { "a condition, counted 0 or 1" } else { "a plain number" };
    let _ = writeln!(text, "          is {kind}, {}", range(task.meaning.term_bounds[index]));
    if !meaning.reads.is_empty() {
        let _ = writeln!(text, "          reads {}", meaning.reads.join(", "));
    }
    let owned = memories(task, task.meaning.outputs.terms[index]);
    if !owned.is_empty() {
        let _ = writeln!(text, "          remembers {}", owned.join(", "));
    }
    if let Some(report) = at_reset {
        let _ = writeln!(
            text,
            "          at reset {}, pays {}",
            short(report.terms[index]),
            short(report.terms[index] * term.weight)
        );
    }
}

/// The memories that a node depends on, in words.
fn memories(task: &CompiledTask, node: NodeId) -> Vec<String> {
    let graph = &task.meaning.graph;
    let nodes = graph.reachable([node]);
    let told = nodes.iter().filter_map(|id| {
        let node = graph.node(*id);
        Some(match &node.operation {
            Operation::Memory(Memory::Delay(steps)) => format!("{} value(s) {steps} step(s) ago", node.width),
            Operation::Memory(memory) => format!("{} value(s), {}", node.width, format!("{memory:?}").to_lowercase()),
            Operation::StateBefore(index) | Operation::StateAfter(index) => format!("state {index}"),
            _ => return None,
        })
    });
    told.collect()
}

fn ends(task: &CompiledTask, at_reset: Option<&StepReport>, text: &mut String) {
    let _ = writeln!(text, "\nEnds as a failure");
    if task.terminations.is_empty() {
        let _ = writeln!(text, "  never");
    }
    for (index, (name, condition)) in task.terminations.iter().zip(&task.meaning.terminations).enumerate() {
        let holds = at_reset.is_some_and(|report| report.terminations.get(index) == Some(&true));
        let _ = writeln!(text, "  {name} when {condition}{}", if holds { "   (holds at reset!)" } else { "" });
    }
    let holds = at_reset.is_some_and(|report| report.success);
    let _ = writeln!(
        text,
        "\nSucceeds when {} at the last step{}",
        task.meaning.success,
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

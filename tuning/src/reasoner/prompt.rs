//! The prompt of a reasoner that reads words.

use super::Request;
use crate::statistics::{Allowed, TermStatistics};
use msk_compiler::numbers::for_people;
use msk_compiler::weights::written;
use std::fmt::Write;

/// The request in words: what the terms are, what they did, what may be changed, and that the answer is data only.
pub fn prompt(request: &Request) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "You tune the weights of a reward function. The reward of a control step is the sum of weight times term.\n\n\
         Task: {} ({})\nAim: {}\nAn episode has at most {} steps.\n",
        request.task, request.summary, request.objective, request.horizon
    );
    terms(request, &mut text);
    outcome(request, &mut text);
    rules(request, &mut text);
    text
}

fn terms(request: &Request, text: &mut String) {
    let _ = writeln!(text, "Terms (dimensionless):");
    for (term, (_, formula)) in request.statistics.terms.iter().zip(&request.formulas) {
        let _ = writeln!(text, "- {} = {formula}", term.term);
        let _ = writeln!(text, "  weight {}, {}; value {}", written(term.weight), allowed(term), range(term.range));
        let _ = writeln!(
            text,
            "  per step: mean {}, standard deviation {}; share of the reward {}; saturated {}, dead {} of the steps; correlation with success {}, with survival {}",
            number(term.mean),
            number(term.deviation),
            percent(term.share),
            percent(term.saturated),
            percent(term.dead),
            number(term.with_success),
            number(term.with_survival),
        );
    }
    text.push('\n');
}

fn allowed(term: &TermStatistics) -> String {
    match term.bounds {
        _ if !term.in_scope => "not to be changed".into(),
        Allowed::Fixed => "not to be changed".into(),
        Allowed::Between(low, high) => format!("allowed {} to {}", written(low), written(high)),
        Allowed::SameSign if term.weight > 0.0 => "must stay above 0".into(),
        Allowed::SameSign if term.weight < 0.0 => "must stay below 0".into(),
        Allowed::SameSign => "must stay 0".into(),
    }
}

fn range([low, high]: [Option<f64>; 2]) -> String {
    match (low, high) {
        (Some(low), Some(high)) => format!("between {} and {}", for_people(low), for_people(high)),
        (Some(low), None) => format!("at least {}", for_people(low)),
        (None, Some(high)) => format!("at most {}", for_people(high)),
        (None, None) => "unbounded".into(),
    }
}

fn outcome(request: &Request, text: &mut String) {
    let statistics = &request.statistics;
    let _ = writeln!(
        text,
        "Outcome of {} episodes, {} steps: {:.1} % succeeded; {} steps survived on average.",
        statistics.episodes,
        statistics.steps,
        100.0 * statistics.success_rate,
        number(statistics.survival.map(|spread| spread.mean))
    );
    let endings: Vec<String> = statistics.ended_by.iter().map(|(reason, count)| format!("{reason} {count}")).collect();
    let _ = writeln!(text, "Episodes ended by: {}.", endings.join(", "));
    for metric in &statistics.metrics {
        let [mean, last] = [metric.mean, metric.last].map(|spread| number(spread.map(|spread| spread.mean)));
        let unit = if metric.unit.is_empty() { "no unit" } else { &metric.unit };
        let _ = writeln!(text, "- {} [{unit}]: mean {mean}, at the end {last}", metric.metric);
    }
    if !request.history.is_empty() {
        let _ = writeln!(text, "\nEarlier rounds, the oldest first:");
    }
    for past in &request.history {
        let weights: Vec<String> = past.weights.iter().map(|(term, weight)| format!("{term} {}", written(*weight))).collect();
        let _ = writeln!(text, "- round {}: score {}; {}", past.round, number(Some(past.score)), weights.join(", "));
    }
    text.push('\n');
}

fn rules(request: &Request, text: &mut String) {
    let _ = writeln!(
        text,
        "Rules: a weight may change by at most {} % of its size; signs stay; a weight of 0 stays 0; each weight stays within its bounds above.",
        written(100.0 * request.step)
    );
    if let Some(norm) = request.norm {
        let _ = writeln!(text, "The absolute values of all weights that may be changed must sum to {}.", written(norm));
    }
    let _ = write!(
        text,
        "Weights that you leave out stay unchanged.\n\nAnswer with data only: one JSON object {{\"weights\": {{\"term\": number, ...}}, \"reason\": \"one sentence\"}}. No code, no other words.\n"
    );
}

fn number(value: Option<f64>) -> String {
    value.map_or("unknown".into(), for_people)
}

fn percent(value: Option<f64>) -> String {
    value.map_or("unknown".into(), |value| format!("{:.1} %", 100.0 * value))
}

//! The beginning of a task: overlaps, what does not hold together, ends that hold at the first step.

use crate::episode::{Ending, Episode, EpisodeKey, Penetration, REST, Residual};
use crate::library::{BodyLibrary, in_words};
use msk_compiler::diagnostics::codes::{lints, probing};
use msk_compiler::diagnostics::{Code, Diagnostic, FileId, Span};
use msk_compiler::task::CompiledTask;
use std::sync::Arc;

/// How often a task is begun: enough to see through its noise.
const SEEDS: u64 = 3;

/// How many overlaps or gaps are told one by one.
const MOST_TOLD: usize = 4;

/// What was found over all seeds.
#[derive(Default)]
struct Found {
    /// The deepest of each pair of shapes.
    penetrations: Vec<Penetration>,
    /// The largest of each connection.
    residuals: Vec<Residual>,
    /// In how many episodes each termination, each reason to finish and success held.
    terminations: Vec<u64>,
    finishes: Vec<u64>,
    success: u64,
}

/// Begins a task with several seeds and tells what is wrong with that.
pub(super) fn probe(task: &Arc<CompiledTask>, bodies: &BodyLibrary) -> Vec<Diagnostic> {
    let told = match found(task, bodies) {
        Ok(found) => tell(task, &found),
        Err(reason) => {
            let message = format!("the task `{}` cannot begin", task.name);
            vec![(CANNOT_BEGIN, at(probing::CANNOT_BEGIN, task.places.init, message).found(reason))]
        }
    };
    told.into_iter().filter(|(lint, _)| !task.places.allowed.contains(*lint)).map(|(_, diagnostic)| diagnostic).collect()
}

/// Names under which what is found is allowed.
const CANNOT_BEGIN: &str = "cannot_begin";
const STARTS_INSIDE: &str = "starts_inside";
const STARTS_APART: &str = "starts_apart";
const HOLDS_AT_RESET: &str = "holds_at_reset";

fn found(task: &Arc<CompiledTask>, bodies: &BodyLibrary) -> Result<Found, String> {
    let staged = bodies.stage(&task.body, &task.scene).map_err(|error| in_words(&error))?;
    let mut episode = Episode::new(staged.model, staged.body, task.clone()).map_err(|error| in_words(&error))?;
    let rest = vec![REST; episode.context().body.muscles.len()];
    let mut found =
        Found { terminations: vec![0; task.terminations.len()], finishes: vec![0; task.finishes.len()], ..Found::default() };
    for seed in 0..SEEDS {
        let key = EpisodeKey { seed, episode: 0 };
        let start = episode.inspect_start(key).map_err(|error| in_words(&error))?;
        start.penetrations.into_iter().for_each(|overlap| found.overlap(overlap));
        start.residuals.into_iter().for_each(|gap| found.gap(gap));
        episode.reset(key);
        if episode.ending().is_none() {
            episode.step(&rest).map_err(|error| in_words(&error))?;
        }
        if let Some(Ending::Fault(fault)) = episode.ending() {
            return Err(format!("at step {} of seed {seed}: {}", episode.steps(), in_words(fault)));
        }
        let report = episode.report();
        let count =
            |counts: &mut [u64], holds: &[bool]| counts.iter_mut().zip(holds).for_each(|(n, holds)| *n += u64::from(*holds));
        count(&mut found.terminations, &report.terminations);
        count(&mut found.finishes, &report.finishes);
        found.success += u64::from(report.success);
    }
    found.penetrations.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    Ok(found)
}

impl Found {
    fn overlap(&mut self, new: Penetration) {
        match self.penetrations.iter_mut().find(|known| known.shapes == new.shapes) {
            Some(known) => known.depth = known.depth.max(new.depth),
            None => self.penetrations.push(new),
        }
    }

    fn gap(&mut self, new: Residual) {
        match self.residuals.iter_mut().find(|known| known.name == new.name) {
            Some(known) => {
                known.distance = known.distance.max(new.distance);
                known.turn = known.turn.max(new.turn);
            }
            None => self.residuals.push(new),
        }
    }
}

/// What is found as warnings, each with the name under which it is allowed.
fn tell(task: &CompiledTask, found: &Found) -> Vec<(&'static str, Diagnostic)> {
    let places = &task.places;
    let mut told = Vec::new();
    if let Some(deepest) = found.penetrations.first() {
        let message = format!("the task `{}` begins with {}", task.name, overlap(deepest));
        let diagnostic = at(probing::STARTS_INSIDE, places.init, message);
        let diagnostic = others(diagnostic, found.penetrations.iter().map(overlap));
        told.push((STARTS_INSIDE, diagnostic.help("move one of them, or say `allow starts_inside \"...\"`")));
    }
    if let Some(first) = found.residuals.first() {
        let message = format!("the task `{}` begins with {}", task.name, gap(first));
        let diagnostic = at(probing::STARTS_APART, places.init, message);
        let diagnostic = others(diagnostic, found.residuals.iter().map(gap));
        told.push((
            STARTS_APART,
            diagnostic.help("begin where both meet, hold them `here`, or say `allow starts_apart \"...\"`"),
        ));
    }
    // A failure is wrong in any episode; what is no failure may be met by chance, but not always.
    let failures = task.terminations.iter().zip(&places.terminations).zip(&found.terminations);
    for ((name, place), &count) in failures.filter(|(_, count)| **count > 0) {
        told.push((HOLDS_AT_RESET, holds(&format!("the termination `{name}`"), *place, count)));
    }
    let finishes = task.finishes.iter().zip(&places.finishes).zip(&found.finishes);
    for ((name, place), &count) in finishes.filter(|(_, count)| **count == SEEDS) {
        told.push((HOLDS_AT_RESET, holds(&format!("the reason to finish `{name}`"), *place, count)));
    }
    // The last step of an episode may well succeed.
    if found.success == SEEDS && task.horizon > 1 {
        told.push((HOLDS_AT_RESET, holds("success", places.success, found.success)));
    }
    told
}

fn holds(what: &str, place: (FileId, Span), count: u64) -> Diagnostic {
    let message = format!("{what} holds at the first step, with muscles at rest, in {count} of {SEEDS} episodes");
    at(lints::HOLDS_AT_RESET, place, message).help("mend the condition or the beginning, or say `allow holds_at_reset \"...\"`")
}

fn overlap(found: &Penetration) -> String {
    let [one, other] = &found.shapes;
    format!("`{one}` {:.1} mm inside `{other}`", 1e3 * found.depth)
}

fn gap(found: &Residual) -> String {
    let turn = if found.turn > 0.0 { format!(" and {:.1} degrees", found.turn.to_degrees()) } else { String::new() };
    // A coupling of angles is missed by radians, which are told as thousandths just as metres are.
    format!("`{}` apart by {:.3} mm or mrad{turn}", found.name, 1e3 * found.distance)
}

/// Tells what the message does not: all but the first.
fn others(diagnostic: Diagnostic, all: impl ExactSizeIterator<Item = String>) -> Diagnostic {
    let more = all.len().saturating_sub(MOST_TOLD);
    let diagnostic = all.take(MOST_TOLD).skip(1).fold(diagnostic, |diagnostic, one| diagnostic.help(format!("also {one}")));
    if more > 0 { diagnostic.help(format!("and {more} more")) } else { diagnostic }
}

fn at(code: &'static Code, (file, span): (FileId, Span), message: String) -> Diagnostic {
    Diagnostic::new(code, file, span, message)
}

//! Checks of the initial state: penetrations, unsatisfied constraints, terminations true at step 0.

use super::at;
use super::poses::Room;
use msk_compiler::diagnostics::codes::{lints, probing};
use msk_compiler::diagnostics::{Diagnostic, FileId, Span};
use msk_compiler::lint::DEAD;
use msk_compiler::survey::{About, Survey};
use msk_physics::State;
use msk_physics::collision::{Placed, Scratch, distance};
use msk_physics::scalar::Real;
use msk_program::numbers::for_people;
use msk_program::task::CompiledTask;
use msk_runtime::episode::{Ending, Environment, EpisodeKey, Penetration, Residual};
use msk_runtime::library::{BodyLibrary, BoundBody, in_words};
use std::sync::Arc;

/// How often a task is begun: enough to see through its noise, and more often where body or scene differ between episodes, so that
/// an impossible or unlucky world in twenty is seen.
const EPISODES: u64 = 3;
const WORLDS: u64 = 60;

/// How many overlaps or gaps are listed one by one.
const MOST_LISTED: usize = 4;

/// Shapes that are worn may be so deep in what wears them, m.
const DEEPEST_WORN: f64 = 0.01;

/// A body that begins higher than this above everything falls, m.
const HIGHEST: f64 = 0.01;

/// A task that can begin.
pub(super) struct Begun {
    pub staged: BoundBody,
    pub episode: Environment,
    /// Where the first seed begins.
    pub state: State<f64>,
    /// The sensor records of all initial states.
    pub frames: Vec<Vec<f64>>,
}

/// What was found over all seeds.
#[derive(Default)]
struct Tally {
    /// How often the task was begun.
    episodes: u64,
    /// The deepest of each pair of shapes.
    penetrations: Vec<Penetration>,
    /// The largest of each connection.
    residuals: Vec<Residual>,
    /// In how many episodes each termination, each reason to finish and success held.
    terminations: Vec<u64>,
    finishes: Vec<u64>,
    success: u64,
    /// What each term was at most at the first step.
    terms: Vec<f64>,
}

/// Resets a task with several seeds and reports what is wrong; a task that cannot be reset is not probed further.
pub(super) fn probe(task: &Arc<CompiledTask>, bodies: &BodyLibrary, diagnostics: &mut Vec<Diagnostic>) -> Option<Begun> {
    match begin(task, bodies) {
        Ok((begun, tally)) => {
            diagnostics.append(&mut warnings(task, &tally));
            dead(task, &tally, diagnostics);
            Some(begun)
        }
        Err(reason) => {
            let message = format!("the task `{}` cannot be reset or stepped", task.name);
            let diagnostic = at(probing::CANNOT_RESET, task.places.init, message).found(reason);
            diagnostics.push(diagnostic);
            None
        }
    }
}

/// Terms of the first phase that could contribute much and contribute almost nothing in the initial state.
fn dead(task: &CompiledTask, found: &Tally, diagnostics: &mut Vec<Diagnostic>) {
    let Some(survey) = Survey::new(task, 0) else { return };
    for subject in survey.subjects().iter().filter(|subject| !subject.gated && subject.of_pose) {
        let About::Term(index) = subject.about else { continue };
        let (range, term) = (subject.range, &task.terms[index]);
        let Some(&most) = found.terms.get(index).filter(|_| term.weight > 0.0) else { continue };
        if range.low >= 0.0 && range.high.is_finite() && range.single().is_none() && most < DEAD * range.high {
            let message = format!("the term `{}` is almost zero in the initial state", term.name);
            let diagnostic = at(lints::DEAD_AT_RESET, subject.at, message)
                .expected(format!("more than a twentieth of its highest value, {}", for_people(range.high)))
                .found(format!("{} at most in {} episodes", for_people(most), found.episodes))
                .help("look for a wrong axis, side or sign; if the term becomes relevant later, write `allow dead_at_reset \"...\"`");
            diagnostics.push(diagnostic);
        }
    }
}

/// Reports a body that begins in the air with nothing that holds it.
pub(super) fn above(task: &CompiledTask, room: &mut Room<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let root = &task.init.root;
    let meant = root.lift > 0.0 || root.velocity != [0.0; 3] || task.init.follows.is_some() || task.init.settle.is_some();
    if meant || room.body.root.free.is_none() || room.body.shapes.is_empty() || !room.body.connections.is_empty() {
        return;
    }
    let height = room.initial_height();
    if height > HIGHEST && height.is_finite() {
        let message = format!("the task `{}` starts with the body {:.1} cm above everything: it falls", task.name, 1e2 * height);
        let diagnostic = at(probing::STARTS_ABOVE, task.places.init, message).help(
            "`height on ground` puts its lowest point on the ground; if a drop is intended, write `allow starts_above \"...\"`",
        );
        diagnostics.push(diagnostic);
    }
}

/// Reports objects that the body wears inside it: bodies fixed to each other never collide, so no contact shows it.
pub(super) fn worn(task: &CompiledTask, room: &Room<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let (model, kinematics) = (room.model, &room.workspace.kinematics);
    let mut scratch = Scratch::default();
    let mut overlaps: Vec<Penetration> = Vec::new();
    let shapes_of = |body: usize| (0..model.geoms.body.len()).filter(move |geom| model.geoms.body[*geom] == body);
    let solid = |geom: &usize| model.geoms.contact_type[*geom] != 0 || model.geoms.contact_affinity[*geom] != 0;
    for &thing in &room.body.carried {
        for one in shapes_of(thing).filter(solid) {
            for &other in &room.body.shapes {
                let placed = [one, other].map(|geom| Placed::of(model, kinematics, 0, geom));
                let gap = distance::between(&placed[0], &placed[1], 0.0, &mut scratch);
                if let Some(gap) = gap.filter(|gap| gap.distance < -DEEPEST_WORN) {
                    let shapes = [one, other].map(|geom| model.geoms.name[geom].clone());
                    overlaps.push(Penetration { shapes, depth: -gap.distance });
                }
            }
        }
    }
    overlaps.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    if let Some(deepest) = overlaps.first() {
        let message = format!("the task `{}` starts with attached objects inside the body: {}", task.name, overlap(deepest));
        let diagnostic = others(at(probing::STARTS_INSIDE, task.places.init, message), overlaps.iter().map(overlap));
        let help = "set their place: `at` in the frame of the parent, or write `allow starts_inside \"...\"`";
        diagnostics.push(diagnostic.help(help));
    }
}

fn begin(task: &Arc<CompiledTask>, bodies: &BodyLibrary) -> Result<(Begun, Tally), String> {
    let staged = bodies.stage(&task.body, &task.scene).map_err(|error| in_words(&error))?;
    let mut episode =
        Environment::new(staged.model.clone(), staged.body.clone(), task.clone()).map_err(|error| in_words(&error))?;
    let rest = episode.engine().action(msk_runtime::action::ActsOn::Task);
    let mut found = Tally {
        episodes: if task.init.has_worlds() { WORLDS } else { EPISODES },
        terminations: vec![0; task.terminations.len()],
        finishes: vec![0; task.finishes.len()],
        ..Tally::default()
    };
    let (mut states, mut frames) = (Vec::new(), Vec::new());
    for seed in 0..found.episodes {
        let key = EpisodeKey { seed, episode: 0 };
        let start = episode.inspect_start(key).map_err(|error| in_words(&error))?;
        start.penetrations.into_iter().for_each(|overlap| found.overlap(overlap));
        start.residuals.into_iter().for_each(|gap| found.gap(gap));
        episode.reset(key);
        states.push(episode.state().clone());
        frames.push(episode.frame().to_vec());
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
        found.terms.resize(report.terms.len(), 0.0);
        found.terms.iter_mut().zip(&report.terms).for_each(|(most, value)| *most = most.at_least(value.abs()));
    }
    found.penetrations.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    let state = states.into_iter().next().unwrap_or_else(|| episode.state().clone());
    Ok((Begun { staged, episode, state, frames }, found))
}

impl Tally {
    fn overlap(&mut self, new: Penetration) {
        match self.penetrations.iter_mut().find(|known| known.shapes == new.shapes) {
            Some(known) => known.depth = known.depth.at_least(new.depth),
            None => self.penetrations.push(new),
        }
    }

    fn gap(&mut self, new: Residual) {
        match self.residuals.iter_mut().find(|known| known.name == new.name) {
            Some(known) => {
                known.distance = known.distance.at_least(new.distance);
                known.turn = known.turn.at_least(new.turn);
            }
            None => self.residuals.push(new),
        }
    }
}

/// The findings as warnings.
fn warnings(task: &CompiledTask, found: &Tally) -> Vec<Diagnostic> {
    let places = &task.places;
    let mut diagnostics = Vec::new();
    if let Some(deepest) = found.penetrations.first() {
        let message = format!("the task `{}` starts with penetrations: {}", task.name, overlap(deepest));
        let diagnostic = at(probing::STARTS_INSIDE, places.init, message);
        let diagnostic = others(diagnostic, found.penetrations.iter().map(overlap));
        let raised = task.init.root.height.is_some();
        let help = if raised {
            "`root { height on ground }` puts the lowest point of the body on the ground; otherwise move"
        } else {
            "move"
        };
        diagnostics.push(diagnostic.help(format!("{help} one of the shapes, or write `allow starts_inside \"...\"`")));
    }
    if let Some(first) = found.residuals.first() {
        let message = format!("the task `{}` starts with penetrations: {}", task.name, gap(first));
        let diagnostic = at(probing::STARTS_APART, places.init, message);
        let diagnostic = others(diagnostic, found.residuals.iter().map(gap));
        diagnostics.push(
            diagnostic.help("start where both ends coincide, keep the offset with `here`, or write `allow starts_apart \"...\"`"),
        );
    }
    // A failure is wrong in any episode; what is no failure may be met by chance, but not always.
    let failures = task.terminations.iter().zip(&places.terminations).zip(&found.terminations);
    for ((name, place), &count) in failures.filter(|(_, count)| **count > 0) {
        diagnostics.push(holds(&format!("the termination `{name}`"), *place, count, found));
    }
    let finishes = task.finishes.iter().zip(&places.finishes).zip(&found.finishes);
    for ((name, place), &count) in finishes.filter(|(_, count)| **count == found.episodes) {
        diagnostics.push(holds(&format!("the reason to finish `{name}`"), *place, count, found));
    }
    // The last step of an episode may well succeed.
    if found.success == found.episodes && task.horizon > 1 {
        diagnostics.push(holds("success", places.success, found.success, found));
    }
    diagnostics
}

fn holds(what: &str, place: (FileId, Span), count: u64, found: &Tally) -> Diagnostic {
    let all = found.episodes;
    let message = format!("{what} holds at the first step, with muscles at rest, in {count} of {all} episodes");
    at(lints::HOLDS_AT_RESET, place, message)
        .help("fix the condition or the initial state, or write `allow holds_at_reset \"...\"`")
}

fn overlap(found: &Penetration) -> String {
    let [one, other] = &found.shapes;
    format!("`{one}` penetrates `{other}` by {:.1} mm", 1e3 * found.depth)
}

fn gap(found: &Residual) -> String {
    let turn = if found.turn > 0.0 { format!(" and {:.1} degrees", found.turn.to_degrees()) } else { String::new() };
    // A coupling of angles is missed by radians, which are printed in thousandths like metres.
    format!("`{}` apart by {:.3} mm or mrad{turn}", found.name, 1e3 * found.distance)
}

/// Adds what the message leaves out: all but the first.
fn others(diagnostic: Diagnostic, all: impl ExactSizeIterator<Item = String>) -> Diagnostic {
    let more = all.len().saturating_sub(MOST_LISTED);
    let diagnostic = all.take(MOST_LISTED).skip(1).fold(diagnostic, |diagnostic, one| diagnostic.help(format!("also {one}")));
    if more > 0 { diagnostic.help(format!("and {more} more")) } else { diagnostic }
}

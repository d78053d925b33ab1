//! Model-dependent lints: what of a task shows only with its model at hand, reported at its spans.
//!
//! 1. Every task is reset a few times, always with the same seeds, and takes one step at rest (`initial_state`);
//! 2. its body is put into many poses in its scene, always the same ones (`poses`): what holds, fails, contributes
//!    nothing or always contributes in all of them is searched for (`search`), and reported if nothing is found (`reach`);
//! 3. a task declared symmetric is shown states and their mirror images (`mirror`): both must be rewarded alike (`symmetry`).
//! 4. apart from these, since it takes seconds and not moments: an episode of each task is played at rest (`play`), which must not succeed
//!    and not earn more than holding the pose.
//!
//! What is found is a warning with numbers; the task may allow it by the name of its lint.

mod initial_state;
mod mirror;
mod play;
mod poses;
mod reach;
mod search;
mod symmetry;

pub use play::episodes;

use msk_compiler::diagnostics::codes::lints::HOLDS_AT_RESET;
use msk_compiler::diagnostics::codes::probing::UNREACHED;
use msk_compiler::diagnostics::{Allowance, Code, Diagnostic, FileId, Span, Stage, allowance};
use msk_program::task::CompiledTask;
use msk_runtime::library::BodyLibrary;
use rayon::prelude::*;
use std::sync::Arc;

/// What probing finds of a task.
struct Probed {
    /// What no `allow` covers.
    warnings: Vec<Diagnostic>,
    /// Every `allow` of the task, and whether it covers what the compiler or probing finds.
    allowances: Vec<Allowance>,
}

/// Probes tasks on all cores, in their order: what no `allow` covers.
pub fn tasks(tasks: &[Arc<CompiledTask>], bodies: &BodyLibrary) -> Vec<Diagnostic> {
    tasks.par_iter().flat_map_iter(|task| probe(task, bodies).warnings).collect()
}

/// The same without what the compiler has `reported` already (one place and code are reported once), and with every `allow` of
/// what probing looks for that covers nothing.
pub fn new_of(tasks: &[Arc<CompiledTask>], bodies: &BodyLibrary, reported: &[Diagnostic]) -> Vec<Diagnostic> {
    let (warnings, allowances): (Vec<_>, Vec<_>) =
        tasks.par_iter().map(|task| probe(task, bodies)).map(|probed| (probed.warnings, probed.allowances)).unzip();
    let mut found = warnings.concat();
    found.retain(|new| reported.iter().all(|known| !repeats(new, known)));
    found.extend(allowance::unfulfilled(allowances.iter().flatten(), Stage::Probe));
    found
}

/// Whether `new` repeats what is known already: the same, or that no pose decides otherwise what holds at once.
fn repeats(new: &Diagnostic, known: &Diagnostic) -> bool {
    let same = new.code.id == known.code.id || (new.code.id, known.code.id) == (UNREACHED.id, HOLDS_AT_RESET.id);
    same && (new.file(), new.span()) == (known.file(), known.span())
}

fn probe(task: &Arc<CompiledTask>, bodies: &BodyLibrary) -> Probed {
    let (mut warnings, mut allowances) = (Vec::new(), task.places.allowances.clone());
    if let Some(begun) = initial_state::probe(task, bodies, &mut warnings) {
        let (model, body) = (&*begun.staged.model, &*begun.staged.body);
        let mut room = poses::Room::new(model, body, &begun.state, &task.frame);
        initial_state::above(task, &mut room, &mut warnings);
        initial_state::worn(task, &room, &mut warnings);
        let shown = reach::draw(&mut room);
        let mut reached = reach::probe(task, &mut room, &shown, &begun.frames);
        reached.retain(|new| warnings.iter().all(|known| !repeats(new, known)));
        warnings.append(&mut reached);
        warnings.extend(symmetry::probe(task, &mut room, &shown, &begun.episode));
    } else {
        // Nothing is known of a task that cannot begin, so no `allow` is needless.
        allowances.iter_mut().for_each(|allowance| allowance.fulfilled = true);
    }
    allowance::apply(&mut allowances, &mut warnings);
    Probed { warnings, allowances }
}

fn at(code: &'static Code, (file, span): (FileId, Span), message: String) -> Diagnostic {
    Diagnostic::new(code, file, span, message)
}

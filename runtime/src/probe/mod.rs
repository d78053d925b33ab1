//! Probing: what of a task shows only with its model at hand, told where it stands in the texts.
//!
//! 1. Every task is begun a few times, always with the same seeds, and takes one step at rest (`beginning`);
//! 2. its body is put into many poses in its scene, always the same ones (`poses`): what holds, fails, pays nothing or always pays in all of them
//!    is searched for (`search`), and told if nothing is found (`reach`);
//! 3. a task that says that it is symmetric is shown states and their mirror images (`mirror`): both must pay the same (`symmetry`).
//!
//! What is found is a warning with numbers; the task may allow it by the name of its lint.

mod beginning;
mod mirror;
mod poses;
mod reach;
mod search;
mod symmetry;

use crate::library::BodyLibrary;
use msk_compiler::diagnostics::codes::lints::HOLDS_AT_RESET;
use msk_compiler::diagnostics::codes::probing::UNREACHED;
use msk_compiler::diagnostics::{Code, Diagnostic, FileId, Span};
use msk_compiler::task::CompiledTask;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Something found: the name under which it is allowed, the lints that are allowed in its place, what is told.
type Found = (&'static str, BTreeSet<String>, Diagnostic);

/// Probes tasks on all cores, in their order.
pub fn tasks(tasks: &[Arc<CompiledTask>], bodies: &BodyLibrary) -> Vec<Diagnostic> {
    tasks.par_iter().flat_map_iter(|task| probe(task, bodies)).collect()
}

/// The same without what the compiler has `told` already: of one place and one code once is enough.
pub fn new_of(tasks: &[Arc<CompiledTask>], bodies: &BodyLibrary, told: &[Diagnostic]) -> Vec<Diagnostic> {
    let mut found = self::tasks(tasks, bodies);
    found.retain(|new| told.iter().all(|known| !repeats(new, known)));
    found
}

/// Whether `new` says what is known already: the same, or that no pose decides otherwise what holds at once.
fn repeats(new: &Diagnostic, known: &Diagnostic) -> bool {
    let same = new.code.id == known.code.id || (new.code.id, known.code.id) == (UNREACHED.id, HOLDS_AT_RESET.id);
    same && (new.file(), new.span()) == (known.file(), known.span())
}

fn probe(task: &Arc<CompiledTask>, bodies: &BodyLibrary) -> Vec<Diagnostic> {
    let mut told = Vec::new();
    if let Some(begun) = beginning::probe(task, bodies, &mut told) {
        let (model, body) = (&*begun.staged.model, &*begun.staged.body);
        let mut room = poses::Room::new(model, body, &begun.state, &task.frame);
        beginning::above(task, &mut room, &mut told);
        beginning::worn(task, &room, &mut told);
        let shown = reach::draw(&mut room);
        let mut reached = reach::probe(task, &mut room, &shown, &begun.frames);
        reached.retain(|(_, _, new)| told.iter().all(|(_, _, known)| !repeats(new, known)));
        told.append(&mut reached);
        told.extend(symmetry::probe(task, &mut room, &shown, &begun.episode));
    }
    let allowed = &task.places.allowed;
    let remarks = told.into_iter().filter(|(lint, own, _)| !allowed.contains(*lint) && !own.contains(*lint));
    remarks.map(|(_, _, diagnostic)| diagnostic).collect()
}

fn at(code: &'static Code, (file, span): (FileId, Span), message: String) -> Diagnostic {
    Diagnostic::new(code, file, span, message)
}

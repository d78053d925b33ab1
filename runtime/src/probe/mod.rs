//! Probing: what of a task shows only with its model at hand, told where it stands in the texts.
//!
//! Every task is begun a few times, always with the same seeds, and takes one step at rest (`beginning`). What is found is a
//! warning with numbers; the task may allow it by the name of its lint.

mod beginning;

use crate::library::BodyLibrary;
use msk_compiler::diagnostics::Diagnostic;
use msk_compiler::task::CompiledTask;
use rayon::prelude::*;
use std::sync::Arc;

/// Probes tasks on all cores, in their order.
pub fn tasks(tasks: &[Arc<CompiledTask>], bodies: &BodyLibrary) -> Vec<Diagnostic> {
    tasks.par_iter().flat_map_iter(|task| beginning::probe(task, bodies)).collect()
}

/// The same without what the compiler has `told` already: of one place and one code once is enough.
pub fn new_of(tasks: &[Arc<CompiledTask>], bodies: &BodyLibrary, told: &[Diagnostic]) -> Vec<Diagnostic> {
    let mut found = self::tasks(tasks, bodies);
    let place = |diagnostic: &Diagnostic| (diagnostic.code.id, diagnostic.file(), diagnostic.span());
    found.retain(|new| told.iter().all(|known| place(known) != place(new)));
    found
}

//! What a compilation understood, for editors: nothing is left out because something else is wrong.

use super::Suite;
use crate::body::BodyDescription;
use crate::diagnostics::{FileId, Report, Span};
use crate::hir::TypedFormulas;
use crate::syntax::tree;
use crate::task::CompiledTask;
use crate::vocabulary::Vocabulary;
use std::path::PathBuf;
use std::sync::Arc;

/// Everything that is known of a file and of all that it uses.
#[derive(Default)]
pub struct Inspection {
    /// Errors and warnings, with the texts.
    pub report: Report,
    /// Tasks without errors.
    pub tasks: Vec<Arc<CompiledTask>>,
    /// All bodies, by name.
    pub bodies: Vec<Arc<BodyDescription>>,
    /// The suites of the entry file.
    pub suites: Vec<Suite>,
    /// The files, in the order of reading; the entry is the first.
    pub files: Vec<InspectedFile>,
    /// What each task and sequence sees.
    pub scopes: Vec<TaskScope>,
}

/// A file that was read.
pub struct InspectedFile {
    /// Where it is.
    pub path: PathBuf,
    /// Its text.
    pub tree: tree::File,
    /// The files that it uses, by their place among all.
    pub uses: Vec<usize>,
}

/// What was understood of a task or a sequence.
pub struct TaskScope {
    /// Its name.
    pub name: String,
    /// In which file it stands.
    pub file: FileId,
    /// Where its name stands.
    pub span: Span,
    /// What exists on its body and in its scene.
    pub vocabulary: Arc<Vocabulary>,
    /// The typed HIR of its scene and of each of its phases.
    pub typed: Vec<TypedFormulas>,
}

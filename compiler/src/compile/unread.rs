//! Names that nothing reads, over all tasks together: what one inherits and does not read, another may.

use crate::check::scene::CheckedScene;
use crate::diagnostics::{Diagnostic, FileId, Span, codes};
use crate::resolve::scope::Names;
use std::collections::{BTreeMap, BTreeSet};

/// How many tasks have a declaration, and how many of them do not read it.
#[derive(Default)]
pub(super) struct Unread(BTreeMap<(FileId, Span), Count>);

#[derive(Default)]
struct Count {
    declared: usize,
    unread: usize,
}

impl Unread {
    /// Counts the names of a task, of which `warnings` list those that it does not read.
    pub(super) fn note(&mut self, names: &Names<'_>, scene: &CheckedScene<'_>, warnings: &[Diagnostic]) {
        let groups = scene.statements.groups.iter().map(|group| (group.file, group.statement.name.span));
        let declared = names.of_task().map(|(_, declared)| (declared.file, declared.definition.span()));
        for place in declared.chain(groups).collect::<BTreeSet<_>>() {
            self.0.entry(place).or_default().declared += 1;
        }
        let unread = warnings.iter().filter(|diagnostic| diagnostic.code == codes::lints::UNUSED);
        for place in unread.map(|diagnostic| (diagnostic.file(), diagnostic.span())).collect::<BTreeSet<_>>() {
            self.0.entry(place).or_default().unread += 1;
        }
    }

    /// Drops the warnings about names that some task reads.
    pub(super) fn drop_read(&self, diagnostics: &mut Vec<Diagnostic>) {
        let read = |place| self.0.get(&place).is_some_and(|count| count.unread < count.declared);
        diagnostics.retain(|diagnostic| diagnostic.code != codes::lints::UNUSED || !read((diagnostic.file(), diagnostic.span())));
    }
}

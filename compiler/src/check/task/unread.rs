//! Declarations that nothing reads.

use crate::check::context::Checker;
use crate::resolve::scope::{Declared, Definition};

impl<'a> Checker<'a> {
    /// Checks the values that nothing reads, so that their mistakes are reported; what is computed for them is discarded.
    pub(super) fn unread(&mut self) {
        let names = self.names;
        let value = |declared: &Declared<'a>| matches!(declared.definition, Definition::Let(_) | Definition::Clock(_));
        let unread: Vec<_> = names.of_task().filter(|(name, declared)| value(declared) && !self.used.contains(*name)).collect();
        if unread.is_empty() {
            return;
        }
        let (graph, memo, used) = (self.graph.clone(), self.memo.clone(), self.used.clone());
        let (compared, queries, repeated) = (self.comparisons.len(), self.queries.len(), self.repeated.len());
        let (mark, formulas) = (self.hir.mark(), self.formulas.clone());
        for (name, declared) in unread {
            // An error is reported where it stands.
            let _ = self.in_file(declared.file, |checker| checker.plain_name(name, declared.definition.span()));
        }
        (self.graph, self.memo, self.used, self.formulas) = (graph, memo, used, formulas);
        self.hir.rewind(mark);
        self.comparisons.truncate(compared);
        self.queries.truncate(queries);
        self.repeated.truncate(repeated);
    }
}

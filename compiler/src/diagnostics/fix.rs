//! Applying fixes: edits to texts, all of a fix or none of it.

use super::{Diagnostic, Edit, FileId, Report};

impl Report {
    /// The text of `file` with every automatic fix applied, and how many were. Where two fixes touch, the first one is applied;
    /// the other is left for the next run.
    pub fn fixed(&self, file: FileId) -> (String, usize) {
        fixed(self.sources.text(file), file, &self.diagnostics)
    }
}

/// `text` of `file` with the automatic fixes of `diagnostics` applied, and how many were.
pub fn fixed(text: &str, file: FileId, diagnostics: &[Diagnostic]) -> (String, usize) {
    let mut chosen: Vec<&Edit> = Vec::new();
    let mut applied = 0;
    for diagnostic in diagnostics {
        let Some(fix) = diagnostic.fixes.iter().find(|fix| fix.automatic) else { continue };
        let fits = |edit: &Edit| edit.file == file && !chosen.iter().any(|other| touch(edit, other));
        if fix.edits.iter().all(fits) {
            chosen.extend(&fix.edits);
            applied += 1;
        }
    }
    chosen.sort_by_key(|edit| edit.span);
    let (mut result, mut at) = (String::with_capacity(text.len()), 0);
    for edit in chosen {
        result += text.get(at..edit.span.start as usize).unwrap_or("");
        result += &edit.replacement;
        at = edit.span.end as usize;
    }
    result += text.get(at..).unwrap_or("");
    (result, applied)
}

/// Whether two edits overlap or meet; two that meet could be in either order.
fn touch(a: &Edit, b: &Edit) -> bool {
    a.span.start <= b.span.end && b.span.start <= a.span.end
}

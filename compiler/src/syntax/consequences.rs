//! Errors that only follow from others are not reported.
//!
//! A bracket too few or too many lets the rest of its line stand where it does not belong: errors about it there would be
//! about a text that was never written. The first error of such a line is reported; everything else wrong with it shows when that
//! is mended.

use crate::diagnostics::codes::syntax as codes;
use crate::diagnostics::{Diagnostic, Severity};

/// Keeps of every line on which a bracket is wrong the first error only. `diagnostics` are sorted by place in `text`.
pub(super) fn forget(text: &str, diagnostics: &mut Vec<Diagnostic>) {
    let mut kept = Vec::with_capacity(diagnostics.len());
    let mut rest = std::mem::take(diagnostics).into_iter().peekable();
    let (mut line, mut counted) = (0, 0);
    let mut line_of = |diagnostic: &Diagnostic| {
        let start = (diagnostic.span().start as usize).min(text.len());
        line += text.as_bytes()[counted.min(start)..start].iter().filter(|byte| **byte == b'\n').count();
        counted = counted.max(start);
        line
    };
    while let Some(first) = rest.next() {
        let line = line_of(&first);
        let mut together = vec![first];
        while let Some(next) = rest.next_if(|next| line_of(next) == line) {
            together.push(next);
        }
        if together.iter().any(is_of_a_bracket) {
            let first = together.iter().position(|diagnostic| diagnostic.severity == Severity::Error);
            together.truncate(first.map_or(1, |first| first + 1));
        }
        kept.append(&mut together);
    }
    *diagnostics = kept;
}

fn is_of_a_bracket(diagnostic: &Diagnostic) -> bool {
    [codes::UNCLOSED_BRACKET.id, codes::UNOPENED_BRACKET.id, codes::MISSING_BLOCK.id].contains(&diagnostic.code.id)
}

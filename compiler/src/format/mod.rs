//! The one layout of `.msk` texts.
//!
//! 1. `lines`: the lines of the source with their tokens, comments and depth; where lines break is the author's choice;
//! 2. `columns`: from the tree, where the columns of a statement begin: weight, bounds, name, formula;
//! 3. `spacing`: what stands between two tokens;
//! 4. `layout`: indentation, aligned columns, aligned comments.
//!
//! Only blanks change: tokens and comments stay, in order, and the result is compared with the source before it is given
//! out. Formatting what is formatted changes nothing.

mod columns;
mod layout;
mod lines;
mod spacing;

use crate::diagnostics::{Diagnostic, FileId, Severity};
use crate::syntax::{parse, scanner};

/// Why a text is left as it is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FormatError {
    /// What cannot be read cannot be laid out.
    #[error("the file has syntax errors")]
    Unreadable(Vec<Diagnostic>),
    /// The layout would have changed more than blanks: a defect of the formatter. The text is safe.
    #[error("formatting would change the semantics; please report this file")]
    Changed,
}

/// Lays out a text.
///
/// # Errors
/// A text with syntax errors.
///
/// ```
/// use msk_compiler::{diagnostics::SourceMap, format::format};
/// let mut sources = SourceMap::default();
/// let file = sources.add("a.msk", "const  reach=0.4 m\nconst x  =  -reach*2");
/// assert_eq!(format(file, sources.text(file)).unwrap(), "const reach = 0.4 m\nconst x     = -reach * 2\n");
/// ```
pub fn format(file: FileId, text: &str) -> Result<String, FormatError> {
    let parsed = parse(file, text);
    if parsed.has_errors() {
        let errors = parsed.diagnostics.into_iter().filter(|diagnostic| diagnostic.severity == Severity::Error).collect();
        return Err(FormatError::Unreadable(errors));
    }
    let marks = columns::Marks::of(&parsed.tree);
    let lines = lines::split(file, text, &parsed.comments, &marks);
    let mut formatted = layout::lay_out(text, &lines, &marks);
    if text.contains("\r\n") {
        formatted = formatted.replace('\n', "\r\n");
    }
    if content(file, text) == content(file, &formatted) { Ok(formatted) } else { Err(FormatError::Changed) }
}

/// The content of a text: its tokens and comments, and where statements end.
fn content(file: FileId, text: &str) -> (Vec<&str>, Vec<&str>) {
    let (tokens, goes_on) = scanner::tokens(file, text);
    let mut pieces = Vec::with_capacity(tokens.len());
    let mut ended = true;
    for (token, goes_on) in tokens.iter().zip(goes_on) {
        if token.kind != scanner::TokenKind::Newline {
            pieces.push(&text[token.start..token.end]);
            ended = false;
        } else if !goes_on && !std::mem::replace(&mut ended, true) {
            pieces.push("\n");
        }
    }
    if !ended {
        pieces.push("\n");
    }
    (pieces, parse(file, text).comments.iter().map(|comment| comment.span.of(text).trim_end()).collect())
}

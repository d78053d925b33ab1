//! Text to syntax tree.
//!
//! 1. `scanner`: comments are set aside, newlines that do not end a statement are blanked, brackets are repaired.
//! 2. `grammar`: pest parses the prepared text; what fits nothing becomes junk, statement by statement.
//! 3. `build`: pest's pairs become the [`tree`]; precedence, names and units are read here.
//! 4. `recovery`: each piece of junk is examined again to report what is wrong with it.
//!
//! [`parse`] never fails and never panics: it returns the tree of everything that could be read, and all errors of the rest.

mod build;
mod consequences;
mod grammar;
mod recovery;
pub(crate) mod scanner;
pub mod tree;
mod units;
mod wording;

pub use units::UNITS;

use crate::diagnostics::{Diagnostic, FileId, Severity, Span};
use pest::Parser;
use tree::{Comment, File};

/// Most bytes a file may have.
pub const MAXIMUM_FILE_SIZE: usize = 256 * 1024;
/// Most operators, calls and fields that one statement may have.
pub const MAXIMUM_OPERATORS: usize = 512;
pub use crate::diagnostics::MAXIMUM_ERRORS;

/// Most brackets that may be open at once.
pub const MAXIMUM_DEPTH: usize = scanner::MAXIMUM_DEPTH;

/// What a text is read as.
#[derive(Debug, Clone, PartialEq)]
pub struct Parsed {
    /// Everything that could be read.
    pub tree: File,
    /// In the order of the text.
    pub comments: Vec<Comment>,
    /// Sorted by place.
    pub diagnostics: Vec<Diagnostic>,
}

impl Parsed {
    /// Whether a statement is missing from the tree or wrong in it.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }
}

/// Whether a text is a name that a declaration may have: no word that is reserved, and none that is spelled otherwise.
pub fn is_name(text: &str) -> bool {
    let lower = text.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_');
    let whole = |pairs: pest::iterators::Pairs<'_, grammar::Rule>| pairs.as_str() == text;
    lower && !text.ends_with('_') && grammar::Grammar::parse(grammar::Rule::identifier, text).is_ok_and(whole)
}

/// Reads a text. Spans in the result are bytes of `text`.
pub fn parse(file: FileId, text: &str) -> Parsed {
    let tree = File { file, docs: None, items: Vec::new() };
    if text.len() > MAXIMUM_FILE_SIZE {
        let diagnostics = vec![wording::file_too_big(file, text.len(), MAXIMUM_FILE_SIZE)];
        return Parsed { tree, comments: Vec::new(), diagnostics };
    }
    let mut scanned = scanner::scan(file, text);
    let mut diagnostics = std::mem::take(&mut scanned.diagnostics);
    let tree = match grammar::Grammar::parse(grammar::Rule::file, &scanned.masked.text) {
        Ok(pairs) => build::build(file, &scanned, pairs, &mut diagnostics),
        // Junk takes whatever statements do not, so that only pest's own guard of the stack comes here.
        Err(error) => {
            let place = scanned.masked.to_source(recovery::position(&error));
            diagnostics.push(wording::unreadable(file, Span::at(place)));
            tree
        }
    };
    diagnostics.sort_by_key(|diagnostic| (diagnostic.span(), diagnostic.code.id));
    consequences::forget(text, &mut diagnostics);
    if let Some(next) = diagnostics.get(MAXIMUM_ERRORS) {
        let more = wording::more_errors(file, next.span(), MAXIMUM_ERRORS);
        diagnostics.truncate(MAXIMUM_ERRORS);
        diagnostics.push(more);
    }
    Parsed { tree, comments: scanned.comments, diagnostics }
}

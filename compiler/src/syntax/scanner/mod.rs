//! Before the grammar: comments, brackets and line ends.
//!
//! 1. [`lexer`]: characters to tokens; comments are set aside, foreign signs replaced.
//! 2. [`lines`]: which line goes on with the statement of the line before.
//! 3. [`brackets`]: brackets are paired and repaired.
//! 4. [`mask`]: the text the grammar sees. A newline in it always ends a statement.

mod brackets;
mod lexer;
mod lines;
mod mask;

pub(crate) use brackets::MAXIMUM_DEPTH;
pub(crate) use lexer::{Token, TokenKind};
pub(crate) use mask::{DocRun, Masked};

use super::MAXIMUM_ERRORS;
use super::tree::{Comment, CommentKind};
use crate::diagnostics::{Diagnostic, FileId};

/// Errors found so far; beyond the limit none is made, so that a file full of them costs no more than any other.
#[derive(Debug, Default)]
struct Errors(Vec<Diagnostic>);

impl Errors {
    fn tell(&mut self, diagnostic: impl FnOnce() -> Diagnostic) {
        if self.0.len() <= MAXIMUM_ERRORS {
            self.0.push(diagnostic());
        }
    }
}

/// What the scanner makes of a text.
pub(crate) struct Scanned {
    /// What the grammar sees.
    pub(crate) masked: Masked,
    /// In the order of the text.
    pub(crate) comments: Vec<Comment>,
    /// Runs of `///`.
    pub(crate) docs: Vec<DocRun>,
    /// Runs of `//!`.
    pub(crate) file_docs: Vec<DocRun>,
    /// Errors of characters, quotes, brackets and line ends.
    pub(crate) diagnostics: Vec<Diagnostic>,
}

/// The tokens of a text, newlines among them, and for each whether it is a newline with which no statement ends.
pub(crate) fn tokens(file: FileId, source: &str) -> (Vec<Token>, Vec<bool>) {
    let mut errors = Errors::default();
    let lexed = lexer::lex(file, source, &mut errors);
    let lines = lines::describe(source, &lexed.tokens);
    let goes_on = match brackets::pair(file, source, &lexed.tokens, &lines, &mut errors) {
        None => vec![false; lexed.tokens.len()],
        Some(brackets) => lines::masked(file, source, &lexed.tokens, &lines, &brackets.paired, &mut errors),
    };
    (lexed.tokens, goes_on)
}

/// Scans a text.
pub(crate) fn scan(file: FileId, source: &str) -> Scanned {
    let mut errors = Errors::default();
    let lexed = lexer::lex(file, source, &mut errors);
    let lines = lines::describe(source, &lexed.tokens);
    let masked = match brackets::pair(file, source, &lexed.tokens, &lines, &mut errors) {
        None => Masked::default(),
        Some(brackets) => {
            let newlines = lines::masked(file, source, &lexed.tokens, &lines, &brackets.paired, &mut errors);
            mask::mask(source, &lexed.tokens, &newlines, &brackets)
        }
    };
    Scanned {
        masked,
        docs: mask::doc_runs(source, &lexed.comments, CommentKind::Doc),
        file_docs: mask::doc_runs(source, &lexed.comments, CommentKind::FileDoc),
        comments: lexed.comments,
        diagnostics: errors.0,
    }
}

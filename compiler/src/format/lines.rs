//! The lines of a text: their tokens, comments and depth.

use super::columns::Marks;
use crate::diagnostics::{FileId, Span};
use crate::syntax::scanner::{self, Token, TokenKind};
use crate::syntax::tree::Comment;

/// A line of the source.
#[derive(Debug, Default)]
pub(super) struct Line {
    /// Its tokens; the words of a unit are one.
    pub(super) tokens: Vec<Token>,
    /// A comment at its end, or alone on it.
    pub(super) comment: Option<Span>,
    /// How many levels it is indented.
    pub(super) level: usize,
}

impl Line {
    /// Whether nothing stands on it.
    pub(super) fn is_blank(&self) -> bool {
        self.tokens.is_empty() && self.comment.is_none()
    }
}

/// Splits a text without errors into its lines.
pub(super) fn split(file: FileId, text: &str, comments: &[Comment], marks: &Marks) -> Vec<Line> {
    let (tokens, goes_on) = scanner::tokens(file, text);
    let mut comments = comments.iter().map(|comment| comment.span).peekable();
    let mut lines = Vec::new();
    let mut line = Line::default();
    let mut depth = Depth::default();
    let mut continues = false;
    for (token, goes_on) in tokens.into_iter().zip(goes_on) {
        if token.kind == TokenKind::Newline {
            line.comment = comments.next_if(|comment| (comment.start as usize) < token.start);
            finish(&mut lines, &mut line, &mut depth, continues);
            continues = goes_on;
        } else if let Some(unit) = line.tokens.last_mut().filter(|last| marks.in_unit(last.start, token.start)) {
            unit.end = token.end;
        } else {
            line.tokens.push(token);
        }
    }
    line.comment = comments.next();
    finish(&mut lines, &mut line, &mut depth, continues);
    lines
}

/// Brackets that are open.
#[derive(Debug, Default, Clone, Copy)]
struct Depth {
    braces: usize,
    /// Round and square.
    others: usize,
}

impl Depth {
    fn pass(&mut self, token: &Token) {
        match token.kind {
            TokenKind::Open(b'{') => self.braces += 1,
            TokenKind::Close(b'}') => self.braces = self.braces.saturating_sub(1),
            TokenKind::Open(_) => self.others += 1,
            TokenKind::Close(_) => self.others = self.others.saturating_sub(1),
            _ => {}
        }
    }
}

fn finish(lines: &mut Vec<Line>, line: &mut Line, depth: &mut Depth, continues: bool) {
    let mut first = *depth;
    let mut closes = false;
    for token in line.tokens.iter().take_while(|token| matches!(token.kind, TokenKind::Close(_))) {
        first.pass(token);
        closes = true;
    }
    // A line that closes a bracket stands under the statement that opened it.
    let further = if continues && closes { first.others } else { usize::from(continues).max(first.others) };
    line.level = first.braces + further;
    line.tokens.iter().for_each(|token| depth.pass(token));
    lines.push(std::mem::take(line));
}

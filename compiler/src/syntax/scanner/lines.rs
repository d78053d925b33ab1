//! Where statements end: which line ends the grammar sees.
//!
//! A statement ends with its line. It goes on where a round or square bracket is open, where the line ends in an operator, or
//! where the next line begins with a word that cannot begin a statement.

use super::super::wording;
use super::Errors;
use super::lexer::{Token, TokenKind};
use crate::diagnostics::FileId;

/// What is known of the line a token stands on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Line {
    /// Whether the token is the first of its line.
    pub(super) first: bool,
    /// Column of the line's first token; a tab goes to the next multiple of four.
    pub(super) indent: usize,
    /// Whether the line goes on with the statement of the line before, brackets apart.
    pub(super) continues: bool,
    /// The last token before this one that is not a newline.
    pub(super) previous: Option<usize>,
}

/// Describes the line of every token.
pub(super) fn describe(source: &str, tokens: &[Token]) -> Vec<Line> {
    let mut lines = Vec::with_capacity(tokens.len());
    let mut present = Line::default();
    let mut begins = true;
    let mut previous = None;
    for (index, token) in tokens.iter().enumerate() {
        if begins {
            let line_start = source[..token.start].rfind('\n').map_or(0, |newline| newline + 1);
            present.indent = column(&source[line_start..token.start]);
            present.continues = previous.is_some_and(|before: usize| joins(source, &tokens[before], token));
        }
        lines.push(Line { first: begins, previous, ..present });
        begins = token.kind == TokenKind::Newline;
        previous = if begins { previous } else { Some(index) };
    }
    lines
}

fn column(blanks: &str) -> usize {
    blanks.chars().fold(0, |column, blank| if blank == '\t' { column / 4 * 4 + 4 } else { column + 1 })
}

/// The newlines that do not end a statement: for each token, whether the grammar sees a blank instead.
pub(super) fn masked(
    file: FileId,
    source: &str,
    tokens: &[Token],
    lines: &[Line],
    paired: &[bool],
    errors: &mut Errors,
) -> Vec<bool> {
    let mut masked = vec![false; tokens.len()];
    let mut depth = 0_usize;
    let mut newlines = Vec::new();
    for (index, token) in tokens.iter().enumerate() {
        if token.kind == TokenKind::Newline {
            newlines.push(index);
            continue;
        }
        if let Some(before) = lines[index].previous.filter(|_| !newlines.is_empty()).map(|before| &tokens[before]) {
            let joined = depth > 0 || joins(source, before, token);
            if joined && depth == 0 && begins_wrongly(source, token) && !ends_open(source, before) {
                errors.tell(|| wording::line_begins_with(file, before.span(), token.span(), token.text(source)));
            }
            for newline in newlines.drain(..) {
                masked[newline] = joined;
            }
        }
        newlines.clear();
        match token.kind {
            TokenKind::Open(_) if paired[index] => depth += 1,
            TokenKind::Close(_) if paired[index] => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    masked
}

/// Whether a statement goes on from `before`, the last token of a line, to `after`, the first of a later one.
fn joins(source: &str, before: &Token, after: &Token) -> bool {
    let text = after.text(source);
    let declares = after.kind == TokenKind::Word && matches!(text, "let" | "const" | "fn" | "task");
    if declares || after.kind == TokenKind::Close(b'}') {
        return false;
    }
    let clause =
        after.kind == TokenKind::Word && matches!(text, "becomes" | "when" | "where" | "redraw" | "then" | "else" | "and" | "or");
    // A clause word at the very start of a block belongs to nothing.
    (clause && before.kind != TokenKind::Open(b'{')) || ends_open(source, before) || begins_wrongly(source, after)
}

/// Whether a line that ends in `token` needs more.
fn ends_open(source: &str, token: &Token) -> bool {
    let text = token.text(source).trim();
    match token.kind {
        TokenKind::Mark => {
            matches!(text, "+" | "-" | "*" | "/" | "^" | "<" | "<=" | ">" | ">=" | "==" | "!=" | "=" | "*=" | ":" | "," | "..")
        }
        TokenKind::Word => {
            matches!(text, "and" | "or" | "not" | "in" | "if" | "then" | "else" | "becomes" | "when" | "where" | "until" | "by")
        }
        _ => false,
    }
}

/// Whether no statement can begin with `token`, although one could go on with it.
fn begins_wrongly(source: &str, token: &Token) -> bool {
    match token.kind {
        TokenKind::Mark => {
            let text = token.text(source).trim();
            matches!(text, "+" | "*" | "/" | "^" | "<" | "<=" | ">" | ">=" | "==" | "!=" | "=" | "*=" | "," | ".." | ".")
        }
        TokenKind::Open(b'{') => true,
        _ => false,
    }
}

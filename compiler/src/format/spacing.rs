//! What stands between two tokens of a line.

use super::columns::Marks;
use crate::syntax::scanner::{Token, TokenKind};

/// The tokens of a line with what stands between them.
pub(super) fn joined(text: &str, marks: &Marks, tokens: &[Token]) -> String {
    let mut line = String::new();
    for (index, token) in tokens.iter().enumerate() {
        if index > 0 && apart(text, marks, tokens, index) {
            line.push(' ');
        }
        line.push_str(&text[token.start..token.end]);
    }
    line
}

/// Whether a blank stands before the token at `index`, which is not the first.
fn apart(text: &str, marks: &Marks, tokens: &[Token], index: usize) -> bool {
    let (before, after) = (&tokens[index - 1], &tokens[index]);
    let word = |token: &Token| &text[token.start..token.end];
    let (left, right) = (word(before), word(after));
    if marks.is_value(after.start) {
        return true;
    }
    match (before.kind, after.kind) {
        (_, TokenKind::Open(b'{')) | (TokenKind::Open(b'{'), _) | (_, TokenKind::Close(b'}')) => true,
        (TokenKind::Open(_), _) | (_, TokenKind::Close(_)) => false,
        // Brackets touch what is called or indexed; elsewhere they stand alone.
        (TokenKind::Word | TokenKind::Close(_), TokenKind::Open(_)) => before.end < after.start,
        (_, TokenKind::Mark) if matches!(right, "," | ";" | ":" | "." | "^") => false,
        (TokenKind::Mark, _) if matches!(left, "." | "^") => false,
        (TokenKind::Mark, _) if left == "-" => {
            let exponent = index >= 2 && word(&tokens[index - 2]) == "^";
            marks.is_binary(before.start) && !exponent
        }
        // Bounds without units: `(5..30)`, `0..10`. Bounds with units are set apart.
        (TokenKind::Number, TokenKind::Mark) if right == ".." => false,
        (TokenKind::Mark, _) if left == ".." => !(index >= 2 && tokens[index - 2].kind == TokenKind::Number),
        _ => true,
    }
}

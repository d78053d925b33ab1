//! Characters to tokens: only as fine as brackets and line ends need.
//!
//! Comments are taken out here and kept beside the tokens. Characters that have no meaning, and signs of other languages that
//! have one here under another spelling, are reported once and replaced, so that nothing after them stumbles.

use super::super::tree::{Comment, CommentKind};
use super::super::wording;
use crate::diagnostics::{Diagnostic, FileId, Span};

/// What the layout must know of a stretch of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TokenKind {
    /// A word, with glued braces if it has any.
    Word,
    /// A number.
    Number,
    /// A quoted text.
    Text,
    /// `(`, `[` or `{`
    Open(u8),
    /// `)`, `]` or `}`
    Close(u8),
    /// An operator or a punctuation mark.
    Mark,
    /// The end of a line.
    Newline,
}

/// A stretch of text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Token {
    /// What it is.
    pub(super) kind: TokenKind,
    /// First byte.
    pub(super) start: usize,
    /// Byte after the last.
    pub(super) end: usize,
    /// What the grammar sees instead of it.
    pub(super) replacement: Option<String>,
}

impl Token {
    /// Where it stands.
    pub(super) fn span(&self) -> Span {
        Span::new(self.start, self.end)
    }

    /// What the grammar sees.
    pub(super) fn text<'a>(&'a self, source: &'a str) -> &'a str {
        self.replacement.as_deref().unwrap_or(&source[self.start..self.end])
    }
}

/// All tokens of a text, its comments, and what was wrong with its characters.
#[derive(Default)]
pub(super) struct Lexed {
    pub(super) tokens: Vec<Token>,
    pub(super) comments: Vec<Comment>,
    pub(super) diagnostics: Vec<Diagnostic>,
}

/// Splits `text` into tokens and comments.
pub(super) fn lex(file: FileId, text: &str) -> Lexed {
    let mut lexer = Lexer { file, text, at: 0, line_has_token: false, lexed: Lexed::default() };
    while let Some(character) = lexer.rest().chars().next() {
        lexer.next(character);
    }
    lexer.lexed
}

/// Operators and marks of more than one character, the longest first.
const LONG_MARKS: [&str; 7] = ["..", "<=", ">=", "==", "!=", "*=", "->"];

struct Lexer<'a> {
    file: FileId,
    text: &'a str,
    at: usize,
    line_has_token: bool,
    lexed: Lexed,
}

impl<'a> Lexer<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn next(&mut self, character: char) {
        let rest = self.rest();
        match character {
            ' ' | '\t' => self.at += 1,
            '\r' if rest.starts_with("\r\n") => self.at += 1,
            '\u{feff}' if self.at == 0 => self.at += character.len_utf8(),
            '\n' => {
                self.push(TokenKind::Newline, 1, None);
                self.line_has_token = false;
            }
            '/' if rest.starts_with("//") => self.comment(),
            '/' if rest.starts_with("/*") => self.block_comment(),
            '#' => self.hash_comment(),
            '"' | '\'' | '“' | '”' | '„' | '‘' | '’' => self.quoted(character),
            '(' | '[' | '{' => self.push(TokenKind::Open(character as u8), 1, None),
            ')' | ']' | '}' => self.push(TokenKind::Close(character as u8), 1, None),
            _ if character.is_ascii_digit() => {
                let length = number_length(rest);
                self.push(TokenKind::Number, length, None);
            }
            _ if character.is_ascii_alphabetic() || character == '_' => self.word(),
            _ => self.mark(character),
        }
    }

    fn push(&mut self, kind: TokenKind, length: usize, replacement: Option<String>) {
        let token = Token { kind, start: self.at, end: self.at + length, replacement };
        self.lexed.tokens.push(token);
        self.at += length;
        self.line_has_token = true;
    }

    fn to_line_end(&self) -> usize {
        let line = self.rest().split('\n').next().unwrap_or("");
        line.trim_end_matches('\r').len()
    }

    fn comment(&mut self) {
        let rest = self.rest();
        let kind = if rest.starts_with("//!") {
            CommentKind::FileDoc
        } else if rest.starts_with("///") && !rest.starts_with("////") {
            CommentKind::Doc
        } else {
            CommentKind::Plain
        };
        let length = self.to_line_end();
        let span = Span::new(self.at, self.at + length);
        self.lexed.comments.push(Comment { span, kind, own_line: !self.line_has_token });
        self.at += length;
    }

    fn hash_comment(&mut self) {
        let length = self.to_line_end();
        let span = Span::new(self.at, self.at + 1);
        self.lexed.diagnostics.push(wording::foreign_comment(self.file, span, "#"));
        self.at += length;
    }

    /// `/* ... */` is taken as a comment to its end, or to the end of its line if it has none.
    fn block_comment(&mut self) {
        let length = self.rest().find("*/").map_or(self.to_line_end(), |end| end + 2);
        let span = Span::new(self.at, self.at + 2);
        self.lexed.diagnostics.push(wording::foreign_comment(self.file, span, "/* */"));
        self.at += length;
    }

    fn quoted(&mut self, quote: char) {
        let line = &self.rest()[..self.to_line_end()];
        let closes = |character: char| match quote {
            '\'' | '‘' | '’' => matches!(character, '\'' | '’' | '‘'),
            _ => matches!(character, '"' | '”' | '“'),
        };
        let inner = &line[quote.len_utf8()..];
        let Some((length, closing)) = inner.char_indices().find(|(_, character)| closes(*character)) else {
            let inner = inner.trim_end();
            let span = Span::new(self.at, self.at + quote.len_utf8() + inner.len());
            self.lexed.diagnostics.push(wording::unclosed_text(self.file, span));
            let replacement = format!("\"{}\"", inner.replace('"', " "));
            return self.push(TokenKind::Text, quote.len_utf8() + inner.len(), Some(replacement));
        };
        let inner = &inner[..length];
        let total = quote.len_utf8() + length + closing.len_utf8();
        if quote == '"' && closing == '"' {
            return self.push(TokenKind::Text, total, None);
        }
        let replacement = format!("\"{}\"", inner.replace('"', " "));
        let span = Span::new(self.at, self.at + total);
        self.lexed.diagnostics.push(wording::foreign_quotes(self.file, span, &replacement));
        self.push(TokenKind::Text, total, Some(replacement));
    }

    /// A word takes braces that are glued to its underscore: `ankle_{l,r}`.
    fn word(&mut self) {
        let rest = self.rest();
        let mut length = word_length(rest);
        while rest[..length].ends_with('_') && rest[length..].starts_with('{') {
            let inside = &rest[length + 1..];
            let Some(close) = inside.find(['}', '{', '\n']).filter(|end| inside[*end..].starts_with('}')) else { break };
            length += close + 2;
            length += word_length(&rest[length..]);
        }
        self.push(TokenKind::Word, length, None);
    }

    /// A word that replaces a sign of `length` bytes is set off from words and numbers beside it.
    fn spaced(&self, ours: &str, length: usize) -> String {
        let is_word = ours.starts_with(in_words);
        let before = is_word && !self.text[..self.at].ends_with([' ', '(', '[', '\n']);
        let after = is_word && !self.text[self.at + length..].starts_with([' ', ')', ']', '\r', '\n']);
        format!("{}{ours}{}", if before { " " } else { "" }, if after { " " } else { "" })
    }

    fn mark(&mut self, character: char) {
        let rest = self.rest();
        if let Some(mark) = LONG_MARKS.iter().find(|mark| rest.starts_with(**mark)) {
            return self.push(TokenKind::Mark, mark.len(), None);
        }
        if let Some((foreign, ours)) = wording::FOREIGN_SIGNS.iter().find(|(foreign, _)| rest.starts_with(foreign)) {
            let span = Span::new(self.at, self.at + foreign.len());
            let ours = self.spaced(ours, foreign.len());
            self.lexed.diagnostics.push(wording::foreign_sign(self.file, span, foreign, &ours));
            if ours.trim().is_empty() {
                self.at += foreign.len();
            } else {
                self.push(TokenKind::Mark, foreign.len(), Some(ours));
            }
            return;
        }
        if matches!(character, '+' | '-' | '*' | '/' | '^' | '<' | '>' | '=' | ',' | ';' | ':' | '.' | '%') {
            return self.push(TokenKind::Mark, 1, None);
        }
        let same = rest.chars().take_while(|next| *next == character).count();
        let length = same * character.len_utf8();
        let span = Span::new(self.at, self.at + length);
        self.lexed.diagnostics.push(wording::meaningless_character(self.file, span, character));
        self.at += length;
    }
}

/// Whether a character belongs to words.
fn in_words(character: char) -> bool {
    character.is_ascii_alphanumeric() || character == '_'
}

fn word_length(text: &str) -> usize {
    text.bytes().take_while(|byte| byte.is_ascii_alphanumeric() || *byte == b'_').count()
}

/// `12`, `0.5`, `1e-3`; a fraction needs a digit after its point, so that `0..10` is a range.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut length = digits(0);
    if text[length..].starts_with('.') && digits(length + 1) > 0 {
        length += 1 + digits(length + 1);
    }
    if text[length..].starts_with(['e', 'E']) {
        let sign = usize::from(text[length + 1..].starts_with(['+', '-']));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}

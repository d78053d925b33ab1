//! Characters to tokens: only as fine as brackets and line ends need.
//!
//! Comments are taken out here and kept beside the tokens. Characters that have no meaning, and signs of other languages that
//! have one here under another spelling, are reported once and replaced, so that nothing after them stumbles.

use super::super::tree::{Comment, CommentKind};
use super::super::wording;
use super::Errors;
use crate::diagnostics::{FileId, Span};

/// What the layout must know of a stretch of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TokenKind {
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
pub(crate) struct Token {
    /// What it is.
    pub(crate) kind: TokenKind,
    /// First byte.
    pub(crate) start: usize,
    /// Byte after the last.
    pub(crate) end: usize,
    /// What the grammar sees instead of it.
    pub(crate) replacement: Option<String>,
}

impl Token {
    /// Where it stands.
    pub(crate) fn span(&self) -> Span {
        Span::new(self.start, self.end)
    }

    /// What the grammar sees.
    pub(crate) fn text<'a>(&'a self, source: &'a str) -> &'a str {
        self.replacement.as_deref().unwrap_or(&source[self.start..self.end])
    }
}

/// All tokens of a text, and its comments.
#[derive(Default)]
pub(super) struct Lexed {
    pub(super) tokens: Vec<Token>,
    pub(super) comments: Vec<Comment>,
}

/// Splits `text` into tokens and comments.
pub(super) fn lex(file: FileId, text: &str, errors: &mut Errors) -> Lexed {
    let mut lexer = Lexer {
        file,
        errors,
        block_comments: true,
        closing_bar: None,
        text,
        at: 0,
        line_has_token: false,
        last_solid: None,
        lexed: Lexed::default(),
    };
    while let Some(character) = lexer.rest().chars().next() {
        lexer.next(character);
    }
    lexer.lexed
}

/// Operators and marks of more than one character, the longest first.
const LONG_MARKS: [&str; 7] = ["..", "<=", ">=", "==", "!=", "*=", "->"];

struct Lexer<'a, 'e> {
    file: FileId,
    errors: &'e mut Errors,
    text: &'a str,
    at: usize,
    line_has_token: bool,
    /// The last token that is not a newline.
    last_solid: Option<usize>,
    /// Whether the rest of the text may hold the end of a block comment.
    block_comments: bool,
    /// Where the second bar of `|x|` stands, once the first is reported.
    closing_bar: Option<usize>,
    lexed: Lexed,
}

impl<'a> Lexer<'a, '_> {
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
            // No line begins with an operator: a single slash there is half a comment.
            '/' if !self.line_has_token && !self.open_line() => self.foreign_comment("/"),
            '#' => self.foreign_comment("#"),
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
        if kind != TokenKind::Newline {
            self.last_solid = Some(self.lexed.tokens.len());
        }
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

    fn foreign_comment(&mut self, mark: &str) {
        let length = self.to_line_end();
        let span = Span::new(self.at, self.at + mark.len());
        self.errors.tell(|| wording::foreign_comment(self.file, span, mark));
        self.at += length;
    }

    /// Whether the line before ends in an operator or an open bracket.
    fn open_line(&self) -> bool {
        let before = self.last_solid.map(|index| self.lexed.tokens[index].kind);
        before.is_some_and(|kind| matches!(kind, TokenKind::Mark | TokenKind::Open(b'(' | b'[')))
    }

    /// `/* ... */` is taken as a comment to its end, or to the end of its line if it has none.
    fn block_comment(&mut self) {
        let end = if self.block_comments { self.rest().find("*/") } else { None };
        let length = end.map_or(self.to_line_end(), |end| end + 2);
        self.block_comments = end.is_some();
        let span = Span::new(self.at, self.at + 2);
        self.errors.tell(|| wording::foreign_comment(self.file, span, "/* */"));
        self.at += length;
    }

    fn quoted(&mut self, quote: char) {
        let closes = |character: char| match quote {
            '\'' | '‘' | '’' => matches!(character, '\'' | '’' | '‘'),
            _ => matches!(character, '"' | '”' | '“'),
        };
        let inner = &self.rest()[quote.len_utf8()..];
        let end = inner.char_indices().find(|(_, character)| closes(*character) || *character == '\n');
        let Some((length, closing)) = end.filter(|(_, character)| *character != '\n') else {
            let inner = inner[..end.map_or(inner.len(), |(length, _)| length)].trim_end();
            let span = Span::new(self.at, self.at + quote.len_utf8() + inner.len());
            self.errors.tell(|| wording::unclosed_text(self.file, span));
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
        self.errors.tell(|| wording::foreign_quotes(self.file, span, &replacement));
        self.push(TokenKind::Text, total, Some(replacement));
    }

    /// A word takes braces that are glued to its underscore: `ankle_{l,r}`.
    fn word(&mut self) {
        let rest = self.rest();
        let mut length = word_length(rest);
        while rest[..length].ends_with('_') && rest[length..].starts_with('{') {
            let inside = &rest[length + 1..];
            let end = inside.find(|next| !(in_words(next) || matches!(next, ',' | '.' | '*' | ' '))).unwrap_or(inside.len());
            if !inside[end..].starts_with('}') {
                return self.open_pattern(length);
            }
            length += end + 2;
            length += word_length(&rest[length..]);
        }
        self.push(TokenKind::Word, length, None);
    }

    /// A pattern that is never closed ends with its words: `ankle_{l,r.height`.
    fn open_pattern(&mut self, stem: usize) {
        let rest = self.rest();
        let inside = &rest[stem + 1..];
        let end = inside.find(|next| !(in_words(next) || next == ',')).unwrap_or(inside.len());
        let span = Span::new(self.at + stem, self.at + stem + 1);
        self.errors.tell(|| wording::unclosed_pattern(self.file, span));
        let length = stem + 1 + end;
        let replacement = if end == 0 { "_".to_owned() } else { format!("{}}}", &rest[..length]) };
        self.push(TokenKind::Word, length, Some(replacement));
    }

    /// A word that replaces a sign of `length` bytes is set off from words and numbers beside it.
    fn spaced(&self, ours: &str, length: usize) -> String {
        let is_word = ours.starts_with(in_words);
        let before = is_word && !self.text[..self.at].ends_with([' ', '(', '[', '\n']);
        let after = is_word && !self.text[self.at + length..].starts_with([' ', ')', ']', '\r', '\n']);
        format!("{}{ours}{}", if before { " " } else { "" }, if after { " " } else { "" })
    }

    /// Bytes of `|x|` that begins here: a bar where a value is wanted, and a second one on its line.
    fn bars(&self) -> Option<usize> {
        let rest = self.rest();
        let wanted = self.open_line() && !rest[1..].starts_with([' ', '|']);
        let line = &rest[1..rest.find('\n').unwrap_or(rest.len())];
        line.find('|').filter(|_| wanted).map(|end| end + 2)
    }

    fn mark(&mut self, character: char) {
        let rest = self.rest();
        if let Some(mark) = LONG_MARKS.iter().find(|mark| rest.starts_with(**mark)) {
            return self.push(TokenKind::Mark, mark.len(), None);
        }
        if let Some((foreign, ours)) = wording::FOREIGN_SIGNS.iter().find(|(foreign, _)| rest.starts_with(foreign)) {
            let span = Span::new(self.at, self.at + foreign.len());
            let ours = self.spaced(ours, foreign.len());
            if *foreign == "|"
                && let Some(length) = self.bars()
            {
                let (whole, inside) = (Span::new(self.at, self.at + length), &rest[1..length - 1]);
                self.errors.tell(|| wording::absolute_bars(self.file, whole, inside));
                self.closing_bar = Some(self.at + length - 1);
                return self.push(TokenKind::Mark, 1, Some(ours));
            }
            if self.closing_bar == Some(self.at) {
                return self.push(TokenKind::Mark, 1, Some(ours));
            }
            self.errors.tell(|| wording::foreign_sign(self.file, span, foreign, &ours));
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
        self.errors.tell(|| wording::meaningless_character(self.file, span, character));
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

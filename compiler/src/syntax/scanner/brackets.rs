//! Pairs brackets, and repairs what does not pair, so that the grammar always sees balanced text.
//!
//! Round and square brackets end at the latest where a block begins or ends. Braces are taken as they are while they balance;
//! if they do not, the indentation decides which one is missing or too many.

use super::super::wording;
use super::lexer::{Token, TokenKind};
use super::lines::Line;
use crate::diagnostics::{Diagnostic, FileId};

/// Most brackets that may be open at once.
pub(crate) const MAXIMUM_DEPTH: usize = 64;

/// A character the grammar sees although the source lacks it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Insertion {
    /// After which token.
    pub(super) after: usize,
    /// The bracket.
    pub(super) character: char,
}

/// How the brackets of a text pair.
#[derive(Default)]
pub(super) struct Brackets {
    /// For each token: whether it is a round or square bracket with a partner.
    pub(super) paired: Vec<bool>,
    /// Missing brackets, sorted by place.
    pub(super) insertions: Vec<Insertion>,
    /// Closing brackets that the grammar must not see, or sees as another: (token, instead).
    pub(super) replaced: Vec<(usize, &'static str)>,
    /// What was wrong.
    pub(super) diagnostics: Vec<Diagnostic>,
    /// The text nests too deep to be read at all.
    pub(super) too_deep: bool,
}

/// Pairs the brackets of `tokens`.
pub(super) fn pair(file: FileId, source: &str, tokens: &[Token], lines: &[Line]) -> Brackets {
    let surplus = brace_surplus(tokens);
    let brackets = Brackets { paired: vec![false; tokens.len()], ..Brackets::default() };
    let mut pairing = Pairing { file, source, tokens, lines, surplus, open: Vec::new(), brackets };
    for (index, token) in tokens.iter().enumerate() {
        pairing.visit(index);
        if pairing.open.len() > MAXIMUM_DEPTH {
            let diagnostic = wording::too_deep(file, token.span(), MAXIMUM_DEPTH);
            return Brackets { too_deep: true, diagnostics: vec![diagnostic], ..pairing.brackets };
        }
    }
    pairing.finish();
    let mut brackets = pairing.brackets;
    brackets.insertions.sort_by_key(|insertion| insertion.after);
    brackets
}

/// How the braces fail to balance, if they do: the number of closing ones too many (negative: too few).
fn brace_surplus(tokens: &[Token]) -> Option<i64> {
    let (mut depth, mut went_below) = (0_i64, false);
    for token in tokens {
        match token.kind {
            TokenKind::Open(b'{') => depth += 1,
            TokenKind::Close(b'}') => depth -= 1,
            _ => continue,
        }
        went_below |= depth < 0;
    }
    (depth != 0 || went_below).then_some(-depth)
}

struct Open {
    token: usize,
    bracket: u8,
    /// Indentation of the line it stands on.
    indent: usize,
    /// Indentation of the first line inside.
    inside: Option<usize>,
}

struct Pairing<'a> {
    file: FileId,
    source: &'a str,
    tokens: &'a [Token],
    lines: &'a [Line],
    surplus: Option<i64>,
    open: Vec<Open>,
    brackets: Brackets,
}

impl Pairing<'_> {
    fn visit(&mut self, index: usize) {
        let token = &self.tokens[index];
        if self.lines[index].first && token.kind != TokenKind::Newline {
            self.begin_line(index);
        }
        match token.kind {
            TokenKind::Open(b'{') => {
                self.close_unclosed();
                self.push(index, b'{');
            }
            TokenKind::Open(bracket) => self.push(index, bracket),
            TokenKind::Close(b'}') => self.close_block(index),
            TokenKind::Close(bracket) => self.close(index, bracket),
            _ => {}
        }
    }

    fn push(&mut self, token: usize, bracket: u8) {
        self.open.push(Open { token, bracket, indent: self.lines[token].indent, inside: None });
    }

    fn top(&self) -> Option<&Open> {
        self.open.last()
    }

    /// A declaration never stands in round or square brackets; where braces do not balance, the indentation speaks.
    fn begin_line(&mut self, index: usize) {
        let token = &self.tokens[index];
        if token.kind == TokenKind::Word && matches!(token.text(self.source), "let" | "const" | "fn" | "task") {
            self.close_unclosed();
        }
        let in_brackets = self.top().is_some_and(|open| open.bracket != b'{');
        let Some(surplus) = self.surplus else { return };
        if in_brackets || self.lines[index].continues || token.kind == TokenKind::Close(b'}') {
            return;
        }
        let indent = self.lines[index].indent;
        while let Some(open) = self.open.pop_if(|open| indent <= open.indent) {
            self.brackets.diagnostics.push(wording::unclosed_block(self.file, self.tokens[open.token].span()));
            self.insert_before(index, '}');
        }
        let inside = match self.open.last_mut() {
            Some(open) => *open.inside.get_or_insert(indent),
            None => 0,
        };
        if let Some(previous) = self.lines[index].previous.filter(|_| surplus > 0 && indent > inside) {
            self.surplus = Some(surplus - 1);
            self.brackets.diagnostics.push(wording::unopened_block(self.file, self.tokens[previous].span()));
            self.insert_before(index, '{');
            let indent_before = self.lines[previous].indent;
            self.open.push(Open { token: previous, bracket: b'{', indent: indent_before, inside: Some(indent) });
        }
    }

    /// Inserts at the end of the last line that is not empty before `index`.
    fn insert_before(&mut self, index: usize, character: char) {
        let last = match self.lines.get(index) {
            Some(line) => line.previous,
            None => self.tokens.iter().rposition(|token| token.kind != TokenKind::Newline),
        };
        self.brackets.insertions.push(Insertion { after: last.unwrap_or(0), character });
    }

    /// Ends every round and square bracket that is open in the present block, at the end of the line where it was opened.
    fn close_unclosed(&mut self) {
        while let Some(open) = self.open.pop_if(|open| open.bracket != b'{') {
            self.report_unclosed(open.token, open.bracket);
        }
    }

    fn report_unclosed(&mut self, opener: usize, bracket: u8) {
        let closer = if bracket == b'(' { ')' } else { ']' };
        self.brackets.diagnostics.push(wording::unclosed_bracket(self.file, self.tokens[opener].span(), closer));
        let mut depth = 0_usize;
        let mut after = opener;
        for (index, token) in self.tokens.iter().enumerate().skip(opener + 1) {
            let ends = matches!(token.kind, TokenKind::Newline | TokenKind::Open(b'{') | TokenKind::Close(b'}'));
            if depth == 0 && (ends || token.text(self.source) == ";") {
                break;
            }
            match token.kind {
                TokenKind::Open(_) if self.brackets.paired[index] => depth += 1,
                TokenKind::Close(_) if self.brackets.paired[index] => depth = depth.saturating_sub(1),
                _ => {}
            }
            after = if token.kind == TokenKind::Newline { after } else { index };
        }
        self.brackets.insertions.push(Insertion { after, character: closer });
    }

    fn close(&mut self, index: usize, bracket: u8) {
        let opening = if bracket == b')' { b'(' } else { b'[' };
        let block = self.open.iter().rposition(|open| open.bracket == b'{').map_or(0, |block| block + 1);
        let partner = self.open[block..].iter().rposition(|open| open.bracket == opening);
        match (partner, self.open[block..].last()) {
            (Some(_), _) => {
                while let Some(open) = self.open.pop_if(|open| open.bracket != opening) {
                    self.report_unclosed(open.token, open.bracket);
                }
                if let Some(open) = self.open.pop() {
                    self.brackets.paired[open.token] = true;
                    self.brackets.paired[index] = true;
                }
            }
            (None, Some(open)) => {
                let (opener, right) = (open.token, if open.bracket == b'(' { ")" } else { "]" });
                let (here, there) = (self.tokens[index].span(), self.tokens[opener].span());
                self.brackets.diagnostics.push(wording::wrong_closer(self.file, here, there, right));
                self.brackets.replaced.push((index, right));
                self.brackets.paired[opener] = true;
                self.brackets.paired[index] = true;
                self.open.pop();
            }
            (None, None) => self.drop_closer(index),
        }
    }

    fn close_block(&mut self, index: usize) {
        self.close_unclosed();
        if self.surplus.is_some() && self.lines[index].first {
            let indent = self.lines[index].indent;
            if self.open.iter().any(|open| open.indent == indent) {
                while let Some(open) = self.open.pop_if(|open| open.indent > indent) {
                    self.brackets.diagnostics.push(wording::unclosed_block(self.file, self.tokens[open.token].span()));
                    self.insert_before(index, '}');
                }
            } else if let Some(surplus) = self.surplus.filter(|surplus| *surplus > 0) {
                self.surplus = Some(surplus - 1);
                return self.drop_closer(index);
            }
        }
        if self.open.pop().is_none() {
            self.drop_closer(index);
        }
    }

    fn drop_closer(&mut self, index: usize) {
        let token = &self.tokens[index];
        self.brackets.diagnostics.push(wording::unopened_closer(self.file, token.span(), token.text(self.source)));
        self.brackets.replaced.push((index, ""));
    }

    /// What is still open at the end of the file is one mistake, shown at the innermost opener.
    fn finish(&mut self) {
        self.close_unclosed();
        let Some(innermost) = self.open.last() else { return };
        let mut diagnostic = wording::unclosed_block(self.file, self.tokens[innermost.token].span());
        let outer: Vec<_> = self.open.iter().rev().skip(1).map(|open| self.tokens[open.token].span()).collect();
        for span in outer {
            diagnostic = diagnostic.label(self.file, span, "nor is this one");
        }
        self.brackets.diagnostics.push(diagnostic);
        for _ in 0..self.open.len() {
            self.insert_before(self.tokens.len(), '}');
        }
    }
}

//! Pairs brackets, and repairs what does not pair, so that the grammar always sees balanced text.
//!
//! Round and square brackets end at the latest where a block begins or ends. Braces are taken as they are while they balance;
//! if they do not, the indentation decides which one is missing or too many.

use super::super::wording;
use super::Errors;
use super::lexer::{Token, TokenKind};
use super::lines::Line;
use crate::diagnostics::FileId;

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
}

/// Pairs the brackets of `tokens`; `None` if they nest too deep for the text to be read at all.
pub(super) fn pair(file: FileId, source: &str, tokens: &[Token], lines: &[Line], errors: &mut Errors) -> Option<Brackets> {
    let surplus = brace_surplus(tokens);
    let brackets = Brackets { paired: vec![false; tokens.len()], ..Brackets::default() };
    let mut pairing = Pairing { file, source, tokens, lines, surplus, open: Vec::new(), skip: 0, brackets, errors };
    for (index, token) in tokens.iter().enumerate() {
        if index < pairing.skip {
            continue;
        }
        pairing.visit(index);
        if pairing.open.len() > MAXIMUM_DEPTH {
            *pairing.errors = Errors::default();
            pairing.errors.tell(|| wording::too_deep(file, token.span(), MAXIMUM_DEPTH));
            return None;
        }
    }
    pairing.finish();
    let mut brackets = pairing.brackets;
    brackets.insertions.sort_by_key(|insertion| insertion.after);
    Some(brackets)
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

struct Pairing<'a, 'e> {
    errors: &'e mut Errors,
    file: FileId,
    source: &'a str,
    tokens: &'a [Token],
    lines: &'a [Line],
    surplus: Option<i64>,
    open: Vec<Open>,
    /// Tokens before this one are done with.
    skip: usize,
    brackets: Brackets,
}

impl Pairing<'_, '_> {
    fn visit(&mut self, index: usize) {
        let token = &self.tokens[index];
        if self.lines[index].first && token.kind != TokenKind::Newline {
            self.begin_line(index);
        }
        match token.kind {
            TokenKind::Open(b'{') if self.in_brackets() && self.skip_pattern(index) => {}
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

    fn in_brackets(&self) -> bool {
        self.open.last().is_some_and(|open| open.bracket != b'{')
    }

    /// Braces within round or square brackets that close on their line were meant as a pattern: `sum(sole{l,r}.speed)`.
    fn skip_pattern(&mut self, index: usize) -> bool {
        let rest = self.tokens[index + 1..].iter();
        let ends = |token: &Token| matches!(token.kind, TokenKind::Close(_) | TokenKind::Open(_) | TokenKind::Newline);
        let Some(length) = rest.take(MAXIMUM_DEPTH).position(ends) else { return false };
        let close = index + 1 + length;
        if self.tokens[close].kind != TokenKind::Close(b'}') {
            return false;
        }
        let span = self.tokens[index].span().to(self.tokens[close].span());
        self.errors.tell(|| wording::misplaced_pattern(self.file, span));
        self.brackets.replaced.extend([(index, ""), (close, "")]);
        self.skip = close + 1;
        true
    }

    /// A declaration never stands in round or square brackets; where braces do not balance, the indentation speaks.
    fn begin_line(&mut self, index: usize) {
        let token = &self.tokens[index];
        if token.kind == TokenKind::Word && matches!(token.text(self.source), "let" | "const" | "fn" | "task") {
            self.close_unclosed();
        }
        let Some(surplus) = self.surplus else { return };
        if self.in_brackets() || self.lines[index].continues || token.kind == TokenKind::Close(b'}') {
            return;
        }
        let indent = self.lines[index].indent;
        while let Some(open) = self.open.pop_if(|open| indent <= open.indent) {
            self.errors.tell(|| wording::unclosed_block(self.file, self.tokens[open.token].span()));
            self.insert_before(index, '}');
        }
        let inside = match self.open.last_mut() {
            Some(open) => *open.inside.get_or_insert(indent),
            None => 0,
        };
        let deeper = surplus > 0 && indent > inside;
        if let Some(previous) = self.lines[index].previous.filter(|previous| deeper && self.could_open(*previous)) {
            self.surplus = Some(surplus - 1);
            self.errors.tell(|| wording::unopened_block(self.file, self.tokens[previous].span()));
            self.insert_before(index, '{');
            let indent_before = self.lines[previous].indent;
            self.open.push(Open { token: previous, bracket: b'{', indent: indent_before, inside: Some(indent) });
        }
    }

    /// Whether the line that ends with `token` begins with a word. Weights in a column are deeper than one another without a
    /// block between them.
    fn could_open(&self, token: usize) -> bool {
        let first = (0..=token).rev().find(|index| self.lines[*index].first);
        first.is_some_and(|first| self.tokens[first].kind == TokenKind::Word)
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
        self.errors.tell(|| wording::unclosed_bracket(self.file, self.tokens[opener].span(), closer));
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
                self.errors.tell(|| wording::wrong_closer(self.file, here, there, right));
                self.brackets.replaced.push((index, right));
                self.brackets.paired[opener] = true;
                self.brackets.paired[index] = true;
                self.open.pop();
            }
            (None, None) => self.drop_closer(index),
        }
    }

    fn close_block(&mut self, index: usize) {
        if let Some(surplus) = self.surplus.filter(|surplus| *surplus > 0 && !self.lines[index].first)
            && !self.opened_on_line(index)
        {
            // What this one closes was lost on the same line.
            self.surplus = Some(surplus - 1);
            return self.drop_closer(index);
        }
        self.close_unclosed();
        if self.surplus.is_some() && self.lines[index].first {
            let indent = self.lines[index].indent;
            if self.open.iter().any(|open| open.indent == indent) {
                while let Some(open) = self.open.pop_if(|open| open.indent > indent) {
                    self.errors.tell(|| wording::unclosed_block(self.file, self.tokens[open.token].span()));
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

    /// Whether the block that is open was opened on the line of `index`.
    fn opened_on_line(&self, index: usize) -> bool {
        let block = self.open.iter().rev().find(|open| open.bracket == b'{');
        block.is_some_and(|open| !self.source[self.tokens[open.token].start..self.tokens[index].start].contains('\n'))
    }

    fn drop_closer(&mut self, index: usize) {
        let token = &self.tokens[index];
        self.errors.tell(|| wording::unopened_closer(self.file, token.span(), token.text(self.source)));
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
        self.errors.tell(|| diagnostic);
        for _ in 0..self.open.len() {
            self.insert_before(self.tokens.len(), '}');
        }
    }
}

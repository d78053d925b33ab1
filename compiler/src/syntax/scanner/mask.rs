//! The text the grammar sees, and the way back to the source.

use super::super::tree::Comment;
use super::brackets::Brackets;
use super::lexer::{Token, TokenKind};
use crate::diagnostics::Span;

/// The source with comments and joined line ends blanked and brackets repaired. Bytes stand where they stand in the source but
/// for the few that were inserted or replaced.
#[derive(Debug, Default)]
pub(crate) struct Masked {
    /// What the grammar sees.
    pub(crate) text: String,
    /// Where the two drift apart: (byte of the mask, byte of the source), from there on in step.
    drifts: Vec<(usize, usize)>,
    /// What stands for something of another length, or for signs of several bytes: bytes `start..end` of the mask, and where that begins in the source. A byte
    /// within has no counterpart, and the same number of bytes further on could be within a character.
    exchanged: Vec<(usize, usize, usize)>,
    source_length: usize,
}

impl Masked {
    /// The byte of the source that a byte of the mask stands for.
    pub(crate) fn to_source(&self, byte: usize) -> usize {
        let within =
            self.exchanged.partition_point(|(start, ..)| *start < byte).checked_sub(1).map(|index| self.exchanged[index]);
        if let Some((_, _, source)) = within.filter(|(_, end, _)| byte < *end) {
            return source;
        }
        let next = self.drifts.partition_point(|(masked, _)| *masked <= byte);
        let (masked, source) = next.checked_sub(1).map_or((0, 0), |index| self.drifts[index]);
        let limit = self.drifts.get(next).map_or(self.source_length, |(_, source)| *source);
        (source + (byte - masked)).min(limit)
    }

    /// The span of the source for bytes `start..end` of the mask, blanks at its end left out.
    pub(crate) fn span(&self, start: usize, end: usize) -> Span {
        let trimmed = self.text.get(start..end).map_or(end, |slice| start + slice.trim_end().len());
        Span::new(self.to_source(start), self.to_source(trimmed.max(start)))
    }
}

/// Builds the mask.
pub(super) fn mask(source: &str, tokens: &[Token], masked_newlines: &[bool], brackets: &Brackets) -> Masked {
    let mut masked = Masked {
        text: String::with_capacity(source.len()),
        drifts: Vec::new(),
        exchanged: Vec::new(),
        source_length: source.len(),
    };
    let mut insertions = brackets.insertions.iter().peekable();
    let mut replaced = brackets.replaced.iter().peekable();
    let mut at = 0;
    for (index, token) in tokens.iter().enumerate() {
        masked.blank(token.start - at);
        at = token.end;
        let instead = replaced.next_if(|(replaced, _)| *replaced == index).map(|(_, text)| *text);
        match instead.or(token.replacement.as_deref()) {
            _ if masked_newlines[index] => masked.blank(token.end - token.start),
            Some(text) => masked.replace(text, token, &source[token.start..token.end]),
            None => masked.text.push_str(&source[token.start..token.end]),
        }
        while let Some(insertion) = insertions.next_if(|insertion| insertion.after == index) {
            masked.text.push(insertion.character);
            masked.drifts.push((masked.text.len(), token.end));
        }
    }
    masked.blank(source.len() - at);
    masked
}

impl Masked {
    fn blank(&mut self, length: usize) {
        self.text.extend(std::iter::repeat_n(' ', length));
    }

    fn replace(&mut self, text: &str, token: &Token, original: &str) {
        let start = self.text.len();
        self.text.push_str(text);
        if text.len() != original.len() || !original.is_ascii() {
            self.exchanged.push((start, self.text.len(), token.start));
        }
        if text.len() != token.end - token.start || token.kind == TokenKind::Text {
            self.drifts.push((self.text.len(), token.end));
        }
    }
}

/// A run of `///` lines, and the token it stands directly above.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct DocRun {
    /// From the first mark to the end of the last line.
    pub(crate) span: Span,
    /// Marks removed, joined by newlines.
    pub(crate) text: String,
    /// Byte of the token that begins the next line; `None` if that line is empty.
    pub(crate) above: Option<usize>,
}

/// Collects runs of documentation comments of one kind on lines of their own.
pub(super) fn doc_runs(source: &str, comments: &[Comment], kind: super::super::tree::CommentKind) -> Vec<DocRun> {
    let mut runs: Vec<DocRun> = Vec::new();
    for comment in comments.iter().filter(|comment| comment.kind == kind) {
        let line = comment.span.of(source).get(3..).unwrap_or("");
        let line = line.strip_prefix(' ').unwrap_or(line).trim_end();
        let above = next_line_token(source, comment.span.end as usize);
        if let Some(run) = runs.last_mut().filter(|run| run.above == Some(comment.span.start as usize)) {
            run.text.push('\n');
            run.text.push_str(line);
            run.span = run.span.to(comment.span);
            run.above = above;
        } else {
            let above = above.filter(|_| comment.own_line);
            runs.push(DocRun { span: comment.span, text: line.to_owned(), above });
        }
    }
    runs
}

/// First byte that is not blank of the line after the one that ends at `end`.
fn next_line_token(source: &str, end: usize) -> Option<usize> {
    let rest = &source[end..];
    let newline = rest.find('\n')?;
    let line = &rest[newline + 1..];
    let blanks = line.len() - line.trim_start_matches([' ', '\t', '\r']).len();
    let first = line[blanks..].chars().next()?;
    (first != '\n').then_some(end + newline + 1 + blanks)
}

//! Errors that only follow from errors of syntax are not reported: names whose declaration could not be read, and what a task or
//! an element lacks because its statement could not be read.

use crate::diagnostics::{Diagnostic, FileId, SourceMap, codes};
use std::collections::{BTreeMap, BTreeSet};

/// Leaves out what follows from errors of syntax.
pub(super) fn forget(sources: &SourceMap, diagnostics: &mut Vec<Diagnostic>) {
    unread_names(sources, diagnostics);
    unread_statements(sources, diagnostics);
}

/// Leaves out complaints about names whose declaration is there, but could not be read: only the declaration is at fault.
fn unread_names(sources: &SourceMap, diagnostics: &mut Vec<Diagnostic>) {
    const WORDS: [&str; 9] = ["fn", "let", "const", "state", "clock", "random", "reference", "observation", "task"];
    let unreadable: BTreeSet<FileId> =
        diagnostics.iter().filter(|diagnostic| diagnostic.code.id.starts_with("E01")).map(Diagnostic::file).collect();
    let mut declared = BTreeSet::new();
    for file in unreadable {
        let words: Vec<&str> = sources.text(file).split_whitespace().collect();
        let named = words.windows(2).filter(|pair| WORDS.contains(&pair[0])).map(|pair| pair[1]);
        declared.extend(named.filter_map(|word| word.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).next()));
    }
    declared.remove("");
    diagnostics.retain(|diagnostic| {
        diagnostic.code != codes::names::UNKNOWN_NAME || !declared.contains(diagnostic.span().of(sources.text(diagnostic.file())))
    });
}

/// Leaves out errors of what is missing where an error of syntax stands on a line, there or further down, that would have
/// declared it.
fn unread_statements(sources: &SourceMap, diagnostics: &mut Vec<Diagnostic>) {
    // Of each word on a line that could not be read, where the last such line begins. Every line is looked at once.
    let mut unread: BTreeMap<(FileId, &str), usize> = BTreeMap::new();
    let mut lines = BTreeSet::new();
    for diagnostic in diagnostics.iter().filter(|diagnostic| codes::syntax::ALL.iter().any(|code| code.id == diagnostic.code.id))
    {
        let (start, line) = line_of(sources.text(diagnostic.file()), diagnostic.span().start as usize);
        if lines.insert((diagnostic.file(), start)) {
            for word in words(line) {
                let last = unread.entry((diagnostic.file(), word)).or_default();
                *last = (*last).max(start);
            }
        }
    }
    diagnostics.retain(|diagnostic| {
        let missing = missing(diagnostic);
        let last = missing.iter().filter_map(|word| unread.get(&(diagnostic.file(), *word))).max();
        last.is_none_or(|line| *line < line_of(sources.text(diagnostic.file()), diagnostic.span().start as usize).0)
    });
}

/// The words that would have declared what is missing; none of other errors.
fn missing(diagnostic: &Diagnostic) -> Vec<&str> {
    if diagnostic.code.id == codes::scene::MASS.id {
        return vec!["mass", "density"];
    }
    let missing = diagnostic.message.split_once("does not declare").filter(|_| diagnostic.code.id == codes::tasks::MISSING.id);
    missing.map_or_else(Vec::new, |(_, missing)| words(missing).collect())
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|character: char| !(character.is_ascii_alphanumeric() || character == '_')).filter(|word| !word.is_empty())
}

/// Where the line of a byte begins, and the line.
fn line_of(text: &str, byte: usize) -> (usize, &str) {
    let byte = (0..=byte.min(text.len())).rev().find(|&byte| text.is_char_boundary(byte)).unwrap_or(0);
    let start = text[..byte].rfind('\n').map_or(0, |newline| newline + 1);
    let end = text[byte..].find('\n').map_or(text.len(), |newline| byte + newline);
    (start, &text[start..end])
}

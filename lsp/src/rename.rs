//! Renaming what a text declares, in all files, so that it means what it meant.

use crate::edits::Edits;
use crate::positions::{Encoding, Lines};
use crate::workspace::Workspace;
use lsp_types::{Range, WorkspaceEdit};
use msk_compiler::diagnostics::{Diagnostic, Severity, Span};
use msk_compiler::resolve::index::{Index, Occurrence, Space};
use msk_compiler::syntax::UNITS;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Words that no name may be.
const RESERVED: &[&str] = &[
    "and", "or", "not", "if", "then", "else", "in", "for", "when", "where", "becomes", "redraw", "until", "by", "true", "false",
    "let", "const", "fn", "task",
];

/// The name at a byte, if it can be changed.
///
/// # Errors
/// In words, why it cannot.
pub fn prepare(workspace: &Workspace<'_>, path: &Path, byte: usize, encoding: Encoding) -> Result<Range, String> {
    let index = workspace.index();
    let (file, here) = changeable(&index, path, byte)?;
    Ok(Lines::new(&index.files[file].text, encoding).range(here.span))
}

/// Renames what is named at a byte.
///
/// # Errors
/// In words, why it cannot be done: what is there is declared nowhere, the new name is none, or a text would mean something else.
pub fn rename(
    workspace: &Workspace<'_>,
    edits: &Edits,
    path: &Path,
    byte: usize,
    new_name: &str,
) -> Result<WorkspaceEdit, String> {
    let index = workspace.index();
    let (_, here) = changeable(&index, path, byte)?;
    must_be_a_name(new_name)?;
    let mut places: Vec<(usize, Span)> = index.places_of(here.symbol).map(|place| (place.file, place.span)).collect();
    places.sort_unstable();
    places.dedup();
    let changes: Vec<(PathBuf, Span, String)> =
        places.iter().map(|(file, span)| (index.files[*file].path.clone(), *span, new_name.to_owned())).collect();
    let texts = changed(&index, &places, new_name);
    must_mean_the_same(workspace, &index, here, &places, new_name, &texts)?;
    edits.workspace_edit(workspace, changes).ok_or_else(|| "a built-in file cannot be changed".to_owned())
}

fn changeable(index: &Index, path: &Path, byte: usize) -> Result<(usize, Occurrence), String> {
    let file = index.file(path).ok_or("this file cannot be read")?;
    let here = index.at(file, byte).ok_or("there is no name here that a file declares")?;
    let symbol = &index.symbols[here.symbol];
    if matches!(symbol.space, Space::Body | Space::Part | Space::Pose) {
        return Err(format!("`{}` belongs to a body; tasks of other folders may use it", symbol.name));
    }
    if let Some(pattern) = index.places_of(here.symbol).find(|place| place.pattern) {
        let written = pattern.span.of(&index.files[pattern.file].text);
        return Err(format!("`{}` is one of the names of `{written}`, which cannot be renamed alone", symbol.name));
    }
    Ok((file, here))
}

fn must_be_a_name(name: &str) -> Result<(), String> {
    let first = name.chars().next().is_some_and(|first| first.is_ascii_lowercase() || first == '_');
    let rest = name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if !first || !rest || name.ends_with('_') {
        return Err(format!(
            "`{name}` is not a valid name: lower-case letters, digits and `_`, a letter first and no `_` at the end"
        ));
    }
    if RESERVED.contains(&name) || UNITS.contains(&name) {
        return Err(format!("`{name}` is a word of the language"));
    }
    Ok(())
}

/// The texts with the name changed at all places, which are sorted.
fn changed(index: &Index, places: &[(usize, Span)], new_name: &str) -> BTreeMap<PathBuf, String> {
    let mut texts = BTreeMap::new();
    for (number, file) in index.files.iter().enumerate() {
        let mut text = file.text.clone();
        let mut touched = false;
        for (_, span) in places.iter().rev().filter(|(place, _)| *place == number) {
            text.replace_range(span.range(), new_name);
            touched = true;
        }
        if touched {
            texts.insert(file.path.clone(), text);
        }
    }
    texts
}

/// A new name must neither clash with another nor come to mean it.
fn must_mean_the_same(
    workspace: &Workspace<'_>,
    index: &Index,
    here: Occurrence,
    places: &[(usize, Span)],
    new_name: &str,
    texts: &BTreeMap<PathBuf, String>,
) -> Result<(), String> {
    let moved = |file: usize, span: Span| {
        let before = places.iter().filter(|(other, place)| *other == file && place.start < span.start);
        let grown: i64 = before.map(|(_, place)| new_name.len() as i64 - i64::from(place.end - place.start)).sum();
        (i64::from(span.start) + grown).max(0) as usize
    };
    let after = workspace.index_assuming(texts);
    let same_place = after.file(&index.files[here.file].path).and_then(|file| after.at(file, moved(here.file, here.span)));
    let mut found: Vec<(&Path, usize)> = same_place
        .iter()
        .flat_map(|here| after.places_of(here.symbol))
        .map(|place| (after.files[place.file].path.as_path(), place.span.start as usize))
        .collect();
    let mut wanted: Vec<(&Path, usize)> =
        places.iter().map(|(file, span)| (index.files[*file].path.as_path(), moved(*file, *span))).collect();
    for places in [&mut found, &mut wanted] {
        places.sort_unstable();
        places.dedup();
    }
    if found != wanted {
        return Err(format!("`{new_name}` is already defined where `{}` is used", index.symbols[here.symbol].name));
    }
    for entry in texts.keys().chain(workspace.documents().map(|(path, _)| path)) {
        let errors =
            |diagnostics: &[Diagnostic]| diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error).count();
        let before = errors(&workspace.inspect(entry).report.diagnostics);
        let diagnostics = workspace.diagnostics_assuming(entry, texts);
        if errors(&diagnostics) > before {
            let first = diagnostics.iter().find(|diagnostic| diagnostic.message.contains(new_name)).or(diagnostics.first());
            return Err(
                first.map_or_else(|| "the file would no longer compile".to_owned(), |diagnostic| diagnostic.message.clone())
            );
        }
    }
    Ok(())
}

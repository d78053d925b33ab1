//! From names to declarations and back.

use crate::paths;
use crate::positions::{Encoding, Lines};
use crate::workspace::Workspace;
use lsp_types::{DocumentHighlight, DocumentHighlightKind, Location};
use msk_compiler::resolve::index::{Index, Occurrence};
use msk_compiler::syntax::tree::{Item, Text};
use std::path::Path;

/// Where what is named at a byte is declared. On the path of a `use`, the file.
pub fn definitions(workspace: &Workspace<'_>, path: &Path, byte: usize, encoding: Encoding) -> Vec<Location> {
    let index = workspace.index();
    let Some(file) = index.file(path) else { return Vec::new() };
    if let Some(used) = used_at(&index, file, byte) {
        let target = index.files[file].uses.iter().map(|&used| &index.files[used].path);
        let target = target
            .filter(|target| target.ends_with(used.value.rsplit('/').next().unwrap_or_default()))
            .find_map(|target| paths::uri(target));
        return target.map(|uri| Location::new(uri, lsp_types::Range::default())).into_iter().collect();
    }
    let Some(here) = index.at(file, byte) else { return Vec::new() };
    let declared = index.places_of(here.symbol).filter(|place| place.declares);
    declared.filter_map(|place| location(&index, place, encoding)).collect()
}

/// Every place at which what is named at a byte is named.
pub fn references(workspace: &Workspace<'_>, path: &Path, byte: usize, declared: bool, encoding: Encoding) -> Vec<Location> {
    let index = workspace.index();
    let Some(here) = index.file(path).and_then(|file| index.at(file, byte)) else { return Vec::new() };
    let places = index.places_of(here.symbol).filter(|place| declared || !place.declares);
    let mut locations: Vec<Location> = places.filter_map(|place| location(&index, place, encoding)).collect();
    locations.dedup();
    locations
}

/// The same within one file.
pub fn highlights(workspace: &Workspace<'_>, path: &Path, byte: usize, encoding: Encoding) -> Vec<DocumentHighlight> {
    let index = workspace.index();
    let Some(file) = index.file(path) else { return Vec::new() };
    let Some(here) = index.at(file, byte) else { return Vec::new() };
    let lines = Lines::new(&index.files[file].text, encoding);
    let places = index.places_of(here.symbol).filter(|place| place.file == file);
    places
        .map(|place| DocumentHighlight {
            range: lines.range(place.span),
            kind: Some(if place.declares { DocumentHighlightKind::WRITE } else { DocumentHighlightKind::READ }),
        })
        .collect()
}

fn location(index: &Index, place: &Occurrence, encoding: Encoding) -> Option<Location> {
    let file = &index.files[place.file];
    Some(Location::new(paths::uri(&file.path)?, Lines::new(&file.text, encoding).range(place.span)))
}

fn used_at(index: &Index, file: usize, byte: usize) -> Option<&Text> {
    index.files[file].tree.items.iter().find_map(|item| match item {
        Item::Use(used) if used.path.span.start as usize <= byte && byte <= used.path.span.end as usize => Some(&used.path),
        _ => None,
    })
}

//! What mends a text: the fixes of the compiler, as changes that an editor can make.

use crate::edits::Edits;
use crate::positions::Lines;
use crate::report::Translator;
use crate::workspace::Workspace;
use lsp_types::{CodeAction, CodeActionKind, CodeActionOrCommand, Range};
use msk_compiler::diagnostics::{Diagnostic, Edit, FileId, SourceMap, Span, fixed};
use std::path::{Path, PathBuf};

/// All that can be mended at once in a file.
pub const FIX_ALL: CodeActionKind = CodeActionKind::SOURCE_FIX_ALL;

/// What mends what is wrong within `range` of a file, and, if `only` asks for it, all that is surely meant.
pub fn actions(
    workspace: &Workspace<'_>,
    edits: &Edits,
    path: &Path,
    range: Range,
    only: Option<&[CodeActionKind]>,
) -> Vec<CodeActionOrCommand> {
    let wanted = |kind: &CodeActionKind| {
        only.is_none_or(|only| {
            only.iter().any(|wish| kind.as_str() == wish.as_str() || kind.as_str().starts_with(&format!("{}.", wish.as_str())))
        })
    };
    let Some(text) = workspace.text(path) else { return Vec::new() };
    let place = Lines::new(&text, edits.encoding).span(range);
    let mut actions: Vec<CodeAction> = Vec::new();
    let inspections = workspace.inspections_of(path);
    for (file, whole) in &inspections {
        let here = |diagnostic: &&Diagnostic| diagnostic.file() == *file && touches(diagnostic.span(), place);
        let sources = &whole.report.sources;
        let translator = Translator::new(sources, edits.encoding);
        for diagnostic in whole.report.diagnostics.iter().filter(here) {
            if wanted(&CodeActionKind::QUICKFIX) {
                actions.extend(quick(diagnostic, sources, edits, workspace, &translator));
            }
        }
    }
    if let Some((file, whole)) = inspections.first().filter(|_| only.is_some() && wanted(&FIX_ALL)) {
        actions.extend(all(&whole.report.diagnostics, *file, &text, path, edits, workspace));
    }
    let mut seen: Vec<CodeAction> = Vec::new();
    for action in actions {
        // A library that several open texts use is looked at with each of them.
        if !seen.contains(&action) {
            seen.push(action);
        }
    }
    seen.into_iter().map(CodeActionOrCommand::CodeAction).collect()
}

/// Empty spans touch what they stand beside.
fn touches(a: Span, b: Span) -> bool {
    a.start <= b.end && b.start <= a.end
}

fn quick<'a>(
    diagnostic: &'a Diagnostic,
    sources: &'a SourceMap,
    edits: &'a Edits,
    workspace: &'a Workspace<'_>,
    translator: &'a Translator<'a>,
) -> impl Iterator<Item = CodeAction> + 'a {
    diagnostic.fixes.iter().filter_map(move |fix| {
        let changes = fix
            .edits
            .iter()
            .map(|Edit { file, span, replacement }| (PathBuf::from(sources.path(*file)), *span, replacement.clone()));
        Some(CodeAction {
            title: fix.title.clone(),
            kind: Some(CodeActionKind::QUICKFIX),
            diagnostics: Some(vec![translator.translate(diagnostic)]),
            edit: Some(edits.workspace_edit(workspace, changes.collect())?),
            is_preferred: Some(fix.automatic),
            ..CodeAction::default()
        })
    })
}

fn all(
    diagnostics: &[Diagnostic],
    file: FileId,
    text: &str,
    path: &Path,
    edits: &Edits,
    workspace: &Workspace<'_>,
) -> Option<CodeAction> {
    let (mended, count) = fixed(text, file, diagnostics);
    if count == 0 {
        return None;
    }
    let change = (path.to_path_buf(), Span::new(0, text.len()), mended);
    Some(CodeAction {
        title: "apply all safe fixes".to_owned(),
        kind: Some(FIX_ALL),
        edit: Some(edits.workspace_edit(workspace, vec![change])?),
        ..CodeAction::default()
    })
}

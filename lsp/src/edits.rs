//! Changes of texts as the client wants them.

use crate::paths;
use crate::positions::{Encoding, Lines};
use crate::workspace::Workspace;
use lsp_types::{
    DocumentChanges, OneOf, OptionalVersionedTextDocumentIdentifier, TextDocumentEdit, TextEdit, Uri, WorkspaceEdit,
};
use msk_compiler::diagnostics::Span;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// How the client wants changes of texts.
pub struct Edits {
    /// How positions are counted.
    pub encoding: Encoding,
    /// Whether they may name the version of the text that they change.
    pub versioned: bool,
}

impl Edits {
    /// Changes of several files as the client wants them; nothing if one of them cannot be addressed.
    #[allow(clippy::mutable_key_type, reason = "the immutable part of an address is not compared")]
    pub fn workspace_edit(&self, workspace: &Workspace<'_>, changes: Vec<(PathBuf, Span, String)>) -> Option<WorkspaceEdit> {
        let mut by_file: BTreeMap<PathBuf, Vec<TextEdit>> = BTreeMap::new();
        for (path, span, new_text) in changes {
            let text = workspace.text(&path)?;
            let range = Lines::new(&text, self.encoding).range(span);
            by_file.entry(path).or_default().push(TextEdit { range, new_text });
        }
        let mut edits = Vec::new();
        for (path, changes) in by_file {
            let document = workspace.document(&path);
            let uri = document.map(|document| document.uri.clone()).or_else(|| paths::uri(&path))?;
            edits.push((uri, document.map(|document| document.version), changes));
        }
        if !self.versioned {
            let changes = edits.into_iter().map(|(uri, _, changes)| (uri, changes)).collect();
            return Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() });
        }
        let edit = |(uri, version, changes): (Uri, Option<i32>, Vec<TextEdit>)| TextDocumentEdit {
            text_document: OptionalVersionedTextDocumentIdentifier { uri, version },
            edits: changes.into_iter().map(OneOf::Left).collect(),
        };
        let edits = edits.into_iter().map(edit).collect();
        Some(WorkspaceEdit { document_changes: Some(DocumentChanges::Edits(edits)), ..WorkspaceEdit::default() })
    }
}

//! What the compiler tells, as the editor wants it.

use crate::paths;
use crate::positions::{Encoding, Lines};
use crate::workspace::Workspace;
use lsp_types::{
    Diagnostic as Told, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Location, NumberOrString,
    PublishDiagnosticsParams,
};
use msk_compiler::diagnostics::{Diagnostic, FileId, Severity, SourceMap, codes};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What was last told of each file.
#[derive(Default)]
pub struct Reporter {
    told: BTreeMap<PathBuf, (Option<i32>, Vec<Told>)>,
}

impl Reporter {
    /// What has changed since the last time, file by file: of all open texts and of what they use.
    pub fn news(&mut self, workspace: &Workspace<'_>, encoding: Encoding) -> Vec<PublishDiagnosticsParams> {
        let mut present: BTreeMap<PathBuf, Vec<Told>> = self.told.keys().map(|path| (path.clone(), Vec::new())).collect();
        for (path, _) in workspace.documents() {
            let whole = workspace.inspect(path);
            present.entry(path.clone()).or_default();
            for diagnostic in &whole.report.diagnostics {
                let sources = &whole.report.sources;
                let told = told(diagnostic, sources, encoding);
                let file = present.entry(PathBuf::from(sources.path(diagnostic.file()))).or_default();
                // A library that several open texts use is looked at with each of them.
                if !file.contains(&told) {
                    file.push(told);
                }
            }
        }
        let mut news = Vec::new();
        for (path, diagnostics) in present {
            let version = workspace.document(&path).map(|document| document.version);
            let state = (version, diagnostics);
            if self.told.get(&path) == Some(&state) {
                continue;
            }
            let uri = workspace.document(&path).map(|document| document.uri.clone()).or_else(|| paths::uri(&path));
            if let Some(uri) = uri {
                news.push(PublishDiagnosticsParams { uri, diagnostics: state.1.clone(), version });
            }
            // What is closed and sound needs no memory.
            if version.is_none() && state.1.is_empty() {
                self.told.remove(&path);
            } else {
                self.told.insert(path, state);
            }
        }
        news
    }
}

/// One error or warning.
pub fn told(diagnostic: &Diagnostic, sources: &SourceMap, encoding: Encoding) -> Told {
    let place = |file: FileId, span| Lines::new(sources.text(file), encoding).range(span);
    let mut message = diagnostic.message.clone();
    if let Some(label) = diagnostic.labels.first().filter(|label| !label.text.is_empty()) {
        message += &format!(" ({})", label.text);
    }
    let lines = [("expected", &diagnostic.expected), ("found", &diagnostic.found)];
    for (word, line) in lines {
        message.extend(line.iter().map(|line| format!("\n{word}: {line}")));
    }
    message.extend(diagnostic.help.iter().map(|help| format!("\n{help}")));
    let related: Vec<DiagnosticRelatedInformation> = diagnostic
        .labels
        .iter()
        .skip(1)
        .filter_map(|label| {
            let uri = paths::uri(Path::new(sources.path(label.file)))?;
            let message = if label.text.is_empty() { "here".to_owned() } else { label.text.clone() };
            Some(DiagnosticRelatedInformation { location: Location::new(uri, place(label.file, label.span)), message })
        })
        .collect();
    Told {
        range: place(diagnostic.file(), diagnostic.span()),
        severity: Some(match diagnostic.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
        }),
        code: Some(NumberOrString::String(diagnostic.code.id.to_owned())),
        source: Some("msk".to_owned()),
        message,
        related_information: (!related.is_empty()).then_some(related),
        tags: (diagnostic.code == codes::lints::UNUSED).then(|| vec![DiagnosticTag::UNNECESSARY]),
        ..Told::default()
    }
}

//! Translates diagnostics of the compiler to those of the protocol.

use crate::paths;
use crate::positions::{Encoding, Lines};
use crate::workspace::Workspace;
use lsp_types::{
    Diagnostic as LspDiagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Location, NumberOrString,
    PublishDiagnosticsParams, Range,
};
use msk_compiler::diagnostics::{Diagnostic, FileId, Severity, SourceMap, Span, codes};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The diagnostics last published for each file.
#[derive(Default)]
pub struct Reporter {
    published: BTreeMap<PathBuf, (Option<i32>, Vec<LspDiagnostic>)>,
}

impl Reporter {
    /// What has changed since the last time, file by file: of all open texts and of what they use.
    pub fn news(&mut self, workspace: &Workspace<'_>, encoding: Encoding) -> Vec<PublishDiagnosticsParams> {
        let mut present: BTreeMap<PathBuf, Vec<LspDiagnostic>> =
            self.published.keys().map(|path| (path.clone(), Vec::new())).collect();
        // A library that several open texts use is looked at with each of them.
        let mut seen: BTreeSet<(PathBuf, String)> = BTreeSet::new();
        for (path, _) in workspace.documents() {
            let whole = workspace.inspect(path);
            present.entry(path.clone()).or_default().extend(workspace.defect(path).map(defect));
            let sources = &whole.report.sources;
            let translator = Translator::new(sources, encoding);
            for diagnostic in &whole.report.diagnostics {
                let translated = translator.translate(diagnostic);
                let file = PathBuf::from(sources.path(diagnostic.file()));
                if seen.insert((file.clone(), serde_json::to_string(&translated).unwrap_or_default())) {
                    present.entry(file).or_default().push(translated);
                }
            }
        }
        let mut news = Vec::new();
        for (path, diagnostics) in present {
            let version = workspace.document(&path).map(|document| document.version);
            let state = (version, diagnostics);
            if self.published.get(&path) == Some(&state) {
                continue;
            }
            let uri = workspace.document(&path).map(|document| document.uri.clone()).or_else(|| paths::uri(&path));
            if let Some(uri) = uri {
                news.push(PublishDiagnosticsParams { uri, diagnostics: state.1.clone(), version });
            }
            // What is closed and sound needs no memory.
            if version.is_none() && state.1.is_empty() {
                self.published.remove(&path);
            } else {
                self.published.insert(path, state);
            }
        }
        news
    }
}

/// The diagnostic of a text at which the compiler panicked.
fn defect(words: String) -> LspDiagnostic {
    LspDiagnostic {
        severity: Some(DiagnosticSeverity::ERROR),
        source: Some("msk".to_owned()),
        message: format!("the compiler cannot continue with this file, which is a bug; please report it with the file: {words}"),
        ..LspDiagnostic::default()
    }
}

/// Puts diagnostics into the words of the protocol; the lines of each file are found once.
pub struct Translator<'a> {
    sources: &'a SourceMap,
    encoding: Encoding,
    lines: RefCell<BTreeMap<FileId, Lines<'a>>>,
}

impl<'a> Translator<'a> {
    /// For diagnostics of some files.
    pub fn new(sources: &'a SourceMap, encoding: Encoding) -> Self {
        Self { sources, encoding, lines: RefCell::default() }
    }

    fn range(&self, file: FileId, span: Span) -> Range {
        let fresh = || Lines::new(self.sources.text(file), self.encoding);
        self.lines.borrow_mut().entry(file).or_insert_with(fresh).range(span)
    }

    /// One error or warning.
    pub fn translate(&self, diagnostic: &Diagnostic) -> LspDiagnostic {
        let mut message = diagnostic.message.clone();
        if let Some(label) = diagnostic.labels.first().filter(|label| !label.text.is_empty()) {
            message += &format!(" ({})", label.text);
        }
        let lines = [("expected", &diagnostic.expected), ("found", &diagnostic.found)];
        for (word, line) in lines {
            message.extend(line.iter().map(|line| format!("\n{word}: {line}")));
        }
        message.extend(diagnostic.code.lint.iter().map(|lint| format!("\nlint: {}", lint.name)));
        message.extend(diagnostic.help.iter().map(|help| format!("\n{help}")));
        let related: Vec<DiagnosticRelatedInformation> = diagnostic
            .labels
            .iter()
            .skip(1)
            .filter_map(|label| {
                let uri = paths::uri(Path::new(self.sources.path(label.file)))?;
                let message = if label.text.is_empty() { "here".to_owned() } else { label.text.clone() };
                Some(DiagnosticRelatedInformation { location: Location::new(uri, self.range(label.file, label.span)), message })
            })
            .collect();
        LspDiagnostic {
            range: self.range(diagnostic.file(), diagnostic.span()),
            severity: Some(match diagnostic.severity {
                Severity::Error => DiagnosticSeverity::ERROR,
                Severity::Warning => DiagnosticSeverity::WARNING,
            }),
            code: Some(NumberOrString::String(diagnostic.code.id.to_owned())),
            source: Some("msk".to_owned()),
            message,
            related_information: (!related.is_empty()).then_some(related),
            tags: (diagnostic.code == codes::lints::UNUSED).then(|| vec![DiagnosticTag::UNNECESSARY]),
            ..LspDiagnostic::default()
        }
    }
}

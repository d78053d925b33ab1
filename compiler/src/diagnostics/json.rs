//! Diagnostics as JSON, for editors, agents and `--fix`.

use super::{Diagnostic, FileId, Report, SourceMap, Span};
use serde_json::{Value, json};

impl Report {
    /// All diagnostics. Lines and columns count from 1, columns in characters; bytes count from 0.
    pub fn to_json(&self) -> Value {
        let diagnostics: Vec<Value> = self.diagnostics.iter().map(|diagnostic| diagnostic.to_json(&self.sources)).collect();
        json!({ "diagnostics": diagnostics })
    }
}

impl Diagnostic {
    /// This diagnostic.
    pub fn to_json(&self, sources: &SourceMap) -> Value {
        let labels: Vec<Value> = self
            .labels
            .iter()
            .map(|label| json!({ "place": place(sources, label.file, label.span), "text": label.text }))
            .collect();
        let fixes: Vec<Value> = self
            .fixes
            .iter()
            .map(|fix| {
                let edits: Vec<Value> = fix
                    .edits
                    .iter()
                    .map(|edit| json!({ "place": place(sources, edit.file, edit.span), "replacement": edit.replacement }))
                    .collect();
                json!({ "title": fix.title, "automatic": fix.automatic, "edits": edits })
            })
            .collect();
        json!({
            "code": self.code.id,
            "lint": self.code.lint.map(|lint| lint.name),
            "severity": self.severity,
            "message": self.message,
            "labels": labels,
            "expected": self.expected,
            "found": self.found,
            "help": self.help,
            "denied_by": self.denied_by,
            "fixes": fixes,
        })
    }
}

fn place(sources: &SourceMap, file: FileId, span: Span) -> Value {
    let (line, column) = sources.line_column(file, span.start as usize);
    let (end_line, end_column) = sources.line_column(file, span.end as usize);
    json!({
        "file": sources.path(file),
        "start": { "byte": span.start, "line": line, "column": column },
        "end": { "byte": span.end, "line": end_line, "column": end_column },
    })
}

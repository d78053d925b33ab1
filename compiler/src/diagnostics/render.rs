//! Diagnostics as text: the code, the source line, carets under the exact place, what was expected and found, what to do.

use super::visible::{visible, visible_place};
use super::{Diagnostic, FileId, Label, Report, Severity, SourceMap, Span};
use annotate_snippets::{Annotation, AnnotationKind, Level, Renderer, Snippet};
use std::fmt::Write;

/// Columns of source shown of a long line.
const WIDTH: usize = 120;

/// Whether to colour the text for a terminal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// No escape sequences.
    Plain,
    /// ANSI colours.
    Coloured,
}

impl Report {
    /// All diagnostics as text, and a line that counts them.
    pub fn render(&self, style: Style) -> String {
        let mut text = String::new();
        for diagnostic in &self.diagnostics {
            text += &diagnostic.render(&self.sources, style);
            text.push('\n');
        }
        let count = |severity| self.diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count();
        let counted = [(count(Severity::Error), "error"), (count(Severity::Warning), "warning")];
        let counted = counted.iter().filter(|(count, _)| *count > 0);
        let counted: Vec<String> =
            counted.map(|(count, word)| format!("{count} {word}{}", if *count == 1 { "" } else { "s" })).collect();
        if !counted.is_empty() {
            let _ = writeln!(text, "{}", counted.join(", "));
        }
        text
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.render(Style::Plain))
    }
}

impl std::error::Error for Report {}

impl Diagnostic {
    /// This diagnostic as text.
    pub fn render(&self, sources: &SourceMap, style: Style) -> String {
        let renderer = match style {
            Style::Plain => Renderer::plain(),
            Style::Coloured => Renderer::styled(),
        };
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let mut files: Vec<FileId> = Vec::new();
        for label in &self.labels {
            if !files.contains(&label.file) {
                files.push(label.file);
            }
        }
        let group = level
            .primary_title(visible(&self.message))
            .id(self.code.named())
            .elements(files.into_iter().map(|file| self.snippet(sources, file)))
            .elements(self.notes().map(|(name, text)| Level::NOTE.with_name(name).message(visible(&text).into_owned())));
        renderer.term_width(WIDTH).render(&[group]) + "\n"
    }

    /// The lines of a file from the first that has a label to the last. Lines between are left out where they are many.
    fn snippet<'a>(&'a self, sources: &'a SourceMap, file: FileId) -> Snippet<'a, Annotation<'a>> {
        let line_of = |label: &Label| sources.line_column(file, label.span.start as usize).0;
        let labels = || self.labels.iter().filter(|label| label.file == file);
        let (first, last) = (labels().map(line_of).min().unwrap_or(1), labels().map(line_of).max().unwrap_or(1));
        let line = |number: usize| sources.line(file, number).unwrap_or_default();
        let window = Span::new(line(first).start as usize, line(last).end as usize);
        let source = window.of(sources.text(file));
        let shown = |byte: u32| visible_place(source, (byte - window.start) as usize);
        let annotations = labels().map(|label| {
            let is_main = self.labels.first().is_some_and(|main| std::ptr::eq(main, label));
            let kind = if is_main { AnnotationKind::Primary } else { AnnotationKind::Context };
            // A place over several lines is marked on its first.
            let start = label.span.start.clamp(window.start, window.end);
            let end = label.span.end.min(line(line_of(label)).end).max(start);
            kind.span(shown(start)..shown(end)).label((!label.text.is_empty()).then(|| visible(&label.text)))
        });
        Snippet::source(visible(source)).path(visible(sources.path(file))).line_start(first).annotations(annotations)
    }

    /// What stands below the source, each with its name.
    fn notes(&self) -> impl Iterator<Item = (&'static str, String)> {
        // What was found stands below what was expected, aligned with it.
        let found = if self.expected.is_some() { "   found" } else { "found" };
        let facts = self.expected.iter().map(|text| ("expected", text)).chain(self.found.iter().map(move |text| (found, text)));
        let help = self.help.iter().chain(self.fixes.iter().map(|fix| &fix.title)).map(|text| ("help", text));
        let notes = facts.chain(help).map(|(name, text)| (name, text.clone()));
        notes.chain(self.denied_by.iter().map(|option| ("note", format!("a warning, denied by `{option}`"))))
    }
}

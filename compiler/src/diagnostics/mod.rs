//! What the compiler reports: errors and warnings with exact places, what was expected and found, and fixes.
//!
//! 1. Every stage makes [`Diagnostic`]s; none stops at the first.
//! 2. A [`Report`] holds those of all files, sorted, beside the [`SourceMap`] they point into.
//! 3. It is rendered as text with the source and carets, or as JSON with edits a machine can apply.
//!
//! The codes, with an explanation and an example for each, are one table: [`codes`].

pub mod allowance;
pub mod codes;
mod fix;
mod foreign;
mod json;
mod levels;
mod lint;
mod render;
mod reported;
mod source;
mod synonyms;
mod visible;

pub use codes::Code;
pub use fix::fixed;
pub use foreign::{function_elsewhere, is_module, name_elsewhere};
pub use levels::{Levels, Lints};
pub use lint::{Level, Lint, Stage, find_lint, lints};
pub use msk_program::nearest::nearest;
pub use msk_program::source::{Allowance, Scope};
pub use render::Style;
pub(crate) use reported::Failures;
pub use reported::{Checked, Reported};
pub use source::{FileId, SourceMap, Span};
pub use synonyms::synonyms;

use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use visible::visible;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Nothing is compiled.
    Error,
    /// Compiled, but probably not what was meant.
    Warning,
}

/// A span of a file with its label.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// Which file.
    pub file: FileId,
    /// Which bytes of it.
    pub span: Span,
    /// A few words beside the carets; may be empty.
    pub text: String,
}

/// Replaces bytes of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edit {
    /// Which file.
    pub file: FileId,
    /// Which bytes of it; empty to insert.
    pub span: Span,
    /// By what.
    pub replacement: String,
}

/// A change that resolves a diagnostic.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fix {
    /// What it does, as an order: "write `1 m^-2`".
    pub title: String,
    /// All of them together, or none.
    pub edits: Vec<Edit>,
    /// Whether it surely is what was meant, so that it may be applied unasked.
    pub automatic: bool,
}

/// One error or warning.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// Its stable code.
    pub code: &'static Code,
    /// How bad it is.
    pub severity: Severity,
    /// One sentence without a full stop, names in backquotes.
    pub message: String,
    /// The first is where it is; the others explain.
    pub labels: Vec<Label>,
    /// What would have been right, to be set above `found`.
    pub expected: Option<String>,
    /// What is there.
    pub found: Option<String>,
    /// What to do, one sentence each.
    pub help: Vec<String>,
    /// Changes that resolve it, the likeliest first.
    pub fixes: Vec<Fix>,
    /// The option that made an error of a warning: `--deny warnings`.
    pub denied_by: Option<String>,
}

impl Diagnostic {
    /// A diagnostic at one place; codes that begin with `W` are warnings.
    pub fn new(code: &'static Code, file: FileId, span: Span, message: impl Into<String>) -> Self {
        let severity = if code.id.starts_with('W') { Severity::Warning } else { Severity::Error };
        let place = Label { file, span, text: String::new() };
        Self {
            code,
            severity,
            message: message.into(),
            labels: vec![place],
            expected: None,
            found: None,
            help: Vec::new(),
            fixes: Vec::new(),
            denied_by: None,
        }
    }

    /// Puts words beside the carets of the main place.
    pub fn here(mut self, text: impl Into<String>) -> Self {
        if let Some(first) = self.labels.first_mut() {
            first.text = text.into();
        }
        self
    }

    /// Points at a further place.
    pub fn label(mut self, file: FileId, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { file, span, text: text.into() });
        self
    }

    /// Adds what was expected.
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// Adds what was found.
    pub fn found(mut self, found: impl Into<String>) -> Self {
        self.found = Some(found.into());
        self
    }

    /// Adds a sentence of help.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }

    /// Offers to replace `span` of the main file: a change that surely is what was meant.
    pub fn fix(self, title: impl Into<String>, span: Span, replacement: impl Into<String>) -> Self {
        let place = (self.file(), span);
        self.offer(title, place, replacement, true)
    }

    /// Offers a change that may be what was meant, such as the nearest name.
    pub fn suggest(self, title: impl Into<String>, span: Span, replacement: impl Into<String>) -> Self {
        let place = (self.file(), span);
        self.offer(title, place, replacement, false)
    }

    /// Offers to replace a place of another file than the main one.
    pub fn suggest_at(self, title: impl Into<String>, place: (FileId, Span), replacement: impl Into<String>) -> Self {
        self.offer(title, place, replacement, false)
    }

    fn offer(
        mut self,
        title: impl Into<String>,
        (file, span): (FileId, Span),
        replacement: impl Into<String>,
        automatic: bool,
    ) -> Self {
        let edit = Edit { file, span, replacement: replacement.into() };
        self.fixes.push(Fix { title: title.into(), edits: vec![edit], automatic });
        self
    }

    /// Makes characters visible that would hide in its texts or reorder them, wherever these are shown. Places and replacements are
    /// those of the file.
    fn show(&mut self) {
        let texts = [&mut self.message].into_iter().chain(self.labels.iter_mut().map(|label| &mut label.text));
        let texts = texts.chain(&mut self.expected).chain(&mut self.found).chain(&mut self.help);
        for text in texts.chain(self.fixes.iter_mut().map(|fix| &mut fix.title)) {
            if let Cow::Owned(shown) = visible(text) {
                *text = shown;
            }
        }
    }

    /// The file of the main place.
    pub fn file(&self) -> FileId {
        self.labels.first().map_or(FileId::default(), |label| label.file)
    }

    /// The main place.
    pub fn span(&self) -> Span {
        self.labels.first().map_or(Span::default(), |label| label.span)
    }
}

/// All diagnostics of all files, with the files.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// The files they point into.
    pub sources: SourceMap,
    /// Sorted by file, place and code.
    pub diagnostics: Vec<Diagnostic>,
}

/// Most errors that are reported of one file, and most warnings.
pub const MAXIMUM_ERRORS: usize = 500;

impl Report {
    /// Sorts the diagnostics, drops repetitions, and leaves at most [`MAXIMUM_ERRORS`] errors and as many warnings of each file,
    /// with a last one that counts the others. Their texts hide nothing from then on.
    pub fn new(sources: SourceMap, mut diagnostics: Vec<Diagnostic>) -> Self {
        diagnostics.iter_mut().for_each(Diagnostic::show);
        diagnostics.sort_by(|a, b| {
            let key = |d: &Diagnostic| (d.file(), d.span().start, d.span().end, d.code.id);
            key(a).cmp(&key(b)).then_with(|| a.message.cmp(&b.message))
        });
        diagnostics.dedup();
        Self { sources, diagnostics: capped(diagnostics) }
    }

    /// Whether anything in it forbids to go on.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }
}

/// The first errors and the first warnings of each file, with the number of the others in place of those.
fn capped(diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut counts: BTreeMap<(FileId, Severity), usize> = BTreeMap::new();
    let mut kept: Vec<Diagnostic> = Vec::with_capacity(diagnostics.len());
    let mut closing: BTreeMap<(FileId, Severity), usize> = BTreeMap::new();
    for diagnostic in diagnostics {
        // What was left out before is counted already.
        if [codes::syntax::MORE_ERRORS, codes::lints::MORE_WARNINGS].contains(&diagnostic.code) {
            kept.push(diagnostic);
            continue;
        }
        let of = (diagnostic.file(), diagnostic.severity);
        let count = counts.entry(of).or_default();
        *count += 1;
        if *count <= MAXIMUM_ERRORS {
            kept.push(diagnostic);
        } else if *count == MAXIMUM_ERRORS + 1 {
            closing.insert(of, kept.len());
            let code = match diagnostic.severity {
                Severity::Error => codes::syntax::MORE_ERRORS,
                Severity::Warning => codes::lints::MORE_WARNINGS,
            };
            kept.push(Diagnostic::new(code, diagnostic.file(), diagnostic.span(), ""));
        }
    }
    for (of, place) in closing {
        let more = counts.get(&of).map_or(0, |count| count - MAXIMUM_ERRORS);
        let (plural, word) = (if more == 1 { "" } else { "s" }, if of.1 == Severity::Error { "error" } else { "warning" });
        kept[place].message = format!("and {more} more {word}{plural} in this file: at most {MAXIMUM_ERRORS} are shown");
    }
    kept
}

//! What the targets of the language share: which text bytes stand for, a body without physics, files in memory, and what must
//! hold of every answer.

#![allow(dead_code, reason = "each target needs its own part")]

#[path = "../../compiler/tests/support/generate.rs"]
pub mod generate;

use msk_compiler::body::BodyDescription;
use msk_compiler::diagnostics::{Diagnostic, Report, SourceMap, Span, Style};
use msk_compiler::files::{BodySource, LoadError, Loader};
use msk_compiler::vocabulary::{GroupKind, Vocabulary};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The path under which a text is compiled.
pub const ENTRY: &str = "example.msk";

/// The text that bytes stand for: their own, or behind a zero byte a program grown from the rest.
pub fn text(bytes: &[u8]) -> Option<String> {
    match bytes.split_first() {
        Some((0, seed)) => Some(generate::program(seed)),
        _ => std::str::from_utf8(bytes).ok().map(str::to_owned),
    }
}

/// One text, and the library of the project beside it.
pub struct Texts<'a>(pub &'a str);

impl Loader for Texts<'_> {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        match path.to_str() {
            Some(ENTRY) => Ok(self.0.to_owned()),
            Some("lib/posture.msk") => Ok(include_str!("../../tasks/lib/posture.msk").to_owned()),
            _ => Err(LoadError::Missing(path.to_path_buf())),
        }
    }
}

/// The human body with a few of its muscles, its file as short as it can be: texts are what is looked at.
pub struct Human;

impl BodySource for Human {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        let text = "body human {\n    model \"human.xml\"\n    root pelvis { forward x, up z }\n}\n";
        (name == "human").then(|| (PathBuf::from("bodies/human.msk"), text.to_owned()))
    }

    fn vocabulary(&self, _: &BodyDescription) -> Result<Vocabulary, String> {
        Ok(vocabulary().clone())
    }
}

/// What exists on that body.
pub fn vocabulary() -> &'static Vocabulary {
    static HUMAN: OnceLock<Vocabulary> = OnceLock::new();
    HUMAN.get_or_init(few_muscles)
}

fn few_muscles() -> Vocabulary {
    let text = include_str!("../../compiler/tests/fixtures/human_vocabulary.json");
    let mut whole: Vocabulary = serde_json::from_str(text).expect("the fixture of the compiler's tests");
    let (known, rest): (Vec<_>, Vec<_>) = whole.muscles.into_iter().partition(|muscle| muscle.name.starts_with("soleus"));
    whole.muscles = known.into_iter().chain(rest).take(12).collect();
    let (muscles, joints) = (whole.muscles.len(), whole.joints.len());
    for group in &mut whole.groups {
        let most = if group.kind == GroupKind::Muscles { muscles } else { joints.max(whole.landmarks.len()) };
        group.members.retain(|member| *member < most);
    }
    whole.groups.retain(|group| !group.members.is_empty());
    whole
}

/// What must hold of every diagnostic: places lie within their texts, and every way of printing it works.
pub fn must_be_sound(report: &Report) {
    let within = |sources: &SourceMap, file, span: Span| span.start <= span.end && sources.text(file).get(span.range()).is_some();
    for diagnostic in &report.diagnostics {
        let Diagnostic { labels, fixes, message, .. } = diagnostic;
        assert!(!labels.is_empty() && !message.is_empty(), "{diagnostic:?}");
        assert!(labels.iter().all(|label| within(&report.sources, label.file, label.span)), "{diagnostic:?}");
        let mut edits = fixes.iter().flat_map(|fix| &fix.edits);
        assert!(edits.all(|edit| within(&report.sources, edit.file, edit.span)), "{diagnostic:?}");
    }
    assert!(report.render(Style::Coloured).is_empty() == report.diagnostics.is_empty());
    let _ = report.to_json().to_string();
    for file in report.sources.files() {
        let (mended, count) = report.fixed(file);
        assert!(count > 0 || mended == report.sources.text(file));
    }
}

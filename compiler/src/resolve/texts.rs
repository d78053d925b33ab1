//! What names are made of where a text gives none: the formula itself.

use crate::diagnostics::{FileId, Span};
use crate::syntax::tree::{Channel, Docs, Expr};

/// The text that a label is made of.
pub(crate) trait Texts {
    /// The text of a span of a file.
    fn text(&self, file: FileId, span: Span) -> &str;
}

/// The label before `=`, else the formula itself, blanks made even.
pub(crate) fn label_of(channel: &Channel, file: FileId, texts: &dyn Texts) -> String {
    match &channel.label {
        Some(label) => label.text.clone(),
        None => written(&channel.value, file, texts),
    }
}

/// A formula as written, blanks made even.
pub(crate) fn written(expr: &Expr, file: FileId, texts: &dyn Texts) -> String {
    texts.text(file, expr.span).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The first sentence group of a documentation comment.
pub(crate) fn summary(docs: Option<&Docs>) -> String {
    let text = docs.map_or("", |docs| docs.text.as_str());
    let paragraph: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    paragraph.join(" ")
}

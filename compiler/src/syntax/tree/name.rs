//! Words, quoted texts and names with brace patterns.

use crate::diagnostics::Span;

/// A plain word.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ident {
    /// The word.
    pub text: String,
    /// Where it stands.
    pub span: Span,
}

/// A text in double quotes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Text {
    /// Without the quotes.
    pub value: String,
    /// With the quotes.
    pub span: Span,
}

/// A name that may hold brace patterns: `pelvis`, `ankle_{l,r}`, `pole_{0..9}`, `pole_{*}`, `pole_{i}`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// As written.
    pub text: String,
    /// The parts in order; a plain name is one `Literal`.
    pub parts: Vec<NamePart>,
    /// Where it stands.
    pub span: Span,
}

/// A part of a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NamePart {
    /// Ordinary characters.
    Literal(String),
    /// `{l,r}`: two or more words.
    Words(Vec<String>),
    /// `{0..9}`: whole numbers, the upper one excluded.
    Range(u32, u32),
    /// `{*}`: whatever exists.
    Any,
    /// `{i}`: the present value of a loop variable.
    Variable(String),
}

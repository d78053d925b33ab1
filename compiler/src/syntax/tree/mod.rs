//! The syntax tree: the content of a file in its order.
//!
//! Every node carries the [`Span`] of the source it came from, in bytes, so that errors point at exact text and edits change
//! nothing else. Names keep their brace patterns, numbers keep their unit expressions, brackets are nodes of their own.
//! Nothing here knows what exists or what is allowed where a word is free: that is the checker's work.

mod body;
mod expression;
mod name;
mod scene;
mod task;
mod test;
pub mod walk;

pub use body::*;
pub use expression::*;
pub use name::*;
pub use scene::*;
pub use task::*;
pub use test::*;

use crate::diagnostics::{FileId, Span};

/// One parsed file.
#[derive(Debug, Clone, PartialEq)]
pub struct File {
    /// Which file.
    pub file: FileId,
    /// The `//!` lines at the top, joined.
    pub docs: Option<Docs>,
    /// Declarations, in the order of the text.
    pub items: Vec<Item>,
}

/// A declaration at the top level of a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// `use "lib/posture.msk"`
    Use(Use),
    /// `task stand { ... }`
    Task(Task),
    /// `sequence carry_and_sit { ... }`
    Sequence(Sequence),
    /// `suite msk_bench { ... }`
    Suite(Suite),
    /// `body human { ... }`
    Body(Body),
    /// `observation proprioception { ... }`
    Observation(Observation),
    /// `const reach = 0.4 m`
    Const(Binding),
    /// `fn bell(x, width) = exp(-(x / width)^2)`
    Function(Function),
}

/// Documentation comments (`///` or `//!`), their marks removed, lines joined by newlines.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Docs {
    /// The text.
    pub text: String,
    /// From the first mark to the end of the last line.
    pub span: Span,
}

/// A comment, kept beside the tree: comments never are nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Comment {
    /// From its slashes to the end of its line, the newline excluded.
    pub span: Span,
    /// Which of the three.
    pub kind: CommentKind,
    /// Whether nothing but blanks stands before it on its line.
    pub own_line: bool,
}

/// The three kinds of comment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CommentKind {
    /// `// ...`
    Plain,
    /// `/// ...`: documents the declaration below.
    Doc,
    /// `//! ...`: documents the file.
    FileDoc,
}

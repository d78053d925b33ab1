//! From syntax trees to typed graphs.
//!
//! 1. `scope`: which names are in sight of a task;
//! 2. `body`: a body file becomes a plain description, which the runtime binds to a model and answers with a vocabulary;
//! 3. `scene`: what surrounds the body, whose objects join the vocabulary;
//! 4. `task`: the statements of a task, each checked by a file of its own: `init`, `observe`, `reward`, `ends`;
//! 5. `expression`: formulas become nodes of the graph, with dimension, frame and length checked at every operator;
//!    names are resolved by `lookup` and `member`, calls by `call` and `functions`, motions by `reference`;
//! 6. `lints`: what is allowed but probably not meant, from the bounds of every term.
//!
//! Every error is reported where it is, none stops the rest.

mod advice;
pub(crate) mod allows;
mod arithmetic;
pub(crate) mod body;
mod call;
mod constant;
mod context;
pub(crate) mod edits;
mod ends;
mod expression;
pub mod functions;
pub(crate) mod inherit;
mod init;
mod layers;
mod lints;
mod lookup;
mod meeting;
mod member;
pub(crate) mod observe;
mod offered;
mod parameters;
mod random;
mod ranges;
pub(crate) mod reference;
mod reward;
pub mod scene;
pub(crate) mod scope;
pub(crate) mod suite;
pub(crate) mod task;
mod tests;
pub(crate) mod uncalled;

pub(crate) use crate::hir::{types, value};
pub(crate) use crate::quantity::{dimension, unit};
pub(crate) use crate::signals;
pub(crate) use context::{Compared, Timing};
pub use lints::DEAD;
pub(crate) use lints::gated;
pub(crate) use observe::{Texts, written};
pub(crate) use ranges::Working;
pub(crate) use tests::CheckedTests;

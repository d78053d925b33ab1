//! Type checking: from resolved tasks to the typed HIR and the graph.
//!
//! 1. `body`: a body file becomes a plain description, which the runtime binds to a model and answers with a vocabulary;
//! 2. `scene`: what surrounds the body, whose objects join the vocabulary;
//! 3. `task`: the statements of a task, each checked by a file of its own: `init`, `observe`, `reward`, `ends`;
//! 4. `expression`: formulas become nodes of the graph, with dimension, frame and length checked at every operator;
//!    names are resolved by `lookup` and `member`, calls by `call` and `functions`, motions by `reference`;
//! 5. `warn`: what is allowed but probably not meant in single formulas; `lint` looks at whole tasks.
//!
//! Every error is reported where it is, none stops the rest.

pub mod action;
mod advice;
pub(crate) mod allows;
mod arithmetic;
pub(crate) mod body;
mod call;
pub(crate) mod context;
pub(crate) mod edits;
mod ends;
mod expression;
pub mod functions;
mod init;
mod lookup;
mod meeting;
mod member;
pub(crate) mod observe;
mod offered;
mod parameters;
mod random;
pub(crate) mod ranges;
pub(crate) mod reference;
pub(crate) mod reward;
pub mod scene;
mod states;
pub(crate) mod suite;
pub(crate) mod task;
mod tests;
pub(crate) mod uncalled;
mod warn;

pub(crate) use crate::hir::{types, value};
pub(crate) use crate::quantity::{dimension, unit};
pub(crate) use crate::signals;
pub(crate) use context::Timing;
pub(crate) use ranges::OperatingRange;
pub(crate) use tests::CheckedTests;

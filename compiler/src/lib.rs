//! Compiler of the `.msk` language: text -> syntax tree -> resolved and typed tree -> dataflow graph -> program.
//!
//! [`compile`](compile::compile) is the entry; [`explain`] tells what was understood; [`task::CompiledTask`] is what runs.

// Results agree between machines to the bit: see `clippy.toml` here.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod beginning;
pub mod body;
pub mod check;
pub mod compile;
pub mod diagnostics;
pub mod difference;
pub mod digest;
mod evaluation;
pub mod explain;
pub mod extremes;
pub mod files;
pub mod format;
pub mod frame;
pub mod graph;
pub mod hir;
pub mod lint;
mod lower;
pub mod motion;
pub mod mutation;
mod notation;
pub mod numbers;
pub mod quantity;
mod resolve;
pub mod scene;
pub mod signals;
pub mod snapshot;
pub mod spoken;
pub mod survey;
pub mod syntax;
pub mod task;
pub mod testing;
pub mod vocabulary;
pub mod weights;
mod work;

pub use compile::{Compilation, Inspection, Protocol, Suite, compile, compile_with, inspect};
pub use evaluation::{Draws, Middle};
#[cfg(feature = "interpreter")]
pub use lower::{PlainTask, Snapshot};

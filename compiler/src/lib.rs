//! Compiler of the `.msk` language: text -> syntax tree -> resolved and typed tree -> dataflow graph -> program ([`msk_program`]).
//!
//! [`compile`](compile::compile) is the entry; [`explain`] tells what was understood; [`task::CompiledTask`] is what runs.

// Results agree between machines to the bit: see `clippy.toml` here.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod check;
pub mod compile;
pub mod diagnostics;
pub mod difference;
mod emit;
pub mod explain;
pub mod format;
pub mod hir;
mod link;
pub mod lint;
pub mod motion;
pub mod mutation;
mod notation;
pub mod quantity;
pub mod resolve;
pub mod signals;
pub mod spoken;
pub mod survey;
pub mod syntax;
pub mod weights;

pub use msk_program::{
    action, body, digest, extremes, files, frame, graph, init, numbers, scene, script, snapshot, task, testing, vocabulary,
};

use msk_program::work;

pub use compile::{Compilation, Inspection, Protocol, Suite, compile, compile_with, inspect};
pub use msk_program::evaluation::{Draws, Middle};
#[cfg(feature = "interpreter")]
pub use msk_program::plain::{PlainTask, Snapshot};

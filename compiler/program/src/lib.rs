//! What a compiled task is: plain data, without the language it was written in and without physics.
//!
//! The compiler makes a [`task::CompiledTask`], the runtime steps it, the evaluator reports it; none of them needs another for that.
//!
//! * What a task may name: [`vocabulary`], [`body`], [`scene`]; what it reads of the physics: [`frame`]; what a
//!   policy's action asks for: [`action`].
//! * What is computed: [`graph`], one dataflow graph per phase; `lower` makes closures over flat records of it, which
//!   [`evaluation`] runs once per control step.
//! * How an episode begins: [`init`], with [`motion`] where a motion is followed; [`testing`] and [`script`]: what its tests show.
//! * What it means: [`snapshot`], canonical text and content hash; [`debug`], what explanations print.
//! * [`weights`] laid over it; [`sweep`], the perturbations under which a suite has it evaluated.
//! * What these share: [`quantity`], [`spoken`], [`numbers`], [`nearest`](mod@nearest), [`source`].

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod action;
pub mod body;
pub mod debug;
pub mod digest;
pub mod evaluation;
pub mod extremes;
pub mod files;
pub mod formula;
pub mod frame;
pub mod graph;
pub mod init;
pub mod lower;
pub mod motion;
pub mod nearest;
#[cfg(feature = "interpreter")]
pub mod plain;
pub mod quantity;
pub mod scene;
pub mod schedule;
pub mod script;
pub mod snapshot;
pub mod source;
pub mod spoken;
pub mod sweep;
pub mod task;
pub mod testing;
pub mod vocabulary;
pub mod weights;
#[doc(hidden)]
pub mod work;

pub use msk_text::numbers;

//! MSK: a declarative, statically typed language for full-body motor-control tasks, with its muscle simulator and evaluator.
//!
//! This facade re-exports the two crates a user meets: the [`compiler`] (text to compiled tasks) and the [`runtime`]
//! (bodies, physics, episodes, evaluation).

pub use msk_compiler as compiler;
pub use msk_runtime as runtime;

#[cfg(feature = "insta")]
pub mod testing;

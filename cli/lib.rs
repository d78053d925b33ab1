//! MSK: a declarative, statically typed language for full-body motor-control tasks, with its muscle simulator and evaluator.
//!
//! This facade re-exports the crates a user meets: the [`compiler`] (text to compiled tasks), the [`physics`] (models, steps),
//! the [`runtime`] (bodies, episodes, policies), [`evaluate`] (evaluations, tests of tasks), [`export`] (tasks over MuJoCo), [`draw`]
//! (pictures), [`view`] (episodes as pages), [`train`] (agents that learn) and [`tuning`] (weights that change while tasks run).

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub use msk_compiler as compiler;
pub use msk_draw as draw;
pub use msk_evaluate as evaluate;
pub use msk_export as export;
pub use msk_physics as physics;
pub use msk_plan as plan;
pub use msk_runtime as runtime;
pub use msk_train as train;
pub use msk_tuning as tuning;
pub use msk_view as view;

#[cfg(feature = "insta")]
pub mod testing;

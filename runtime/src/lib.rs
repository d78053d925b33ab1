//! Bodies, physics, episodes and evaluation.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod bench;
pub mod bodies;
pub mod body;
pub mod condition;
pub mod episode;
pub mod evaluate;
pub mod files;
pub mod inspect;
pub mod library;
pub mod policy;
pub mod probe;
pub mod process_group;
pub mod scene;
pub mod testing;

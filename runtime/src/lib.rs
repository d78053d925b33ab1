//! Bodies in their scenes, episodes of compiled tasks, and policies.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod action;
pub mod bench;
pub mod bodies;
pub mod body;
mod cmc;
pub mod condition;
pub mod episode;
pub mod files;
pub mod inspect;
pub mod library;
pub mod policy;
pub mod process_group;
pub mod scene;
pub mod script;

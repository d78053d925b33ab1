//! Bodies in their scenes, episodes of compiled tasks, and policies.
//!
//! Without the feature `system` nothing here touches files, programs or clocks: texts come through a
//! [`Loader`](msk_program::files::Loader), models through [`ModelFiles`](msk_physics::model::ModelFiles), as in a browser.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod action;
#[cfg(feature = "system")]
pub mod bench;
pub mod bodies;
pub mod body;
mod cmc;
pub mod condition;
pub mod episode;
pub mod files;
pub mod inspect;
pub mod library;
pub mod perturbation;
pub mod policy;
#[cfg(feature = "system")]
pub mod process_group;
pub mod reference;
pub mod scene;
pub mod script;

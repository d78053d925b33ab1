//! Bodies, physics, episodes and evaluation.

pub mod bench;
pub mod bodies;
pub mod body;
pub mod condition;
pub mod draw;
pub mod episode;
pub mod evaluate;
pub mod files;
pub mod inspect;
pub mod library;
pub mod model;
pub mod physics;
pub mod policy;
pub mod probe;
pub mod scalar;
pub mod scene;
pub mod testing;

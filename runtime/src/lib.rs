//! Bodies, physics, episodes and evaluation.

pub mod bench;
pub mod bodies;
pub mod body;
pub mod draw;
pub mod inspect;
pub mod model;
pub mod physics;
pub mod scalar;

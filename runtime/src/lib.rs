//! Bodies, physics, episodes and evaluation.

pub mod body;
pub mod draw;
pub mod model;
pub mod physics;
pub mod scalar;

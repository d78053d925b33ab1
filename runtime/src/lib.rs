//! Bodies, physics, episodes and evaluation.

pub mod model;
pub mod physics;
pub mod scalar;

//! Physical quantities: dimensions, and the units in which they are written.

pub mod dimension;
pub mod unit;

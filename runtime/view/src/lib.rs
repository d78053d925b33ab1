//! An episode as one HTML page that works without a network, and as pictures without a browser ([`render`]).
//!
//! 1. [`Recorder`] looks at an episode after its reset and after every control step;
//! 2. `anatomy` describes the model once: bodies, joints, shapes, muscles with their paths;
//! 3. `track` turns what changes over time into few bytes: multiples of a quantum, differences, byte planes;
//! 4. [`page()`] compresses recordings and puts them into a page beside the program that shows them (`page/*.js`).
//!
//! Poses are stored as joint coordinates, finer than 0.1 mm at the end of a limb; the page repeats the kinematics of the tree.
//! Points of muscles that are fixed to bodies are constant; where a path touches a wrapping surface is stored, so that the page
//! needs no physics. The same episode gives the same bytes.

#![allow(clippy::disallowed_methods, reason = "no result is computed from a picture")]

mod anatomy;
mod contacts;
mod muscles;
mod page;
mod recorder;
mod recording;
pub mod render;
mod shapes;
mod signals;
mod task;
mod track;
mod wraps;

pub use page::page;
pub use recorder::Recorder;
pub use recording::{Caption, Recording, RecordingError};

#[cfg(test)]
mod tests;

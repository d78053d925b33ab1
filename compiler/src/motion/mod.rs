//! Motions as texts of comma-separated values.
//!
//! 1. [`read`] takes a text apart and reports every error in it, with its place;
//! 2. [`problems`] compares its columns with what exists on a body.
//!
//! What is read is a [`Motion`], data of the compiled task. Reference motions of tasks, scripted motions of tests and the drawings of
//! motions all read it here.

mod fit;
mod read;

pub use fit::problems;
pub use msk_program::motion::{Column, Motion, RootPart, Table, Target};
pub use read::read;
pub(crate) use read::read_into;

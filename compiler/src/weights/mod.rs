//! Weights as data: read from a text, changed in it digit by digit, and kept within what their author allows.
//!
//! 1. [`Weights::of`] lists the weights of a text with their bounds and where their digits stand;
//! 2. [`Weights::edit`] checks a set of changes as one: all are made, or none;
//! 3. [`CompiledTask::reweighted`](crate::task::CompiledTask::reweighted) lays other weights over a compiled task;
//! 4. [`rules`] bounds how far one change may go, and projects proposals onto a fixed sum of sizes.
//!
//! An edit of the source replaces the digits of the weights concerned; every other byte stays.

mod source;

pub use msk_program::weights::*;
pub use source::{Edit, Entry, Weights};

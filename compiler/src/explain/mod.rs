//! What the compiler understood, told back: to people as text, to reviews as a snapshot.

mod formula;
mod snapshot;
mod text;

pub(crate) use formula::{mathematics, names_in};
pub(crate) use text::short;
pub use text::{Options, text};

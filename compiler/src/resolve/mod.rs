//! Name resolution: which declarations a formula sees, and what a task takes from those that it extends.
//!
//! 1. `inherit` follows `extends` and lays statements over each other row by row (`layers`);
//! 2. `scope` holds the declarations of all files and of one task, and finds what a name is declared to be at a place;
//! 3. [`index`] resolves the names of all files, for editors.

pub mod index;
pub(crate) mod inherit;
pub(crate) mod layers;
pub(crate) mod scope;
mod texts;

pub(crate) use texts::{Texts, label_of, summary, written};

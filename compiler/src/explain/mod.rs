//! What the compiler understood, told back.
//!
//! An [`Account`] holds all of it as plain data, which is also what tools get as JSON; text for terminals, tables for papers
//! ([`latex`]) and pages for browsers ([`html`]) are written from it. Formulas come from one tree of mathematics
//! (`notation`), which is written in plain characters, as LaTeX and as MathML.

mod account;
mod gather;
mod html;
mod latex;
mod text;

pub use account::*;
pub use gather::{Options, account};
pub use html::html;
pub use latex::latex;
pub use text::text;

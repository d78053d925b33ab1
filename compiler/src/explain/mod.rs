//! Reports what the compiler understood of a task.
//!
//! A [`TaskReport`] contains all of it as plain data, which is also what tools get as JSON; text for terminals, tables for papers
//! ([`latex`]) and pages for browsers ([`html`]) are written from it. Formulas come from one tree of mathematics
//! (`notation`), which is written in plain characters, as LaTeX and as MathML.

mod action;
mod gather;
mod html;
mod latex;
mod report;
mod text;

pub use action::ActionReport;
pub use gather::{Options, task_report};
pub use html::html;
pub use latex::latex;
pub use report::*;
pub use text::text;

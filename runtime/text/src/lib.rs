//! Numbers and texts as their readers see them.
//!
//! * [`numbers`]: as few digits as a reader needs, or as many as bring every bit back; never a row of three hundred zeros.
//! * [`printable`], [`in_one_line`]: texts of other people's files, which must neither steer a terminal nor pass for other text.
//!
//! ```
//! use msk_text::{in_one_line, numbers, printable};
//!
//! assert_eq!(numbers::for_people(2.0e300), "2e300");
//! assert_eq!(printable("\u{1b}[2J"), r"\u001b[2J");
//! assert_eq!(in_one_line("a\nb"), r"a\nb");
//! ```

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod numbers;
mod printable;

pub use printable::{in_one_line, is_invisible, printable};

//! All tests of this crate as one program, which is linked once; each file is a module.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod exploits;
mod lanes;
mod probing;

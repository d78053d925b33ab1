//! All tests of this crate as one program, which is linked once; each file is a module.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod agreement;
mod caps;
mod codes;
mod corpus;
mod differences;
mod dropped;
mod editors;
mod explaining;
mod format;
mod generated;
mod hostile;
mod hostile_scenes;
mod language;
mod meaning;
mod modules;
mod motions;
mod mutation;
mod reference;
mod rendering;
mod robustness;
mod running;
mod scenes;
mod statements;
mod support;
mod trees;
mod weights;

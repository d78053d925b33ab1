//! The `msk` command line.

fn main() {}

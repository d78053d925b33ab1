//! The program from end to end, through its binary: what users type, what they get, and how it fails.

mod bad_input;
mod check;
mod collect;
mod diff;
mod empty;
mod eval;
mod exit_codes;
mod explain;
mod exploit;
mod fmt;
mod help;
mod interrupt;
mod mcp;
mod merge;
mod motion;
mod mutate;
mod new;
mod numbers;
#[cfg(unix)]
mod pictures;
mod policies;
mod project;
mod report;
mod run;
mod sensitivity;
mod session;
mod special_files;
mod terminal;
mod test;
mod trace;
mod train;
mod tune;
mod view;
mod weights;

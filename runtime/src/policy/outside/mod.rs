//! Policies from outside: a program that answers line by line, and recorded actions.

mod lines;
mod message;
mod process;
mod replay;

pub(super) use process::Process;
pub(super) use replay::Replay;

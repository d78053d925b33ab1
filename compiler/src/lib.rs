//! Compiler of the `.msk` language: text -> syntax tree -> resolved and typed tree -> dataflow graph -> closures.

pub mod body;
pub mod diagnostics;
pub mod files;
pub mod frame;
pub mod syntax;
pub mod task;
pub mod vocabulary;

//! Threads in processes that may be forked.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::thread::available_parallelism;

/// The process in which threads were started: a forked child has none of them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Process(u32);

impl Process {
    /// This one.
    pub fn present() -> Self {
        Self(std::process::id())
    }

    /// Whether this is a child of the process that started the threads. Notes this process in its place.
    pub fn has_changed(&mut self) -> bool {
        std::mem::replace(self, Self::present()) != Self::present()
    }
}

/// As many threads as were asked for; by default one per processor that this process may use.
pub fn threads(asked: Option<NonZeroUsize>) -> NonZeroUsize {
    asked.or_else(|| available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN)
}

/// The operating system gives no threads.
pub fn no_threads(error: &rayon::ThreadPoolBuildError) -> PyErr {
    PyRuntimeError::new_err(format!("cannot start threads: {error}; ask for fewer with `threads=`"))
}

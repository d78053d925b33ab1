//! Threads in processes that may be forked.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::available_parallelism;

/// The process in which threads were started: a forked child has none of them.
pub struct Process(AtomicU32);

impl Process {
    /// This one.
    pub fn present() -> Self {
        Self(AtomicU32::new(std::process::id()))
    }

    /// Whether it is this one, and no parent of it.
    pub fn is_present(&self) -> bool {
        self.0.load(Ordering::Relaxed) == std::process::id()
    }

    /// Whether this is a child of the process that started the threads. Notes this process in its place.
    pub fn has_changed(&self) -> bool {
        self.0.swap(std::process::id(), Ordering::Relaxed) != std::process::id()
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

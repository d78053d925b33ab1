//! The way out of Python and back: without the interpreter's lock, and without panics.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

pyo3::import_exception!(msk.errors, InternalError);

/// How often signals are looked at.
const SIGNALS: Duration = Duration::from_millis(20);

/// Runs `work` while other Python threads go on.
///
/// # Errors
/// `msk.InternalError` if it panics: a defect of msk, never of its user.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).map_err(|panic| internal(&*panic))
}

/// Runs `work` on a thread of its own while other Python threads go on and signals are handled: one that raises, such as Ctrl-C, asks the
/// work to stop, and is raised when it has.
///
/// # Errors
/// What a signal raised, and those of [`detached`].
pub fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let worker = scope.spawn(|| work(&stop));
        let mut raised = None;
        while !worker.is_finished() {
            py.detach(|| thread::sleep(SIGNALS));
            if let Err(error) = py.check_signals() {
                stop.store(true, Ordering::Relaxed);
                raised.get_or_insert(error);
            }
        }
        let result = worker.join().map_err(|panic| internal(&*panic))?;
        raised.map_or(Ok(result), Err)
    })
}

fn internal(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    InternalError::new_err(format!(
        "a defect of msk, not of your program: {}; please report it with what led to it",
        text.unwrap_or("a panic without a message")
    ))
}

/// A value that a panic may have left half changed: it is not used again.
pub struct Guarded<T>(Option<T>);

impl<T: Send> Guarded<T> {
    pub fn new(value: T) -> Self {
        Self(Some(value))
    }

    /// Changes the value while other Python threads go on.
    ///
    /// # Errors
    /// A panic, now or before.
    pub fn change<R: Send>(&mut self, py: Python<'_>, work: impl FnOnce(&mut T) -> R + Send) -> PyResult<R> {
        let mut value = self.0.take().ok_or_else(spoiled)?;
        // A panic drops the value with the closure.
        let (value, result) = detached(py, move || {
            let result = work(&mut value);
            (value, result)
        })?;
        self.0 = Some(value);
        Ok(result)
    }

    /// Reads the value.
    ///
    /// # Errors
    /// A panic before.
    pub fn get(&self) -> PyResult<&T> {
        self.0.as_ref().ok_or_else(spoiled)
    }

    /// The value itself, for changes that cannot panic.
    ///
    /// # Errors
    /// A panic before.
    pub fn get_mut(&mut self) -> PyResult<&mut T> {
        self.0.as_mut().ok_or_else(spoiled)
    }
}

fn spoiled() -> PyErr {
    PyRuntimeError::new_err("an internal error has ended this environment: make a new one")
}

/// Panics: for the tests, which want to see that no panic reaches Python. Releases do not have it.
#[cfg(debug_assertions)]
#[pyfunction]
#[allow(clippy::panic)]
pub fn provoke_panic(py: Python<'_>) -> PyResult<()> {
    detached(py, || panic!("provoked"))
}

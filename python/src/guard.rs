//! The way out of Python and back: without the interpreter's lock, and without panics.

use crate::queue::Queue;
use crate::workers::Process;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::ops::{Deref, DerefMut};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Mutex, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard, TryLockError};
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

/// A value that one thread uses at a time, and that a panic may have left half changed: then it is not used again. It may be away for a
/// while, where a [`Queue`] changes it.
///
/// A thread that finds another one at it gets an error and never waits, so that no two can wait for each other: with the interpreter's lock
/// and without it.
pub struct Guarded<T>(RwLock<Place<T>>);

enum Place<T> {
    Here(T),
    /// Where the value comes back to, in the process that has sent it away.
    Away(Mutex<Receiver<thread::Result<T>>>, Process),
    Spoiled,
}

/// A value that is read.
pub struct Read<'a, T>(RwLockReadGuard<'a, Place<T>>);

/// A value that is changed.
pub struct Write<'a, T>(RwLockWriteGuard<'a, Place<T>>);

impl<T: Send + 'static> Guarded<T> {
    pub fn new(value: T) -> Self {
        Self(RwLock::new(Place::Here(value)))
    }

    /// Changes the value while other Python threads go on.
    ///
    /// # Errors
    /// A panic, now or before; a value that is away, or in use by another thread.
    pub fn change<R: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut T) -> R + Send) -> PyResult<R> {
        let mut place = self.locked()?;
        let mut value = take(&mut place)?;
        // A panic drops the value with the closure.
        let (value, result) = detached(py, move || {
            let result = work(&mut value);
            (value, result)
        })?;
        *place = Place::Here(value);
        Ok(result)
    }

    /// Changes the value in the background, after what was sent to the queue before. It is away until [`wait`](Self::wait).
    ///
    /// # Errors
    /// A panic before; a value that is away already, or in use by another thread; no thread.
    pub fn send(&self, queue: &Queue, work: impl FnOnce(&mut T) + Send + 'static) -> PyResult<()> {
        let mut place = self.locked()?;
        let mut value = take(&mut place)?;
        let (back, received) = sync_channel(1);
        *place = Place::Away(Mutex::new(received), Process::present());
        queue.send(Box::new(move || {
            let changed = catch_unwind(AssertUnwindSafe(move || {
                work(&mut value);
                value
            }));
            // Nobody waits where the environment was dropped meanwhile.
            drop(back.send(changed));
        }))
    }

    /// Waits for a value that is away, while other Python threads go on and signals are handled.
    ///
    /// # Errors
    /// A value that is not away, or for which another thread waits; a panic; what a signal raised: the value is away still.
    pub fn wait(&self, py: Python<'_>) -> PyResult<()> {
        let mut place = self.locked()?;
        let Place::Away(received, process) = &mut *place else {
            return Err(PyRuntimeError::new_err("no step is under way: call send() before recv()"));
        };
        if !process.is_present() {
            // It is not dropped: it would wait for what the thread may have held when the process was forked.
            std::mem::forget(std::mem::replace(&mut *place, Place::Spoiled));
            return Err(PyRuntimeError::new_err("the step was sent before this process was forked: make a new environment"));
        }
        let received = received.get_mut().unwrap_or_else(PoisonError::into_inner);
        let changed = loop {
            let received = &mut *received;
            match py.detach(move || received.recv_timeout(SIGNALS)) {
                Err(RecvTimeoutError::Timeout) => py.check_signals()?,
                Err(RecvTimeoutError::Disconnected) => break Err(spoiled()),
                Ok(changed) => break changed.map_err(|panic| internal(&*panic)),
            }
        };
        *place = Place::Spoiled;
        changed.map(|value| *place = Place::Here(value))
    }

    /// Reads the value.
    ///
    /// # Errors
    /// A panic before; a value that is away, or changed by another thread.
    pub fn get(&self) -> PyResult<Read<'_, T>> {
        let place = match self.0.try_read() {
            Ok(place) => place,
            Err(TryLockError::Poisoned(place)) => place.into_inner(),
            Err(TryLockError::WouldBlock) => return Err(in_use()),
        };
        match &*place {
            Place::Here(_) => Ok(Read(place)),
            Place::Away(..) => Err(away()),
            Place::Spoiled => Err(spoiled()),
        }
    }

    /// The value itself, for changes that cannot panic.
    ///
    /// # Errors
    /// A panic before; a value that is away, or in use by another thread.
    pub fn get_mut(&self) -> PyResult<Write<'_, T>> {
        let place = self.locked()?;
        match &*place {
            Place::Here(_) => Ok(Write(place)),
            Place::Away(..) => Err(away()),
            Place::Spoiled => Err(spoiled()),
        }
    }

    /// The place, for this thread alone. A panic of a thread that had it has left it as it was, or empty.
    fn locked(&self) -> PyResult<RwLockWriteGuard<'_, Place<T>>> {
        match self.0.try_write() {
            Ok(place) => Ok(place),
            Err(TryLockError::Poisoned(place)) => Ok(place.into_inner()),
            Err(TryLockError::WouldBlock) => Err(in_use()),
        }
    }
}

impl<T> Deref for Read<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        here(&self.0)
    }
}

impl<T> Deref for Write<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        here(&self.0)
    }
}

impl<T> DerefMut for Write<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        match &mut *self.0 {
            Place::Here(value) => value,
            // A `Write` is made of a value that is here, and keeps its place locked.
            Place::Away(..) | Place::Spoiled => unreachable!(),
        }
    }
}

fn here<T>(place: &Place<T>) -> &T {
    match place {
        Place::Here(value) => value,
        // A `Read` or `Write` is made of a value that is here, and keeps its place locked.
        Place::Away(..) | Place::Spoiled => unreachable!(),
    }
}

fn take<T>(place: &mut Place<T>) -> PyResult<T> {
    match std::mem::replace(place, Place::Spoiled) {
        Place::Here(value) => Ok(value),
        Place::Spoiled => Err(spoiled()),
        elsewhere @ Place::Away(..) => {
            *place = elsewhere;
            Err(away())
        }
    }
}

fn in_use() -> PyErr {
    PyRuntimeError::new_err("another thread is using this object: give each thread one of its own, or let them take turns")
}

fn away() -> PyErr {
    PyRuntimeError::new_err("a step is under way: call recv() first")
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

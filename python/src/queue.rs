//! Work that is done in the background, one thing after the other.

use crate::workers::Process;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;

type Job = Box<dyn FnOnce() + Send>;

/// A thread that does what it is sent, in that order. It never touches the interpreter, starts with the first job, and ends with the queue.
#[pyclass(module = "msk._native", frozen)]
#[derive(Default)]
pub struct Queue(Mutex<Option<(Sender<Job>, Process)>>);

#[pymethods]
impl Queue {
    #[new]
    fn new() -> Self {
        Self::default()
    }
}

impl Queue {
    /// Does `job` after those that were sent before it. In a process that was forked the thread starts anew.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn send(&self, job: Job) -> PyResult<()> {
        let mut thread = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (jobs, process) = match thread.take() {
            Some(known) if known.1.is_present() => known,
            // The other end is not dropped: it would wait for what the thread may have held when the process was forked.
            Some(forked) => {
                std::mem::forget(forked);
                start()?
            }
            None => start()?,
        };
        // The thread ends only when this sender is dropped.
        let sent = jobs.send(job).map_err(|_| PyRuntimeError::new_err("the thread of the queue has ended"));
        *thread = Some((jobs, process));
        sent
    }
}

fn start() -> PyResult<(Sender<Job>, Process)> {
    let (jobs, sent) = channel::<Job>();
    let named = thread::Builder::new().name("msk queue".to_owned());
    let started = named.spawn(move || sent.into_iter().for_each(|job| job()));
    started.map_err(|error| PyRuntimeError::new_err(format!("cannot start a thread: {error}")))?;
    Ok((jobs, Process::present()))
}

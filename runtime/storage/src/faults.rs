//! Faults for tests: system calls that fail when a test wants them to.

use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A system call that changes something on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Call {
    /// A folder is created.
    CreateFolder,
    /// A file is created, or opened for writing.
    Create,
    /// Bytes are written. When it fails, half of them have been.
    Write,
    /// A file is shortened.
    Truncate,
    /// Owner and mode of a file are set.
    SetOwner,
    /// Bytes of a file are forced to the disk.
    Sync,
    /// A file takes the place of another.
    Rename,
    /// A file is removed.
    Remove,
    /// The names of a folder are forced to the disk.
    SyncFolder,
}

/// Decides whether a call may proceed.
pub trait Faults: std::fmt::Debug + Send + Sync {
    /// Called before each [`Call`].
    ///
    /// # Errors
    /// The error that the call is to end with.
    fn before(&self, call: Call, path: &Path) -> io::Result<()>;
}

/// How a call fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// The disk is full (`ENOSPC`); later calls succeed.
    StorageFull,
    /// The device failed (`EIO`); later calls succeed.
    Device,
    /// The program died: this call and every later one fail.
    Crash,
}

/// Fails the k-th call, counted from 0. A test learns the number of calls from a run with [`FailAt::never`].
#[derive(Debug)]
pub struct FailAt {
    at: usize,
    failure: Failure,
    calls: AtomicUsize,
}

impl FailAt {
    /// Fails call `at`.
    pub fn new(at: usize, failure: Failure) -> Self {
        Self { at, failure, calls: AtomicUsize::new(0) }
    }

    /// Fails nothing and counts.
    pub fn never() -> Self {
        Self::new(usize::MAX, Failure::Device)
    }

    /// Calls so far.
    pub fn calls(&self) -> usize {
        self.calls.load(Ordering::SeqCst)
    }

    /// Whether the call that is to fail has been made.
    pub fn has_failed(&self) -> bool {
        self.calls() > self.at
    }
}

impl Faults for FailAt {
    fn before(&self, _: Call, _: &Path) -> io::Result<()> {
        let call = self.calls.fetch_add(1, Ordering::SeqCst);
        match self.failure {
            Failure::StorageFull if call == self.at => Err(io::ErrorKind::StorageFull.into()),
            Failure::Device if call == self.at => Err(io::Error::other("input/output error (injected)")),
            Failure::Crash if call >= self.at => Err(io::Error::other("the program died here (injected)")),
            _ => Ok(()),
        }
    }
}

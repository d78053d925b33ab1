//! Durable files of MSK projects.
//!
//! Results, weights and their histories are kept by people who share their folders with others, whose disks fill up, and whose
//! programs are killed. This crate holds the four operations that they need, each with a promise that survives all of that:
//!
//! * [`Folder::read`] gives the bytes of a regular file, within a limit. Pipes, devices and the files of `/proc` are refused
//!   without being read.
//! * [`Folder::replace`] exchanges a whole file in one move: readers see the old bytes or the new ones, also after a power cut.
//!   [`write_file`] does so for a file that the user named.
//! * [`Log::append`] adds a line to a file of lines: it is on the disk, whole, or the file is what it was. [`Folder::lines`] reads them.
//! * [`Folder::lock`] keeps other processes out until the lock is dropped or the program ends.
//!
//! A [`Folder`] is a capability ([`cap_std`]): the operating system resolves every path beneath the opened folder, so neither
//! `..`, nor an absolute path, nor a link, nor a folder exchanged for a link meanwhile leads out of it.
//!
//! [`Faults`] lets tests fail the k-th system call.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod error;
mod faults;
mod folder;
mod lines;
mod lock;
mod log;
mod regular;
mod replace;

pub use error::StorageError;
pub use faults::{Call, FailAt, Failure, Faults};
pub use folder::{Entry, Folder, Kind};
pub use lines::Lines;
pub use lock::Lock;
pub use log::Log;
pub use regular::{read_file, read_text_file};
pub use replace::write_file;

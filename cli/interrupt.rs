//! Signals that ask a long command to stop, and the exit code that tells which one did.

use crate::error::Error;
use signal_hook::consts::signal;
use signal_hook::flag;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Listens for the signals by which terminals, shells, service managers and schedulers end a program: SIGINT, SIGTERM and
/// SIGHUP.
///
/// The first one asks the command to stop: it gives up what it is playing and keeps what has ended. A second one ends the
/// program at once; what it writes is valid either way.
pub struct Interrupt {
    stop: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    /// Begins to listen.
    ///
    /// # Errors
    /// The operating system refuses.
    pub fn listen() -> Result<Self, Error> {
        let this = Self { stop: Arc::default(), signal: Arc::default() };
        for signal in signals() {
            // Actions run in the order of their registration: only a second signal finds the flag set.
            flag::register_conditional_shutdown(signal, code(signal), this.stop.clone())?;
            flag::register_usize(signal, this.signal.clone(), usize::try_from(signal).unwrap_or_default())?;
            flag::register(signal, this.stop.clone())?;
        }
        Ok(this)
    }

    /// Becomes true when a signal has come.
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// The exit code after the signal that came, as shells give it: 128 and its number.
    pub fn code(&self) -> ExitCode {
        let signal = i32::try_from(self.signal.load(Ordering::Relaxed)).ok().filter(|signal| *signal != 0);
        ExitCode::from(u8::try_from(code(signal.unwrap_or(signal::SIGINT))).unwrap_or(u8::MAX))
    }
}

fn code(signal: i32) -> i32 {
    128 + signal
}

#[cfg(unix)]
fn signals() -> Vec<i32> {
    let mut signals = vec![signal::SIGINT, signal::SIGTERM];
    // `nohup msk eval ... &` goes on when its terminal closes.
    if !is_ignored(signal::SIGHUP) {
        signals.push(signal::SIGHUP);
    }
    signals
}

#[cfg(not(unix))]
fn signals() -> Vec<i32> {
    vec![signal::SIGINT, signal::SIGTERM]
}

/// Whether the parent process had the program ignore a signal. Only Linux tells without `unsafe`; elsewhere the answer is no.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

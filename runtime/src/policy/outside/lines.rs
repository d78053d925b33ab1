//! Lines of text to and from a program, each direction in a thread of its own: neither side can hold the other up.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{ChildStderr, ChildStdin, ChildStdout};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

/// Longest reply that is read, bytes.
pub(super) const LONGEST: usize = 1 << 24;
/// Replies that are kept before they are asked for; a program that writes more waits.
const AHEAD: usize = 4;
/// What is kept of the end of standard error, bytes.
const TAIL: usize = 2000;

/// A line that was read.
pub(super) enum Line {
    Text(Vec<u8>),
    /// Longer than [`LONGEST`].
    TooLong,
}

/// Takes lines and writes them until it is dropped, which ends the program's standard input.
pub(super) fn writer(mut input: ChildStdin) -> Sender<String> {
    let (sender, lines) = channel::<String>();
    thread::spawn(move || {
        for line in lines {
            // A program that reads no more has ended, or will be missed by its replies.
            if input.write_all(line.as_bytes()).and_then(|()| input.flush()).is_err() {
                break;
            }
        }
    });
    sender
}

/// Gives the lines of a program's standard output; it is disconnected where that ends.
pub(super) fn reader(output: ChildStdout) -> Receiver<Line> {
    let (sender, lines) = sync_channel(AHEAD);
    thread::spawn(move || read(output, &sender));
    lines
}

fn read(output: impl Read, sender: &SyncSender<Line>) {
    let mut output = BufReader::new(output);
    loop {
        let mut line = Vec::new();
        let most = u64::try_from(LONGEST + 1).unwrap_or(u64::MAX);
        let Ok(count) = output.by_ref().take(most).read_until(b'\n', &mut line) else { return };
        if count == 0 {
            return;
        }
        let line = if line.last() == Some(&b'\n') || count <= LONGEST { Line::Text(line) } else { Line::TooLong };
        let last = matches!(line, Line::TooLong);
        if sender.send(line).is_err() || last {
            return;
        }
    }
}

/// The end of what a program writes to its standard error.
#[derive(Clone, Default)]
pub(super) struct Tail(Arc<Mutex<VecDeque<u8>>>);

impl Tail {
    pub fn of(mut errors: ChildStderr) -> Self {
        let tail = Self::default();
        let kept = tail.0.clone();
        thread::spawn(move || {
            let mut piece = [0; 1024];
            while let Ok(count @ 1..) = errors.read(&mut piece) {
                let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                kept.extend(&piece[..count]);
                let over = kept.len().saturating_sub(TAIL);
                kept.drain(..over);
            }
        });
        tail
    }

    /// As text, without line ends around it.
    pub fn text(&self) -> String {
        let kept: Vec<u8> = self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().copied().collect();
        String::from_utf8_lossy(&kept).trim().to_owned()
    }
}

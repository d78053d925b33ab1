//! Messages to and from a program, each direction in a thread of its own: neither side can hold the other up.

use super::message::{Encoding, Reply};

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

/// What was read.
pub(super) enum Incoming {
    /// A reply, or what is wrong with it, in words.
    Reply(Result<Reply, String>),
    /// Longer than [`LONGEST`].
    TooLong,
}

/// Takes messages and writes them until it is dropped, which ends the program's standard input.
pub(super) fn writer(mut input: ChildStdin) -> Sender<Vec<u8>> {
    let (sender, messages) = channel::<Vec<u8>>();
    thread::spawn(move || {
        for message in messages {
            // A program that reads no more has ended, or will be missed by its replies.
            if input.write_all(&message).and_then(|()| input.flush()).is_err() {
                break;
            }
        }
    });
    sender
}

/// Gives the replies on a program's standard output; it is disconnected where that ends.
pub(super) fn reader(output: ChildStdout, encoding: Encoding) -> Receiver<Incoming> {
    let (sender, replies) = sync_channel(AHEAD);
    thread::spawn(move || read(output, encoding, &sender));
    replies
}

fn read(output: impl Read, encoding: Encoding, sender: &SyncSender<Incoming>) {
    let mut output = BufReader::new(output);
    let next = match encoding {
        Encoding::Json => line,
        Encoding::MessagePack => object,
    };
    while let Some(incoming) = next(&mut output) {
        // Where a line is too long or an object is none, the next one does not begin at a known place.
        let last = match &incoming {
            Incoming::TooLong => true,
            Incoming::Reply(reply) => reply.is_err() && encoding == Encoding::MessagePack,
        };
        if sender.send(incoming).is_err() || last {
            return;
        }
    }
}

/// The next line; `None` at the end.
fn line(output: &mut dyn BufRead) -> Option<Incoming> {
    let mut line = Vec::new();
    let count = output.take(LONGEST as u64 + 1).read_until(b'\n', &mut line).ok().filter(|count| *count > 0)?;
    let whole = line.last() == Some(&b'\n') || count <= LONGEST;
    Some(if whole { Incoming::Reply(Reply::of_json(&line)) } else { Incoming::TooLong })
}

/// The next object of MessagePack; `None` at the end, also within an object.
fn object(output: &mut dyn BufRead) -> Option<Incoming> {
    if output.fill_buf().ok()?.is_empty() {
        return None;
    }
    let mut bounded = output.take(LONGEST as u64);
    let reply = Reply::of_message_pack(&mut bounded);
    match reply {
        Err(_) if bounded.limit() == 0 => Some(Incoming::TooLong),
        Err(None) => None,
        Err(Some(reason)) => Some(Incoming::Reply(Err(reason))),
        Ok(reply) => Some(Incoming::Reply(Ok(reply))),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What is read of some bytes: actions, or what is wrong.
    fn read_all(bytes: &[u8], encoding: Encoding) -> Vec<String> {
        let (sender, replies) = sync_channel(100);
        read(bytes, encoding, &sender);
        drop(sender);
        let shown = |incoming| match incoming {
            Incoming::TooLong => "too long".to_owned(),
            Incoming::Reply(Ok(reply)) => format!("{:?} {:?} {:?}", reply.ready, reply.action, reply.error),
            Incoming::Reply(Err(reason)) => reason,
        };
        replies.iter().map(shown).collect()
    }

    #[test]
    fn lines_are_read_one_by_one() {
        let text = b"{\"ready\": true}\n{\"action\": [1]}\nhello\n{\"action\": [2]}";
        let read = read_all(text, Encoding::Json);
        assert_eq!(read.len(), 4);
        assert_eq!(read[1], "None Some([1.0]) None");
        assert!(read[2].starts_with("its reply does not follow the protocol: `hello`"), "{}", read[2]);
    }

    #[test]
    fn objects_of_message_pack_are_read_one_by_one() {
        // {"ready": true}, {"action": [-1, 0.5 (single), 0.25]}, {"error": "no"}
        let mut bytes = b"\x81\xa5ready\xc3".to_vec();
        bytes.extend(b"\x81\xa6action\x93\xff\xca\x3f\x00\x00\x00\xcb\x3f\xd0\0\0\0\0\0\0");
        bytes.extend(b"\x81\xa5error\xa2no");
        let expected = ["Some(true) None None", "None Some([-1.0, 0.5, 0.25]) None", "None None Some(\"no\")"];
        assert_eq!(read_all(&bytes, Encoding::MessagePack), expected);
        // An end within an object is an end.
        assert_eq!(read_all(&bytes[..bytes.len() - 1], Encoding::MessagePack), expected[..2]);
    }

    #[test]
    fn what_is_no_reply_in_message_pack_is_the_last_that_is_read() {
        for (bytes, wrong) in [
            (&b"loading weights\n"[..], "its reply does not follow the protocol"),
            (b"\x81\xa7actions\x90\x81\xa5ready\xc3", "unknown field `actions`"),
            (b"\x81\xa6action\x91\xcb\x7f\xf8\0\0\0\0\0\0\x81\xa5ready\xc3", "its action contains NaN, which is not a number"),
            (b"\x81\xa6action\x91\xca\xff\x80\0\0\x81\xa5ready\xc3", "its action contains Infinity, which is not a number"),
            (b"\x81\xa6action\xdd\xff\xff\xff\xff\xc3", "its reply does not follow the protocol"),
        ] {
            let read = read_all(bytes, Encoding::MessagePack);
            assert!(read.len() == 1 && read[0].contains(wrong), "{read:?}");
        }
    }

    #[test]
    fn a_reply_that_does_not_end_is_too_long() {
        let endless = |beginning: &[u8], filler: u8| [beginning, &vec![filler; LONGEST + 10]].concat();
        assert_eq!(read_all(&endless(b"{\"action\": [", b' '), Encoding::Json), ["too long"]);
        // An array of 2^32 - 1 numbers.
        assert_eq!(read_all(&endless(b"\x81\xa6action\xdd\xff\xff\xff\xff", 0), Encoding::MessagePack), ["too long"]);
    }
}

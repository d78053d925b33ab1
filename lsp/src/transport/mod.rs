//! The connection to a client over a reader and a writer, such as standard input and output.
//!
//! 1. `frames` cuts bodies out of the stream of bytes, and finds the next one after bytes that are none;
//! 2. `message` decodes a body;
//! 3. two threads move messages between the streams and the channels of a [`Connection`].
//!
//! A client may send anything: what is no message is answered with an error of JSON-RPC, under the identifier of its request where
//! that can be known, and logged; then reading goes on. `lsp_server`'s own reader ends at the first such message and allocates what
//! a header claims. Both channels are bounded: a client that does not read is not read either.

mod frames;
mod message;
mod surrogates;

use frames::Frames;
use lsp_server::{Connection, ErrorCode, Message, Notification};
use lsp_types::notification::{Exit, LogMessage, Notification as _};
use lsp_types::{LogMessageParams, MessageType};
use message::{Decoded, Malformed};
use serde_json::{Value, json};
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

/// Messages that may wait in each direction.
const WAITING: usize = 64;

/// The threads behind a connection.
pub struct Threads {
    reader: JoinHandle<io::Result<()>>,
    writer: JoinHandle<io::Result<()>>,
}

impl Threads {
    /// Waits until everything is written and the client has sent `exit` or closed its stream. The connection must have been
    /// dropped.
    ///
    /// # Errors
    /// The streams failed.
    pub fn join(self) -> io::Result<()> {
        finish(self.reader)?;
        finish(self.writer)
    }
}

fn finish(thread: JoinHandle<io::Result<()>>) -> io::Result<()> {
    thread.join().unwrap_or_else(|_| Err(io::Error::other("a thread of the connection panicked")))
}

/// Connects to a client.
///
/// # Errors
/// The system starts no more threads.
pub fn connect(input: impl Read + Send + 'static, output: impl Write + Send + 'static) -> io::Result<(Connection, Threads)> {
    let (to_server, receiver) = crossbeam_channel::bounded(WAITING);
    let (sender, to_client) = crossbeam_channel::bounded(WAITING);
    let output = Arc::new(Output(Mutex::new(BufWriter::new(output))));
    let shared = Arc::clone(&output);
    let writer = thread::Builder::new()
        .name("writer".to_owned())
        .spawn(move || to_client.into_iter().try_for_each(|message| shared.send(&message)))?;
    let reader = thread::Builder::new()
        .name("reader".to_owned())
        .spawn(move || read(BufReader::new(input), &output, |message| to_server.send(message).is_ok()))?;
    Ok((Connection { sender, receiver }, Threads { reader, writer }))
}

/// Passes every message on, until `exit`, the end of the input, or a server that takes no more.
fn read<R: io::BufRead, W: Write>(input: R, output: &Output<W>, mut pass: impl FnMut(Message) -> bool) -> io::Result<()> {
    let mut frames = Frames::new(input);
    while let Some(frame) = frames.next()? {
        let Decoded { message, malformed } = match frame {
            Ok(body) => message::decode(&body),
            Err(error) => {
                let malformed = Malformed::new(Value::Null, ErrorCode::ParseError, error.to_string());
                Decoded { message: None, malformed: Some(malformed) }
            }
        };
        if let Some(malformed) = malformed {
            output.refuse(&malformed)?;
        }
        let Some(message) = message else { continue };
        let exits = matches!(&message, Message::Notification(notification) if notification.method == Exit::METHOD);
        if !pass(message) || exits {
            break;
        }
    }
    Ok(())
}

/// The stream to the client, for one message at a time.
struct Output<W: Write>(Mutex<BufWriter<W>>);

impl<W: Write> Output<W> {
    fn send(&self, message: &Message) -> io::Result<()> {
        // A thread that panicked here lets the stream end within a message at worst.
        message.write(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Answers what is no message, and logs it. `lsp_server` knows no answer without an identifier.
    fn refuse(&self, malformed: &Malformed) -> io::Result<()> {
        let Malformed { id, code, reason } = malformed;
        let answer = json!({ "jsonrpc": "2.0", "id": id, "error": { "code": code, "message": reason } }).to_string();
        let mut stream = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        write!(stream, "Content-Length: {}\r\n\r\n{answer}", answer.len())?;
        logged(MessageType::ERROR, format!("a message cannot be read: {reason}")).write(&mut *stream)
    }
}

/// A line for the client's log.
pub(crate) fn logged(typ: MessageType, message: String) -> Message {
    Notification::new(LogMessage::METHOD.to_owned(), LogMessageParams { typ, message }).into()
}

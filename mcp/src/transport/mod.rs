//! Messages over an input and an output, one a line, each line answered.
//!
//! The transport of the SDK drops lines that are no JSON and lines that are too long, and notices only after a delay that its input has
//! ended. Here a task reads and a task writes:
//!
//! * a line that is no JSON, no valid message, or too long is answered with an error, under the id of its request where one can be
//!   found, and the conversation goes on;
//! * [`Closing`] is set as soon as the input ends or the output is closed, so that running calls can stop;
//! * at most [`OUTSTANDING`] requests are unanswered: a client that reads no answers is not read from either.

mod line;
mod request_id;

use line::{Line, LineReader};
use request_id::is_id;
use rmcp::RoleServer;
use rmcp::model::{
    ClientJsonRpcMessage, ClientNotification, ClientRequest, ErrorCode, GetMeta, JsonRpcMessage, ProtocolVersion, RequestId,
    ServerJsonRpcMessage,
};
use rmcp::transport::Transport;
use serde_json::{Value, json};
use std::collections::HashSet;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, AsyncWriteExt, BufReader};
use tokio::sync::{Notify, mpsc, oneshot, watch};
use tokio::task::JoinHandle;

/// Longest line, bytes: the largest text of a task with every character escaped, and some.
pub const LONGEST_LINE: usize = 2 << 20;
/// Most requests without an answer.
const OUTSTANDING: usize = 256;
/// How long the last answers may take to be written when the conversation ends.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// Whether the conversation is ending: no client waits for answers any more.
#[derive(Debug, Clone)]
pub struct Closing(Arc<watch::Sender<bool>>);

impl Default for Closing {
    fn default() -> Self {
        Self(Arc::new(watch::Sender::new(false)))
    }
}

impl Closing {
    /// Whether it is.
    pub fn is_set(&self) -> bool {
        *self.0.borrow()
    }

    /// Waits until it is.
    pub async fn wait(&self) {
        // The sender lives as long as `self`.
        let _ = self.0.subscribe().wait_for(|set| *set).await;
    }

    fn set(&self) {
        self.0.send_replace(true);
    }
}

/// A client at the other end of an input and an output.
pub struct Conversation {
    incoming: mpsc::Receiver<ClientJsonRpcMessage>,
    outgoing: Option<mpsc::Sender<Outgoing>>,
    unanswered: Arc<Unanswered>,
    writer: JoinHandle<()>,
}

impl Conversation {
    /// Begins to read and write; `closing` is set when either end is closed.
    pub fn over<R, W>(input: R, output: W, closing: Closing) -> Self
    where
        R: AsyncRead + Send + Unpin + 'static,
        W: AsyncWrite + Send + Unpin + 'static,
    {
        let (outgoing, lines) = mpsc::channel(64);
        let (messages, incoming) = mpsc::channel(1);
        let unanswered = Arc::new(Unanswered::default());
        let writer = tokio::spawn(write(output, lines, closing.clone()));
        let reader = Reader { messages, outgoing: outgoing.clone(), unanswered: unanswered.clone(), opened: false };
        tokio::spawn(async move {
            tokio::select! {
                () = reader.run(LineReader::new(BufReader::new(input), LONGEST_LINE)) => closing.set(),
                () = closing.wait() => {}
            }
        });
        Self { incoming, outgoing: Some(outgoing), unanswered, writer }
    }
}

impl Transport<RoleServer> for Conversation {
    type Error = io::Error;

    fn send(&mut self, message: ServerJsonRpcMessage) -> impl Future<Output = io::Result<()>> + Send + 'static {
        let (outgoing, unanswered) = (self.outgoing.clone(), self.unanswered.clone());
        async move {
            let closed = || io::Error::from(io::ErrorKind::BrokenPipe);
            let line = serde_json::to_vec(&message)?;
            let (written, was_written) = oneshot::channel();
            let sent = outgoing.ok_or_else(closed)?.send(Outgoing { line, written: Some(written) }).await;
            let result = match sent {
                Ok(()) => was_written.await.map_err(|_| closed()),
                Err(_) => Err(closed()),
            };
            match &message {
                JsonRpcMessage::Response(response) => unanswered.remove(&response.id),
                JsonRpcMessage::Error(error) => error.id.iter().for_each(|id| unanswered.remove(id)),
                _ => {}
            }
            result
        }
    }

    async fn receive(&mut self) -> Option<ClientJsonRpcMessage> {
        self.incoming.recv().await
    }

    async fn close(&mut self) -> io::Result<()> {
        self.incoming.close();
        self.outgoing = None;
        // A client that does not read the last answers does not keep the server alive.
        if tokio::time::timeout(LAST_WORDS, &mut self.writer).await.is_err() {
            self.writer.abort();
        }
        Ok(())
    }
}

/// A line to be written, and who waits for that.
struct Outgoing {
    line: Vec<u8>,
    written: Option<oneshot::Sender<()>>,
}

async fn write(mut output: impl AsyncWrite + Unpin, mut lines: mpsc::Receiver<Outgoing>, closing: Closing) {
    while let Some(Outgoing { mut line, written }) = lines.recv().await {
        line.push(b'\n');
        let result = async {
            output.write_all(&line).await?;
            output.flush().await
        };
        if result.await.is_err() {
            closing.set();
            return;
        }
        if let Some(written) = written {
            // The requester may have stopped waiting.
            let _ = written.send(());
        }
    }
}

/// The ids of the requests that have no answer yet.
#[derive(Default)]
struct Unanswered {
    ids: Mutex<HashSet<RequestId>>,
    answered: Notify,
}

impl Unanswered {
    fn ids(&self) -> MutexGuard<'_, HashSet<RequestId>> {
        // No thread panics while it holds the lock.
        self.ids.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds an id when there is room; false if it is there already.
    async fn add(&self, id: &RequestId) -> bool {
        loop {
            let answered = self.answered.notified();
            {
                let mut ids = self.ids();
                if ids.len() < OUTSTANDING || ids.contains(id) {
                    return ids.insert(id.clone());
                }
            }
            answered.await;
        }
    }

    fn remove(&self, id: &RequestId) {
        self.ids().remove(id);
        self.answered.notify_one();
    }
}

/// Turns lines into messages and answers those that are none.
struct Reader {
    messages: mpsc::Sender<ClientJsonRpcMessage>,
    outgoing: mpsc::Sender<Outgoing>,
    unanswered: Arc<Unanswered>,
    /// Whether the client has begun the conversation with `initialize` or with a request that needs none.
    opened: bool,
}

impl Reader {
    /// Reads until the input ends or cannot be read, or has no receiver.
    async fn run<R: tokio::io::AsyncBufRead + Unpin>(mut self, mut lines: LineReader<R>) {
        while let Ok(Some(line)) = lines.next().await {
            let open = match parse(line) {
                Parsed::Message(message) => self.deliver(*message).await,
                Parsed::Nothing => true,
                Parsed::Wrong(error) => self.refuse(error).await,
            };
            if !open {
                return;
            }
        }
    }

    /// Passes a message on. False if there is no receiver.
    async fn deliver(&mut self, message: ClientJsonRpcMessage) -> bool {
        match &message {
            JsonRpcMessage::Request(request) => {
                self.opened |= opens(&request.request);
                if !self.unanswered.add(&request.id).await {
                    let reason = "the id is that of a request that has no answer yet".to_owned();
                    return self.refuse(Wrong { id: id_value(&request.id), code: ErrorCode::INVALID_REQUEST, reason }).await;
                }
            }
            // The SDK ends the conversation at anything but a request before it has begun, where it cannot mean anything.
            _ if !self.opened => return true,
            JsonRpcMessage::Notification(notification) => {
                if let ClientNotification::CancelledNotification(cancelled) = &notification.notification
                    && let Some(id) = &cancelled.params.request_id
                {
                    // A cancelled request gets no answer.
                    self.unanswered.remove(id);
                }
            }
            _ => {}
        }
        self.messages.send(message).await.is_ok()
    }

    async fn refuse(&self, Wrong { id, code, reason }: Wrong) -> bool {
        let error = json!({ "jsonrpc": "2.0", "id": id, "error": { "code": code.0, "message": reason } });
        let line = error.to_string().into_bytes();
        self.outgoing.send(Outgoing { line, written: None }).await.is_ok()
    }
}

/// What a line holds.
enum Parsed {
    Message(Box<ClientJsonRpcMessage>),
    /// Nothing that is answered: an empty line, an unknown notification.
    Nothing,
    Wrong(Wrong),
}

/// A line that is no message.
struct Wrong {
    id: Value,
    code: ErrorCode,
    reason: String,
}

fn parse(line: Line) -> Parsed {
    let line = match line {
        Line::Whole(line) => line,
        Line::TooLong(id) => {
            let reason = format!("the message is longer than {LONGEST_LINE} bytes");
            return Parsed::Wrong(Wrong { id: id.into(), code: ErrorCode::INVALID_REQUEST, reason });
        }
    };
    let text = line.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&line);
    if text.trim_ascii().is_empty() {
        return Parsed::Nothing;
    }
    if let Ok(message) = serde_json::from_slice(text) {
        return Parsed::Message(Box::new(message));
    }
    match serde_json::from_slice::<Value>(text) {
        Ok(value) if is_notification(&value) => Parsed::Nothing,
        Ok(value) => {
            let id = value.get("id").filter(|id| is_id(id)).cloned().into();
            Parsed::Wrong(Wrong { id, code: ErrorCode::INVALID_REQUEST, reason: fault(&value).to_owned() })
        }
        Err(error) => {
            let mut scanner = request_id::RequestIdScanner::default();
            scanner.read(text);
            Parsed::Wrong(Wrong {
                id: scanner.id().into(),
                code: ErrorCode::PARSE_ERROR,
                reason: format!("the line is not JSON: {error}"),
            })
        }
    }
}

/// Whether a value is a notification, though none that is known: it is not answered.
fn is_notification(value: &Value) -> bool {
    value["jsonrpc"] == "2.0" && value["method"].is_string() && value.get("id").is_none()
}

/// Why a JSON value is no message.
fn fault(value: &Value) -> &'static str {
    match value {
        Value::Array(_) => "expected one JSON-RPC message per line, found an array: batches are not supported",
        Value::Object(_) if value["jsonrpc"] != "2.0" => "expected a JSON-RPC message with `\"jsonrpc\": \"2.0\"`",
        Value::Object(object) if object.contains_key("method") && !value["method"].is_string() => "expected a string as `method`",
        Value::Object(object) if object.get("id").is_some_and(|id| !is_id(id)) => "expected a string or an integer as `id`",
        Value::Object(_) => "expected a JSON-RPC request with `id`, `method` and an object as `params`",
        _ => "expected a JSON-RPC message, which is an object",
    }
}

/// Whether a request begins the conversation: `initialize`, or one that carries what `initialize` would have carried.
fn opens(request: &ClientRequest) -> bool {
    match request {
        ClientRequest::InitializeRequest(_) => true,
        ClientRequest::PingRequest(_) | ClientRequest::DiscoverRequest(_) => false,
        other => {
            let meta = other.get_meta();
            let known = meta.protocol_version().is_some_and(|version| ProtocolVersion::KNOWN_VERSIONS.contains(&version));
            known && meta.missing_required_keys(&ProtocolVersion::V_2026_07_28).is_empty()
        }
    }
}

fn id_value(id: &RequestId) -> Value {
    serde_json::to_value(id).unwrap_or_default()
}

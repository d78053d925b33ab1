//! A client in memory: what an editor would send and get, with texts and a body that need no disk and no physics.

use lsp_server::{Connection, Message, Notification, Request, RequestId, Response};
use lsp_types::notification::{self as notifications, Notification as _};
use lsp_types::{Position, PublishDiagnosticsParams, Range};
use msk_compiler::body::BodyDescription;
use msk_compiler::files::{BodySource, LoadError, Loader};
use msk_compiler::vocabulary::Vocabulary;
use msk_lsp::Ended;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// Far more than any answer takes, so that only a server that hangs fails by it.
const PATIENCE: Duration = Duration::from_secs(120);

/// Files on disk, for the server. Others may change them at any time. Listing a folder called `panic` panics.
#[derive(Default, Clone)]
pub struct Disk(Arc<Mutex<BTreeMap<PathBuf, String>>>);

impl Disk {
    /// Writes a file.
    pub fn write(&self, path: impl Into<PathBuf>, text: &str) {
        self.0.lock().unwrap().insert(path.into(), text.to_owned());
    }

    fn below(&self, root: &Path) -> Vec<PathBuf> {
        assert!(!root.display().to_string().contains("panic"), "this folder makes the server panic");
        self.0.lock().unwrap().keys().filter(|path| path.starts_with(root)).cloned().collect()
    }
}

impl Loader for Disk {
    fn load(&self, path: &Path) -> Result<String, LoadError> {
        self.0.lock().unwrap().get(path).cloned().ok_or_else(|| LoadError::Missing(path.to_path_buf()))
    }
}

/// The human body, its vocabulary read from the compiler's fixture; from its second revision on the pelvis has another name. A body
/// called `panic` panics.
#[derive(Default, Clone)]
pub struct Human(Arc<AtomicU64>);

impl Human {
    /// Changes the model behind the body.
    pub fn change(&self) {
        self.0.fetch_add(1, Ordering::SeqCst);
    }
}

impl BodySource for Human {
    fn find(&self, name: &str) -> Option<(PathBuf, String)> {
        let text = include_str!("../../../bodies/human.msk");
        (name == "human").then(|| (PathBuf::from("<built-in>/bodies/human.msk"), text.to_owned()))
    }

    fn vocabulary(&self, description: &BodyDescription) -> Result<Vocabulary, String> {
        assert_ne!(description.name, "panic", "this body makes the compiler panic");
        let text = include_str!("../../../compiler/tests/fixtures/human_vocabulary.json");
        let mut vocabulary: Vocabulary = serde_json::from_str(text).map_err(|error| error.to_string())?;
        if let Some(pelvis) = vocabulary.landmarks.iter_mut().find(|landmark| landmark.name == "pelvis")
            && self.0.load(Ordering::SeqCst) > 0
        {
            pelvis.name = "basin".to_owned();
        }
        Ok(vocabulary)
    }

    fn revision(&self, _: &BodyDescription) -> u64 {
        self.0.load(Ordering::SeqCst)
    }
}

/// A client with its server.
pub struct Client {
    connection: Connection,
    server: Option<JoinHandle<Ended>>,
    next: i32,
    early: Vec<Response>,
    /// The diagnostics last published for each file.
    pub published: BTreeMap<String, PublishDiagnosticsParams>,
    /// Lines of the log.
    pub log: Vec<String>,
    /// The files that the server reads.
    pub disk: Disk,
    /// The body that the server reads.
    pub human: Human,
}

impl Client {
    /// Starts a server that is not initialised.
    pub fn new(files: &[(&str, &str)]) -> Self {
        let (server, connection) = Connection::memory();
        let (disk, human) = (Disk::default(), Human::default());
        for (path, text) in files {
            disk.write(*path, text);
        }
        if let Some((path, text)) = human.find("human") {
            disk.write(path, &text);
        }
        let (files, body) = (disk.clone(), human.clone());
        let thread = std::thread::spawn(move || msk_lsp::serve(&server, &files, &body, &|root: &Path| files.below(root)));
        let (early, published, log) = Default::default();
        Self { connection, server: Some(thread), next: 0, early, published, log, disk, human }
    }

    /// Starts one and greets it.
    pub fn ready(files: &[(&str, &str)]) -> Self {
        Self::greeted(files, json!({}))
    }

    /// The same with what the client can do.
    pub fn greeted(files: &[(&str, &str)], capabilities: Value) -> Self {
        let mut client = Self::new(files);
        client.greet("file:///project", capabilities);
        client
    }

    /// Begins the conversation, with a folder open.
    pub fn greet(&mut self, folder: &str, capabilities: Value) {
        let folders = json!([{ "uri": folder, "name": "project" }]);
        self.ask("initialize", json!({ "capabilities": capabilities, "workspaceFolders": folders })).unwrap();
        self.tell("initialized", json!({}));
    }

    /// Sends a notification.
    pub fn tell(&mut self, method: &str, params: Value) {
        self.connection.sender.send(Notification::new(method.to_owned(), params).into()).unwrap();
    }

    /// Sends a request without waiting for its answer.
    pub fn send(&mut self, method: &str, params: Value) -> RequestId {
        self.next += 1;
        let id = RequestId::from(self.next);
        self.connection.sender.send(Request::new(id.clone(), method.to_owned(), params).into()).unwrap();
        id
    }

    /// The answer to a request: its result, or code and message of its error.
    pub fn answer(&mut self, id: &RequestId) -> Result<Value, (i32, String)> {
        loop {
            let response = self.message();
            if let Some(Response { id: found, result, error }) = response {
                assert_eq!(found, *id, "answers come in order");
                return match error {
                    Some(error) => Err((error.code, error.message)),
                    None => Ok(result.unwrap_or(Value::Null)),
                };
            }
        }
    }

    /// The same, where other answers may come before it: they are kept.
    pub fn answer_any_order(&mut self, id: &RequestId) -> Result<Value, (i32, String)> {
        loop {
            if let Some(place) = self.early.iter().position(|response| response.id == *id) {
                let Response { result, error, .. } = self.early.remove(place);
                return error.map_or_else(|| Ok(result.unwrap_or(Value::Null)), |error| Err((error.code, error.message)));
            }
            if let Some(response) = self.message() {
                self.early.push(response);
            }
        }
    }

    /// Sends a request and waits.
    pub fn ask(&mut self, method: &str, params: Value) -> Result<Value, (i32, String)> {
        let id = self.send(method, params);
        self.answer(&id)
    }

    fn message(&mut self) -> Option<Response> {
        match self.connection.receiver.recv_timeout(PATIENCE).expect("the server is silent") {
            Message::Response(response) => Some(response),
            Message::Notification(n) if n.method == notifications::PublishDiagnostics::METHOD => {
                let news: PublishDiagnosticsParams = serde_json::from_value(n.params).unwrap();
                self.published.insert(news.uri.as_str().to_owned(), news);
                None
            }
            Message::Notification(n) if n.method == notifications::LogMessage::METHOD => {
                self.log.push(n.params["message"].as_str().unwrap().to_owned());
                None
            }
            other => panic!("unexpected {other:?}"),
        }
    }

    /// Opens a text.
    pub fn open(&mut self, path: &str, text: &str) {
        let document = json!({ "uri": uri(path), "languageId": "msk", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Replaces a text.
    pub fn change(&mut self, path: &str, version: i32, text: &str) {
        let document = json!({ "uri": uri(path), "version": version });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [{ "text": text }] }));
    }

    /// The codes published for a file, once `version` of it has been looked at.
    pub fn codes(&mut self, path: &str, version: Option<i32>) -> Vec<String> {
        let key = uri(path);
        while self.published.get(&key).is_none_or(|news| news.version != version) {
            assert!(self.message().is_none(), "no answer is due");
        }
        self.published[&key].diagnostics.iter().map(|diagnostic| code(&serde_json::to_value(diagnostic).unwrap())).collect()
    }

    /// Asks about a place.
    pub fn ask_at(&mut self, method: &str, path: &str, place: Position) -> Result<Value, (i32, String)> {
        self.ask(method, at(path, place))
    }

    /// Ends the conversation as the protocol demands.
    pub fn end(mut self) -> Ended {
        self.ask("shutdown", Value::Null).unwrap();
        self.tell("exit", Value::Null);
        self.server.take().unwrap().join().unwrap()
    }

    /// Ends it without `shutdown`.
    pub fn leave(mut self) -> Ended {
        self.tell("exit", Value::Null);
        self.server.take().unwrap().join().unwrap()
    }
}

fn code(diagnostic: &Value) -> String {
    diagnostic["code"].as_str().unwrap().to_owned()
}

/// The address of a path.
pub fn uri(path: &str) -> String {
    format!("file://{path}")
}

/// A place of a file as parameters.
pub fn at(path: &str, place: Position) -> Value {
    json!({ "textDocument": { "uri": uri(path) }, "position": place })
}

/// A text without its mark `|`, and where it stood.
pub fn marked(text: &str) -> (String, Position) {
    let byte = text.find('|').expect("a mark");
    let line = text[..byte].matches('\n').count();
    let column = text[..byte].rsplit('\n').next().unwrap().encode_utf16().count();
    (text.replacen('|', "", 1), Position::new(line as u32, column as u32))
}

/// The text of a range of ASCII lines.
pub fn within(text: &str, range: &Value) -> String {
    let range: Range = serde_json::from_value(range.clone()).unwrap();
    assert_eq!(range.start.line, range.end.line);
    text.lines().nth(range.start.line as usize).unwrap()[range.start.character as usize..range.end.character as usize].to_owned()
}

/// A whole task around some statements.
pub fn task(statements: &str) -> String {
    format!(
        "task example {{\n    body human\n    control 100 Hz\n    horizon 10 s\n    init {{ pose neutral }}\n    \
         observe {{ pelvis.height }}\n    success survived and pelvis.height > 0.5 m\n{statements}\n}}\n"
    )
}

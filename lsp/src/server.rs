//! The conversation: messages come in, answers go out, one after the other.

use crate::edits::Edits;
use crate::positions::{Encoding, Lines};
use crate::report::Reporter;
use crate::transport::logged;
use crate::workspace::{Document, Workspace, words_of};
use crate::{actions, completion, hints, hover, layout, navigation, paths, rename, symbols};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types::notification::{self as notifications, Notification as _};
use lsp_types::request::{self as asked, Request as _};
use lsp_types::{
    CodeActionKind, CodeActionOptions, CodeActionProviderCapability, CompletionOptions, CompletionResponse,
    DocumentSymbolResponse, GotoDefinitionResponse, HoverProviderCapability, InitializeParams, MessageType, OneOf,
    PrepareRenameResponse, RenameOptions, SaveOptions, ServerCapabilities, TextDocumentContentChangeEvent,
    TextDocumentPositionParams, TextDocumentSyncCapability, TextDocumentSyncKind, TextDocumentSyncOptions,
    TextDocumentSyncSaveOptions,
};
use msk_compiler::diagnostics::FileId;
use msk_compiler::files::{BodySource, Loader};
use msk_compiler::syntax::parse;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::VecDeque;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};

/// How a conversation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// After `shutdown`, with `exit`.
    Properly,
    /// With `exit` or the end of the input, without `shutdown`.
    Abruptly,
}

/// Begins, answers and ends.
pub fn serve(
    connection: &Connection,
    loader: &dyn Loader,
    bodies: &dyn BodySource,
    list: &dyn Fn(&Path) -> Vec<PathBuf>,
) -> Ended {
    let Some((id, client)) = first(connection) else { return Ended::Abruptly };
    let edits = Edits {
        encoding: Encoding::negotiated(&client.capabilities),
        versioned: client.capabilities.workspace.as_ref().and_then(|it| it.workspace_edit.as_ref()?.document_changes)
            == Some(true),
    };
    let information = serde_json::json!({
        "capabilities": capabilities(edits.encoding),
        "serverInfo": { "name": "msk", "version": env!("CARGO_PKG_VERSION") },
    });
    let mut workspace = Workspace::new(loader, bodies, list);
    workspace.roots = roots(&client);
    let mut server = Server { connection, workspace, edits, reporter: Reporter::default(), down: false };
    server.answer(Response::new_ok(id, information));
    server.run()
}

/// The request with which a conversation begins. Others are refused, `exit` ends it.
fn first(connection: &Connection) -> Option<(RequestId, InitializeParams)> {
    while let Ok(message) = connection.receiver.recv() {
        let (id, code, refusal) = match message {
            Message::Request(request) if request.method == asked::Initialize::METHOD => match read(request.params) {
                Ok(client) => return Some((request.id, client)),
                Err((code, refusal)) => (request.id, code, refusal),
            },
            Message::Request(request) => {
                (request.id, ErrorCode::ServerNotInitialized, "the server has not been initialised".to_owned())
            }
            Message::Notification(notification) if notification.method == notifications::Exit::METHOD => return None,
            Message::Notification(_) | Message::Response(_) => continue,
        };
        let _ = connection.sender.send(logged(MessageType::ERROR, format!("a request is rejected: {refusal}")));
        let _ = connection.sender.send(Response::new_err(id, code as i32, refusal).into());
    }
    None
}

#[allow(deprecated, reason = "clients without folders give a root")]
fn roots(client: &InitializeParams) -> Vec<PathBuf> {
    let folders = client.workspace_folders.iter().flatten().map(|folder| &folder.uri);
    let mut roots: Vec<PathBuf> = folders.map(paths::path).collect();
    if roots.is_empty() {
        roots.extend(client.root_uri.iter().map(paths::path));
    }
    roots.retain(|root| root.is_absolute());
    roots
}

fn capabilities(encoding: Encoding) -> ServerCapabilities {
    ServerCapabilities {
        position_encoding: Some(encoding.kind()),
        text_document_sync: Some(TextDocumentSyncCapability::Options(TextDocumentSyncOptions {
            open_close: Some(true),
            change: Some(TextDocumentSyncKind::INCREMENTAL),
            save: Some(TextDocumentSyncSaveOptions::SaveOptions(SaveOptions { include_text: Some(false) })),
            ..TextDocumentSyncOptions::default()
        })),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(vec![".".to_owned(), " ".to_owned()]),
            ..CompletionOptions::default()
        }),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        document_highlight_provider: Some(OneOf::Left(true)),
        document_symbol_provider: Some(OneOf::Left(true)),
        document_formatting_provider: Some(OneOf::Left(true)),
        code_action_provider: Some(CodeActionProviderCapability::Options(CodeActionOptions {
            code_action_kinds: Some(vec![CodeActionKind::QUICKFIX, actions::FIX_ALL]),
            ..CodeActionOptions::default()
        })),
        rename_provider: Some(OneOf::Right(RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: lsp_types::WorkDoneProgressOptions::default(),
        })),
        inlay_hint_provider: Some(OneOf::Left(true)),
        ..ServerCapabilities::default()
    }
}

/// Most messages that are looked through for cancellations.
const MOST_WAITING: usize = 1000;

struct Server<'a> {
    connection: &'a Connection,
    workspace: Workspace<'a>,
    edits: Edits,
    reporter: Reporter,
    /// Whether `shutdown` was asked for.
    down: bool,
}

/// What an answer is, or why there is none.
type Answer = Result<Value, (ErrorCode, String)>;

impl Server<'_> {
    fn run(&mut self) -> Ended {
        let mut waiting: VecDeque<Message> = VecDeque::new();
        loop {
            if waiting.is_empty() {
                // Nothing is being typed: time to publish diagnostics.
                self.publish();
                match self.connection.receiver.recv() {
                    Ok(message) => waiting.push_back(message),
                    Err(_) => return Ended::Abruptly,
                }
            }
            // The rest waits with the client: its channel is bounded.
            waiting.extend(self.connection.receiver.try_iter().take(MOST_WAITING.saturating_sub(waiting.len())));
            self.cancel(&mut waiting);
            self.workspace.next_turn();
            match waiting.pop_front() {
                Some(Message::Request(request)) => self.request(request),
                Some(Message::Notification(notification)) if notification.method == notifications::Exit::METHOD => {
                    return if self.down { Ended::Properly } else { Ended::Abruptly };
                }
                Some(Message::Notification(notification)) => self.notify(notification),
                Some(Message::Response(_)) | None => {}
            }
        }
    }

    /// Cancelled requests are refused without work.
    fn cancel(&self, waiting: &mut VecDeque<Message>) {
        let cancelled = |message: &Message| match message {
            Message::Notification(n) if n.method == notifications::Cancel::METHOD => Some(n.params.get("id")?.clone()),
            _ => None,
        };
        let ids: Vec<Value> = waiting.iter().filter_map(cancelled).collect();
        if ids.is_empty() {
            return;
        }
        waiting.retain(|message| {
            let Message::Request(request) = message else { return cancelled(message).is_none() };
            let unwanted = serde_json::to_value(&request.id).is_ok_and(|id| ids.contains(&id));
            if unwanted {
                let message = "cancelled by the client".to_owned();
                self.answer(Response::new_err(request.id.clone(), ErrorCode::RequestCanceled as i32, message));
            }
            !unwanted
        });
    }

    fn answer(&self, response: Response) {
        // A client that no longer listens ends the conversation at the next read.
        let _ = self.connection.sender.send(response.into());
    }

    fn log(&self, typ: MessageType, message: String) {
        let _ = self.connection.sender.send(logged(typ, message));
    }

    fn publish(&mut self) {
        if self.down {
            return;
        }
        let news = self.survive(|server| server.reporter.news(&server.workspace, server.edits.encoding));
        for news in news.unwrap_or_default() {
            let notification = Notification::new(notifications::PublishDiagnostics::METHOD.to_owned(), news);
            let _ = self.connection.sender.send(notification.into());
        }
    }

    /// Does `work`; a panic within it is logged, and everything but the open texts is forgotten.
    ///
    /// # Errors
    /// The message of the panic.
    fn survive<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> Result<T, String> {
        // Texts change as the last step of a notification, caches may hold anything after a panic: they are emptied.
        std::panic::catch_unwind(AssertUnwindSafe(|| work(self))).map_err(|panic| {
            self.workspace.forget_all();
            let message = format!("a bug in the server, please report it: {}", words_of(&*panic));
            self.log(MessageType::ERROR, message.clone());
            message
        })
    }

    fn request(&mut self, request: Request) {
        let Request { id, method, params } = request;
        let answer = if self.down {
            Err((ErrorCode::InvalidRequest, "the server is shut down".to_owned()))
        } else {
            let answer = self.survive(|server| server.answer_to(&method, params));
            answer.unwrap_or_else(|defect| Err((ErrorCode::InternalError, defect)))
        };
        if let Err((ErrorCode::InvalidRequest | ErrorCode::InvalidParams | ErrorCode::MethodNotFound, reason)) = &answer {
            self.log(MessageType::WARNING, format!("the request `{method}` is rejected: {reason}"));
        }
        self.answer(match answer {
            Ok(value) => Response::new_ok(id, value),
            Err((code, message)) => Response::new_err(id, code as i32, message),
        });
    }

    fn answer_to(&mut self, method: &str, params: Value) -> Answer {
        match method {
            asked::Shutdown::METHOD => {
                self.down = true;
                Ok(Value::Null)
            }
            asked::Initialize::METHOD => Err((ErrorCode::InvalidRequest, "the server is initialised already".to_owned())),
            asked::HoverRequest::METHOD => self.with::<asked::HoverRequest>(params, |server, params| {
                let (path, byte) = server.place(&params.text_document_position_params)?;
                hover::hover(&server.workspace, &path, byte, server.edits.encoding)
            }),
            asked::Completion::METHOD => self.with::<asked::Completion>(params, |server, params| {
                let (path, byte) = server.place(&params.text_document_position)?;
                let items = completion::complete(&server.workspace, &path, byte, server.edits.encoding);
                Some(CompletionResponse::Array(items))
            }),
            asked::GotoDefinition::METHOD => self.with::<asked::GotoDefinition>(params, |server, params| {
                let (path, byte) = server.place(&params.text_document_position_params)?;
                let found = navigation::definitions(&server.workspace, &path, byte, server.edits.encoding);
                Some(GotoDefinitionResponse::Array(found))
            }),
            asked::References::METHOD => self.with::<asked::References>(params, |server, params| {
                let (path, byte) = server.place(&params.text_document_position)?;
                let declared = params.context.include_declaration;
                Some(navigation::references(&server.workspace, &path, byte, declared, server.edits.encoding))
            }),
            asked::DocumentHighlightRequest::METHOD => self.with::<asked::DocumentHighlightRequest>(params, |server, params| {
                let (path, byte) = server.place(&params.text_document_position_params)?;
                Some(navigation::highlights(&server.workspace, &path, byte, server.edits.encoding))
            }),
            asked::DocumentSymbolRequest::METHOD => self.with::<asked::DocumentSymbolRequest>(params, |server, params| {
                let text = server.workspace.text(&paths::path(&params.text_document.uri))?;
                let lines = Lines::new(&text, server.edits.encoding);
                Some(DocumentSymbolResponse::Nested(symbols::outline(&parse(FileId::default(), &text).tree, &lines)))
            }),
            asked::Formatting::METHOD => self.with::<asked::Formatting>(params, |server, params| {
                let text = server.workspace.text(&paths::path(&params.text_document.uri))?;
                layout::layout(&text, server.edits.encoding)
            }),
            asked::CodeActionRequest::METHOD => self.with::<asked::CodeActionRequest>(params, |server, params| {
                let path = paths::path(&params.text_document.uri);
                let only = params.context.only.as_deref();
                Some(actions::actions(&server.workspace, &server.edits, &path, params.range, only))
            }),
            asked::InlayHintRequest::METHOD => self.with::<asked::InlayHintRequest>(params, |server, params| {
                let path = paths::path(&params.text_document.uri);
                let text = server.workspace.text(&path)?;
                let lines = Lines::new(&text, server.edits.encoding);
                let whole = server.workspace.inspect(&path);
                let tree = &whole.files.iter().find(|file| file.path == path)?.tree;
                Some(hints::shares(tree, &whole, &lines, lines.span(params.range)))
            }),
            asked::PrepareRenameRequest::METHOD => {
                let position: TextDocumentPositionParams = read(params)?;
                let (path, byte) = self.place(&position).ok_or_else(unreadable)?;
                let range = rename::prepare(&self.workspace, &path, byte, self.edits.encoding).map_err(refused)?;
                written(PrepareRenameResponse::Range(range))
            }
            asked::Rename::METHOD => {
                let params: lsp_types::RenameParams = read(params)?;
                let (path, byte) = self.place(&params.text_document_position).ok_or_else(unreadable)?;
                let edit = rename::rename(&self.workspace, &self.edits, &path, byte, &params.new_name).map_err(refused)?;
                written(edit)
            }
            _ => Err((ErrorCode::MethodNotFound, format!("`{method}` is not supported"))),
        }
    }

    fn with<R: asked::Request>(&self, params: Value, answer: impl FnOnce(&Self, R::Params) -> R::Result) -> Answer
    where
        R::Params: DeserializeOwned,
        R::Result: Serialize,
    {
        written(answer(self, read(params)?))
    }

    /// The file and the byte of a position; nothing of a file that cannot be read.
    fn place(&self, position: &TextDocumentPositionParams) -> Option<(PathBuf, usize)> {
        let path = paths::path(&position.text_document.uri);
        let text = self.workspace.text(&path)?;
        let byte = Lines::new(&text, self.edits.encoding).byte(position.position);
        Some((path, byte))
    }

    /// Notifications are never answered: one that cannot be read, or is unknown, is logged and changes nothing.
    fn notify(&mut self, notification: Notification) {
        let Notification { method, params } = notification;
        if let Ok(Err((_, reason))) = self.survive(|server| server.notification(&method, params)) {
            self.log(MessageType::WARNING, format!("the notification `{method}` is ignored: {reason}"));
        }
    }

    fn notification(&mut self, method: &str, params: Value) -> Result<(), (ErrorCode, String)> {
        match method {
            notifications::DidOpenTextDocument::METHOD => {
                let params: lsp_types::DidOpenTextDocumentParams = read(params)?;
                let document = params.text_document;
                let path = paths::path(&document.uri);
                self.workspace.put(path, Document { uri: document.uri, version: document.version, text: document.text });
            }
            notifications::DidChangeTextDocument::METHOD => {
                let params: lsp_types::DidChangeTextDocumentParams = read(params)?;
                let path = paths::path(&params.text_document.uri);
                let document = self.workspace.document(&path).ok_or_else(|| not_open(&path))?;
                let version = params.text_document.version;
                // A change that comes late would be made to another text than it was meant for.
                if version < document.version {
                    let found = format!("it changes version {version}, but the document has version {}", document.version);
                    return Err((ErrorCode::InvalidParams, found));
                }
                let mut text = document.text.clone();
                for change in params.content_changes {
                    apply(&mut text, change, self.edits.encoding);
                }
                let uri = document.uri.clone();
                self.workspace.put(path, Document { uri, version, text });
            }
            notifications::DidCloseTextDocument::METHOD => {
                let params: lsp_types::DidCloseTextDocumentParams = read(params)?;
                let path = paths::path(&params.text_document.uri);
                self.workspace.close(&path).ok_or_else(|| not_open(&path))?;
            }
            // What is on disk is looked at before everything that is understood of it is used.
            notifications::Initialized::METHOD
            | notifications::DidSaveTextDocument::METHOD
            | notifications::DidChangeWatchedFiles::METHOD => {}
            optional if optional.starts_with("$/") => {}
            _ => return Err((ErrorCode::MethodNotFound, "unknown method".to_owned())),
        }
        Ok(())
    }
}

/// Makes one change.
fn apply(text: &mut String, change: TextDocumentContentChangeEvent, encoding: Encoding) {
    match change.range {
        None => *text = change.text,
        Some(range) => {
            let span = Lines::new(text, encoding).span(range);
            text.replace_range(span.range(), &change.text);
        }
    }
}

fn read<P: DeserializeOwned>(params: Value) -> Result<P, (ErrorCode, String)> {
    serde_json::from_value(params).map_err(|error| (ErrorCode::InvalidParams, error.to_string()))
}

fn written(answer: impl Serialize) -> Answer {
    serde_json::to_value(answer).map_err(|error| (ErrorCode::InternalError, error.to_string()))
}

fn not_open(path: &Path) -> (ErrorCode, String) {
    (ErrorCode::InvalidParams, format!("`{}` is not open", path.display()))
}

fn refused(reason: String) -> (ErrorCode, String) {
    (ErrorCode::RequestFailed, reason)
}

fn unreadable() -> (ErrorCode, String) {
    (ErrorCode::InvalidParams, "this file cannot be read".to_owned())
}

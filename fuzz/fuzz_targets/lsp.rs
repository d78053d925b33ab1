//! Any lines given to the language server as messages, behind a proper handshake: every request is answered, nothing panics, and
//! what comes back are messages.
//!
//! A line is a body, put behind its length; after a byte 1 it goes to the server as it is, so that headers may lie, too.

#![no_main]

mod language;

use libfuzzer_sys::fuzz_target;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{self, Cursor, Write};
use std::sync::{Arc, Mutex};

/// How a conversation begins: with a text that compiles.
const HANDSHAKE: &str = include_str!("../seeds/lsp-beginning.jsonl");

/// What the server wrote.
#[derive(Clone, Default)]
struct Sink(Arc<Mutex<Vec<u8>>>);

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("no writer panics").extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fuzz_target!(|text: &str| {
    let mut input = Vec::new();
    for line in HANDSHAKE.lines().chain(text.lines()) {
        match line.strip_prefix('\u{1}') {
            Some(raw) => input.extend_from_slice(format!("{raw}\r\n").as_bytes()),
            None => input.extend_from_slice(format!("Content-Length: {}\r\n\r\n{line}", line.len()).as_bytes()),
        }
    }
    let sink = Sink::default();
    let (connection, threads) = msk_lsp::connect(Cursor::new(input), sink.clone()).expect("threads");
    let _ = msk_lsp::serve(&connection, &language::Texts(""), &language::Human, &|_| Vec::new());
    drop(connection);
    threads.join().expect("streams in memory do not fail");
    let bytes = sink.0.lock().expect("no writer panics");
    let answers = messages(std::str::from_utf8(&bytes).expect("messages are texts"));
    // Bodies that lie about their length swallow those behind them.
    if !text.contains('\u{1}') {
        let lines: Vec<&str> = HANDSHAKE.lines().chain(text.lines()).collect();
        every_request_is_answered(&lines, &answers, text);
    }
});

/// The bodies that the server sent.
fn messages(mut stream: &str) -> Vec<Value> {
    let mut messages = Vec::new();
    while !stream.is_empty() {
        let (head, rest) = stream.split_once("\r\n\r\n").expect("a header");
        let length: usize = head.strip_prefix("Content-Length: ").expect("a length").parse().expect("a number");
        let (body, behind) = rest.split_at(length);
        messages.push(serde_json::from_str(body).expect("JSON"));
        stream = behind;
    }
    messages
}

fn every_request_is_answered(lines: &[&str], answers: &[Value], text: &str) {
    let mut open: BTreeMap<String, i64> = BTreeMap::new();
    for line in lines {
        let Ok(Value::Object(message)) = serde_json::from_str(line) else { continue };
        let Some(method) = message.get("method").and_then(Value::as_str) else { continue };
        match message.get("id") {
            Some(id) if id.as_i64().is_some_and(|id| i32::try_from(id).is_ok()) || id.is_string() => {
                *open.entry(id.to_string()).or_default() += 1
            }
            None if method == "exit" => break,
            _ => {}
        }
    }
    for answer in answers.iter().filter(|answer| answer.get("method").is_none()) {
        if let Some(count) = open.get_mut(&answer["id"].to_string()) {
            *count -= 1;
        }
    }
    // What is no request may be answered under the same identifier.
    assert!(open.values().all(|count| *count <= 0), "left open: {open:?}\n{text}");
}

//! `msk lsp` as an editor meets it: a process that speaks the protocol over its standard input and output.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

struct Editor {
    server: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    next: i64,
}

impl Editor {
    fn start(folder: &Path) -> Self {
        let mut server = Command::new(env!("CARGO_BIN_EXE_msk"))
            .args(["lsp", "--stdio"])
            .current_dir(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (input, output) = (server.stdin.take().unwrap(), BufReader::new(server.stdout.take().unwrap()));
        Self { server, input, output, next: 0 }
    }

    fn write(&mut self, message: &Value) {
        let text = message.to_string();
        write!(self.input, "Content-Length: {}\r\n\r\n{text}", text.len()).unwrap();
        self.input.flush().unwrap();
    }

    fn read(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(self.output.read_line(&mut line).unwrap() > 0, "the server has gone");
            let line = line.trim_end();
            if line.is_empty() {
                break;
            }
            if let Some(value) = line.strip_prefix("Content-Length: ") {
                length = value.parse().unwrap();
            }
        }
        let mut body = vec![0; length];
        self.output.read_exact(&mut body).unwrap();
        serde_json::from_slice(&body).unwrap()
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.write(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let id = self.next;
        self.write(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.read();
            if message["id"] == id {
                assert!(message.get("error").is_none_or(Value::is_null), "{message}");
                return message["result"].clone();
            }
        }
    }

    /// The codes told of `uri` next.
    fn codes(&mut self, uri: &str) -> Vec<String> {
        loop {
            let message = self.read();
            if message["method"] == "textDocument/publishDiagnostics" && message["params"]["uri"] == uri {
                let told = message["params"]["diagnostics"].as_array().unwrap();
                return told.iter().map(|told| told["code"].as_str().unwrap().to_owned()).collect();
            }
        }
    }
}

const TASK: &str = "use \"lean.msk\"\n\ntask example {\n    body human\n    control 100 Hz\n    horizon 10 s\n    init { pose neutral }\n    observe { pelvis.height }\n    reward {\n        10 upright = exp(-lean(torso))\n    }\n    success survived\n}\n";

#[test]
fn a_conversation_with_an_editor() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    fs::write(root.join("lean.msk"), "fn lean(part) = 1 - part.up.z\n").unwrap();
    fs::write(root.join("example.msk"), TASK).unwrap();
    let uri = |name: &str| format!("file://{}/{name}", root.display());
    let mut editor = Editor::start(&root);
    let folders = json!([{ "uri": format!("file://{}", root.display()), "name": "example" }]);
    let begun = editor.ask("initialize", json!({ "processId": null, "capabilities": {}, "workspaceFolders": folders }));
    assert_eq!(begun["serverInfo"]["name"], "msk");
    assert_eq!(begun["capabilities"]["positionEncoding"], "utf-16");
    editor.tell("initialized", json!({}));

    let document = json!({ "uri": uri("example.msk"), "languageId": "msk", "version": 1, "text": TASK });
    editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
    assert!(editor.codes(&uri("example.msk")).is_empty(), "the example is sound");

    let place = |line: u32, character: u32| json!({ "textDocument": { "uri": uri("example.msk") }, "position": { "line": line, "character": character } });
    let hover = editor.ask("textDocument/hover", place(9, 32));
    assert!(hover["contents"]["value"].as_str().unwrap().contains("the landmark `torso`"), "{hover}");
    let defined = editor.ask("textDocument/definition", place(9, 27));
    assert_eq!(defined[0]["uri"], uri("lean.msk"));

    // A character is typed: the error comes, with its place; it is deleted: the error goes.
    let range = json!({ "start": { "line": 9, "character": 31 }, "end": { "line": 9, "character": 31 } });
    let change = json!({ "textDocument": { "uri": uri("example.msk"), "version": 2 }, "contentChanges": [{ "range": range, "text": "x" }] });
    editor.tell("textDocument/didChange", change);
    assert_eq!(editor.codes(&uri("example.msk")), ["E0201"]);
    let range = json!({ "start": { "line": 9, "character": 31 }, "end": { "line": 9, "character": 32 } });
    let change = json!({ "textDocument": { "uri": uri("example.msk"), "version": 3 }, "contentChanges": [{ "range": range, "text": "" }] });
    editor.tell("textDocument/didChange", change);
    assert!(editor.codes(&uri("example.msk")).is_empty());

    let mut rename = place(9, 27);
    rename["newName"] = json!("slant");
    let renamed = editor.ask("textDocument/rename", rename);
    assert_eq!(renamed["changes"].as_object().unwrap().len(), 2);

    assert_eq!(editor.ask("shutdown", Value::Null), Value::Null);
    editor.tell("exit", Value::Null);
    assert!(editor.server.wait().unwrap().success());
}

#[test]
fn a_client_that_goes_without_a_word_leaves_no_server_behind() {
    let folder = tempfile::tempdir().unwrap();
    let mut editor = Editor::start(folder.path());
    editor.ask("initialize", json!({ "processId": null, "capabilities": {} }));
    let Editor { mut server, input, output, .. } = editor;
    drop((input, output));
    assert!(!server.wait().unwrap().success());
}

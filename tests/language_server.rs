//! `msk lsp` as an editor meets it: a process that speaks the protocol over its standard input and output.

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

    /// The codes published next for `uri`.
    fn codes(&mut self, uri: &str) -> Vec<String> {
        loop {
            let message = self.read();
            if message["method"] == "textDocument/publishDiagnostics" && message["params"]["uri"] == uri {
                let diagnostics = message["params"]["diagnostics"].as_array().unwrap();
                return diagnostics.iter().map(|diagnostic| diagnostic["code"].as_str().unwrap().to_owned()).collect();
            }
        }
    }
}

const TASK: &str = "use \"lean.msk\"\n\ntask example {\n    body human\n    control 100 Hz\n    horizon 10 s\n    init { pose neutral }\n    observe { pelvis.height }\n    reward {\n        10 upright = exp(-lean(torso))\n    }\n    success survived and pelvis.height > 0.5 m\n}\n";

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

/// A pipe without a writer, that a text uses: a plain read of it never returns.
#[cfg(unix)]
#[test]
fn a_named_pipe_that_a_text_uses_is_an_error_and_no_wait() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    assert!(Command::new("mkfifo").arg(root.join("lean.msk")).status().unwrap().success());
    fs::write(root.join("example.msk"), TASK).unwrap();
    let uri = |name: &str| format!("file://{}/{name}", root.display());
    let mut editor = Editor::start(&root);
    // A server that waits is ended from outside, and then the next answer is missing.
    let process = editor.server.id().to_string();
    let (done, waits) = std::sync::mpsc::channel::<()>();
    let watch = std::thread::spawn(move || {
        if waits.recv_timeout(std::time::Duration::from_secs(60)) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
            let _ = Command::new("kill").arg(process).status();
        }
    });
    let folders = json!([{ "uri": format!("file://{}", root.display()), "name": "example" }]);
    editor.ask("initialize", json!({ "processId": null, "capabilities": {}, "workspaceFolders": folders }));
    editor.tell("initialized", json!({}));
    let document = json!({ "uri": uri("example.msk"), "languageId": "msk", "version": 1, "text": TASK });
    editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
    assert!(!editor.codes(&uri("example.msk")).is_empty(), "the pipe is no text");
    assert_eq!(editor.ask("shutdown", Value::Null), Value::Null);
    editor.tell("exit", Value::Null);
    assert!(editor.server.wait().unwrap().success());
    done.send(()).unwrap();
    watch.join().unwrap();
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

/// The answer to a bad message: code and identifier of the error.
fn refused(editor: &mut Editor) -> (i64, Value) {
    loop {
        let message = editor.read();
        if message.get("error").is_some() {
            let line = editor.read();
            assert_eq!(line["method"], "window/logMessage", "{line}");
            return (message["error"]["code"].as_i64().unwrap(), message["id"].clone());
        }
    }
}

#[test]
fn no_bytes_end_the_server_and_each_bad_message_is_answered_and_logged() {
    const PARSE_ERROR: i64 = -32700;
    const INVALID_REQUEST: i64 = -32600;
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    let mut editor = Editor::start(&root);
    editor.ask("initialize", json!({ "processId": null, "capabilities": {} }));
    let uri = format!("file://{}/a.msk", root.display());
    let document = json!({ "uri": uri, "languageId": "msk", "version": 1, "text": "const a = 1\n" });
    editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
    let body = |text: &str| format!("Content-Length: {}\r\n\r\n{text}", text.len());
    let bad = [
        (body("{"), PARSE_ERROR, Value::Null),
        (body("nonsense"), PARSE_ERROR, Value::Null),
        (body(r#"{"jsonrpc":"2.0","id":7,"method":"textDocument/hover","params":"\ud800"}"#), PARSE_ERROR, json!(7)),
        (body(r#"{"jsonrpc":"2.0","id":[],"method":"a"}"#), INVALID_REQUEST, Value::Null),
        (body(r#"{"jsonrpc":"2.0","id":8,"method":3}"#), INVALID_REQUEST, json!(8)),
        (body("[]"), INVALID_REQUEST, Value::Null),
        (body("7"), INVALID_REQUEST, Value::Null),
        ("Content-Length: 40000000000\r\n\r\n{}".to_owned(), PARSE_ERROR, Value::Null),
        ("Content-Length: -1\r\n\r\n{}".to_owned(), PARSE_ERROR, Value::Null),
        ("Content-Length: many\r\n\r\n{}".to_owned(), PARSE_ERROR, Value::Null),
        ("Content-Type: x\r\n\r\n{}".to_owned(), PARSE_ERROR, Value::Null),
        ("{\"id\":1}\r\n\r\n".to_owned(), PARSE_ERROR, Value::Null),
        ("\u{fffd}\u{0}garbage".to_owned(), PARSE_ERROR, Value::Null),
    ];
    let symbols = json!({ "textDocument": { "uri": uri } });
    for (bytes, code, id) in bad {
        editor.input.write_all(bytes.as_bytes()).unwrap();
        // The next message is read as if nothing had happened.
        editor.tell("$/nothing", Value::Null);
        assert_eq!(refused(&mut editor), (code, id), "{bytes:?}");
        assert_eq!(editor.ask("textDocument/documentSymbol", symbols.clone())[0]["name"], "a", "{bytes:?}");
    }
    // Half of a character that is being typed: the text stays in step with the editor's.
    let change = r#"{"jsonrpc":"2.0","method":"textDocument/didChange","params":{"textDocument":{"uri":"URI","version":2},
        "contentChanges":[{"range":{"start":{"line":0,"character":0},"end":{"line":0,"character":0}},"text":"// \ud834 b\n"}]}}"#;
    let change = change.replace("URI", &uri);
    editor.input.write_all(body(&change).as_bytes()).unwrap();
    assert_eq!(refused(&mut editor), (PARSE_ERROR, Value::Null));
    let place = editor.ask("textDocument/documentSymbol", symbols)[0]["range"]["start"].clone();
    assert_eq!(place, json!({ "line": 1, "character": 0 }));
    assert_eq!(editor.ask("shutdown", Value::Null), Value::Null);
    editor.tell("exit", Value::Null);
    assert!(editor.server.wait().unwrap().success());
}

#[test]
fn a_model_that_changes_on_disk_is_seen() {
    const MODEL: &str = "<mujoco><worldbody><body name=\"trunk\" pos=\"0 0 1\"><freejoint name=\"root\"/>\
        <geom name=\"ball\" size=\"0.1\" mass=\"1\"/></body></worldbody></mujoco>\n";
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    fs::write(root.join("ball.xml"), MODEL).unwrap();
    let text = "body ball {\n    model \"ball.xml\"\n    root trunk { forward x, up z }\n    pose neutral { }\n}\n";
    let uri = format!("file://{}/ball.msk", root.display());
    let mut editor = Editor::start(&root);
    editor.ask("initialize", json!({ "processId": null, "capabilities": {} }));
    let document = json!({ "uri": uri, "languageId": "msk", "version": 1, "text": text });
    editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
    assert_eq!(editor.codes(&uri), Vec::<String>::new());
    fs::write(root.join("ball.xml"), MODEL.replace("trunk", "torso")).unwrap();
    editor.tell("textDocument/didSave", json!({ "textDocument": { "uri": uri } }));
    assert_eq!(editor.codes(&uri), ["E0209"]);
    fs::write(root.join("ball.xml"), MODEL).unwrap();
    editor.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": uri } }));
    assert_eq!(editor.codes(&uri), Vec::<String>::new());
}

//! What goes wrong in a conversation ends neither it nor the server, is answered or logged, and leaves nothing stale behind.

#[allow(dead_code, reason = "the other tests use the rest")]
use crate::support;

use lsp_types::Position;
use msk_lsp::Ended;
use serde_json::json;
use support::{Client, at, task, uri};

const A: &str = "/project/a.msk";
const B: &str = "/project/b.msk";

const INTERNAL_ERROR: i32 = -32603;
const INVALID_PARAMS: i32 = -32602;

fn sound() -> String {
    task("    reward { 1 tall = pelvis.height / 1 m }")
}

#[test]
fn an_initialize_that_cannot_be_read_is_refused_and_the_next_one_is_taken() {
    let mut client = Client::new(&[]);
    assert_eq!(client.ask("initialize", json!({ "capabilities": 3 })).unwrap_err().0, INVALID_PARAMS);
    assert_eq!(client.ask("initialize", json!([])).unwrap_err().0, INVALID_PARAMS);
    assert_eq!(client.log.len(), 2);
    client.greet("file:///project", json!({}));
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn notifications_that_cannot_be_followed_are_logged() {
    let mut client = Client::ready(&[]);
    client.open(A, &sound());
    assert!(client.codes(A, Some(1)).is_empty());
    let bad = [
        ("textDocument/didOpen", json!({ "nonsense": true }), "missing field `textDocument`"),
        ("textDocument/didChange", json!({ "textDocument": { "uri": uri(A) } }), "missing field `version`"),
        ("textDocument/didChange", json!(7), "invalid type"),
        ("textDocument/didClose", json!({ "textDocument": { "uri": uri(B) } }), "`/project/b.msk` is not open"),
        ("textDocument/didInvent", json!({}), "unknown method"),
    ];
    for (method, params, reason) in bad {
        client.tell(method, params);
        client.ask_at("textDocument/hover", A, Position::new(0, 0)).unwrap();
        let line = client.log.pop().unwrap();
        assert!(line.contains(method) && line.contains(reason), "{line}");
    }
    client.change(A, 0, "task");
    client.ask_at("textDocument/hover", A, Position::new(0, 0)).unwrap();
    assert!(client.log.pop().unwrap().contains("the document has version 1"));
    client.tell("$/setTrace", json!({ "value": "off" }));
    assert_eq!(client.ask("textDocument/hover", json!({ "position": 3 })).unwrap_err().0, INVALID_PARAMS);
    assert_eq!(client.log.len(), 1);
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn a_panic_at_one_text_is_reported_there_and_the_other_texts_are_served() {
    let mut client = Client::ready(&[]);
    client.open(A, "body panic {\n    model \"panic.xml\"\n    root pelvis { forward x, up z }\n}\n");
    client.open(B, &task("    reward { 1 tall = pelvis.hight / 1 m }"));
    assert_eq!(client.codes(B, Some(1)), ["E0202"]);
    let diagnostics = &client.published[&uri(A)].diagnostics;
    assert!(diagnostics[0].message.contains("this body makes the compiler panic"), "{diagnostics:?}");
    assert!(client.ask_at("textDocument/hover", A, Position::new(0, 0)).is_ok());
    // The text goes on where it was: what is typed next counts.
    let range = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 4, "character": 0 } });
    let document = json!({ "uri": uri(A), "version": 2 });
    client.tell(
        "textDocument/didChange",
        json!({ "textDocument": document, "contentChanges": [{ "range": range, "text": sound() }] }),
    );
    assert!(client.codes(A, Some(2)).is_empty());
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn a_panic_within_a_request_is_its_answer() {
    let mut client = Client::new(&[]);
    client.greet("file:///panic", json!({}));
    client.open(A, &sound());
    for _ in 0..3 {
        let (code, message) = client.ask_at("textDocument/documentHighlight", A, Position::new(8, 20)).unwrap_err();
        assert_eq!(code, INTERNAL_ERROR);
        assert!(message.contains("this folder makes the server panic"), "{message}");
        assert!(client.log.pop().unwrap().contains(&message));
    }
    client.change(A, 2, &task("    reward { 1 tall = pelvis.hight / 1 m }"));
    assert_eq!(client.codes(A, Some(2)), ["E0202"]);
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn files_that_change_on_disk_are_seen_without_a_word() {
    let user = format!("use \"b.msk\"\n{}", task("    reward { 1 tall = high(pelvis) }"));
    let mut client = Client::ready(&[(B, "fn high(x) = x.height / 1 m\n")]);
    client.open(A, &user);
    assert!(client.codes(A, Some(1)).is_empty());
    assert_ne!(client.ask("textDocument/definition", at(A, Position::new(8, 24))).unwrap(), json!([]));
    client.disk.write(B, "fn tall(x) = x.height / 1 m\n");
    assert_eq!(client.ask("textDocument/definition", at(A, Position::new(8, 24))), Ok(json!([])));
    while client.codes(A, Some(1)) != ["E0201"] {
        client.ask_at("textDocument/hover", A, Position::new(0, 0)).unwrap();
    }
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn a_model_that_changes_on_disk_is_seen_without_a_word() {
    let mut client = Client::ready(&[]);
    client.open(A, &sound());
    assert!(client.codes(A, Some(1)).is_empty());
    client.human.change();
    while client.codes(A, Some(1)).is_empty() {
        client.ask_at("textDocument/hover", A, Position::new(0, 0)).unwrap();
    }
    assert!(client.codes(A, Some(1)).iter().all(|code| code == "E0201"));
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn a_lone_carriage_return_ends_a_line() {
    let mut client = Client::ready(&[]);
    client.open(A, &format!("// one\r// two\r\n{}", task("    reward { 1 tall = pelvis.hight / 1 m }")));
    assert_eq!(client.codes(A, Some(1)), ["E0202"]);
    assert_eq!(client.published[&uri(A)].diagnostics[0].range.start, Position::new(9, 29));
    let range = json!({ "start": { "line": 9, "character": 29 }, "end": { "line": 9, "character": 34 } });
    let document = json!({ "uri": uri(A), "version": 2 });
    let change = json!([{ "range": range, "text": "height" }]);
    client.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": change }));
    assert!(client.codes(A, Some(2)).is_empty());
    assert_eq!(client.end(), Ended::Properly);
}

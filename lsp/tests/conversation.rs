//! How a conversation with the language server begins, goes on and ends.

#[allow(dead_code, reason = "the other tests use the rest")]
use crate::support;

use lsp_types::Position;
use msk_lsp::Ended;
use serde_json::{Value, json};
use support::{Client, at, task, uri};

const A: &str = "/project/a.msk";
const B: &str = "/project/b.msk";

fn sound() -> String {
    task("    reward { 1 tall = pelvis.height / 1 m }")
}

#[test]
fn before_initialize_and_after_shutdown_requests_are_refused() {
    let mut client = Client::new(&[]);
    assert_eq!(client.ask("textDocument/hover", at(A, Position::new(0, 0))).unwrap_err().0, -32002);
    client.tell("textDocument/didOpen", json!({ "nonsense": true }));
    client.ask("initialize", json!({ "capabilities": {} })).unwrap();
    client.tell("initialized", json!({}));
    assert_eq!(client.ask("initialize", json!({ "capabilities": {} })).unwrap_err().0, -32600);
    assert_eq!(client.ask("shutdown", Value::Null), Ok(Value::Null));
    assert_eq!(client.ask("textDocument/hover", at(A, Position::new(0, 0))).unwrap_err().0, -32600);
    assert_eq!(client.leave(), Ended::Properly);
}

#[test]
fn an_exit_without_shutdown_is_no_proper_end() {
    assert_eq!(Client::ready(&[]).leave(), Ended::Abruptly);
    assert_eq!(Client::new(&[]).leave(), Ended::Abruptly);
    assert_eq!(Client::ready(&[]).end(), Ended::Properly);
}

#[test]
fn errors_come_while_typing_and_go_when_mended() {
    let mut client = Client::ready(&[]);
    client.open(A, &task("    reward { 1 tall = pelvis.hight / 1 m }"));
    assert_eq!(client.codes(A, Some(1)), ["E0202"]);
    client.change(A, 2, &sound());
    assert!(client.codes(A, Some(2)).is_empty());
    client.change(A, 3, &task("    reward { 1 tall = pelvis.height }"));
    assert_eq!(client.codes(A, Some(3)), ["E0302"]);
    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri(A) } }));
    assert!(client.codes(A, None).is_empty());
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn texts_that_are_open_win_over_those_on_disk() {
    let library = "fn tall(x) = x.height / 1 m\n";
    let user = format!("use \"b.msk\"\n{}", task("    reward { 1 tall = high(pelvis) }"));
    let mut client = Client::ready(&[(B, library)]);
    client.open(A, &user);
    assert_eq!(client.codes(A, Some(1)), ["E0201"]);
    client.open(B, "fn high(x) = x.height / 1 m\n");
    while !client.codes(A, Some(1)).is_empty() {
        client.ask("textDocument/hover", at(A, Position::new(0, 0))).unwrap();
    }
    // An error in the library is reported at its place, with the call that leads to it.
    client.change(B, 2, "fn high(x) = x.height\n");
    assert_eq!(client.codes(B, Some(2)), Vec::<String>::new());
    while client.codes(A, Some(1)) != ["E0302"] {
        client.ask("textDocument/hover", at(A, Position::new(0, 0))).unwrap();
    }
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn changes_are_made_in_the_units_of_utf_16() {
    let mut client = Client::ready(&[]);
    let text = format!("// \u{1d11e}\u{e9} is no name\n{}", sound());
    client.open(A, &text);
    assert!(client.codes(A, Some(1)).is_empty());
    // Behind a character of two units and one of one: the comment ends there, what follows is no statement.
    let range = json!({ "start": { "line": 0, "character": 6 }, "end": { "line": 0, "character": 6 } });
    let document = json!({ "uri": uri(A), "version": 2 });
    let change = json!([{ "range": range, "text": "\n" }]);
    client.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": change }));
    assert_eq!(client.codes(A, Some(2)), ["E0115"]);
    let range = &client.published[&uri(A)].diagnostics[0].range;
    assert_eq!((range.start.line, range.start.character), (1, 1));
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn bytes_are_counted_where_the_client_prefers_them() {
    let mut client = Client::new(&[]);
    let wishes = json!({ "general": { "positionEncodings": ["utf-32", "utf-8", "utf-16"] } });
    let answer = client.ask("initialize", json!({ "capabilities": wishes })).unwrap();
    assert_eq!(answer["capabilities"]["positionEncoding"], "utf-8");
    client.tell("initialized", json!({}));
    client.open(A, "const a = 1 // \u{e9}\u{e9}\nconst b = missing\n");
    let edit = client.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": uri(A) } })).unwrap();
    assert_eq!(edit[0]["name"], "a");
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn messages_that_make_no_sense_change_nothing() {
    let mut client = Client::ready(&[]);
    client.open(A, &sound());
    assert!(client.codes(A, Some(1)).is_empty());
    // A change of a text that is not open, one that comes late, one that is none.
    client.change(B, 7, "task");
    client.change(A, 0, "task");
    client.tell("textDocument/didChange", json!({ "textDocument": { "uri": uri(A) } }));
    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri(B) } }));
    client.tell("workspace/didChangeWatchedFiles", json!({ "changes": [] }));
    client.tell("$/anything", json!(3));
    assert_eq!(client.ask("textDocument/hover", json!({ "position": 3 })).unwrap_err().0, -32602);
    assert_eq!(client.ask("textDocument/invented", json!({})).unwrap_err().0, -32601);
    assert_eq!(client.ask("textDocument/hover", at(B, Position::new(9, 9))), Ok(Value::Null));
    assert_eq!(client.ask("textDocument/hover", at(A, Position::new(9999, 9999))), Ok(Value::Null));
    // What is known of the text is what it was.
    client.change(A, 2, &sound());
    assert!(client.codes(A, Some(2)).is_empty());
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn a_range_that_does_not_exist_is_brought_into_the_text() {
    let mut client = Client::ready(&[]);
    client.open(A, "const a = 1");
    let range = json!({ "start": { "line": 9, "character": 9 }, "end": { "line": 0, "character": 11 } });
    let document = json!({ "uri": uri(A), "version": 2 });
    let change = json!([{ "range": range, "text": "\n// end\n" }]);
    client.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": change }));
    let layout = client.ask(
        "textDocument/formatting",
        json!({ "textDocument": { "uri": uri(A) }, "options": { "tabSize": 4, "insertSpaces": true } }),
    );
    assert_eq!(layout, Ok(json!([])));
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn what_is_cancelled_is_refused() {
    let mut client = Client::ready(&[]);
    client.open(A, &sound());
    // The three are sent at once, so that the request may still wait when its cancellation comes.
    let first = client.send("textDocument/completion", at(A, Position::new(7, 20)));
    let second = client.send("textDocument/completion", at(A, Position::new(7, 20)));
    client.tell("$/cancelRequest", json!({ "id": second.to_string().parse::<i32>().unwrap() }));
    let mut answers = Vec::new();
    for id in [first, second] {
        answers.push(client.answer_any_order(&id));
    }
    assert!(answers.iter().all(|answer| answer.is_ok() || matches!(answer, Err((-32800, _)))));
    assert_eq!(client.end(), Ended::Properly);
}

#[test]
fn huge_and_broken_texts_are_survived() {
    let mut client = Client::ready(&[]);
    client.open(A, &"// much\n".repeat(40_000));
    assert_eq!(client.codes(A, Some(1)), ["E0123"]);
    let mut version = 1;
    let whole = sound();
    let broken =
        ["task t { reward { 10 a = ", "((((((((", "}}}}{{{{", "\u{0}\u{feff}\u{1d11e}", "task t { let x = \"", "use \"b", ""];
    for text in broken.into_iter().map(str::to_owned).chain((0..whole.len()).step_by(37).map(|cut| whole[..cut].to_owned())) {
        version += 1;
        client.change(A, version, &text);
        for method in
            ["textDocument/hover", "textDocument/completion", "textDocument/definition", "textDocument/documentHighlight"]
        {
            client.ask_at(method, A, Position::new(0, 7)).unwrap();
            client.ask_at(method, A, Position::new(text.lines().count() as u32, 0)).unwrap();
        }
        client.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": uri(A) } })).unwrap();
    }
    assert_eq!(client.end(), Ended::Properly);
}

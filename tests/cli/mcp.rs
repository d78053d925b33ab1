//! `msk mcp`: the program speaks the protocol on its standard input and output, and ends with them.

use super::project::{LEAN, Project};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

#[test]
fn a_client_talks_over_standard_input_and_output() {
    let project = Project::lean();
    let mut command = project.command(&["mcp"]);
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut ask = |message: Value| {
        writeln!(input, "{message}").unwrap();
        if message["id"].is_null() {
            return Value::Null;
        }
        let answer: Value = serde_json::from_str(&output.next().unwrap().unwrap()).unwrap();
        assert_eq!(answer["id"], message["id"], "{answer}");
        answer["result"].clone()
    };
    let info = json!({ "protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": { "name": "test", "version": "1" } });
    let hello = ask(json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": info }));
    assert_eq!(hello["serverInfo"]["name"], "msk", "{hello}");
    ask(json!({ "jsonrpc": "2.0", "method": "notifications/initialized" }));
    let call = |id: u64, tool: &str, arguments: Value| json!({ "jsonrpc": "2.0", "id": id, "method": "tools/call", "params": { "name": tool, "arguments": arguments } });
    let listed = ask(call(2, "list_tasks", json!({})));
    assert_eq!(listed["structuredContent"]["tasks"][0]["task"], "lean", "{listed}");
    let wish = json!({ "file": "lean.msk", "weights": { "pose": 11.5 } });
    assert_eq!(ask(call(3, "apply_weights", wish))["structuredContent"]["written"], false);
    assert_eq!(project.read("lean.msk"), LEAN);
    let outside = json!({ "file": "../lean.msk", "weights": { "pose": 11.5 }, "dry_run": false });
    assert_eq!(ask(call(4, "apply_weights", outside))["isError"], true);
    drop(input);
    assert!(child.wait().unwrap().success());
}

#[test]
fn the_program_ends_with_its_input_whatever_still_runs() {
    let project = Project::lean();
    let long = LEAN.replace("20 steps", "100000 steps").replace("- 2 cm", "- 20 m");
    project.write("tasks.msk", &long);
    let mut command = project.command(&["mcp"]);
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap()).lines();
    let info = json!({ "protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": { "name": "test", "version": "1" } });
    writeln!(input, "{}", json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": info })).unwrap();
    output.next().unwrap().unwrap();
    let arguments = json!({ "task": "lean", "policy": "zero", "max_steps": 200_000, "max_seconds": 600 });
    let params = json!({ "name": "evaluate", "arguments": arguments });
    writeln!(input, "{}", json!({ "jsonrpc": "2.0", "id": 2, "method": "tools/call", "params": params })).unwrap();
    writeln!(input, "{}", json!({ "jsonrpc": "2.0", "id": 3, "method": "ping" })).unwrap();
    let pong: Value = serde_json::from_str(&output.next().unwrap().unwrap()).unwrap();
    assert_eq!(pong["id"], 3, "the evaluation has begun and is not answered: {pong}");
    drop(input);
    // A tenth of the evaluation's budget.
    let start = std::time::Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed().as_secs() > 60 {
            child.kill().unwrap();
            panic!("the server lives on");
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert!(child.wait().unwrap().success());
}

#[test]
fn a_project_that_is_not_there_is_reported() {
    Project::lean().msk(&["mcp", "--project", "none"]).failed(1, &["none"]);
}

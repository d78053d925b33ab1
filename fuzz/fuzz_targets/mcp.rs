//! Any lines given to the server for agents, behind a proper handshake: every request is answered, nothing panics, and nothing
//! outside of the project is shown or changed.
//!
//! The project is a folder on disk, written anew for each input; beside it lies what no answer may hold.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msk_mcp::Server;
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::Duration;
use tempfile::TempDir;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader};
use tokio::runtime::Runtime;

/// How a conversation begins.
const HANDSHAKE: &str = include_str!("../seeds/mcp-beginning.jsonl");
/// What lies beside the project.
const OUTSIDE: &str = "a secret beside the project";
/// Files of the project.
const FILES: [(&str, &str); 4] = [
    ("tasks.msk", include_str!("../seeds/mcp-project/tasks.msk")),
    ("weights.toml", "[swing]\nstill = 2\n"),
    ("bodies/puppet.msk", include_str!("../seeds/mcp-project/puppet.msk")),
    ("bodies/puppet.xml", include_str!("../seeds/mcp-project/puppet.xml")),
];
/// How long an answer may take: evaluations have a budget far below.
const PATIENCE: Duration = Duration::from_secs(15);

/// The folder that holds the project and what lies beside it.
fn ground() -> &'static TempDir {
    static GROUND: OnceLock<TempDir> = OnceLock::new();
    GROUND.get_or_init(|| {
        let ground = tempfile::tempdir().expect("a temporary folder");
        fs::write(ground.path().join("outside.msk"), OUTSIDE).expect("a file");
        ground
    })
}

/// The project as it is before any message.
fn project() -> PathBuf {
    let project = ground().path().join("project");
    let _ = fs::remove_dir_all(&project);
    fs::create_dir_all(project.join("bodies")).expect("a folder");
    for (name, text) in FILES {
        fs::write(project.join(name), text).expect("a file");
    }
    project
}

fn runtime() -> &'static Runtime {
    static RUNTIME: OnceLock<Runtime> = OnceLock::new();
    RUNTIME.get_or_init(|| tokio::runtime::Builder::new_current_thread().enable_all().build().expect("an executor"))
}

/// The id of a request, as JSON, if the line is one that must be answered under it.
fn request(line: &str) -> Option<String> {
    let message: Value = serde_json::from_str(line).ok()?;
    let proper = message.get("jsonrpc")?.as_str() == Some("2.0") && message.get("method")?.is_string();
    let id = message.get("id").filter(|id| id.is_i64() || id.is_string())?;
    proper.then(|| id.to_string())
}

fuzz_target!(|text: &str| {
    let server = Server::new(&project()).expect("a project");
    runtime().block_on(async {
        let (here, there) = tokio::io::duplex(1 << 20);
        let (input, output) = tokio::io::split(there);
        let serving = tokio::spawn(server.converse(input, output));
        let (output, mut input) = tokio::io::split(here);
        let mut answers = BufReader::new(output).lines();
        for line in HANDSHAKE.lines().chain(text.lines()) {
            if input.write_all(format!("{line}\n").as_bytes()).await.is_err() {
                break;
            }
            let Some(id) = request(line) else { continue };
            loop {
                let next = tokio::time::timeout(PATIENCE, answers.next_line()).await;
                let answer = next.unwrap_or_else(|_| panic!("no answer to {line}\nof {text:?}")).expect("a text");
                let Some(answer) = answer else { panic!("the conversation ended at {line}\nof {text:?}") };
                assert!(!answer.contains(OUTSIDE), "told what lies outside: {text:?}");
                let answer: Value = serde_json::from_str(&answer).expect("JSON");
                if answer.get("method").is_none() && answer.get("id").is_some_and(|found| found.to_string() == id) {
                    break;
                }
            }
        }
        drop((input, answers));
        let ended = tokio::time::timeout(PATIENCE, serving).await;
        let _ = ended.expect("the server ends with its client").expect("it does not panic");
    });
    let outside = fs::read_to_string(ground().path().join("outside.msk"));
    assert_eq!(outside.expect("it stays"), OUTSIDE);
    assert_eq!(fs::read_dir(ground().path()).expect("a folder").count(), 2, "something new lies outside: {text:?}");
});

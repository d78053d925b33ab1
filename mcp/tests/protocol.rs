//! Lines that a client should not send, requests that it cancels, and more requests than are taken: all are answered, none ends the server.

use msk_mcp::{LONGEST_LINE, ServeError, Server, WAITING_EVALUATIONS};
use serde_json::{Value, json};
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader, DuplexStream, ReadHalf, WriteHalf};
use tokio::task::JoinHandle;

/// An episode of a task that lasts for minutes, and one of five steps.
const TASKS: &str = "
task long {
    body     human
    control  100 Hz
    horizon  100000 steps
    init { pose neutral; root { height on ground } }
    observe { pelvis.height }
    reward { 1 alive = not terminated }
    terminate { sunk when pelvis.height < -10 m }
    success survived
}
task short extends long {
    horizon 5 steps
}
";

/// How long an answer may take before the test fails instead of hanging.
const WATCHDOG: Duration = Duration::from_secs(120);

async fn watched<T>(what: &str, future: impl Future<Output = T>) -> T {
    tokio::time::timeout(WATCHDOG, future).await.unwrap_or_else(|_| panic!("{what}: nothing happened"))
}

/// A client that writes and reads lines.
struct Client {
    _folder: tempfile::TempDir,
    input: WriteHalf<DuplexStream>,
    output: BufReader<ReadHalf<DuplexStream>>,
    server: JoinHandle<Result<(), ServeError>>,
}

impl Client {
    fn connect() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("tasks.msk"), TASKS).unwrap();
        let (here, there) = tokio::io::duplex(1 << 16);
        let server = Server::new(folder.path()).unwrap();
        let (input, output) = tokio::io::split(there);
        let server = tokio::spawn(server.converse(input, output));
        let (output, input) = tokio::io::split(here);
        Self { _folder: folder, input, output: BufReader::new(output), server }
    }

    async fn begin() -> Self {
        let mut client = Self::connect();
        client.initialize().await;
        client
    }

    async fn initialize(&mut self) {
        let info =
            json!({ "protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": { "name": "test", "version": "1" } });
        self.send(json!({ "jsonrpc": "2.0", "id": "hello", "method": "initialize", "params": info })).await;
        assert_eq!(self.hear().await["result"]["serverInfo"]["name"], "msk");
        self.send(json!({ "jsonrpc": "2.0", "method": "notifications/initialized" })).await;
    }

    async fn line(&mut self, line: &[u8]) {
        watched("writing", async {
            self.input.write_all(line).await.unwrap();
            self.input.write_all(b"\n").await.unwrap();
        })
        .await;
    }

    async fn send(&mut self, message: Value) {
        self.line(message.to_string().as_bytes()).await;
    }

    async fn hear(&mut self) -> Value {
        let mut line = String::new();
        watched("reading", self.output.read_line(&mut line)).await.unwrap();
        serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"))
    }

    async fn evaluate(&mut self, id: u64, task: &str) {
        let arguments = json!({ "task": task, "policy": "zero", "episodes": 1, "max_steps": 200_000, "max_seconds": 600 });
        let params = json!({ "name": "evaluate", "arguments": arguments });
        self.send(json!({ "jsonrpc": "2.0", "id": id, "method": "tools/call", "params": params })).await;
    }

    async fn cancel(&mut self, id: u64) {
        self.send(json!({ "jsonrpc": "2.0", "method": "notifications/cancelled", "params": { "requestId": id } })).await;
    }

    async fn still_answers(&mut self) {
        self.send(json!({ "jsonrpc": "2.0", "id": "still", "method": "ping" })).await;
        assert_eq!(self.hear().await, json!({ "jsonrpc": "2.0", "id": "still", "result": {} }));
    }
}

#[tokio::test]
async fn lines_that_are_no_messages_are_answered_with_errors() {
    let mut client = Client::begin().await;
    let deep = "[".repeat(100_000);
    let cases: [(&[u8], i64, Value); 17] = [
        (b"hello", -32700, json!(null)),
        (b"{\"jsonrpc\": \"2.0\",", -32700, json!(null)),
        (b"\xff\xfe", -32700, json!(null)),
        (deep.as_bytes(), -32700, json!(null)),
        // The parser refuses a lone surrogate; who asked waits for an answer all the same.
        (br#"{"jsonrpc":"2.0","method":"tools/call","params":{"name":"\ud800"},"id":7}"#, -32700, json!(7)),
        (b"{\"jsonrpc\":\"2.0\",\"method\":\"tools/call\",\"params\":{\"name\":\"\xff\"},\"id\":\"a\"}", -32700, json!("a")),
        (b"7", -32600, json!(null)),
        (b"null", -32600, json!(null)),
        (b"{}", -32600, json!(null)),
        (b"[]", -32600, json!(null)),
        (br#"[{"jsonrpc":"2.0","id":1,"method":"ping"}]"#, -32600, json!(null)),
        (br#"{"jsonrpc":"1.0","id":1,"method":"ping"}"#, -32600, json!(1)),
        (br#"{"id":2,"method":"ping"}"#, -32600, json!(2)),
        (br#"{"jsonrpc":"2.0","id":3}"#, -32600, json!(3)),
        (br#"{"jsonrpc":"2.0","id":4,"method":5}"#, -32600, json!(4)),
        (br#"{"jsonrpc":"2.0","id":null,"method":"ping"}"#, -32600, json!(null)),
        (br#"{"jsonrpc":"2.0","id":1.5,"method":"ping"}"#, -32600, json!(null)),
    ];
    for (line, code, id) in cases {
        let shown = String::from_utf8_lossy(&line[..line.len().min(80)]).into_owned();
        client.line(line).await;
        let answer = client.hear().await;
        assert_eq!((&answer["error"]["code"], answer.get("id")), (&json!(code), Some(&id)), "{shown}: {answer}");
        assert!(answer["error"]["message"].as_str().is_some_and(|message| !message.is_empty()), "{shown}: {answer}");
        client.still_answers().await;
    }
    // Requests that are messages, but not of this server.
    for request in [
        json!({ "jsonrpc": "2.0", "id": 8, "method": "no/such/method" }),
        json!({ "jsonrpc": "2.0", "id": 8, "method": "tools/call", "params": 5 }),
        json!({ "jsonrpc": "2.0", "id": 8, "method": "tools/call", "params": { "name": "no_such_tool" } }),
        json!({ "jsonrpc": "2.0", "id": 8, "method": "tools/call", "params": { "name": "evaluate", "arguments": { "task": 5 } } }),
    ] {
        client.send(request.clone()).await;
        let answer = client.hear().await;
        assert_eq!(answer["id"], 8, "{request}: {answer}");
        assert!(answer["error"].is_object() || answer["result"]["isError"] == true, "{request}: {answer}");
    }
    // A cancelled request is not answered.
    for silent in [
        "",
        "  \r",
        r#"{"jsonrpc":"2.0","method":"$/setTrace"}"#,
        r#"{"jsonrpc":"2.0","method":"notifications/cancelled","params":5}"#,
        r#"{"jsonrpc":"2.0","id":9,"result":{}}"#,
    ] {
        client.line(silent.as_bytes()).await;
    }
    client.still_answers().await;
}

#[tokio::test]
async fn a_request_over_the_limit_is_refused_under_its_id() {
    let mut client = Client::begin().await;
    let text = "a".repeat(LONGEST_LINE + 1);
    let first = format!(
        r#"{{"jsonrpc":"2.0","id":5,"method":"tools/call","params":{{"name":"check","arguments":{{"text":"{text}"}}}}}}"#
    );
    let last = format!(
        r#"{{"method":"tools/call","params":{{"name":"check","arguments":{{"text":"{text}"}}}},"jsonrpc":"2.0","id":6}}"#
    );
    for (line, id) in [(first, json!(5)), (last, json!(6)), (text, json!(null))] {
        // The server answers while it still reads: both directions must flow.
        let line = line + "\n";
        let mut reply = String::new();
        let talk = async { tokio::join!(client.input.write_all(line.as_bytes()), client.output.read_line(&mut reply)) };
        watched("a long line", talk).await.0.unwrap();
        let answer: Value = serde_json::from_str(&reply).unwrap();
        assert_eq!((&answer["error"]["code"], answer.get("id")), (&json!(-32600), Some(&id)), "{answer}");
        assert!(answer["error"]["message"].as_str().unwrap().contains(&LONGEST_LINE.to_string()), "{answer}");
        client.still_answers().await;
    }
    // The largest text fits, however it is escaped.
    let text = "\\u0020".repeat(256 * 1024);
    client
        .line(
            format!(
                r#"{{"jsonrpc":"2.0","id":7,"method":"tools/call","params":{{"name":"check","arguments":{{"text":"{text}"}}}}}}"#
            )
            .as_bytes(),
        )
        .await;
    assert_eq!(client.hear().await["result"]["isError"], false);
}

#[tokio::test]
async fn messages_before_the_handshake_do_not_end_the_server() {
    let mut client = Client::connect();
    client.line(b"hello").await;
    assert_eq!(client.hear().await["error"]["code"], -32700);
    client.send(json!({ "jsonrpc": "2.0", "method": "notifications/initialized" })).await;
    client.send(json!({ "jsonrpc": "2.0", "id": 1, "result": {} })).await;
    client.still_answers().await;
    client.send(json!({ "jsonrpc": "2.0", "id": 2, "method": "tools/list" })).await;
    assert!(client.hear().await["error"].is_object());
    client.cancel(2).await;
    client.initialize().await;
    client.still_answers().await;
}

#[tokio::test]
async fn a_server_that_nobody_asks_ends_with_its_input() {
    let Client { input, output, server, .. } = Client::connect();
    drop((input, output));
    watched("the end", server).await.unwrap().unwrap();
}

#[tokio::test]
async fn beyond_one_evaluation_per_core_and_a_few_that_wait_the_server_is_busy() {
    let mut client = Client::begin().await;
    let cores = std::thread::available_parallelism().unwrap().get();
    let taken = (cores + WAITING_EVALUATIONS) as u64;
    let refused = 5;
    for id in 0..taken + refused {
        client.evaluate(id, "long").await;
    }
    for _ in 0..refused {
        let answer = client.hear().await;
        assert!(answer["id"].as_u64().unwrap() >= taken, "{answer}");
        let content = &answer["result"]["structuredContent"];
        assert_eq!((&answer["result"]["isError"], &content["busy"]), (&json!(true), &json!(true)), "{answer}");
        assert!(
            content["error"].as_str().unwrap().contains(&format!("{cores} calls run and {WAITING_EVALUATIONS} wait")),
            "{answer}"
        );
    }
    // Other tools and messages do not wait behind evaluations.
    client.still_answers().await;
    client
        .send(json!({ "jsonrpc": "2.0", "id": 100, "method": "tools/call", "params": { "name": "list_tasks", "arguments": {} } }))
        .await;
    assert_eq!(client.hear().await["result"]["isError"], false);
    // Waiting and running ones are cancelled, and make room: within a step, not after the ten minutes of their budgets.
    for id in 0..taken {
        client.cancel(id).await;
    }
    client.evaluate(200, "short").await;
    let answer = client.hear().await;
    assert_eq!((&answer["id"], &answer["result"]["structuredContent"]["steps"]), (&json!(200), &json!(5)), "{answer}");
}

#[tokio::test]
async fn an_id_in_use_is_refused() {
    let mut client = Client::begin().await;
    client.evaluate(1, "long").await;
    client.evaluate(1, "short").await;
    let answer = client.hear().await;
    assert_eq!((&answer["error"]["code"], &answer["id"]), (&json!(-32600), &json!(1)), "{answer}");
    client.cancel(1).await;
    client.still_answers().await;
}

#[tokio::test]
async fn a_client_that_does_not_read_is_not_read_from() {
    let mut client = Client::begin().await;
    let ping = json!({ "jsonrpc": "2.0", "id": 0, "method": "ping" }).to_string().len() as u64;
    let mut written = 0;
    // Far more than all buffers between the two hold.
    for id in 0..1_000_000 {
        let line = format!("{}\n", json!({ "jsonrpc": "2.0", "id": id, "method": "ping" }));
        let written_in_time = tokio::time::timeout(Duration::from_secs(5), client.input.write_all(line.as_bytes())).await;
        if written_in_time.is_err() {
            break;
        }
        written += 1;
    }
    assert!(written * ping < 1 << 20, "{written} requests were taken without an answer");
}

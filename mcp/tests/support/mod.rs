//! A real client of the server, connected within the process.

use msk_mcp::Server;
use rmcp::model::CallToolRequestParams;
use rmcp::service::RunningService;
use rmcp::{RoleClient, ServiceExt};
use serde_json::Value;
use std::path::Path;
use std::time::Duration;

/// A client.
pub type Client = RunningService<RoleClient, ()>;

/// A client of a server for the project in `folder`.
pub async fn connect(folder: &Path) -> Client {
    let (here, there) = tokio::io::duplex(1 << 16);
    let (input, output) = tokio::io::split(there);
    tokio::spawn(Server::new(folder).unwrap().converse(input, output));
    ().serve(here).await.unwrap()
}

/// The answer of a tool, and whether it is an error.
pub async fn call(client: &Client, tool: &'static str, arguments: Value) -> (Value, bool) {
    let Value::Object(arguments) = arguments else { panic!("no object") };
    let call = client.call_tool(CallToolRequestParams::new(tool).with_arguments(arguments));
    // A tool that waits, for a pipe for example, would hang the test.
    let result = tokio::time::timeout(Duration::from_secs(120), call).await.expect("the tool hangs").unwrap();
    (result.structured_content.unwrap(), result.is_error == Some(true))
}

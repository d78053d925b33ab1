//! A real client of the server, connected within the process.

use msk_mcp::Server;
use rmcp::model::CallToolRequestParams;
use rmcp::service::RunningService;
use rmcp::{RoleClient, ServiceExt};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
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

/// A throw-away folder and a client of a server for the project in it.
pub struct Talk {
    pub folder: tempfile::TempDir,
    pub client: Client,
}

impl Talk {
    /// A client of a server for the folder `project` of `folder`, which may be `.`.
    pub async fn within(folder: tempfile::TempDir, project: &str) -> Self {
        Self { client: connect(&folder.path().join(project)).await, folder }
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The text of a file in the folder.
    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// The answer of a tool, and whether it is an error.
    pub async fn call(&self, tool: &'static str, arguments: Value) -> (Value, bool) {
        call(&self.client, tool, arguments).await
    }

    /// The answer of a tool, which is no error.
    pub async fn ask(&self, tool: &'static str, arguments: Value) -> Value {
        let (answer, error) = self.call(tool, arguments).await;
        assert!(!error, "{answer}");
        answer
    }

    /// The error that a tool reports.
    pub async fn refused(&self, tool: &'static str, arguments: Value) -> String {
        let (answer, error) = self.call(tool, arguments).await;
        assert!(error, "{answer}");
        answer.to_string()
    }

    /// The text of an answer of a tool, whether it is an error or not.
    pub async fn text_of(&self, tool: &'static str, arguments: Value) -> String {
        self.call(tool, arguments).await.0.to_string()
    }
}

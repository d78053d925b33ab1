//! The task language for agents: a server of the Model Context Protocol over standard input and output.
//!
//! * Tools list tasks and terms, explain, check a text, propose and apply weights, run a few episodes, compare, read results.
//! * Resources are the reference of the language, the vocabulary of the human body, and how to edit weights.
//! * Everything happens inside one folder, the project. A path that leads out of it, also through a link, is refused; and what
//!   writes only says what it would write, unless it is told to.

mod confine;
mod evaluation;
mod project;
mod resources;
mod server;
mod weights;

pub use confine::{Confined, Outside};
pub use server::Server;

use rmcp::ServiceExt;
use std::path::Path;

/// Why the server ended before its client did.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The project cannot be used.
    #[error(transparent)]
    Project(#[from] Outside),
    /// The operating system gives no threads or no standard input and output.
    #[error("cannot serve on standard input and output")]
    System(#[from] std::io::Error),
    /// The client did not speak the protocol.
    #[error("the client does not speak the Model Context Protocol: {0}")]
    Client(String),
}

/// Serves the project in `root` until the client closes standard input.
///
/// # Errors
/// A folder that cannot be used, or a client that does not speak the protocol.
pub fn serve(root: &Path) -> Result<(), ServeError> {
    let server = Server::new(root)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let running = server.serve(rmcp::transport::stdio()).await.map_err(|error| ServeError::Client(error.to_string()))?;
        running.waiting().await.map_err(|error| ServeError::Client(error.to_string()))?;
        Ok(())
    })
}

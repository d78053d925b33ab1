//! The task language for agents: a server of the Model Context Protocol over standard input and output.
//!
//! * Tools list tasks and terms, explain, check a text, propose and apply weights, run a few episodes, compare, read results, and let an
//!   agent control a body directly, one decision after the other.
//! * Resources are the reference of the language, the vocabulary of the human body, and how to edit weights.
//! * Everything happens beneath one opened folder, the project: what a path, a link or a model's file names lead to elsewhere is
//!   neither read nor written, and no client learns whether it exists. Tools that write only report what they
//!   would write, unless asked to write.
//! * Every line is answered, one evaluation runs on each core, and a client that cancels or goes away stops what it started.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod confine;
mod evaluation;
mod project;
mod queue;
mod resources;
mod server;
mod session;
mod transport;
mod weights;

pub use confine::{Confined, Outside};
pub use server::{Server, WAITING_EVALUATIONS};
pub use transport::LONGEST_LINE;

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
    let served = runtime.block_on(server.converse(tokio::io::stdin(), tokio::io::stdout()));
    // A read of standard input, or a write to an output without a reader, would be waited for.
    runtime.shutdown_background();
    served
}

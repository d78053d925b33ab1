//! Language server of `.msk` files, over the Language Server Protocol.
//!
//! 1. `server` reads messages one after the other and answers them; there are no threads and no time-outs in it.
//! 2. `workspace` holds the open texts over the files on disk, and asks the compiler what it understood of them; what is
//!    asked twice is compiled once.
//! 3. `index` knows which word means which declaration, from the syntax trees alone, so that names can be followed and
//!    renamed in texts that do not compile.
//! 4. each kind of question has a file of its own: `hover`, `completion`, `navigation`, `rename`, `symbols`, `actions`, `hints`,
//!    `layout`, `report`.
//!
//! The server opens no file and knows no physics: texts and bodies come from the [`Loader`] and the [`BodySource`] that it is
//! given. Positions are counted in UTF-16 units unless the client prefers bytes.

mod actions;
mod completion;
mod hints;
mod hover;
mod index;
mod layout;
mod navigation;
mod paths;
mod positions;
mod rename;
mod report;
mod server;
mod symbols;
mod workspace;

use lsp_server::Connection;
use msk_compiler::files::{BodySource, Loader};

pub use server::Ended;

/// Why a conversation cannot be held.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The client did not begin as the protocol demands.
    #[error("the client does not speak the protocol: {0}")]
    Protocol(String),
}

/// Holds a conversation over `connection` until the client ends it.
///
/// `list` gives the `.msk` files below a folder: names are renamed in all files of the folders that the client has open.
///
/// # Errors
/// The client does not begin as the protocol demands. What goes wrong later is answered, never an end.
pub fn serve(
    connection: &Connection,
    loader: &dyn Loader,
    bodies: &dyn BodySource,
    list: &dyn Fn(&std::path::Path) -> Vec<std::path::PathBuf>,
) -> Result<Ended, ServeError> {
    server::serve(connection, loader, bodies, list)
}

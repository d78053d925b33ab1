//! Language server of `.msk` files, over the Language Server Protocol.
//!
//! 1. `transport` reads messages from a stream, whatever the stream holds, and writes answers to another.
//! 2. `server` takes messages one after the other and answers them; there are no threads and no time-outs in it.
//! 3. `workspace` holds the open texts over the files on disk, and asks the compiler what it understood of them; what is
//!    asked twice is compiled once, as long as every file that was read is what it was.
//! 4. which name means which declaration is the compiler's to say: its index ([`msk_compiler::resolve::index`]) resolves all names
//!    from the syntax trees, so that they can be followed and renamed in texts that do not compile.
//! 5. each kind of question has a file of its own: `hover`, `completion`, `navigation`, `rename`, `symbols`, `actions`, `hints`,
//!    `layout`, `report`.
//!
//! The server opens no file and knows no physics: texts and bodies come from the [`Loader`] and the [`BodySource`] that it is
//! given. Positions are counted in UTF-16 units unless the client prefers bytes.

// Results agree between machines to the bit: see `clippy.toml`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod actions;
mod completion;
mod edits;
mod hints;
mod hover;
mod inputs;
mod layout;
mod navigation;
mod paths;
mod positions;
mod rename;
mod report;
mod server;
mod symbols;
mod transport;
mod workspace;

use lsp_server::Connection;
use msk_compiler::files::{BodySource, Loader};

pub use server::Ended;
pub use transport::{Threads, connect};

/// Holds a conversation over `connection` until the client ends it.
///
/// `list` gives the `.msk` files below a folder: names are renamed in all files of the folders that the client has open.
///
/// Requests that cannot be answered get an error, notifications that cannot be followed are logged with `window/logMessage`; neither
/// ends the conversation. The same holds for a panic of the compiler.
pub fn serve(
    connection: &Connection,
    loader: &dyn Loader,
    bodies: &dyn BodySource,
    list: &dyn Fn(&std::path::Path) -> Vec<std::path::PathBuf>,
) -> Ended {
    server::serve(connection, loader, bodies, list)
}

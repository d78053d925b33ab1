//! `msk lsp`: the language server, for editors.

use crate::error::{Error, FAILURE};
use crate::terminal;
use crate::texts;
use msk::runtime::library::{BodyLibrary, FileLoader};
use msk_lsp::Ended;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Serve an editor: diagnostics while typing, hovers, completion, definitions, renaming, layout
///
/// Speaks the Language Server Protocol over standard input and output. Editors start it themselves;
/// grammar/editors/README.md describes the setup. Exit code 0 if the editor ended the session as the protocol requires, 1
/// otherwise.
#[derive(clap::Args)]
pub struct Args {
    /// Accepted because clients say so; there is no other way
    #[arg(long)]
    stdio: bool,
}

/// Serves until the editor ends the conversation.
///
/// # Errors
/// Standard input or output fails.
pub fn run(args: Args) -> Result<ExitCode, Error> {
    let Args { stdio: _ } = args;
    let (connection, threads) = msk_lsp::connect(io::stdin(), terminal::bytes())?;
    let bodies = BodyLibrary::default();
    // A folder that cannot be read holds no file that could be changed.
    let list = |folder: &Path| -> Vec<PathBuf> { texts::find(&[folder.to_path_buf()]).unwrap_or_default() };
    let ended = msk_lsp::serve(&connection, &FileLoader, &bodies, &list);
    drop(connection);
    let written = threads.join();
    if ended == Ended::Properly {
        written?;
        return Ok(ExitCode::SUCCESS);
    }
    Ok(ExitCode::from(FAILURE))
}

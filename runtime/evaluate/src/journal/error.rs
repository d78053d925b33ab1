//! What a folder of results refuses.

use msk_storage::StorageError;
use std::path::PathBuf;

/// Why a folder cannot serve as journal.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// A file of the folder cannot be read or written.
    #[error("cannot keep results in `{}`", folder.display())]
    Unusable {
        /// The folder.
        folder: PathBuf,
        /// Which file, and the reason.
        source: StorageError,
    },
    /// The folder holds the results of another run.
    #[error("`{}` contains another run: {difference}", folder.display())]
    OtherRun {
        /// The folder.
        folder: PathBuf,
        /// What is different.
        difference: String,
    },
    /// The folder holds episodes and nothing that names their run.
    #[error("`{}` contains episodes but no `run.json` that identifies their run", folder.display())]
    Unclaimed {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds no journal.
    #[error("`{}` contains no results: it has no `run.json`", folder.display())]
    Empty {
        /// The folder.
        folder: PathBuf,
    },
    /// A file of the folder is damaged, or somebody has changed it.
    #[error("`{}`, line {line}, was modified: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A line of the journal is of another run than the folder.
    #[error("`{}`, line {line}, belongs to another run than `run.json` beside it: {reason}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is different.
        reason: String,
    },
    /// Another process is writing there.
    #[error("another process is writing results to `{}`", folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
}

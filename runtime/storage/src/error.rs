//! What a file or folder refuses, in words for people.

use std::io;
use std::path::{Path, PathBuf};

/// Why a file or folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StorageError {
    /// The operating system refused.
    #[error("cannot {action} `{}`: {source}", path.display())]
    System {
        /// What was being done, as a verb.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The reason; it is part of the message.
        source: io::Error,
    },
    /// A path that leads out of the folder that was opened. The answer is the same whether anything exists there.
    #[error("`{}` leads out of the folder", path.display())]
    Outside {
        /// The path as it was asked for.
        path: PathBuf,
    },
    /// Something other than a regular file.
    #[error("`{}` is {found}; expected a regular file", path.display())]
    NotRegular {
        /// The path.
        path: PathBuf,
        /// What is there, with its article.
        found: &'static str,
    },
    /// A link where following one could change a file elsewhere.
    #[error("`{}` is a symbolic link, which is not followed here: replace the link with a regular file or folder", path.display())]
    Link {
        /// The link.
        path: PathBuf,
    },
    /// Larger than the caller's limit.
    #[error("`{}` is larger than the limit of {limit} bytes", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit, bytes.
        limit: u64,
    },
    /// Not UTF-8.
    #[error("`{}` is not UTF-8 text", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
    },
    /// A file that its owner has made read-only.
    #[error("`{}` is read-only: make it writable (`chmod u+w`) to let it be replaced", path.display())]
    ReadOnly {
        /// The file.
        path: PathBuf,
    },
    /// A path without a file name.
    #[error("`{}` does not name a file", path.display())]
    NoName {
        /// The path.
        path: PathBuf,
    },
    /// A log whose end could not be repaired after a failed append.
    #[error("`{}` is closed: an append failed and its remains could not be removed; open the log again", path.display())]
    Poisoned {
        /// The log.
        path: PathBuf,
    },
}

impl StorageError {
    /// Tells an attempt to leave the folder from other refusals: cap-std makes up the error itself, so it has no system code.
    pub(crate) fn new(action: &'static str, path: &Path, source: io::Error) -> Self {
        let path = path.to_path_buf();
        if source.kind() == io::ErrorKind::PermissionDenied && source.raw_os_error().is_none() {
            return Self::Outside { path };
        }
        Self::System { action, path, source }
    }

    /// The kind of the system's refusal, if the operating system refused.
    pub fn kind(&self) -> Option<io::ErrorKind> {
        match self {
            Self::System { source, .. } => Some(source.kind()),
            _ => None,
        }
    }

    /// The reason without the path, for a message that names the file in its own way and goes on after a colon.
    pub fn reason(&self) -> String {
        match self {
            Self::System { source, .. } => source.to_string(),
            Self::Outside { .. } => "the path leads out of the folder".into(),
            Self::NotRegular { found, .. } => format!("not a regular file, but {found}"),
            Self::Link { .. } => "a symbolic link, which is not followed here".into(),
            Self::TooLarge { limit, .. } => format!("larger than the limit of {limit} bytes"),
            Self::NotText { .. } => "not UTF-8 text".into(),
            Self::ReadOnly { .. } => "read-only".into(),
            Self::NoName { .. } => "the path does not name a file".into(),
            Self::Poisoned { .. } => "not written to any more".into(),
        }
    }
}

//! What can be wrong with a model file.

use super::advice::advice;
use super::values::shortened;
use core::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A line of a model file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file; empty for text that came without one.
    pub file: Arc<Path>,
    /// Line, counted from one.
    pub line: u32,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.file.as_os_str().is_empty() {
            write!(f, "line {}", self.line)
        } else {
            write!(f, "{}:{}", shown(&self.file), self.line)
        }
    }
}

/// A physical feature that the file asks for and the simulator does not have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unsupported {
    /// Where.
    pub place: Place,
    /// What: an element, an attribute of an element, or an attribute with its value.
    pub what: String,
}

impl Unsupported {
    /// What can be done about it.
    pub fn advice(&self) -> &'static str {
        advice(&self.what)
    }
}

/// Why a model could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The file does not exist, or could not or must not be read.
    #[error("cannot read {}: {reason}", shown(path))]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// The file is not what it should be: not text, not a mesh.
    #[error("{}: {reason}", shown(path))]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The text is not well-formed XML.
    #[error("{place}: not well-formed XML: {reason}")]
    Syntax {
        /// Where parsing stopped.
        place: Place,
        /// The parser's words.
        reason: String,
    },
    /// A value, name or structure that makes no sense.
    #[error("{place}: {message}")]
    Invalid {
        /// Where.
        place: Place,
        /// What, and what was expected.
        message: String,
    },
    /// Physical features that are not implemented: all of them.
    #[error("{}", list(.0))]
    Unsupported(Vec<Unsupported>),
}

/// A path for a message; a hostile file may name one of any length.
fn shown(path: &Path) -> String {
    const MOST: usize = 400;
    shortened(&path.display().to_string(), MOST)
}

/// The most unsupported features that are printed; the error holds them all.
const MOST_PRINTED: usize = 50;

fn list(items: &[Unsupported]) -> String {
    let mut text = format!("the model uses {} unsupported feature{}:", items.len(), if items.len() == 1 { "" } else { "s" });
    for (index, item) in items.iter().enumerate().take(MOST_PRINTED) {
        text.push_str(&format!("\n  {}: {}", item.place, item.what));
        // Reported once for a run of alike features.
        if items.get(index + 1).is_none_or(|next| next.advice() != item.advice()) || index + 1 == MOST_PRINTED {
            text.push_str(&format!("\n    help: {}", item.advice()));
        }
    }
    if items.len() > MOST_PRINTED {
        text.push_str(&format!("\n  and {} more", items.len() - MOST_PRINTED));
    }
    text
}

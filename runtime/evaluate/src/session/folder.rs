//! A session as files.

use super::{Comparison, Errors, Moment, Session, SessionError, Tracking, Visible};
use crate::MOST_BYTES;
use crate::trace::{ArchiveError, Trace};
use msk_storage::{Folder, StorageError};
use std::path::{Path, PathBuf};

/// Largest file but the trace that is read, bytes.
const LARGEST: u64 = 64 << 20;
const SESSION: &str = "session.json";
const LOCK: &str = ".lock";
/// What one who decides must not read.
const PRIVATE: &str = "private";
const TRACE: &str = "private/trace.npz";
const COMPARISON: &str = "private/tracking.json";

/// Why a folder cannot serve a session.
#[derive(Debug, thiserror::Error)]
pub enum SessionFolderError {
    /// A file cannot be read or written.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// There is none.
    #[error("`{}` has no session", .0.display())]
    Empty(PathBuf),
    /// There is one already.
    #[error("`{}` has a session already", .0.display())]
    Taken(PathBuf),
    /// A file is damaged.
    #[error("`{}` is damaged: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Another process takes a decision.
    #[error("another process takes a decision in `{}`", .0.display())]
    Busy(PathBuf),
    /// Its trace cannot be written.
    #[error("the trace cannot be kept: {0}")]
    Trace(#[from] ArchiveError),
    /// The session does not go on.
    #[error(transparent)]
    Session(#[from] SessionError),
}

/// A folder with a session.
#[derive(Debug, Clone)]
pub struct SessionFolder {
    folder: Folder,
}

impl SessionFolder {
    /// Writes a session that begins to a folder that has none.
    ///
    /// # Errors
    /// A folder that cannot be written, or has a session.
    pub fn begin(folder: Folder, moment: &Moment) -> Result<Self, SessionFolderError> {
        if folder.read(Path::new(SESSION), LARGEST)?.is_some() {
            return Err(SessionFolderError::Taken(folder.path().into()));
        }
        let this = Self { folder };
        this.write(moment)?;
        Ok(this)
    }

    /// The session of a folder.
    ///
    /// # Errors
    /// A folder that has none, or a damaged one.
    pub fn open(folder: Folder) -> Result<(Self, Session), SessionFolderError> {
        let text = folder.read_text(Path::new(SESSION), LARGEST)?;
        let text = text.ok_or_else(|| SessionFolderError::Empty(folder.path().into()))?;
        let damaged = |error: serde_json::Error| SessionFolderError::Damaged {
            path: folder.path().join(SESSION),
            reason: error.to_string(),
        };
        let session = serde_json::from_str(&text).map_err(damaged)?;
        Ok((Self { folder }, session))
    }

    /// Takes the next decision while no other process does: `decide` gives what it comes to, from the session as it is then.
    ///
    /// # Errors
    /// Those of `decide`, and a folder that cannot be written.
    pub fn decide<E: From<SessionFolderError>>(&self, decide: impl FnOnce(Session) -> Result<Moment, E>) -> Result<Moment, E> {
        let lock = self.folder.try_lock(Path::new(LOCK)).map_err(SessionFolderError::from)?;
        let _lock = lock.ok_or_else(|| SessionFolderError::Busy(self.folder.path().into()))?;
        let (_, session) = Self::open(self.folder.clone())?;
        let moment = decide(session)?;
        self.write(&moment)?;
        Ok(moment)
    }

    /// What is seen before a decision; `None` if there is none of that number.
    ///
    /// # Errors
    /// A damaged file.
    pub fn visible(&self, decision: usize) -> Result<Option<Visible>, SessionFolderError> {
        let name = visible_name(decision);
        let text = self.folder.read_text(Path::new(&name), LARGEST)?;
        let damaged = |error: serde_json::Error| SessionFolderError::Damaged {
            path: self.folder.path().join(&name),
            reason: error.to_string(),
        };
        text.map(|text| serde_json::from_str(&text).map_err(damaged)).transpose()
    }

    /// Every step so far, which one who decides must not see.
    ///
    /// # Errors
    /// A trace that is missing or damaged.
    pub fn trace(&self) -> Result<Trace, SessionFolderError> {
        let path = self.folder.path().join(TRACE);
        let bytes = self.folder.read(Path::new(TRACE), MOST_BYTES)?;
        let bytes = bytes.ok_or_else(|| SessionFolderError::Damaged { path: path.clone(), reason: "it is missing".into() })?;
        Trace::read(&bytes).map_err(|error| SessionFolderError::Damaged { path, reason: error.to_string() })
    }

    /// How closely it has followed the reference of its task; `None` if that has none.
    ///
    /// # Errors
    /// Those of [`trace`](Self::trace).
    pub fn tracking(&self) -> Result<Option<Tracking>, SessionFolderError> {
        Ok(Errors::of(&self.trace()?).and_then(|errors| errors.summary()))
    }

    /// Keeps the comparison of the session with a policy, for reports.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn keep(&self, comparison: &Comparison) -> Result<(), SessionFolderError> {
        let text = crate::journal::pretty(comparison) + "\n";
        Ok(self.folder.replace(Path::new(COMPARISON), text.as_bytes())?)
    }

    /// The comparison that was kept of a session, if it has taken no further step since.
    ///
    /// # Errors
    /// A damaged file.
    pub fn comparison(&self, session: &Session) -> Result<Option<Comparison>, SessionFolderError> {
        let Some(text) = self.folder.read_text(Path::new(COMPARISON), LARGEST)? else { return Ok(None) };
        let damaged = |error: serde_json::Error| SessionFolderError::Damaged {
            path: self.folder.path().join(COMPARISON),
            reason: error.to_string(),
        };
        let found: Comparison = serde_json::from_str(&text).map_err(damaged)?;
        Ok(Some(found).filter(|found| found.steps == session.steps()))
    }

    /// Writes what a decision has come to. The session itself comes last: until then nothing has happened.
    fn write(&self, moment: &Moment) -> Result<(), SessionFolderError> {
        self.folder.create_subfolder(Path::new(PRIVATE))?;
        self.folder.replace(Path::new(TRACE), &moment.trace.archive()?)?;
        if let Some(visible) = &moment.visible {
            let text = crate::journal::pretty(visible) + "\n";
            self.folder.replace(Path::new(&visible_name(visible.decision)), text.as_bytes())?;
        }
        let text = crate::journal::pretty(&moment.session) + "\n";
        Ok(self.folder.replace(Path::new(SESSION), text.as_bytes())?)
    }
}

fn visible_name(decision: usize) -> String {
    format!("decision-{decision:03}.json")
}

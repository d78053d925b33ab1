//! A text file that many programs may read and change at once, with its whole history.
//!
//! * A change is made under an advisory lock, which the operating system takes back when a program dies.
//! * The next text is prepared, the history is written, the file is replaced, in this order: whoever comes after a program that
//!   died in between finishes what it began, or finds that it had not begun.
//! * The file is replaced in one move, so readers need no lock and see one version or the next, never half of one.
//! * A version is the hash of the file's bytes. What an editor changed past this module is noted by the next change.

mod history;

pub use history::{Entry, OUTSIDE};

use sha2::{Digest, Sha256};
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Largest file that is read, bytes: no weights file comes near.
const LARGEST: u64 = 1 << 20;

/// Why a file cannot be read or changed.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The operating system refused.
    #[error("cannot {action} `{}`", path.display())]
    System {
        /// What was being done.
        action: &'static str,
        /// To which file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// A file that is no weights file.
    #[error("`{}` is larger than {LARGEST} bytes or no text", path.display())]
    NoText {
        /// The file.
        path: PathBuf,
    },
    /// The history holds something else than what is written there.
    #[error("the history `{}` is damaged, {line}: {reason}; move the file away to begin a new history", path.display())]
    History {
        /// The history.
        path: PathBuf,
        /// Which line, in words.
        line: String,
        /// What the parser says.
        reason: String,
    },
}

/// A whole file with its version.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Version {
    /// Hash of the bytes.
    pub hash: String,
    /// The text.
    pub text: String,
}

impl Version {
    /// Of a text.
    pub fn of(text: impl Into<String>) -> Self {
        let text = text.into();
        let digest = Sha256::digest(text.as_bytes());
        Self { hash: digest.iter().take(16).fold(String::new(), |hash, byte| hash + &format!("{byte:02x}")), text }
    }
}

/// What a change came to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome<T> {
    /// The file is this version now.
    Changed(Version, T),
    /// The change leaves the file as it is.
    Same(Version, T),
}

/// The lock of a file, held.
#[derive(Debug)]
pub struct Held {
    _lock: File,
}

/// A file with its lock and history, which lie in the folder `.msk` beside it.
#[derive(Debug, Clone)]
pub struct Store {
    path: PathBuf,
    aside: PathBuf,
    name: OsString,
}

impl Store {
    /// The store of a file, which need not exist yet. A link is followed, so that what it leads to is changed.
    pub fn new(path: &Path) -> Self {
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let name = path.file_name().unwrap_or_default().to_os_string();
        let aside = path.parent().unwrap_or(Path::new("")).join(".msk");
        Self { path, aside, name }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file as it is now; `None` if there is none. Needs no lock.
    ///
    /// # Errors
    /// A file that cannot be read or is no text.
    pub fn read(&self) -> Result<Option<Version>, StoreError> {
        let size = match fs::metadata(&self.path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            metadata => metadata.map_err(|source| self.cannot("read", &self.path, source))?.len(),
        };
        if size > LARGEST {
            return Err(StoreError::NoText { path: self.path.clone() });
        }
        match fs::read(&self.path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            bytes => {
                let bytes = bytes.map_err(|source| self.cannot("read", &self.path, source))?;
                let text = String::from_utf8(bytes).map_err(|_| StoreError::NoText { path: self.path.clone() })?;
                Ok(Some(Version::of(text)))
            }
        }
    }

    /// Changes the file: `change` gets the present version (an empty text if there is no file) and gives the next text and
    /// whatever else it has to say. Others wait meanwhile. If it fails nothing has happened.
    ///
    /// # Errors
    /// Those of `change`, or a file, lock or history that cannot be used.
    pub fn change<T, E: From<StoreError>>(
        &self,
        by: &str,
        change: impl FnOnce(&Version) -> Result<(String, T), E>,
    ) -> Result<Outcome<T>, E> {
        let _lock = self.lock()?;
        let present = self.recover()?;
        let before = present.clone().unwrap_or_else(|| Version::of(""));
        let (text, told) = change(&before)?;
        if present.is_some() && text == before.text {
            return Ok(Outcome::Same(before, told));
        }
        let next = Version::of(text);
        self.prepare(&next.text)?;
        self.append(&Entry::now(by, present.as_ref(), &next))?;
        self.commit()?;
        Ok(Outcome::Changed(next, told))
    }

    /// Keeps all others from changing the file while what comes back lives. It must not be asked for twice at once.
    ///
    /// # Errors
    /// A lock that cannot be made.
    pub fn hold(&self) -> Result<Held, StoreError> {
        Ok(Held { _lock: self.lock()? })
    }

    /// Replaces the file in one move, with the lock held, past the history of versions: for files that have another one.
    ///
    /// # Errors
    /// A file that cannot be written; it is then what it was.
    pub fn replace(&self, _: &Held, text: &str) -> Result<(), StoreError> {
        self.prepare(text)?;
        self.commit()
    }

    /// All changes in order, the first first. A line whose writing was cut short is not among them: it changed nothing.
    ///
    /// # Errors
    /// A history that cannot be read or is damaged.
    pub fn history(&self) -> Result<Vec<Entry>, StoreError> {
        Ok(history::read(&self.history_path())?.0)
    }

    /// Waits for the lock; it goes when the file is dropped, and when the program ends in whatever way.
    fn lock(&self) -> Result<File, StoreError> {
        fs::create_dir_all(&self.aside).map_err(|source| self.cannot("make", &self.aside, source))?;
        let path = self.beside(".lock");
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
        let file = file.map_err(|source| self.cannot("open", &path, source))?;
        file.lock().map_err(|source| self.cannot("lock", &path, source))?;
        Ok(file)
    }

    /// Brings file and history together, with the lock held: finishes a change that its program did not live to finish, and
    /// notes what was changed by others.
    fn recover(&self) -> Result<Option<Version>, StoreError> {
        let path = self.history_path();
        let (last, whole) = history::last(&path)?;
        if let Some(whole) = whole {
            // A line that was cut short stood for a change that had not begun.
            let file = OpenOptions::new().write(true).open(&path).map_err(|source| self.cannot("write", &path, source))?;
            file.set_len(whole).map_err(|source| self.cannot("write", &path, source))?;
        }
        let present = self.read()?;
        let hash = present.as_ref().map(|version| version.hash.as_str());
        match (&last, &present) {
            (Some(last), _) if hash == Some(last.version.as_str()) => Ok(present),
            (Some(last), _) if hash == last.before.as_deref() && self.prepared(last) => {
                self.commit()?;
                Ok(Some(Version::of(last.text.clone())))
            }
            (last, Some(found)) => {
                let known = last.as_ref().map(|last| Version::of(last.text.clone()));
                self.append(&Entry::now(OUTSIDE, known.as_ref(), found))?;
                Ok(present)
            }
            (_, None) => Ok(None),
        }
    }

    /// Whether the change stands ready beside the file: after a change that came to its end nothing does.
    fn prepared(&self, entry: &Entry) -> bool {
        fs::read(self.beside(".new")).is_ok_and(|bytes| bytes == entry.text.as_bytes())
    }

    /// Adds a line to the history, and waits until it is on the disk.
    fn append(&self, entry: &Entry) -> Result<(), StoreError> {
        let path = self.history_path();
        let cannot = |source| self.cannot("write", &path, source);
        let mut file = OpenOptions::new().create(true).append(true).open(&path).map_err(cannot)?;
        file.write_all(entry.line().as_bytes()).map_err(cannot)?;
        file.sync_data().map_err(cannot)
    }

    /// Writes the next text beside the file, with the lock held.
    fn prepare(&self, text: &str) -> Result<(), StoreError> {
        // Beside the file and of one name, so that a program that dies here leaves no litter; the lock keeps others from it.
        let fresh = self.beside(".new");
        let cannot = |source| self.cannot("write", &fresh, source);
        let mut file = File::create(&fresh).map_err(cannot)?;
        file.write_all(text.as_bytes()).map_err(cannot)?;
        if let Ok(before) = fs::metadata(&self.path) {
            file.set_permissions(before.permissions()).map_err(cannot)?;
        }
        file.sync_all().map_err(cannot)
    }

    /// Puts what has been prepared in the place of the file, in one move.
    fn commit(&self) -> Result<(), StoreError> {
        let fresh = self.beside(".new");
        fs::rename(&fresh, &self.path).map_err(|source| self.cannot("replace", &self.path, source))?;
        // The move itself lasts only once the folder is on the disk; where folders cannot be opened, it is left to the system.
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if let Ok(folder) = File::open(folder) {
            let _ = folder.sync_all();
        }
        Ok(())
    }

    fn history_path(&self) -> PathBuf {
        self.beside(".history.jsonl")
    }

    fn beside(&self, ending: &str) -> PathBuf {
        let mut name = self.name.clone();
        name.push(ending);
        self.aside.join(name)
    }

    fn cannot(&self, action: &'static str, path: &Path, source: io::Error) -> StoreError {
        StoreError::System { action, path: path.to_path_buf(), source }
    }
}

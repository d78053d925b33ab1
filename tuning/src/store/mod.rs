//! A text file that many programs may read and change at once, with its whole history.
//!
//! The folder `.msk` beside a file `NAME` has its lock, `NAME.lock`, and its history, `NAME.history.jsonl`. None of them may be a
//! link, so that a folder from somebody else leads nowhere.
//!
//! * A change is made under the lock, which the operating system takes back when a program dies.
//! * A line with the whole next text is appended to the history, the file is replaced in one move, and a second line records it.
//!   The next program after one that died before the second line writes it: the change was made unless the file still is what
//!   it was before. The file itself is never touched by that, so what a person has put there stays.
//! * Readers need no lock and see one version or the next, never half of one.
//! * A version is the hash of the file's bytes. What was changed past this module is noted by the next change, in the same line:
//!   a file that is what it was before a change whose second line is there was put back by hand.

mod history;

pub use history::{Entry, OUTSIDE};

use history::{Begun, End};
use msk_compiler::digest::hexadecimal;
use msk_compiler::weights::Change;
use msk_storage::{Folder, StorageError};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Largest file that is read or written, bytes: no weights file comes near.
const LARGEST: u64 = 1 << 20;
/// The folder of locks and histories.
const ASIDE: &str = ".msk";

/// Why a file cannot be read or changed.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The file, its lock or its history cannot be used.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// A path that ends in no name, or in one that is not UTF-8.
    #[error("`{}` does not end in a file name of UTF-8 text", path.display())]
    Name {
        /// The path.
        path: PathBuf,
    },
    /// The history holds something else than what is written there.
    #[error("the history `{}` is damaged, {line}: {reason}; move the file away to start a new history", path.display())]
    History {
        /// The history.
        path: PathBuf,
        /// Which line, in words.
        line: String,
        /// What is wrong with it.
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
        Self { hash: hexadecimal(&Sha256::digest(text.as_bytes())[..16]), text }
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

/// A file with its lock and history.
#[derive(Debug, Clone)]
pub struct Store {
    folder: Folder,
    name: String,
}

impl Store {
    /// The store of a file beneath `folder`, which need not exist yet; the folder that it lies in must.
    ///
    /// # Errors
    /// A path that leads out of the folder or names no file, or a folder that cannot be opened.
    pub fn new(folder: &Folder, path: &Path) -> Result<Self, StoreError> {
        let folder = folder.subfolder(path.parent().unwrap_or(Path::new("")))?;
        Self::of(folder, Path::new(path.file_name().unwrap_or_default()))
    }

    /// The store of a file that the user named, wherever it lies. A link is followed, so that what it leads to is changed.
    ///
    /// # Errors
    /// A path that names no file, or a folder that cannot be opened.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let (folder, name) = Folder::of_file(path)?;
        Self::of(folder, &name)
    }

    /// Lock and history are named after the file, so two files must not come to the same name.
    fn of(folder: Folder, name: &Path) -> Result<Self, StoreError> {
        match name.to_str().filter(|name| !name.is_empty()) {
            Some(name) => Ok(Self { name: name.into(), folder }),
            None => Err(StoreError::Name { path: folder.path().join(name) }),
        }
    }

    /// Where the file lies, for messages.
    pub fn path(&self) -> PathBuf {
        self.folder.path().join(&self.name)
    }

    /// The file as it is now; `None` if there is none. Needs no lock.
    ///
    /// # Errors
    /// A file that cannot be read, is larger than 1 MiB or no text.
    pub fn read(&self) -> Result<Option<Version>, StoreError> {
        Ok(self.folder.read_text(Path::new(&self.name), LARGEST)?.map(Version::of))
    }

    /// Changes the file: `change` gets the present version (an empty text if there is no file) and gives the next text and
    /// whatever else it has to return. Others wait meanwhile. If it fails nothing has happened.
    ///
    /// # Errors
    /// Those of `change`, or a file, lock or history that cannot be used.
    pub fn change<T, E: From<StoreError>>(
        &self,
        by: &str,
        change: impl FnOnce(&Version) -> Result<(String, T), E>,
    ) -> Result<Outcome<T>, E> {
        self.transact(by, change, |_| &[])
    }

    /// Changes weights of a source, like [`Store::change`], and keeps in the history which weights they are. Gives the changes.
    ///
    /// # Errors
    /// As there.
    pub fn edit<E: From<StoreError>>(
        &self,
        by: &str,
        edit: impl FnOnce(&Version) -> Result<(String, Vec<Change>), E>,
    ) -> Result<Vec<Change>, E> {
        let (Outcome::Changed(_, changes) | Outcome::Same(_, changes)) = self.transact(by, edit, |changes| changes)?;
        Ok(changes)
    }

    /// All changes that were made, in order, the first first. A line whose writing was cut short is not among them: it changed
    /// nothing. Needs no lock.
    ///
    /// # Errors
    /// A history that cannot be read or is damaged.
    pub fn history(&self) -> Result<Vec<Entry>, StoreError> {
        let Some(aside) = self.folder.existing_private_subfolder(ASIDE)? else { return Ok(Vec::new()) };
        let name = PathBuf::from(self.beside("history.jsonl"));
        let bytes = aside.read_private(&name, history::LARGEST)?.unwrap_or_default();
        // After the history, so that a change which is not in it is not taken for one that was made past the store.
        history::read(&bytes, &aside.path().join(name), self.read()?.as_ref())
    }

    /// The first change of every weight of a source that went through [`Store::edit`]: what going back to the beginning restores.
    ///
    /// # Errors
    /// Those of [`Store::history`].
    pub fn first_changes(&self) -> Result<Vec<Change>, StoreError> {
        let mut first: Vec<Change> = Vec::new();
        for change in self.history()?.into_iter().flat_map(|entry| entry.changes) {
            if !first.iter().any(|known| known.task == change.task && known.term == change.term) {
                first.push(change);
            }
        }
        Ok(first)
    }

    fn transact<T, E: From<StoreError>>(
        &self,
        by: &str,
        change: impl FnOnce(&Version) -> Result<(String, T), E>,
        changes: impl FnOnce(&T) -> &[Change],
    ) -> Result<Outcome<T>, E> {
        let storage = |error: StorageError| E::from(error.into());
        let aside = self.folder.private_subfolder(ASIDE).map_err(storage)?;
        let _lock = aside.lock(Path::new(&self.beside("lock"))).map_err(storage)?;
        let present = self.read()?;
        let before = present.clone().unwrap_or_else(|| Version::of(""));
        let (text, result) = change(&before)?;
        if present.is_some() && text == before.text {
            return Ok(Outcome::Same(before, result));
        }
        if text.len() as u64 > LARGEST {
            return Err(storage(StorageError::TooLarge { path: self.path(), limit: LARGEST }));
        }
        let next = Version::of(text);
        let mut log = aside.log(&self.beside("history.jsonl")).map_err(storage)?;
        let mut last = history::last(&mut log)?;
        if let Some(last) = &mut last {
            last.settle(&mut log, present.as_ref())?;
        }
        let begun = Begun::now(by, last.as_ref(), present.as_ref(), &next, changes(&result));
        history::begin(&mut log, begun)?;
        let replaced = self.folder.replace(Path::new(&self.name), next.text.as_bytes());
        // After a failure what readers see decides. If the second line cannot be written the next change writes it.
        let made = replaced.is_ok() || self.read().is_ok_and(|now| now.is_some_and(|now| now.hash == next.hash));
        let _ = history::end(&mut log, &next.hash, if made { End::Made } else { End::Undone });
        match replaced {
            Err(error) if !made => Err(storage(error)),
            _ => Ok(Outcome::Changed(next, result)),
        }
    }

    fn beside(&self, ending: &str) -> String {
        format!("{}.{ending}", self.name)
    }
}

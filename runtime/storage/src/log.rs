//! Files of lines that only grow.

use crate::faults::Call;
use crate::{Folder, StorageError, regular};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::PathBuf;

/// A file of lines to which lines are appended, each whole and on the disk when [`Log::append`] returns.
///
/// One log at a time may append; the caller holds a [`Lock`](crate::Lock) for as long as others could. Bytes after the last
/// line end are what a program that died left of a line: no caller was promised that line, readers leave it out
/// ([`Log::whole_lines`]), and the next line takes its place.
#[derive(Debug)]
pub struct Log {
    folder: Folder,
    name: PathBuf,
    file: File,
    /// The end of the last whole line, bytes; unknown before the first append.
    end: Option<u64>,
    /// The name of a new file lasts only once its folder is on the disk.
    folder_is_synced: bool,
    poisoned: bool,
}

impl Folder {
    /// Opens the log of that name directly in this folder, created where it is missing. Nothing is changed by that.
    ///
    /// # Errors
    /// The name of a link or of anything else that is no regular file, or a refusal of the operating system.
    pub fn log(&self, name: &str) -> Result<Log, StorageError> {
        let name = PathBuf::from(name);
        let file = self.open_private(&name)?;
        Ok(Log { folder: self.clone(), name, file, end: None, folder_is_synced: false, poisoned: false })
    }
}

impl Log {
    /// The part of a log's bytes that consists of whole lines.
    pub fn whole_lines(bytes: &[u8]) -> &[u8] {
        let end = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
        &bytes[..end]
    }

    /// The whole lines of the log, with their line ends.
    ///
    /// # Errors
    /// More than `limit` bytes, or a refusal of the operating system.
    pub fn read(&mut self, limit: u64) -> Result<Vec<u8>, StorageError> {
        let file = self.file.try_clone().map_err(|source| self.cannot("read", source))?;
        let mut bytes = regular::read(cap_std::fs::File::from_std(file), &self.path(), limit)?;
        bytes.truncate(Self::whole_lines(&bytes).len());
        Ok(bytes)
    }

    /// The last `count` whole lines, or all of them if there are fewer, with their line ends. Only the end of the file is read.
    ///
    /// # Errors
    /// More than `limit` bytes, or a refusal of the operating system.
    pub fn last_lines(&mut self, count: usize, limit: u64) -> Result<Vec<u8>, StorageError> {
        let mut find = || -> io::Result<(u64, u64)> {
            let end = self.find_end()?;
            // The line end at `end` is the first of them.
            Ok((self.after_line_end(end, count + 1)?, end))
        };
        let (start, end) = find().map_err(|source| self.cannot("read", source))?;
        if end - start > limit {
            return Err(StorageError::TooLarge { path: self.path(), limit });
        }
        self.read_between(start, end).map_err(|source| self.cannot("read", source))
    }

    /// Appends `line`, a line end, and waits until they are on the disk.
    ///
    /// The line must not contain a line end; one that does is refused.
    ///
    /// # Errors
    /// A refusal of the operating system, such as a full disk. The log is then what it was before; if not even that can be
    /// achieved, it is poisoned and refuses every further append until it is opened again.
    pub fn append(&mut self, line: &[u8]) -> Result<(), StorageError> {
        self.append_lines(&[line])
    }

    /// [`append`](Self::append) of several lines, which wait for the disk once. A program that dies meanwhile may leave the first ones.
    ///
    /// # Errors
    /// As there; none of the lines has then been appended.
    pub fn append_lines(&mut self, lines: &[&[u8]]) -> Result<(), StorageError> {
        self.extend(lines, true)
    }

    /// [`append`](Self::append) without waiting for the disk: the line survives the program, and a power cut may lose it or leave
    /// other bytes in its place.
    ///
    /// # Errors
    /// As there.
    pub fn append_unsynced(&mut self, line: &[u8]) -> Result<(), StorageError> {
        self.extend(&[line], false)
    }

    fn extend(&mut self, lines: &[&[u8]], durable: bool) -> Result<(), StorageError> {
        if self.poisoned {
            return Err(StorageError::Poisoned { path: self.path() });
        }
        if lines.iter().any(|line| line.contains(&b'\n')) {
            return Err(self.cannot("write", io::Error::new(io::ErrorKind::InvalidInput, "a line contains a line end")));
        }
        let end = self.find_end().map_err(|source| self.cannot("read", source))?;
        let mut bytes = Vec::with_capacity(lines.iter().map(|line| line.len() + 1).sum());
        for line in lines {
            bytes.extend_from_slice(line);
            bytes.push(b'\n');
        }
        match self.write_at(end, &bytes, durable) {
            Ok(()) => {
                self.end = Some(end + bytes.len() as u64);
                Ok(())
            }
            Err(source) => {
                self.poisoned = self.take_back(end).is_err();
                Err(self.cannot("write", source))
            }
        }
    }

    /// Where the log was when it was opened, for messages.
    pub fn path(&self) -> PathBuf {
        self.folder.path().join(&self.name)
    }

    /// The end of the last whole line. What other logs have appended meanwhile is seen.
    fn find_end(&mut self) -> io::Result<u64> {
        let length = self.file.metadata()?.len();
        if self.end == Some(length) { Ok(length) } else { self.after_line_end(length, 1) }
    }

    /// The position after the `nth` line end before `end`, counted backwards from 1; 0 if there are fewer.
    fn after_line_end(&mut self, mut end: u64, nth: usize) -> io::Result<u64> {
        const PIECE: u64 = 4096;
        let mut left = nth;
        while end > 0 {
            let start = end.saturating_sub(PIECE);
            let piece = self.read_between(start, end)?;
            for (at, _) in piece.iter().enumerate().rev().filter(|&(_, &byte)| byte == b'\n') {
                left -= 1;
                if left == 0 {
                    return Ok(start + at as u64 + 1);
                }
            }
            end = start;
        }
        Ok(0)
    }

    fn read_between(&mut self, start: u64, end: u64) -> io::Result<Vec<u8>> {
        let mut piece = Vec::new();
        self.file.seek(SeekFrom::Start(start))?;
        Read::by_ref(&mut self.file).take(end - start).read_to_end(&mut piece)?;
        Ok(piece)
    }

    fn write_at(&mut self, end: u64, bytes: &[u8], durable: bool) -> io::Result<()> {
        if self.file.metadata()?.len() > end {
            // The remains of a line may be longer than the line that takes its place.
            self.folder.gate(Call::Truncate, &self.name)?;
            self.file.set_len(end)?;
        }
        self.file.seek(SeekFrom::Start(end))?;
        self.folder.write(&mut self.file, &self.name, bytes)?;
        if !durable {
            return Ok(());
        }
        self.folder.gate(Call::Sync, &self.name)?;
        self.file.sync_data()?;
        if !self.folder_is_synced {
            self.folder.sync()?;
            self.folder_is_synced = true;
        }
        Ok(())
    }

    /// Removes what a failed append has left, so that a line which was not promised is not found later.
    fn take_back(&mut self, end: u64) -> io::Result<()> {
        self.folder.gate(Call::Truncate, &self.name)?;
        self.file.set_len(end)?;
        self.folder.gate(Call::Sync, &self.name)?;
        self.file.sync_data()
    }

    fn cannot(&self, action: &'static str, source: io::Error) -> StorageError {
        self.folder.cannot(action, &self.name, source)
    }
}

//! The files of a compilation.

use std::sync::Arc;

pub use msk_program::source::{FileId, Span};

/// The files of one compilation.
#[derive(Debug, Clone, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

#[derive(Debug, Clone)]
struct SourceFile {
    path: String,
    text: Arc<str>,
    line_starts: Vec<usize>,
}

impl SourceMap {
    /// Adds a file; `path` is what diagnostics print.
    pub fn add(&mut self, path: impl Into<String>, text: impl Into<Arc<str>>) -> FileId {
        let text = text.into();
        let newlines = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let line_starts = std::iter::once(0).chain(newlines.map(|(index, _)| index + 1)).collect();
        self.files.push(SourceFile { path: path.into(), text, line_starts });
        FileId::new(self.files.len() - 1)
    }

    /// What diagnostics print for a file.
    pub fn path(&self, file: FileId) -> &str {
        self.get(file).map_or("", |source| &source.path)
    }

    /// The text of a file.
    pub fn text(&self, file: FileId) -> &str {
        self.get(file).map_or("", |source| &source.text)
    }

    /// Line and column of a byte, both from 1; columns count characters.
    pub fn line_column(&self, file: FileId, byte: usize) -> (usize, usize) {
        let Some(source) = self.get(file) else { return (1, 1) };
        let line = source.line_starts.partition_point(|start| *start <= byte).max(1);
        let before = source.text.get(source.line_starts[line - 1]..byte).unwrap_or("");
        (line, before.chars().count() + 1)
    }

    /// Byte range of a line, counted from 1, without its line end.
    pub fn line(&self, file: FileId, line: usize) -> Option<Span> {
        let source = self.get(file)?;
        let start = *source.line_starts.get(line.checked_sub(1)?)?;
        let next = source.line_starts.get(line).map_or(source.text.len(), |next| next - 1);
        let end = if source.text[start..next].ends_with('\r') { next - 1 } else { next };
        Some(Span::new(start, end))
    }

    /// All files, in the order in which they were added.
    pub fn files(&self) -> impl Iterator<Item = FileId> + use<> {
        (0..self.files.len()).map(FileId::new)
    }

    fn get(&self, file: FileId) -> Option<&SourceFile> {
        self.files.get(file.number())
    }
}

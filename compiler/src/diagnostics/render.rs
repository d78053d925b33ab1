//! Diagnostics as text: the code, the source line, carets under the exact place, what was expected and found, what to do.

use super::{Diagnostic, FileId, Label, Report, Severity, SourceMap, Span};
use std::fmt::Write;

/// Columns of source shown of a long line.
const WIDTH: usize = 120;
/// Columns a tab takes.
const TAB: usize = 4;

/// Lines, from 1, with the labels that begin on them.
type LabelledLines<'a> = Vec<(usize, Vec<&'a Label>)>;

/// Whether to colour the text for a terminal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// No escape sequences.
    Plain,
    /// ANSI colours.
    Coloured,
}

impl Report {
    /// All diagnostics as text, and a line that counts them.
    pub fn render(&self, style: Style) -> String {
        let mut text = String::new();
        for diagnostic in &self.diagnostics {
            text += &diagnostic.render(&self.sources, style);
            text.push('\n');
        }
        let count = |severity| self.diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count();
        let counted = [(count(Severity::Error), "error"), (count(Severity::Warning), "warning")];
        let counted = counted.iter().filter(|(count, _)| *count > 0);
        let counted: Vec<String> =
            counted.map(|(count, word)| format!("{count} {word}{}", if *count == 1 { "" } else { "s" })).collect();
        if !counted.is_empty() {
            let _ = writeln!(text, "{}", counted.join(", "));
        }
        text
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.render(Style::Plain))
    }
}

impl std::error::Error for Report {}

impl Diagnostic {
    /// This diagnostic as text.
    pub fn render(&self, sources: &SourceMap, style: Style) -> String {
        let paint = Paint { style, severity: self.severity };
        let mut text = String::new();
        let word = if self.severity == Severity::Error { "error" } else { "warning" };
        let head = format!("{word}[{}]", self.code.named());
        let _ = writeln!(text, "{}: {}", paint.main(&head), paint.bold(&printable(&self.message)));
        let margin = self.margin(sources);
        let mut shown: Option<FileId> = None;
        for (file, lines) in self.lines(sources) {
            if shown != Some(file) {
                let arrow = if shown.is_none() { "-->" } else { ":::" };
                let first = self.labels.iter().find(|label| label.file == file);
                let place = first.map_or((1, 1), |label| sources.line_column(file, label.span.start as usize));
                let path = printable(sources.path(file));
                let place = format!("{path}:{}:{}", place.0, place.1);
                let _ = writeln!(text, "{:margin$}{} {place}", "", paint.quiet(arrow));
                let _ = writeln!(text, "{:margin$} {}", "", paint.quiet("|"));
                shown = Some(file);
            }
            let mut previous: Option<usize> = None;
            for (line, labels) in lines {
                if previous.is_some_and(|previous| line > previous + 1) {
                    let _ = writeln!(text, "{}", paint.quiet("..."));
                }
                previous = Some(line);
                if let Some(span) = sources.line(file, line) {
                    let source = Layout::new(span.of(sources.text(file)), span.start as usize, &labels);
                    self.render_line(&mut text, line, &source, &labels, margin, paint);
                }
            }
        }
        self.render_notes(&mut text, margin, paint);
        text
    }

    fn margin(&self, sources: &SourceMap) -> usize {
        let line = |label: &Label| sources.line_column(label.file, label.span.start as usize).0;
        self.labels.iter().map(line).max().unwrap_or(1).to_string().len()
    }

    /// The labels by file and line: the main file first, lines in order.
    fn lines(&self, sources: &SourceMap) -> Vec<(FileId, LabelledLines<'_>)> {
        let mut files: Vec<(FileId, LabelledLines<'_>)> = Vec::new();
        for label in &self.labels {
            let line = sources.line_column(label.file, label.span.start as usize).0;
            let file = match files.iter().position(|(file, _)| *file == label.file) {
                Some(index) => index,
                None => {
                    files.push((label.file, Vec::new()));
                    files.len() - 1
                }
            };
            let lines = &mut files[file].1;
            match lines.iter().position(|(known, _)| *known == line) {
                Some(index) => lines[index].1.push(label),
                None => lines.push((line, vec![label])),
            }
        }
        for (_, lines) in &mut files {
            lines.sort_by_key(|(line, _)| *line);
        }
        files
    }

    fn render_line(&self, text: &mut String, line: usize, source: &Layout, labels: &[&Label], margin: usize, paint: Paint) {
        let _ = writeln!(text, "{} {} {}", paint.quiet(&format!("{line:>margin$}")), paint.quiet("|"), source.shown);
        for label in labels {
            let is_main = self.labels.first().is_some_and(|main| std::ptr::eq(main, *label));
            let (from, to) = source.columns(label.span);
            let carets = (if is_main { "^" } else { "-" }).repeat((to - from).max(1));
            let carets = if is_main { paint.main(&carets) } else { paint.quiet(&carets) };
            let words = printable(&label.text);
            let blank = if words.is_empty() { "" } else { " " };
            let _ = writeln!(text, "{:margin$} {} {:from$}{carets}{blank}{words}", "", paint.quiet("|"), "");
        }
    }

    fn render_notes(&self, text: &mut String, margin: usize, paint: Paint) {
        let bar = paint.quiet("=");
        if let (Some(expected), Some(found)) = (&self.expected, &self.found) {
            let _ = writeln!(text, "{:margin$} {bar} expected: {}", "", printable(expected));
            let _ = writeln!(text, "{:margin$} {bar}    found: {}", "", printable(found));
        } else if let Some(expected) = &self.expected {
            let _ = writeln!(text, "{:margin$} {bar} expected: {}", "", printable(expected));
        } else if let Some(found) = &self.found {
            let _ = writeln!(text, "{:margin$} {bar} found: {}", "", printable(found));
        }
        let fixes = self.fixes.iter().map(|fix| &fix.title);
        for help in self.help.iter().chain(fixes) {
            let _ = writeln!(text, "{:margin$} {bar} help: {}", "", printable(help));
        }
        if let Some(option) = &self.denied_by {
            let _ = writeln!(text, "{:margin$} {bar} note: a warning, denied by `{}`", "", printable(option));
        }
    }
}

/// A source line as shown: tabs expanded, control characters replaced, cut around the labels if it is long.
struct Layout {
    shown: String,
    /// Byte of the file at which each shown character begins, and the column it has; one entry more for the end.
    places: Vec<(usize, usize)>,
}

impl Layout {
    fn new(line: &str, start: usize, labels: &[&Label]) -> Self {
        let first = labels.iter().map(|label| label.span.start as usize).min().unwrap_or(start);
        let characters: Vec<(usize, char)> = line.char_indices().collect();
        let wanted = characters.partition_point(|(byte, _)| start + byte < first);
        let skip = if characters.len() > WIDTH { wanted.saturating_sub(WIDTH / 2) } else { 0 };
        let (mut shown, mut column, mut places) = (String::new(), 0, Vec::new());
        if skip > 0 {
            shown.push('…');
            column = 1;
        }
        for (byte, character) in characters.iter().skip(skip).take(WIDTH) {
            places.push((start + byte, column));
            let piece = match character {
                '\t' => " ".repeat(TAB - column % TAB),
                character => printable(character.encode_utf8(&mut [0; 4])),
            };
            column += piece.chars().map(columns_of).sum::<usize>();
            shown += &piece;
        }
        let end = characters.get(skip + WIDTH).map_or(start + line.len(), |(byte, _)| start + byte);
        if end < start + line.len() {
            shown.push('…');
        }
        places.push((end, column));
        Self { shown, places }
    }

    /// First column, and the column after the last, of a span; cut at the end of the line.
    fn columns(&self, span: Span) -> (usize, usize) {
        let column = |byte: usize| {
            let index = self.places.partition_point(|(place, _)| *place < byte);
            self.places.get(index).or(self.places.last()).map_or(0, |(_, column)| *column)
        };
        let from = column(span.start as usize);
        (from, column(span.end as usize).max(from))
    }
}

/// Columns a character takes in a terminal: two for the wide scripts of East Asia and for pictures, none for marks that combine.
fn columns_of(character: char) -> usize {
    match u32::from(character) {
        0x0300..=0x036f | 0x200b..=0x200f | 0xfe00..=0xfe0f => 0,
        0x1100..=0x115f | 0x2e80..=0xa4cf | 0xac00..=0xd7a3 | 0xf900..=0xfaff | 0xfe30..=0xfe6f | 0xff00..=0xff60 => 2,
        0x1f300..=0x1faff | 0x20000..=0x3fffd => 2,
        _ => 1,
    }
}

/// Text that cannot move the cursor or recolour the terminal, whatever the file holds.
fn printable(text: &str) -> String {
    let hostile = |character: char| {
        (character.is_control() && character != '\n') || matches!(character, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    text.chars().map(|character| if hostile(character) { '\u{fffd}' } else { character }).collect()
}

#[derive(Clone, Copy)]
struct Paint {
    style: Style,
    severity: Severity,
}

impl Paint {
    fn escape(self, code: &str, text: &str) -> String {
        match self.style {
            Style::Plain => text.to_owned(),
            Style::Coloured => format!("\u{1b}[{code}m{text}\u{1b}[0m"),
        }
    }

    fn main(self, text: &str) -> String {
        self.escape(if self.severity == Severity::Error { "1;31" } else { "1;33" }, text)
    }

    fn bold(self, text: &str) -> String {
        self.escape("1", text)
    }

    fn quiet(self, text: &str) -> String {
        self.escape("34", text)
    }
}

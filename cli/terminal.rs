//! What commands print. Names and texts come from other people's files: none of them may steer the terminal of their reader, in whichever
//! command it shows up. So nothing but this file writes to the standard streams; clippy rejects the rest (`clippy.toml`).

#![expect(clippy::disallowed_methods, reason = "the one place that opens the standard streams")]

use crate::error::USAGE;
use msk::compiler::diagnostics::{Report, Style};
use msk_text::printable;
use std::io::{self, IsTerminal, StderrLock, Stdout, StdoutLock, Write};
use std::process::ExitCode;

/// Standard output, for people and as JSON: what would act instead of being read is made visible.
pub fn out() -> Printable<StdoutLock<'static>> {
    Printable(io::stdout().lock())
}

/// Standard error, likewise.
pub fn notes() -> Printable<StderrLock<'static>> {
    Printable(io::stderr().lock())
}

/// Standard output in the place of a file or a connection: pictures, sources, tables, messages, byte for byte.
pub fn bytes() -> Stdout {
    io::stdout()
}

/// Diagnostics for standard error, with colours where it is a terminal.
pub fn rendered(report: &Report) -> String {
    report.render(style(&io::stderr()))
}

/// Diagnostics for standard output, likewise.
pub fn rendered_out(report: &Report) -> String {
    report.render(style(&io::stdout()))
}

/// Prints why a command line is not understood, or the help that it asks for, and gives the exit code.
pub fn usage(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        // Help is text of this program.
        error.exit();
    }
    let text = error.render();
    let text = if style(&io::stderr()) == Style::Coloured { text.ansi().to_string() } else { text.to_string() };
    // Nothing is left to be done when standard error itself cannot be written.
    let _ = notes().diagnostics(&text);
    ExitCode::from(USAGE)
}

/// Colours for people, none for files and pipes.
fn style(stream: &impl IsTerminal) -> Style {
    let coloured = stream.is_terminal() && std::env::var_os("NO_COLOR").is_none();
    if coloured { Style::Coloured } else { Style::Plain }
}

/// A stream to which nothing is written that would act. Each piece must be whole text, as `write!` gives it.
pub struct Printable<W>(W);

impl<W: Write> Printable<W> {
    /// Writes rendered diagnostics, whose colours stay.
    ///
    /// # Errors
    /// Those of the stream.
    pub fn diagnostics(&mut self, rendered: &str) -> io::Result<()> {
        self.0.write_all(but_colours(rendered).as_bytes())
    }
}

impl<W: Write> Write for Printable<W> {
    fn write(&mut self, piece: &[u8]) -> io::Result<usize> {
        self.0.write_all(printable(&String::from_utf8_lossy(piece)).as_bytes())?;
        Ok(piece.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// Printable, but for the sequences that choose a colour (`ESC [ 1;31 m`, ECMA-48 "select graphic rendition").
fn but_colours(text: &str) -> String {
    let mut pieces = text.split("\u{1b}[");
    let mut shown = printable(pieces.next().unwrap_or_default());
    for piece in pieces {
        let end = piece.find(|letter: char| !(letter.is_ascii_digit() || letter == ';')).unwrap_or(piece.len());
        let is_colour = piece[end..].starts_with('m');
        shown.push_str(if is_colour { "\u{1b}[" } else { "\\u001b[" });
        shown.push_str(&printable(piece));
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_stay_and_nothing_else_does() {
        let text = "\u{1b}[1;31merror\u{1b}[0m: a\u{1b}[2Jb\u{1b}]0;title\u{7}\u{1b}[";
        assert_eq!(but_colours(text), "\u{1b}[1;31merror\u{1b}[0m: a\\u001b[2Jb\\u001b]0;title\\u0007\\u001b[");
    }

    #[test]
    fn a_stream_shows_what_would_act() {
        let mut stream = Printable(Vec::new());
        write!(stream, "a\u{9b}2Jb\n\u{e9}").unwrap();
        stream.diagnostics("\u{1b}[1mx").unwrap();
        assert_eq!(String::from_utf8(stream.0).unwrap(), "a\\u009b2Jb\n\u{e9}\u{1b}[1mx");
    }
}

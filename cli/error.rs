//! The error of a command that cannot go on: one message, its causes, and what to do about it.

use crate::terminal;
use msk::compiler::diagnostics::Report;
use std::error::Error as StdError;
use std::fmt::{self, Display};
use std::io::{self, Write};
use std::process::ExitCode;

/// Exit code of a command that was understood but failed.
pub const FAILURE: u8 = 1;
/// Exit code of a command that was not understood; clap uses the same.
pub const USAGE: u8 = 2;

/// Why a command failed. Any library error becomes one with `?`.
#[derive(Debug)]
pub struct Error {
    message: String,
    cause: Option<Box<dyn StdError + Send + Sync>>,
    hint: Option<String>,
    code: u8,
    quiet: bool,
    rendered: bool,
}

impl Error {
    /// A failure with nothing beneath it.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), cause: None, hint: None, code: FAILURE, quiet: false, rendered: false }
    }

    /// A wrong use of the command line.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { code: USAGE, ..Self::new(message) }
    }

    /// A failure that has already been put into words, line by line, by the compiler.
    pub fn rendered(report: &Report) -> Self {
        Self { rendered: true, ..Self::new(terminal::rendered(report)) }
    }

    /// The same, followed by what came of it.
    pub fn rendered_then(report: &Report, then: &str) -> Self {
        Self { rendered: true, ..Self::new(format!("{}error: {then}\n", terminal::rendered(report))) }
    }

    /// The same failure, where a command's failures have the exit code of a wrong use.
    pub fn into_usage(self) -> Self {
        Self { code: USAGE, ..self }
    }

    /// Adds what to do about it, as one sentence.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Prints the message to standard error and gives the exit code.
    ///
    /// A reader that closed the pipe (`msk vocabulary | head`) has what it wanted: that ends quietly and well.
    pub fn report(&self) -> ExitCode {
        if self.quiet {
            return ExitCode::SUCCESS;
        }
        let (mut notes, text) = (terminal::notes(), self.to_string());
        // Nothing is left to be done when standard error itself cannot be written.
        let _ = if self.rendered { notes.diagnostics(&text) } else { notes.write_all(text.as_bytes()) };
        ExitCode::from(self.code)
    }
}

impl Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.rendered {
            return f.write_str(&self.message);
        }
        writeln!(f, "error: {}", self.message)?;
        let mut printed = self.message.clone();
        let mut cause = self.cause.as_deref().map(|cause| cause as &dyn StdError);
        while let Some(error) = cause {
            let text = error.to_string();
            // Some errors repeat their cause in their own text.
            if !printed.contains(&text) {
                writeln!(f, "  because: {text}")?;
                printed = text;
            }
            cause = error.source();
        }
        if let Some(hint) = &self.hint {
            writeln!(f, "  hint: {hint}")?;
        }
        Ok(())
    }
}

impl<E: StdError + Send + Sync + 'static> From<E> for Error {
    fn from(error: E) -> Self {
        let message = error.to_string();
        let cause: Box<dyn StdError + Send + Sync> = Box::new(error);
        Self { quiet: is_closed_pipe(cause.as_ref()), cause: Some(cause), ..Self::new(message) }
    }
}

/// Whether the reader of our output went away; writers of JSON wrap that error in their own.
fn is_closed_pipe(error: &(dyn StdError + 'static)) -> bool {
    let input_output = error.downcast_ref::<io::Error>().map(io::Error::kind);
    let json = error.downcast_ref::<serde_json::Error>().and_then(serde_json::Error::io_error_kind);
    input_output.or(json) == Some(io::ErrorKind::BrokenPipe)
}

/// Puts what was being done in front of why it failed.
pub trait Context<T> {
    /// `message` describes what could not be done.
    ///
    /// # Errors
    /// The same failure, with the message before it.
    fn context(self, message: impl FnOnce() -> String) -> Result<T, Error>;
}

impl<T, E: StdError + Send + Sync + 'static> Context<T> for Result<T, E> {
    fn context(self, message: impl FnOnce() -> String) -> Result<T, Error> {
        self.map_err(|error| Error { message: message(), ..Error::from(error) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn message_causes_and_hint_come_in_this_order() {
        let denied = io::Error::new(io::ErrorKind::PermissionDenied, "permission denied");
        let error = Err::<(), _>(denied).context(|| "cannot write `results`".into()).unwrap_err();
        let error = error.hint("choose another folder with --out");
        assert_eq!(
            error.to_string(),
            "error: cannot write `results`\n  because: permission denied\n  hint: choose another folder with --out\n"
        );
    }

    #[test]
    fn a_lone_cause_is_the_message_and_is_printed_once() {
        let error = Error::from(io::Error::other("disk is full"));
        assert_eq!(error.to_string(), "error: disk is full\n");
    }

    #[test]
    fn a_closed_pipe_is_no_failure() {
        let error = Error::from(io::Error::from(io::ErrorKind::BrokenPipe));
        assert!(error.quiet);
        assert!(!Error::from(io::Error::other("disk is full")).quiet);
    }
}

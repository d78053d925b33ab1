//! Proof that an error was reported.

use super::{Diagnostic, Severity};

/// A witness that an error has been reported: its holder may give up without a further report.
///
/// Only [`Diagnostic::report`] and [`Reported::among`] make one, both from an error diagnostic, so that nothing can fail in
/// silence: a check that gives up either reports why or passes on the witness of who did. Which error it was is not kept;
/// later stages may drop one that only follows from another, never the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reported(());

/// A result whose error is already reported.
pub type Checked<T> = Result<T, Reported>;

impl Reported {
    /// The witness of an error among these diagnostics, if there is one.
    pub fn among<'d>(diagnostics: impl IntoIterator<Item = &'d Diagnostic>) -> Option<Self> {
        diagnostics.into_iter().any(|diagnostic| diagnostic.severity == Severity::Error).then_some(Self(()))
    }
}

impl Diagnostic {
    /// Adds this to `diagnostics`, as an error whatever its code: the check that reports it gives up.
    pub fn report(mut self, diagnostics: &mut Vec<Diagnostic>) -> Reported {
        self.severity = Severity::Error;
        diagnostics.push(self);
        Reported(())
    }
}

/// Collects failures where all parts are looked at before the whole gives up.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Failures(Option<Reported>);

impl Failures {
    /// The value of a part that did not fail.
    pub(crate) fn catch<T>(&mut self, result: Checked<T>) -> Option<T> {
        result.map_err(|reported| self.add(reported)).ok()
    }

    /// Counts a failure.
    pub(crate) fn add(&mut self, reported: Reported) {
        self.0.get_or_insert(reported);
    }

    /// Whether anything failed.
    pub(crate) fn any(self) -> bool {
        self.0.is_some()
    }

    /// The whole, if no part failed.
    ///
    /// # Errors
    /// The first failure.
    pub(crate) fn or<T>(self, whole: T) -> Checked<T> {
        self.0.map_or(Ok(whole), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::{FileId, Span, codes};

    fn warning() -> Diagnostic {
        Diagnostic::new(codes::lints::UNUSED, FileId::default(), Span::default(), "unused")
    }

    #[test]
    fn a_warning_is_no_witness_unless_a_check_gives_up_on_it() {
        let mut diagnostics = vec![warning()];
        assert_eq!(Reported::among(&diagnostics), None);
        warning().report(&mut diagnostics);
        assert_eq!(diagnostics[1].severity, Severity::Error);
        assert!(Reported::among(&diagnostics).is_some());
    }

    #[test]
    fn one_failed_part_fails_the_whole() {
        let mut failures = Failures::default();
        assert_eq!(failures.catch(Ok(1)), Some(1));
        assert_eq!(failures.or(2), Ok(2));
        failures.catch::<()>(Err(warning().report(&mut Vec::new())));
        assert!(failures.any() && failures.or(2).is_err());
    }
}

//! The codes of all errors and warnings: one table, a page for each.
//!
//! `E01` syntax, `E02` names, `E03` types, dimensions and frames, `E04` what tasks mean, `W05` lints. A code never changes its
//! meaning; a code that is no longer used is not given again.

use super::Lint;

/// A stable code with its page.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// `E0103`
    pub id: &'static str,
    /// The lint that it is, if it is a warning.
    pub lint: Option<Lint>,
    /// A few words.
    pub title: &'static str,
    /// What it means and why it is refused.
    pub explanation: &'static str,
    /// A text that causes it.
    pub example: &'static str,
    /// The same, right.
    pub fix: &'static str,
}

impl Code {
    /// The code and, of a warning, the name of its lint: `W0511 dead_at_reset`.
    pub fn named(&self) -> String {
        self.lint.map_or_else(|| self.id.to_owned(), |lint| format!("{} {}", self.id, lint.name))
    }

    /// The page as text, for `msk help`.
    pub fn page(&self) -> String {
        let indented = |text: &str| text.lines().map(|line| format!("    {line}\n")).collect::<String>();
        let (example, fix) = (indented(self.example), indented(self.fix));
        format!("{}: {}\n\n{}\n\nFor example\n\n{example}\nis written\n\n{fix}", self.named(), self.title, self.explanation)
    }
}

/// Declares a part of the table: a constant per code and the list of all.
macro_rules! codes {
    ($($name:ident = $id:literal $(lint $lint:ident $stage:ident)? {
        title: $title:literal,
        explanation: $explanation:literal,
        example: $example:literal,
        fix: $fix:literal $(,)?
    })*) => {
        $(
            #[doc = $title]
            pub const $name: &$crate::diagnostics::Code = &$crate::diagnostics::Code {
                id: $id,
                lint: $crate::diagnostics::codes::declared!($($lint $stage)?),
                title: $title,
                explanation: $explanation,
                example: $example,
                fix: $fix,
            };
        )*
        /// All of this part, in order.
        pub const ALL: &[&$crate::diagnostics::Code] = &[$($name),*];
    };
}

/// The lint that a code declares: `dead_term Compile`, a name and its stage.
macro_rules! declared {
    () => {
        None
    };
    ($lint:ident $stage:ident) => {
        Some($crate::diagnostics::Lint { name: stringify!($lint), stage: $crate::diagnostics::Stage::$stage })
    };
}
use declared;

pub mod channels;
pub mod composition;
pub mod exploits;
pub mod incentive;
pub mod intent;
pub mod lints;
pub mod names;
pub mod probing;
pub mod scene;
pub mod slips;
pub mod syntax;
pub mod tasks;
pub mod tests;
pub mod types;
pub mod weights;

/// Every code, in order.
pub fn all() -> impl Iterator<Item = &'static Code> {
    [
        syntax::ALL,
        names::ALL,
        types::ALL,
        tasks::ALL,
        scene::ALL,
        composition::ALL,
        tests::ALL,
        weights::ALL,
        lints::ALL,
        probing::ALL,
        intent::ALL,
        incentive::ALL,
        slips::ALL,
        exploits::ALL,
        channels::ALL,
    ]
    .into_iter()
    .flatten()
    .copied()
}

/// The page of a code such as `E0103`, whatever the case of its letter.
pub fn find(id: &str) -> Option<&'static Code> {
    all().find(|code| code.id.eq_ignore_ascii_case(id))
}

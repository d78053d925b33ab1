//! Lints: warnings that have a name, a level, and an `allow` that turns them off where they do not matter.
//!
//! The registry is the table of [`codes`](super::codes): every code of a warning declares its lint beside it, and nothing else
//! lists lints.

use super::{Code, codes, nearest};

/// The name of a warning and how it is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lint {
    /// The name under which texts and command lines speak of it: `dead_at_reset`.
    pub name: &'static str,
    /// The last stage of `msk check` that can find it.
    pub stage: Stage,
}

/// A stage of `msk check`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Reading a text as a whole: no `allow` of a task reaches what is found here.
    Text,
    /// Compiling a task.
    Compile,
    /// Resetting a task on its body and putting it into poses.
    Probe,
    /// Playing an episode of a task.
    Play,
}

impl Stage {
    /// The stage for people: `probe`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Compile => "compile",
            Self::Probe => "probe",
            Self::Play => "play",
        }
    }
}

/// What becomes of what a lint finds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Nothing is reported.
    Allow,
    /// A warning.
    Warn,
    /// An error: `msk check` fails.
    Deny,
}

impl Level {
    /// The level for people: `warn`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Allow => "allow",
            Self::Warn => "warn",
            Self::Deny => "deny",
        }
    }
}

impl Lint {
    /// The level unless a command line sets another: every lint warns. One that is wrong so often that it would have to be off
    /// is to be made better instead.
    pub const fn level(self) -> Level {
        Level::Warn
    }

    /// Whether a task can `allow` it.
    pub const fn allowable(self) -> bool {
        !matches!(self.stage, Stage::Text)
    }
}

/// Every code that is a lint, with its lint, in the order of the codes.
pub fn lints() -> impl Iterator<Item = (&'static Code, Lint)> {
    codes::all().filter_map(|code| Some((code, code.lint?)))
}

/// The lint of a name or a code: `dead_at_reset`, `W0511`.
///
/// # Errors
/// There is none; the nearest names, perhaps none.
pub fn find_lint(name: &str) -> Result<(&'static Code, Lint), Vec<&'static str>> {
    let found = lints().find(|(code, lint)| lint.name == name || code.id.eq_ignore_ascii_case(name));
    found.ok_or_else(|| nearest(&name.replace('-', "_"), lints().map(|(_, lint)| lint.name)))
}

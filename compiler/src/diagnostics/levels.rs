//! Levels of lints as a command line sets them: `--deny warnings --allow unused`.

use super::{Code, Diagnostic, Level, Severity, find_lint};

/// What each lint becomes; of several settings that hold for a lint, the last.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Levels(Vec<Setting>);

#[derive(Debug, Clone, PartialEq, Eq)]
struct Setting {
    lints: Lints,
    level: Level,
    /// As it was given, for messages.
    written: String,
}

/// The lints that a setting is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lints {
    /// `warnings`
    All,
    /// A lint, by its code.
    One(&'static Code),
}

/// The name of all lints together.
const ALL: &str = "warnings";

impl Lints {
    /// What a name, a code or `warnings` means; blanks in names may be `-` or `_`.
    ///
    /// # Errors
    /// There is no such lint; suggests which were probably meant.
    pub fn named(name: &str) -> Result<Self, String> {
        if name == ALL {
            return Ok(Self::All);
        }
        find_lint(&name.replace('-', "_")).map(|(code, _)| Self::One(code)).map_err(|near| {
            let near: Vec<String> = near.iter().map(|near| format!("`{near}`")).collect();
            match near.as_slice() {
                [] => format!("there is no lint `{name}`: `msk help lints` lists them, and `{ALL}` is all of them"),
                near => format!("there is no lint `{name}`; did you mean {}?", near.join(" or ")),
            }
        })
    }

    fn include(self, code: &Code) -> bool {
        match self {
            Self::All => code.lint.is_some(),
            Self::One(one) => one == code,
        }
    }
}

impl Levels {
    /// Sets the level of some lints; `written` is the option as it was given: `--deny warnings`.
    pub fn set(&mut self, lints: Lints, level: Level, written: impl Into<String>) {
        self.0.push(Setting { lints, level, written: written.into() });
    }

    /// Drops warnings of lints that are allowed and makes errors of those that are denied. Errors stay what they are.
    pub fn apply(&self, diagnostics: &mut Vec<Diagnostic>) {
        diagnostics.retain_mut(|diagnostic| {
            if diagnostic.severity == Severity::Error {
                return true;
            }
            let Some(setting) = self.0.iter().rev().find(|setting| setting.lints.include(diagnostic.code)) else { return true };
            if setting.level == Level::Deny {
                diagnostic.severity = Severity::Error;
                diagnostic.denied_by = Some(setting.written.clone());
            }
            setting.level != Level::Allow
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::{FileId, Span, codes};

    fn left(levels: &[(&str, Level)]) -> Vec<(&'static str, Severity)> {
        let mut all = Levels::default();
        for (name, level) in levels {
            all.set(Lints::named(name).unwrap(), *level, format!("--{} {name}", level.name()));
        }
        let warning = |code| Diagnostic::new(code, FileId::default(), Span::default(), "");
        let mut diagnostics =
            vec![warning(codes::lints::UNUSED), warning(codes::intent::SPIKE), warning(codes::names::UNKNOWN_NAME)];
        all.apply(&mut diagnostics);
        diagnostics.iter().map(|diagnostic| (diagnostic.code.id, diagnostic.severity)).collect()
    }

    #[test]
    fn the_last_setting_of_a_lint_holds() {
        use Level::{Allow, Deny, Warn};
        use Severity::{Error, Warning};
        let error = ("E0201", Error);
        assert_eq!(left(&[]), [("W0507", Warning), ("W0543", Warning), error]);
        assert_eq!(left(&[("warnings", Deny), ("unused", Allow)]), [("W0543", Error), error]);
        assert_eq!(left(&[("unused", Allow), ("warnings", Deny)]), [("W0507", Error), ("W0543", Error), error]);
        assert_eq!(left(&[("warnings", Deny), ("unused", Warn)]), [("W0507", Warning), ("W0543", Error), error]);
        assert_eq!(left(&[("warnings", Allow), ("W0543", Deny)]), [("W0543", Error), error]);
    }

    #[test]
    fn a_lint_is_found_by_its_name_in_either_spelling_and_by_its_code() {
        for name in ["dead_at_reset", "dead-at-reset", "W0511", "w0511"] {
            assert_eq!(Lints::named(name), Ok(Lints::One(codes::lints::DEAD_AT_RESET)), "{name}");
        }
        assert_eq!(Lints::named("unusde"), Err("there is no lint `unusde`; did you mean `unused`?".to_owned()));
        assert!(Lints::named("E0201").unwrap_err().contains("msk help lints"));
        assert!(Lints::named("").unwrap_err().contains("msk help lints"));
    }
}

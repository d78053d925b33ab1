//! `allow LINT "REASON"`: which warnings of a task it covers, and whether it still covers any.

use super::{Code, Diagnostic, FileId, Lint, Severity, Span, Stage, codes};
use std::collections::BTreeMap;

/// An `allow` of a task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Allowance {
    /// The code of the lint that is allowed.
    pub code: &'static Code,
    /// Its lint.
    pub lint: Lint,
    /// Where the statement stands.
    pub place: (FileId, Span),
    /// What it covers.
    pub scope: Scope,
    /// Whether it has covered a warning.
    pub fulfilled: bool,
}

/// What an `allow` covers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Scope {
    /// All of the task.
    Task,
    /// A line of a list; none where no line follows.
    Line(Option<(FileId, Span)>),
}

impl Scope {
    fn covers(&self, file: FileId, span: Span) -> bool {
        match self {
            Self::Task => true,
            Self::Line(line) => line.is_some_and(|(own, line)| own == file && line.start <= span.start && span.end <= line.end),
        }
    }
}

impl Allowance {
    /// Takes the warnings of a task that `allowances` cover out of `diagnostics`; each that covers one is fulfilled. Errors stay.
    pub fn apply(allowances: &mut [Self], diagnostics: &mut Vec<Diagnostic>) {
        diagnostics.retain(|told| {
            let mut covered = false;
            for allowance in allowances.iter_mut() {
                let covers = allowance.code == told.code && allowance.scope.covers(told.file(), told.span());
                allowance.fulfilled |= covers;
                covered |= covers;
            }
            !covered || told.severity == Severity::Error
        });
    }

    /// A warning for each place of an `allow` whose lint is decided at `stage` and that covers nothing in any task: an inherited
    /// one counts for all.
    pub fn unfulfilled<'a>(allowances: impl IntoIterator<Item = &'a Self>, stage: Stage) -> Vec<Diagnostic> {
        let mut places: BTreeMap<(FileId, Span), (&Self, bool)> = BTreeMap::new();
        for allowance in allowances.into_iter().filter(|allowance| allowance.lint.stage == stage) {
            places.entry(allowance.place).or_insert((allowance, false)).1 |= allowance.fulfilled;
        }
        places.into_values().filter(|(_, fulfilled)| !fulfilled).map(|(allowance, _)| allowance.needless()).collect()
    }

    fn needless(&self) -> Diagnostic {
        let (file, span) = self.place;
        let message = format!("nothing here causes `{}`, which this allows", self.lint.name);
        let diagnostic = Diagnostic::new(codes::lints::UNFULFILLED_ALLOW, file, span, message);
        match &self.scope {
            Scope::Line(None) => diagnostic.help("it holds for the line below it, and there is none"),
            Scope::Line(Some(_)) => {
                diagnostic.help("it holds for the line below it: remove it, or put it above the line that is warned of")
            }
            Scope::Task => diagnostic.help("remove it: the next mistake of this kind would go unseen"),
        }
    }
}

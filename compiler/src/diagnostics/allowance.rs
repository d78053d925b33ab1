//! `allow LINT "REASON"`: which warnings of a task it covers, and whether it still covers any.

use super::{Allowance, Diagnostic, FileId, Lint, Scope, Severity, Span, Stage, codes, lints};
use std::collections::BTreeMap;

fn lint_of(allowance: &Allowance) -> Option<Lint> {
    lints().find(|(code, _)| code.id == allowance.code).map(|(_, lint)| lint)
}

/// Takes the warnings of a task that `allowances` cover out of `diagnostics`; each that covers one is fulfilled. Errors stay.
pub fn apply(allowances: &mut [Allowance], diagnostics: &mut Vec<Diagnostic>) {
    diagnostics.retain(|diagnostic| {
        let mut covered = false;
        for allowance in allowances.iter_mut() {
            let covers = allowance.code == diagnostic.code.id && allowance.scope.covers(diagnostic.file(), diagnostic.span());
            allowance.fulfilled |= covers;
            covered |= covers;
        }
        !covered || diagnostic.severity == Severity::Error
    });
}

/// A warning for each place of an `allow` whose lint is decided at `stage` and that covers nothing in any task: an inherited
/// one counts for all.
pub fn unfulfilled<'a>(allowances: impl IntoIterator<Item = &'a Allowance>, stage: Stage) -> Vec<Diagnostic> {
    let mut places: BTreeMap<(FileId, Span), (&Allowance, bool)> = BTreeMap::new();
    for allowance in allowances.into_iter().filter(|allowance| lint_of(allowance).is_some_and(|lint| lint.stage == stage)) {
        places.entry(allowance.place).or_insert((allowance, false)).1 |= allowance.fulfilled;
    }
    places.into_values().filter(|(_, fulfilled)| !fulfilled).map(|(allowance, _)| needless(allowance)).collect()
}

fn needless(allowance: &Allowance) -> Diagnostic {
    let (file, span) = allowance.place;
    let message = format!("`{}` has no warning here to allow", lint_of(allowance).map_or(allowance.code, |lint| lint.name));
    let diagnostic = Diagnostic::new(codes::lints::UNFULFILLED_ALLOW, file, span, message);
    match &allowance.scope {
        Scope::Line(None) => diagnostic.help("an `allow` covers the line below it; there is none"),
        Scope::Line(Some(_)) => {
            diagnostic.help("an `allow` covers the line below it: remove it, or move it before the line of the warning")
        }
        Scope::Task => diagnostic.help("remove it: it would hide the next mistake of this kind"),
    }
}

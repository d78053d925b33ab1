//! Terms whose weight or sign rewards nothing, or the wrong thing.

use super::amount::Amount;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};

/// Terms that contribute nothing because their weight is zero and nothing may change it.
pub(super) fn weightless(task: &CheckedTask<'_>, amounts: &[Amount], diagnostics: &mut Vec<Diagnostic>) {
    for (term, amount) in task.terms.iter().zip(amounts) {
        let tuned = term.range.is_some_and(|[low, high]| low < high);
        // `dead_term` and `constant_term` warn of a formula that never changes.
        if term.weight == 0.0 && !tuned && term.schedule.is_none() && amount.value.single().is_none() {
            let message = format!("the term `{}` has weight 0: it contributes nothing but is still computed", term.name);
            let diagnostic = Diagnostic::new(codes::incentive::ZERO_WEIGHT, term.weight_at.0, term.weight_at.1, message)
                .help("a range lets a tuner raise it, `0 (0..10)`; values that are only logged belong in `metrics { ... }`");
            diagnostics.push(diagnostic);
        }
    }
}

//! Terms whose weight or sign pays for nothing, or for the wrong thing.

use super::amount::Amount;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};

/// Terms that pay nothing because their weight is zero and nothing may change it.
pub(super) fn weightless(task: &CheckedTask<'_>, amounts: &[Amount], diagnostics: &mut Vec<Diagnostic>) {
    for (term, amount) in task.terms.iter().zip(amounts) {
        let tuned = term.range.is_some_and(|[low, high]| low < high);
        // `dead_term` and `constant_term` warn of a formula that never changes.
        if term.weight == 0.0 && !tuned && amount.value.single().is_none() {
            let message = format!("the term `{}` has the weight 0: it pays nothing and is computed all the same", term.name);
            let diagnostic = Diagnostic::new(codes::incentive::WEIGHTLESS, term.weight_at.0, term.weight_at.1, message).help(
                "a tuner may raise it within a range, `0 (0..10)`; what is only to be watched belongs in `metrics { ... }`",
            );
            diagnostics.push(diagnostic);
        }
    }
}

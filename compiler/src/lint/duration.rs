//! How long an episode takes.

use crate::check::context::Checker;
use crate::check::task::CheckedTask;
use crate::diagnostics::{Diagnostic, codes};
use crate::numbers::for_people;
use crate::syntax::tree::TaskStatement;

/// The longest episode that is taken as meant, s.
const LONGEST: f64 = 600.0;

/// An episode of more than ten minutes.
pub(super) fn long_horizon(checker: &Checker<'_>, task: &CheckedTask<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let steps = f64::from(task.timing.horizon);
    let duration = steps * task.timing.interval;
    if duration <= LONGEST {
        return;
    }
    let horizon = checker.statements.iter().rev().find_map(|placed| match &placed.statement {
        TaskStatement::Horizon(expr) => Some((placed.file, expr.span)),
        _ => None,
    });
    let Some((file, span)) = horizon else { return };
    let minutes = for_people(duration / 60.0);
    let message = format!("an episode takes {minutes} minutes: {} control steps", for_people(steps));
    let diagnostic = Diagnostic::new(codes::incentive::LONG_HORIZON, file, span, message).expected("at most 10 minutes").help(
        "discounting and credit assignment over thousands of steps is hard; `horizon 10 s` is in seconds, `1000 steps` in steps",
    );
    diagnostics.push(diagnostic);
}

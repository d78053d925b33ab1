//! Initial states: moments that show what the task draws when it is reset, and what is taken over several of them.

use super::Draft;
use crate::check::context::{Checked, Checker, Reported};
use crate::check::dimension::Dimension;
use crate::check::value::TypedValue;
use crate::diagnostics::{Span, codes, nearest};
use crate::numbers::for_people;
use crate::syntax::tree::{Argument, Expr, ExprKind, Ident, Name};
use crate::testing::Statistic;

/// The most episodes that one moment resets.
const MOST_RESETS: f64 = 1000.0;

/// The value and the moment of `min(x at drawn)`.
pub(crate) fn over_resets(arguments: &[Argument]) -> Option<(&Expr, &Ident)> {
    match arguments {
        [Argument { name: None, value: Expr { kind: ExprKind::At { value, pose }, .. } }] => Some((value, pose)),
        _ => None,
    }
}

/// What such a call takes over all episodes.
pub(super) fn statistic_of(function: &Expr) -> Option<Statistic> {
    let ExprKind::Name(name) = &function.kind else { return None };
    Statistic::ALL.into_iter().find(|statistic| statistic.name() == name.text)
}

impl<'a> Checker<'a> {
    /// `reset 50 times`: only the task itself sets how these episodes begin.
    pub(super) fn reset(&mut self, times: Option<&'a Expr>, span: Span, cheat: bool, draft: &mut Draft) -> Checked<()> {
        let count =
            times.map(|times| self.fixed_number(times, Dimension::NONE, "the number of resets")).transpose()?.unwrap_or(1.0);
        if !(1.0..=MOST_RESETS).contains(&count) || count.fract() != 0.0 {
            let at = times.map_or(span, |times| times.span);
            let diagnostic = self
                .diagnostic(codes::tasks::OUT_OF_RANGE, at, "too many resets")
                .expected(format!("a whole number from 1 to {}", for_people(MOST_RESETS)))
                .found(for_people(count));
            return Err(self.report(diagnostic));
        }
        let alone = draft.keys.is_empty() && draft.is_open() && !draft.placed;
        if !alone || cheat && draft.name.is_none() {
            return Err(self.reset_stands_alone(span));
        }
        draft.resets = Some(count as u32);
        Ok(())
    }

    /// What a moment shows besides does not go with its `reset`.
    pub(super) fn must_not_reset(&mut self, draft: &Draft, span: Span) -> Checked<()> {
        if draft.resets.is_some() { Err(self.reset_stands_alone(span)) } else { Ok(()) }
    }

    fn reset_stands_alone(&mut self, span: Span) -> Reported {
        let message = "`reset` is the task's own initial state and cannot be combined with other statements";
        let diagnostic = self.diagnostic(codes::tests::TEST_PLACE, span, message);
        self.report(diagnostic.help("use a separate moment: `moment begun { reset }`"))
    }

    /// `observation.gaze`, and no channel has that label.
    pub(super) fn unknown_channel(&mut self, name: &Name) -> Reported {
        let labels = self.in_tests.iter().flat_map(|in_tests| &in_tests.channels).map(|(label, _)| label.as_str());
        let words: Vec<&str> =
            labels.filter(|label| label.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')).collect();
        let message = format!("no channel of the observation has the label `{}`", name.text);
        let mut diagnostic = self.diagnostic(codes::names::UNKNOWN_NAME, name.span, message);
        let near = nearest(&name.text, words.iter().copied());
        if near.is_empty() {
            diagnostic = diagnostic.help(format!("labels are {}; declare others in `observe`: `goal = ...`", words.join(", ")));
        }
        for label in near {
            diagnostic = diagnostic.suggest(format!("did you mean `{label}`?"), name.span, label);
        }
        self.report(diagnostic)
    }

    /// `min(x at drawn)`: a number of the type of x.
    pub(crate) fn statistic(&mut self, function: &'a Expr, arguments: &'a [Argument], span: Span) -> Checked<TypedValue> {
        let Some((value, _)) = over_resets(arguments) else {
            return Err(self.error(codes::types::WRONG_TYPE, span, "`at` a moment is allowed only in `expect`"));
        };
        if statistic_of(function).is_none() {
            let names: Vec<&str> = Statistic::ALL.iter().map(|statistic| statistic.name()).collect();
            let message = "not an aggregate over the episodes of a moment";
            let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, function.span, message);
            return Err(self.report(diagnostic.help(format!("aggregates are {}", names.join(", ")))));
        }
        let data = self.data(value)?;
        if !data.kind.is_one_number() {
            let found = data.kind.described(self.vocabulary);
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, value.span, "expected one number per episode")
                .found(found)
                .help("use a component, or one number of a list, inside of `at`");
            return Err(self.report(diagnostic));
        }
        Ok(data)
    }
}

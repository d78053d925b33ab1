//! Tests inside files.

use super::{Builder, is_mark, part};
use crate::diagnostics::Span;
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::tree::{
    Argument, Assignment, Change, Expr, ExprKind, Ident, Played, Playing, Situation, Test, TestStatement, UnaryOperator,
};

impl Builder<'_> {
    pub(super) fn test(&mut self, pair: &Pair<'_>) -> Test {
        Test {
            title: self.text(part(pair, Rule::text)),
            cheat: pair.as_rule() == Rule::cheat,
            statements: self.test_statements(pair),
            span: self.span(pair),
        }
    }

    fn test_statements(&mut self, pair: &Pair<'_>) -> Vec<TestStatement> {
        let mut statements = Vec::new();
        for pair in part(pair, Rule::test_block).into_iter().flat_map(Pair::into_inner) {
            if pair.as_rule() == Rule::junk {
                self.junk(&pair, Rule::one_test_statement);
            } else {
                statements.extend(self.test_statement(&pair));
            }
        }
        statements
    }

    fn test_statement(&mut self, pair: &Pair<'_>) -> Option<TestStatement> {
        let span = self.span(pair);
        Some(match pair.as_rule() {
            Rule::situation | Rule::bare_pose => TestStatement::Pose(self.situation(pair)),
            Rule::keyframe | Rule::keyframe_block => TestStatement::Keyframe {
                time: self.expression_in(pair),
                situation: self.situation(pair),
                label: part(pair, Rule::label).map(|label| self.identifier_in(&label)),
                span,
            },
            Rule::placement => TestStatement::Object(self.placement(pair)),
            Rule::test_repeat => TestStatement::Repeat {
                variable: self.identifier_in(pair),
                range: match part(pair, Rule::range) {
                    Some(range) => self.ranged(&range),
                    None => self.missing(),
                },
                statements: self.test_statements(pair),
                span,
            },
            Rule::test_moment => {
                TestStatement::Moment { name: self.identifier_in(pair), statements: self.test_statements(pair), span }
            }
            Rule::play => TestStatement::Play(Box::new(self.playing(pair))),
            Rule::given => TestStatement::Given { name: self.identifier_in(pair), value: self.expression_in(pair), span },
            Rule::until => TestStatement::Until { time: self.expression_in(pair), span },
            Rule::run => TestStatement::Run {
                policy: self.identifier_in(pair),
                duration: part(pair, Rule::expression).map(|duration| self.expression(Some(duration))),
                span,
            },
            Rule::reset => {
                TestStatement::Reset { times: part(pair, Rule::expression).map(|times| self.expression(Some(times))), span }
            }
            Rule::expect => {
                let (condition, moment) = match part(pair, Rule::order) {
                    Some(order) => of_all(self.order(&order)),
                    None => (self.expression_in(pair), self.moment_of(pair)),
                };
                TestStatement::Expect { condition, moment, span }
            }
            _ => return None,
        })
    }

    fn playing(&mut self, pair: &Pair<'_>) -> Playing {
        let mut within = |rule| part(pair, rule).map(|part| self.expression_in(&part));
        let (time, start, duration) = (within(Rule::time), within(Rule::from_phase), within(Rule::lasting));
        let motion = match part(pair, Rule::text) {
            Some(path) => Played::File(self.text(Some(path))),
            None => Played::Reference(self.identifier_in(pair)),
        };
        // The word behind `play` names a reference, no pose.
        let situation = Situation { pose: None, ..self.situation(pair) };
        let label = part(pair, Rule::label).map(|label| self.identifier_in(&label));
        Playing { time, motion, start, duration, situation, label, span: self.span(pair) }
    }

    /// The pose and the changes of a statement.
    fn situation(&mut self, pair: &Pair<'_>) -> Situation {
        let mut changes = Vec::new();
        for pair in part(pair, Rule::changes).into_iter().flat_map(Pair::into_inner) {
            match pair.as_rule() {
                Rule::assignment => changes.push(Change::Assign(Assignment {
                    target: self.expression(part(&pair, Rule::postfixed)),
                    value: self.expression_in(&pair),
                    span: self.span(&pair),
                })),
                Rule::meets => {
                    changes.push(Change::Align(self.align(&pair)));
                }
                Rule::field_junk => self.junk(&pair, Rule::one_change),
                rule => debug_assert!(is_mark(rule)),
            }
        }
        Situation { pose: part(pair, Rule::identifier).map(|name| self.identifier(&name)), changes, span: self.span(pair) }
    }

    /// `at NAME` behind a condition.
    fn moment_of(&mut self, pair: &Pair<'_>) -> Option<Ident> {
        part(pair, Rule::at_moment).map(|moment| self.identifier_in(&moment))
    }

    /// `reward.pose at neutral > reward.pose at squatting`
    fn order(&mut self, pair: &Pair<'_>) -> Expr {
        let (mut operands, mut operators): (Vec<Expr>, Vec<_>) = (Vec::new(), Vec::new());
        for part in pair.clone().into_inner() {
            match part.as_rule() {
                Rule::comparison => operators.push((super::chain::compare_operator(&part), self.span(&part))),
                Rule::side => operands.push(self.side(&part)),
                _ => {}
            }
        }
        self.check_direction(&operators);
        let span = operands.iter().map(|operand| operand.span).reduce(Span::to).unwrap_or_default();
        Expr { kind: ExprKind::Compare { operands, operators }, span }
    }

    /// `min(x at drawn)`: a call whose only argument is read at a moment
    fn statistic(&mut self, pair: &Pair<'_>) -> Expr {
        let span = self.span(pair);
        let name = self.name_in(pair);
        let function = Box::new(Expr { span: name.span, kind: ExprKind::Name(name) });
        let within = part(pair, Rule::over_resets);
        let value = match &within {
            Some(within) => self.expression_in(within),
            None => self.missing(),
        };
        let value = match within.and_then(|within| self.moment_of(&within)) {
            Some(pose) => {
                let span = value.span.to(pose.span);
                Expr { kind: ExprKind::At { value: Box::new(value), pose }, span }
            }
            None => value,
        };
        Expr { kind: ExprKind::Call { function, arguments: vec![Argument { name: None, value }] }, span }
    }

    /// A value, and at which moment it is read.
    fn side(&mut self, pair: &Pair<'_>) -> Expr {
        if let Some(statistic) = part(pair, Rule::statistic) {
            return self.statistic(&statistic);
        }
        let mut value = self.expression(part(pair, Rule::postfixed));
        if part(pair, Rule::minus).is_some() {
            let kind = ExprKind::Unary { operator: UnaryOperator::Negate, operand: Box::new(value) };
            value = Expr { kind, span: self.span(pair) };
        }
        match self.moment_of(pair) {
            Some(pose) => Expr { kind: ExprKind::At { value: Box::new(value), pose }, span: self.span(pair) },
            None => value,
        }
    }
}

/// A moment that stands behind the last side, and at no other, is that of the whole comparison: `1 m < x < 2 m at low`.
fn of_all(mut order: Expr) -> (Expr, Option<Ident>) {
    let ExprKind::Compare { operands, .. } = &mut order.kind else { return (order, None) };
    let Some((last, others)) = operands.split_last_mut() else { return (order, None) };
    if others.iter().any(|other| matches!(other.kind, ExprKind::At { .. })) {
        return (order, None);
    }
    match std::mem::replace(&mut last.kind, ExprKind::Bool(true)) {
        ExprKind::At { value, pose } => {
            *last = *value;
            (order, Some(pose))
        }
        kind => {
            last.kind = kind;
            (order, None)
        }
    }
}

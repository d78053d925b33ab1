//! Bodies, suites, and tests inside files.

use super::{Builder, part};
use crate::diagnostics::Span;
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::tree::{Body, BodyGroup, BodyPose, BodyStatement, Expr, ExprKind, Family, Suite, Test, TestStatement};

impl Builder<'_> {
    pub(super) fn body(&mut self, pair: &Pair<'_>) -> Body {
        let span = self.span(pair);
        let docs = self.docs(span);
        let name = self.identifier_in(pair);
        let mut statements = Vec::new();
        for pair in part(pair, Rule::body_block).into_iter().flat_map(Pair::into_inner) {
            statements.push(match pair.as_rule() {
                Rule::model => BodyStatement::Model(self.text(part(&pair, Rule::text))),
                Rule::setting => BodyStatement::Setting { name: self.first_word(&pair), value: self.identifier_in(&pair) },
                Rule::body_group => BodyStatement::Group(self.body_group(&pair)),
                Rule::body_pose => BodyStatement::Pose(self.body_pose(&pair)),
                Rule::body_element => {
                    let kind = self.first_word(&pair);
                    BodyStatement::Element(self.element_of(&pair, kind))
                }
                Rule::junk => {
                    self.junk(&pair, Rule::one_body_statement);
                    continue;
                }
                _ => continue,
            });
        }
        Body { docs, name, statements, span }
    }

    fn first_word(&self, pair: &Pair<'_>) -> crate::syntax::tree::Ident {
        let word = pair.clone().into_inner().next();
        self.keyword(word.as_ref().unwrap_or(pair))
    }

    fn body_group(&mut self, pair: &Pair<'_>) -> BodyGroup {
        let span = self.span(pair);
        BodyGroup {
            docs: self.docs(span),
            kind: self.first_word(pair),
            name: self.name_in(pair),
            title: part(pair, Rule::text).map(|title| self.text(Some(title))),
            members: self.expression_in(pair),
            span,
        }
    }

    fn body_pose(&mut self, pair: &Pair<'_>) -> BodyPose {
        let span = self.span(pair);
        BodyPose { docs: self.docs(span), name: self.identifier_in(pair), joints: self.assignments(pair), span }
    }

    pub(super) fn suite(&mut self, pair: &Pair<'_>) -> Suite {
        let span = self.span(pair);
        let docs = self.docs(span);
        let name = self.identifier_in(pair);
        let (mut families, mut protocol) = (Vec::new(), None);
        for pair in part(pair, Rule::suite_block).into_iter().flat_map(Pair::into_inner) {
            match pair.as_rule() {
                Rule::suite_family => families.push(self.suite_family(&pair)),
                Rule::protocol => {
                    let kind = self.first_word(&pair);
                    let present = self.element_of(&pair, kind);
                    if protocol.is_some() {
                        self.report(crate::syntax::wording::second_protocol(self.file, present.kind.span));
                    }
                    protocol = Some(present);
                }
                Rule::junk => self.junk(&pair, Rule::one_suite_statement),
                _ => {}
            }
        }
        Suite { docs, name, families, protocol, span }
    }

    fn suite_family(&mut self, pair: &Pair<'_>) -> Family {
        let span = self.span(pair);
        let docs = self.docs(span);
        let name = self.identifier_in(pair);
        let mut tasks = Vec::new();
        for pair in part(pair, Rule::task_names).into_iter().flat_map(Pair::into_inner) {
            match pair.as_rule() {
                Rule::identifier => tasks.push(self.identifier(&pair)),
                Rule::field_junk => self.junk(&pair, Rule::one_task_name),
                _ => {}
            }
        }
        Family { docs, name, tasks, span }
    }

    pub(super) fn test(&mut self, pair: &Pair<'_>) -> Test {
        let mut statements = Vec::new();
        for pair in part(pair, Rule::test_block).into_iter().flat_map(Pair::into_inner) {
            statements.push(match pair.as_rule() {
                Rule::pose | Rule::pose_block => TestStatement::Pose(self.pose_use(&pair)),
                Rule::keyframe | Rule::keyframe_block => {
                    let pose = part(&pair, Rule::pose).or_else(|| part(&pair, Rule::pose_block));
                    let time = self.expression_in(&pair);
                    let pose = self.pose_use(pose.as_ref().unwrap_or(&pair));
                    TestStatement::Keyframe { time, pose }
                }
                Rule::placement => TestStatement::Object(self.placement(&pair)),
                Rule::run => TestStatement::Run {
                    policy: self.identifier_in(&pair),
                    duration: part(&pair, Rule::expression).map(|duration| self.expression(Some(duration))),
                    span: self.span(&pair),
                },
                Rule::expect => {
                    let condition = match part(&pair, Rule::order) {
                        Some(order) => self.order(&order),
                        None => self.expression_in(&pair),
                    };
                    TestStatement::Expect { condition, span: self.span(&pair) }
                }
                Rule::junk => {
                    self.junk(&pair, Rule::one_test_statement);
                    continue;
                }
                _ => continue,
            });
        }
        Test { title: self.text(part(pair, Rule::text)), cheat: pair.as_rule() == Rule::cheat, statements, span: self.span(pair) }
    }

    /// `reward.pose at neutral > reward.pose at squatting`
    fn order(&mut self, pair: &Pair<'_>) -> Expr {
        let (mut operands, mut operators): (Vec<Expr>, Vec<_>) = (Vec::new(), Vec::new());
        for part in pair.clone().into_inner() {
            if part.as_rule() == Rule::comparison {
                operators.push((super::chain::compare_operator(&part), self.span(&part)));
            } else {
                operands.push(self.moment(&part));
            }
        }
        self.check_direction(&operators);
        let span = operands.iter().map(|operand| operand.span).reduce(Span::to).unwrap_or_default();
        Expr { kind: ExprKind::Compare { operands, operators }, span }
    }

    fn moment(&mut self, pair: &Pair<'_>) -> Expr {
        let value = Box::new(self.expression(part(pair, Rule::postfixed)));
        let pose = self.identifier_in(pair);
        Expr { kind: ExprKind::At { value, pose }, span: self.span(pair) }
    }
}

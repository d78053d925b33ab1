//! Bodies, suites, and tests inside files.

use super::{Builder, part};
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::tree::{Body, BodyGroup, BodyPose, BodyStatement, Family, Protocol, Suite};

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
        let (mut families, mut protocols) = (Vec::new(), Vec::<Protocol>::new());
        for pair in part(pair, Rule::suite_block).into_iter().flat_map(Pair::into_inner) {
            match pair.as_rule() {
                Rule::suite_family => families.push(self.suite_family(&pair)),
                Rule::protocol => {
                    let present = self.protocol(&pair);
                    if let Some(before) = protocols.last()
                        && let Some(nameless) = [before, &present].into_iter().find(|protocol| protocol.name.is_none())
                    {
                        self.report(crate::syntax::wording::nameless_protocol(self.file, nameless.settings.kind.span));
                    }
                    protocols.push(present);
                }
                Rule::junk => self.junk(&pair, Rule::one_suite_statement),
                _ => {}
            }
        }
        Suite { docs, name, families, protocols, span }
    }

    fn protocol(&mut self, pair: &Pair<'_>) -> Protocol {
        let name = part(pair, Rule::identifier).map(|name| self.identifier(&name));
        let kind = self.first_word(pair);
        Protocol { name, settings: self.element_of(pair, kind) }
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
}

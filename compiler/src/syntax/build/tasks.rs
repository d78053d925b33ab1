//! Tasks, sequences, and their statements but for scene, initial state and tests.

use super::{Builder, part, parts};
use crate::diagnostics::Span;
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::tree::{
    Block, BodyEdit, BodyUse, Bounds, Channel, ChannelSetting, Clock, Ends, Entry, Expr, Phase, Random, Reason, Reference,
    Reward, Schedule, Sequence, StateDeclaration, Task, TaskParameter, TaskStatement, Term, Update, Weight,
};
use std::sync::Arc;

impl Builder<'_> {
    pub(super) fn task(&mut self, pair: &Pair<'_>) -> Task {
        let span = self.span(pair);
        Task {
            docs: self.docs(span),
            name: self.identifier_in(pair),
            extends: part(pair, Rule::extends).map(|extends| self.identifier_in(&extends)),
            statements: self.task_statements(part(pair, Rule::task_block), Rule::one_task_statement),
            span,
        }
    }

    pub(super) fn sequence(&mut self, pair: &Pair<'_>) -> Sequence {
        let span = self.span(pair);
        Sequence {
            docs: self.docs(span),
            name: self.identifier_in(pair),
            statements: self.task_statements(part(pair, Rule::sequence_block), Rule::one_sequence_statement),
            span,
        }
    }

    fn task_statements(&mut self, block: Option<Pair<'_>>, context: Rule) -> Vec<TaskStatement> {
        let statements = block.into_iter().flat_map(Pair::into_inner);
        statements.filter_map(|pair| self.task_statement(&pair, context)).collect()
    }

    fn task_statement(&mut self, pair: &Pair<'_>, context: Rule) -> Option<TaskStatement> {
        Some(match pair.as_rule() {
            Rule::family => TaskStatement::Family(self.identifier_in(pair)),
            Rule::body_use => TaskStatement::Body(self.body_use(pair)),
            Rule::control => TaskStatement::Control(self.expression_in(pair)),
            Rule::horizon => TaskStatement::Horizon(self.expression_in(pair)),
            Rule::symmetric => TaskStatement::Symmetric(self.span(pair)),
            Rule::success => TaskStatement::Success(self.expression_in(pair)),
            Rule::binding => TaskStatement::Let(self.binding(pair)),
            Rule::state => TaskStatement::State(self.state(pair)),
            Rule::clock => TaskStatement::Clock(self.clock(pair)),
            Rule::random => TaskStatement::Random(self.random(pair)),
            Rule::reference => TaskStatement::Reference(self.reference(pair)),
            Rule::allow => TaskStatement::Allow(self.allow(pair)),
            Rule::phase => TaskStatement::Phase(self.phase(pair)),
            Rule::params => {
                let block = part(pair, Rule::params_block);
                let entries = self.entries(block, Rule::one_parameter, Self::task_parameter);
                TaskStatement::Params(self.block(pair, entries))
            }
            Rule::observe => {
                let entries = self.channels(pair);
                TaskStatement::Observe(self.block(pair, entries))
            }
            Rule::critic => {
                let entries = self.channels(pair);
                TaskStatement::Critic(self.block(pair, entries))
            }
            Rule::metrics => {
                let entries = self.channels(pair);
                TaskStatement::Metrics(self.block(pair, entries))
            }
            Rule::reward => TaskStatement::Reward(self.reward(pair)),
            Rule::terminate => TaskStatement::Terminate(self.ends(pair)),
            Rule::finish => TaskStatement::Finish(self.ends(pair)),
            Rule::scene => {
                let entries = self.scene_statements(part(pair, Rule::scene_block));
                TaskStatement::Scene(self.block(pair, entries))
            }
            Rule::init => {
                let entries = self.init_statements(part(pair, Rule::init_block));
                TaskStatement::Init(self.block(pair, entries))
            }
            Rule::disturb => TaskStatement::Disturb(self.disturb(pair)),
            Rule::act | Rule::act_block => TaskStatement::Act(self.act(pair)),
            Rule::test | Rule::cheat => TaskStatement::Test(Arc::new(self.test(pair))),
            Rule::junk => {
                self.junk(pair, context);
                return None;
            }
            _ => return None,
        })
    }

    pub(super) fn block<T>(&self, pair: &Pair<'_>, entries: Vec<T>) -> Block<T> {
        let keyword = pair.clone().into_inner().next().map(|keyword| self.span(&keyword)).unwrap_or_default();
        Block { keyword, entries, span: self.span(pair) }
    }

    fn body_use(&mut self, pair: &Pair<'_>) -> BodyUse {
        let edits = parts(pair, Rule::body_edit)
            .map(|edit| BodyEdit {
                target: self.expression(part(&edit, Rule::postfixed)),
                scales: part(&edit, Rule::times_equals).is_some(),
                value: self.expression_in(&edit),
            })
            .collect();
        BodyUse { name: self.identifier_in(pair), edits, span: self.span(pair) }
    }

    fn phase(&mut self, pair: &Pair<'_>) -> Phase {
        Phase {
            task: self.identifier_in(pair),
            until: part(pair, Rule::chain).map(|until| self.expression(Some(until))),
            span: self.span(pair),
        }
    }

    fn task_parameter(&mut self, pair: &Pair<'_>) -> TaskParameter {
        let span = self.span(pair);
        let range = part(pair, Rule::parameter_range).and_then(|bracket| part(&bracket, Rule::range));
        TaskParameter {
            docs: self.docs(span),
            name: self.identifier_in(pair),
            annotation: self.annotation(pair),
            value: self.expression_in(pair),
            range: range.map(|range| self.ranged(&range)),
            per_episode: part(pair, Rule::per_episode).map(|clause| self.span(&clause)),
            set: Vec::new(),
            span,
        }
    }

    fn channel_setting(&mut self, pair: &Pair<'_>) -> ChannelSetting {
        let value = match part(pair, Rule::range) {
            Some(range) => self.ranged(&range),
            None => self.expression_in(pair),
        };
        ChannelSetting { word: self.identifier_in(pair), value, span: self.span(pair) }
    }

    pub(super) fn channels(&mut self, pair: &Pair<'_>) -> Vec<Entry<Channel>> {
        self.entries(part(pair, Rule::channels), Rule::one_channel, |builder, channel| {
            let span = builder.span(channel);
            Channel {
                docs: builder.docs(span),
                label: part(channel, Rule::identifier).map(|label| builder.identifier(&label)),
                value: builder.expression_in(channel),
                settings: parts(channel, Rule::channel_setting).map(|setting| builder.channel_setting(&setting)).collect(),
                span,
            }
        })
    }

    fn reward(&mut self, pair: &Pair<'_>) -> Reward {
        Reward {
            per_second: part(pair, Rule::per_second).is_some(),
            terms: self.entries(part(pair, Rule::terms), Rule::one_term, Self::term),
            span: self.span(pair),
        }
    }

    fn term(&mut self, pair: &Pair<'_>) -> Term {
        let span = self.span(pair);
        Term {
            docs: self.docs(span),
            weight: part(pair, Rule::weight).map(|weight| self.weight(&weight)),
            name: self.identifier_in(pair),
            formula: part(pair, Rule::expression).map(|formula| self.expression(Some(formula))),
            span,
        }
    }

    fn weight(&mut self, pair: &Pair<'_>) -> Weight {
        let first = part(pair, Rule::signed_number);
        let first = first.map(|value| self.signed_number(&value)).unwrap_or_default();
        let schedule = part(pair, Rule::schedule);
        let last = schedule.as_ref().and_then(|schedule| part(schedule, Rule::signed_number));
        let (value, span) = last.map_or(first, |last| self.signed_number(&last));
        let schedule = schedule.map(|schedule| self.schedule(&schedule, first));
        let bounds = if let Some(fixed) = part(pair, Rule::fixed) {
            Bounds::Fixed(self.span(&fixed))
        } else if let Some(range) = part(pair, Rule::weight_range) {
            let mut bounds = parts(&range, Rule::signed_number).map(|bound| self.signed_number(&bound).0);
            let (low, high) = (bounds.next().unwrap_or(value), bounds.next().unwrap_or(value));
            Bounds::Range { low, high, span: self.span(&range) }
        } else {
            Bounds::Free
        };
        Weight { schedule, value, span, file: self.file, bounds }
    }

    fn schedule(&mut self, pair: &Pair<'_>, (from, from_span): (f64, Span)) -> Schedule {
        let shares = parts(pair, Rule::share).flat_map(Pair::into_inner);
        let mut shares: Vec<Expr> = shares.map(|share| self.atom(&share)).collect();
        let end = shares.pop().unwrap_or_else(|| self.missing());
        Schedule { from, from_span, begin: shares.pop(), end, span: self.span(pair) }
    }

    fn signed_number(&mut self, pair: &Pair<'_>) -> (f64, Span) {
        let sign = if part(pair, Rule::minus).is_some() { -1.0 } else { 1.0 };
        let value = part(pair, Rule::number).map_or(0.0, |number| self.number(&number).0);
        (sign * value, self.span(pair))
    }

    fn ends(&mut self, pair: &Pair<'_>) -> Ends {
        Ends {
            after: part(pair, Rule::expression).map(|after| self.expression(Some(after))),
            reasons: self.entries(part(pair, Rule::reasons), Rule::one_reason, |builder, reason| {
                let span = builder.span(reason);
                Reason {
                    docs: builder.docs(span),
                    name: builder.identifier_in(reason),
                    bootstrap: part(reason, Rule::kw_bootstrap).map(|word| builder.span(&word)),
                    condition: builder.expression(part(reason, Rule::chain)),
                    span,
                }
            }),
            span: self.span(pair),
        }
    }

    fn state(&mut self, pair: &Pair<'_>) -> StateDeclaration {
        let span = self.span(pair);
        let updates = parts(pair, Rule::update).map(|update| {
            let mut clauses = update.clone().into_inner().filter(|part| is_clause(part.as_rule()));
            Update {
                value: self.expression(clauses.next()),
                condition: clauses.next().map(|condition| self.expression(Some(condition))),
                span: self.span(&update),
            }
        });
        let updates = updates.collect();
        StateDeclaration {
            docs: self.docs(span),
            name: self.identifier_in(pair),
            annotation: self.annotation(pair),
            initial: self.clause(pair),
            updates,
            span,
        }
    }

    /// The first expression of a statement whose expressions hold no bare `when`.
    fn clause(&mut self, pair: &Pair<'_>) -> crate::syntax::tree::Expr {
        let clause = pair.clone().into_inner().find(|part| is_clause(part.as_rule()));
        self.expression(clause)
    }

    fn clock(&mut self, pair: &Pair<'_>) -> Clock {
        let span = self.span(pair);
        Clock { docs: self.docs(span), name: self.identifier_in(pair), frequency: self.expression_in(pair), span }
    }

    fn random(&mut self, pair: &Pair<'_>) -> Random {
        let span = self.span(pair);
        Random {
            docs: self.docs(span),
            name: self.identifier_in(pair),
            annotation: self.annotation(pair),
            distribution: self.clause(pair),
            accept: part(pair, Rule::accept).map(|accept| self.clause(&accept)),
            redraw: part(pair, Rule::redraw).map(|redraw| self.clause(&redraw)),
            span,
        }
    }

    fn reference(&mut self, pair: &Pair<'_>) -> Reference {
        let span = self.span(pair);
        Reference {
            docs: self.docs(span),
            name: self.identifier_in(pair),
            motion: self.text(part(pair, Rule::text)),
            start: part(pair, Rule::expression).map(|start| self.expression(Some(start))),
            span,
        }
    }
}

fn is_clause(rule: Rule) -> bool {
    matches!(rule, Rule::chain | Rule::if_then_else)
}

//! Which declarations the formulas of a task name: `let`, `fn`, `const`, states, clocks, randoms, parameters.

use crate::diagnostics::FileId;
use crate::notation::{clause, notation};
use crate::resolve::inherit::WholeTask;
use crate::resolve::scope::{Declared, Definition as Known, Names, Place};
use crate::resolve::summary;
use crate::syntax::tree::walk::{Visitor, walk_expression};
use crate::syntax::tree::{Docs, Entry, Expr, ExprKind, TaskStatement};
use msk_program::debug::Definition;
use std::collections::BTreeSet;

/// The declarations that the rewarded, ending, logged and observed formulas of a task name, and those that these name in turn;
/// what is read stands before its readers. `others` are formulas from outside the task.
pub(crate) fn definitions<'a>(
    task: &'a WholeTask,
    names: &Names<'a>,
    others: impl Iterator<Item = (&'a Expr, FileId)>,
) -> Vec<Definition> {
    let mut finder = Finder { names, seen: BTreeSet::new(), found: Vec::new() };
    for placed in &task.statements {
        let place = Place { file: placed.file, in_task: true };
        match &placed.statement {
            TaskStatement::Reward(reward) => {
                let formulas = items(&reward.terms).filter_map(|term| term.formula.as_ref());
                formulas.for_each(|formula| finder.formula(formula, place, &[]));
            }
            TaskStatement::Terminate(ends) | TaskStatement::Finish(ends) => {
                items(&ends.reasons).for_each(|reason| finder.formula(&reason.condition, place, &[]));
            }
            TaskStatement::Metrics(block) | TaskStatement::Observe(block) | TaskStatement::Critic(block) => {
                items(&block.entries).for_each(|channel| finder.formula(&channel.value, place, &[]));
            }
            TaskStatement::Success(success) => finder.formula(success, place, &[]),
            _ => {}
        }
    }
    for (formula, file) in others {
        finder.formula(formula, Place { file, in_task: true }, &[]);
    }
    finder.found
}

fn items<T>(entries: &[Entry<T>]) -> impl Iterator<Item = &T> {
    entries.iter().filter_map(|entry| if let Entry::Item(item) = entry { Some(item) } else { None })
}

struct Finder<'n, 'a> {
    names: &'n Names<'a>,
    /// Names with the file of their declaration.
    seen: BTreeSet<(FileId, String)>,
    found: Vec<Definition>,
}

impl<'a> Finder<'_, 'a> {
    /// Finds what a formula names. The checker has bounded how deep names lead, and a name is followed once.
    fn formula(&mut self, formula: &'a Expr, place: Place, locals: &[String]) {
        let mut words = Words { found: Vec::new() };
        words.expression(formula);
        for word in words.found.iter().filter(|word| !locals.contains(word)) {
            let Some((declared, home)) = self.names.find(place, word) else { continue };
            if self.seen.insert((declared.file, word.clone())) {
                self.declared(word, declared, home);
            }
        }
    }

    fn declared(&mut self, name: &str, declared: Declared<'a>, home: Place) {
        let mut parameters = Vec::new();
        let (kind, docs, parts): (_, &Option<Docs>, Vec<(&'static str, &'a Expr)>) = match declared.definition {
            Known::Const(binding) => ("const", &binding.docs, vec![("", &binding.value)]),
            Known::Let(binding) => ("let", &binding.docs, vec![("", &binding.value)]),
            Known::Function(function) => {
                parameters.extend(function.parameters.iter().map(|parameter| parameter.name.text.clone()));
                ("fn", &function.docs, vec![("", &function.body)])
            }
            Known::State(state) => {
                let mut parts = vec![("", &state.initial)];
                for update in &state.updates {
                    parts.push(("becomes", &update.value));
                    parts.extend(update.condition.as_ref().map(|condition| ("when", condition)));
                }
                ("state", &state.docs, parts)
            }
            Known::Clock(clock) => ("clock", &clock.docs, vec![("at", &clock.frequency)]),
            Known::Parameter(parameter) => ("params", &parameter.docs, vec![("", &parameter.value)]),
            Known::Random(random) => {
                let accept = random.accept.as_ref().map(|accept| ("where", accept));
                let redraw = random.redraw.as_ref().map(|redraw| ("redraw when", redraw));
                let parts = std::iter::once(("", &random.distribution)).chain(accept).chain(redraw);
                ("random", &random.docs, parts.collect())
            }
            // A block of channels is unfolded, and the motion of a reference is no formula.
            Known::Observation(_) | Known::Reference(_) => return,
        };
        for (_, formula) in &parts {
            self.formula(formula, home, &parameters);
        }
        let part = |(word, formula): (&'static str, &Expr)| match word {
            "when" | "where" | "redraw when" => (word, clause(formula)),
            _ => (word, notation(formula)),
        };
        let parts = parts.into_iter().map(part).collect();
        self.found.push(Definition { kind, name: name.to_owned(), parameters, parts, docs: summary(docs.as_ref()) });
    }
}

/// Plain names in a formula.
struct Words {
    found: Vec<String>,
}

impl<'a> Visitor<'a> for Words {
    fn expression(&mut self, expression: &'a Expr) {
        if let ExprKind::Name(name) = &expression.kind
            && !self.found.contains(&name.text)
        {
            self.found.push(name.text.clone());
        }
        walk_expression(self, expression);
    }
}

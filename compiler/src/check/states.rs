//! Declared states: their first values, and what they become.

use super::context::{Cell, Checked, Checker, Failures};
use super::types::{ElementType, Type};
use super::value::{TypedValue, Value};
use crate::diagnostics::{FileId, codes};
use crate::graph::NodeId;
use crate::graph::operation::Operation;
use crate::syntax::tree::{StateDeclaration, TaskStatement, Update};

impl<'a> Checker<'a> {
    fn declared_states(&self) -> Vec<(&'a StateDeclaration, FileId)> {
        let states = self.statements.iter().filter_map(|placed| match &placed.statement {
            TaskStatement::State(state) => Some((state, placed.file)),
            _ => None,
        });
        states.collect()
    }

    /// First values of the declared states, in the order of the text: one may read those above it.
    pub(super) fn states(&mut self) {
        for (state, file) in self.declared_states() {
            let initial: Checked<TypedValue> = self.in_file(file, |checker| {
                let initial = checker.data(&state.initial)?;
                checker.check_annotation(state.annotation.as_ref(), &Value::Typed(initial.clone()))?;
                Ok(initial)
            });
            let name = state.name.text.clone();
            match initial {
                Ok(initial) => self.cells.push(Cell { name, kind: initial.kind, initial: initial.node }),
                Err(reported) => {
                    self.broken_states.insert(name, reported);
                }
            }
        }
    }

    /// New values of the declared states: the first `becomes` whose condition holds, else what it was.
    pub(super) fn updates(&mut self) -> Checked<Vec<NodeId>> {
        let mut nodes = Vec::new();
        let mut failures = Failures::default();
        for (state, file) in self.declared_states() {
            let present = match self.state(&state.name.text, state.name.span) {
                Ok(Value::Typed(present)) => present,
                Ok(other) => {
                    failures.add(self.not_numbers(&other, state.name.span));
                    continue;
                }
                Err(reported) => {
                    failures.add(reported);
                    continue;
                }
            };
            let mut next = present.clone();
            for update in state.updates.iter().rev() {
                next = self.in_file(file, |checker| checker.update(update, &present, next))?;
            }
            nodes.push(next.node);
        }
        failures.or(nodes)
    }

    fn update(&mut self, update: &'a Update, present: &TypedValue, otherwise: TypedValue) -> Checked<TypedValue> {
        let value = self.data(&update.value);
        let condition = update.condition.as_ref().map(|condition| self.single_condition(condition)).transpose();
        let (value, condition) = (value?, condition?);
        let Some(node) = value.kept_as(&mut self.graph, &present.kind) else {
            let (expected, found) = (present.kind.described(self.vocabulary), value.kind.described(self.vocabulary));
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, update.value.span, "a state keeps its type")
                .expected(expected)
                .found(found);
            let wraps = |ty: &Type| ty.met() == Some(ElementType::WrappingAngle);
            let diagnostic = if wraps(&value.kind) && !wraps(&present.kind) && present.kind.dimension() == value.kind.dimension()
            {
                diagnostic.help("this angle wraps, the initial value of the state does not: use an initial value that wraps, such as `angle_difference(0 rad, 20 deg)`")
            } else {
                diagnostic
            };
            return Err(self.report(diagnostic));
        };
        let node = match condition {
            None => node,
            Some(condition) => {
                let inputs = [condition.node, node, otherwise.node];
                self.graph.add(Operation::Choose, &inputs)
            }
        };
        Ok(TypedValue::new(node, present.kind.clone()))
    }
}

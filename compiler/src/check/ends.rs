//! What ends an episode, and what of it formulas may read; declared states and clocks.

use super::context::{Checked, Checker, Ends, Reported};
use super::dimension::Dimension;
use super::scope::Place;
use super::signals::Read;
use super::types::Type;
use super::value::{Data, Form, Value};
use crate::diagnostics::{Span, codes};
use crate::frame::Sensor;
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Operation, Reduction, Unary};
use crate::syntax::tree::{Clock, Entry, Expr, Ident, Reason, TaskStatement};

impl<'a> Checker<'a> {
    /// The reasons of `terminate` with their conditions, checked at the first call.
    pub(crate) fn terminations(&mut self) -> Checked<Vec<(String, NodeId)>> {
        let statements = self.statements;
        match &self.ends {
            Ends::Known(reasons) => return Ok(reasons.clone()),
            Ends::Broken => return Err(Reported),
            Ends::Busy => {
                let span = statements.iter().find_map(|s| if let TaskStatement::Terminate(e) = s { Some(e.span) } else { None });
                let message = "a termination cannot depend on whether the episode terminates";
                return Err(self.error(codes::names::CYCLE, span.unwrap_or_default(), message));
            }
            Ends::Unknown => self.ends = Ends::Busy,
        }
        // Terminations are the task's own, whoever asks for them from within a library or an observation.
        let place = self.task_place;
        let after = std::mem::replace(&mut self.after, false);
        let path = std::mem::take(&mut self.path);
        let reasons = self.elsewhere(place, |checker| checker.reasons(statements));
        (self.after, self.path) = (after, path);
        self.ends = match &reasons {
            Ok(known) => Ends::Known(known.clone()),
            Err(Reported) => Ends::Broken,
        };
        reasons
    }

    fn reasons(&mut self, statements: &'a [TaskStatement]) -> Checked<Vec<(String, NodeId)>> {
        let mut reasons: Vec<(String, NodeId)> = Vec::new();
        let mut broken = false;
        for statement in statements {
            let TaskStatement::Terminate(ends) = statement else { continue };
            let grace = match ends.after.as_ref().map(|after| self.steps(after)).transpose() {
                Ok(grace) => grace,
                Err(Reported) => {
                    broken = true;
                    None
                }
            };
            for entry in &ends.reasons {
                let Some(reason) = self.plain_entry(entry, "termination") else { continue };
                if reasons.iter().any(|(known, _)| *known == reason.name.text) {
                    let message = format!("there are two terminations called `{}`", reason.name.text);
                    self.error(codes::tasks::LABEL_TWICE, reason.name.span, message);
                }
                match self.reason(reason, grace) {
                    Ok(node) => reasons.push((reason.name.text.clone(), node)),
                    Err(Reported) => broken = true,
                }
            }
        }
        if broken { Err(Reported) } else { Ok(reasons) }
    }

    fn reason(&mut self, reason: &'a Reason, grace: Option<f64>) -> Checked<NodeId> {
        let condition = self.single_condition(&reason.condition)?;
        let Some(grace) = grace else { return Ok(condition.node) };
        let step = self.graph.add(Operation::Step, &[]);
        let grace = self.graph.constant(grace);
        let past = self.graph.binary(Binary::Less, grace, step);
        Ok(self.graph.binary(Binary::And, past, condition.node))
    }

    /// The entry itself; `remove` needs `extends`, which is reported.
    pub(crate) fn plain_entry<T>(&mut self, entry: &'a Entry<T>, what: &str) -> Option<&'a T> {
        match entry {
            Entry::Item(item) => Some(item),
            Entry::Allow(allow) => {
                self.allow(allow);
                None
            }
            Entry::Remove(remove) => {
                let message = format!("only a task that extends another can remove a {what}");
                self.error(codes::tasks::NOT_YET, remove.span, message);
                None
            }
        }
    }

    fn any_termination(&mut self) -> Checked<NodeId> {
        let reasons = self.terminations()?;
        if reasons.is_empty() {
            return Ok(self.graph.constant(0.0));
        }
        let nodes: Vec<NodeId> = reasons.into_iter().map(|(_, node)| node).collect();
        let joined = self.graph.join(&nodes);
        Ok(self.graph.reduce(Reduction::Maximum, nodes.len(), joined))
    }

    /// `terminated`, `truncated`, `ended`, `survived`.
    pub(crate) fn end_signal(&mut self, read: Read) -> Checked<Data> {
        let terminated = self.any_termination()?;
        let step = self.graph.add(Operation::Step, &[]);
        let horizon = self.graph.constant(f64::from(self.timing.horizon));
        let complete = self.graph.binary(Binary::LessEqual, horizon, step);
        let node = match read {
            Read::Terminated => terminated,
            Read::Ended => self.graph.binary(Binary::Or, terminated, complete),
            _ => {
                let standing = self.graph.unary(Unary::Not, terminated);
                self.graph.binary(Binary::And, complete, standing)
            }
        };
        Ok(Data::new(node, Type::Bool))
    }

    /// `ended by fallen`
    pub(crate) fn ended_by(&mut self, reason: &Ident) -> Checked<Data> {
        let reasons = self.terminations()?;
        if let Some((_, node)) = reasons.iter().find(|(name, _)| *name == reason.text) {
            return Ok(Data::new(*node, Type::Bool));
        }
        let names = reasons.into_iter().map(|(name, _)| name).collect();
        Err(self.unknown_name(&reason.text, reason.span, names))
    }

    /// A time as a whole number of control steps known while compiling.
    pub(crate) fn steps(&mut self, expr: &'a Expr) -> Checked<f64> {
        let data = self.data(expr)?;
        let known = self.graph.constant_value(data.node);
        match (known, &data.kind) {
            (Some(steps), Type::Steps) if steps >= 0.0 => Ok(steps),
            (Some(seconds), Type::Number(Dimension::TIME)) if seconds >= 0.0 => self.whole_steps(seconds, expr.span),
            (Some(0.0), _) if data.is_zero() => Ok(0.0),
            (None, Type::Steps | Type::Number(Dimension::TIME)) => {
                Err(self.error(codes::types::NOT_CONSTANT, expr.span, "this duration must be known while compiling"))
            }
            _ => {
                let found = data.kind.described(self.vocabulary);
                let diagnostic = self
                    .diagnostic(codes::types::DURATION, expr.span, "a duration is wanted here")
                    .expected("a duration: `25 steps` or `0.25 s`")
                    .found(found);
                Err(self.report(diagnostic))
            }
        }
    }

    fn whole_steps(&mut self, seconds: f64, span: Span) -> Checked<f64> {
        let steps = seconds / self.timing.interval;
        let rounded = steps.round();
        // A quotient of two decimal fractions is off by a few roundings, never by a millionth of a step.
        if (steps - rounded).abs() < 1e-6 && rounded <= f64::from(u32::MAX) {
            return Ok(rounded);
        }
        let (below, above) = (steps.floor() * self.timing.interval, steps.ceil() * self.timing.interval);
        let diagnostic = self.diagnostic(codes::types::DURATION, span, "this is not a whole number of control steps").help(
            format!("the nearest are {} s and {} s, {} and {} steps", tidy(below), tidy(above), steps.floor(), steps.ceil()),
        );
        Err(self.report(diagnostic))
    }

    /// The value of a declared state: before its update in formulas, after it in observations.
    pub(crate) fn state(&mut self, name: &str, span: Span) -> Checked<Value> {
        let Some(index) = self.cells.iter().position(|cell| cell.name == name) else {
            let message = format!("`{name}` is a state whose declaration is broken");
            return Err(if self.diagnostics.is_empty() {
                self.error(codes::names::UNKNOWN_NAME, span, message)
            } else {
                Reported
            });
        };
        let cell = self.cells[index].clone();
        let place = u32::try_from(index).unwrap_or(u32::MAX);
        let operation = if self.after { Operation::StateAfter(place) } else { Operation::StateBefore(place) };
        let node = self.graph.add(operation, &[cell.initial]);
        Ok(Value::Data(Data::new(node, cell.kind)))
    }

    /// `clock phase at 1.1 Hz`: 2 pi f t, an angle that wraps.
    pub(crate) fn clock(&mut self, clock: &'a Clock, place: Place) -> Checked<Data> {
        let frequency = self
            .elsewhere(place, |checker| checker.number_of(&clock.frequency, Dimension::FREQUENCY, "the frequency of a clock"))?;
        let time = self.graph.sensors(vec![Sensor::Time]);
        let turns = self.graph.binary(Binary::Multiply, frequency.node, time);
        let turn = self.graph.constant(std::f64::consts::TAU);
        let angle = self.graph.binary(Binary::Multiply, turn, turns);
        let node = self.graph.unary(Unary::Wrap, angle);
        Ok(Data::new(node, Type::Number(Dimension::ANGLE)).with_form(Form::Wrapping))
    }
}

/// A decimal without the tail of binary roundings.
pub(crate) fn tidy(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

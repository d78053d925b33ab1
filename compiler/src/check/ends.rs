//! What ends an episode, and what of it formulas may read; declared states and clocks.

use super::context::{Checked, Checker, End, Ends as Known, Failures, ReadMode};
use super::dimension::Dimension;
use super::signals::Read;
use super::types::{ElementType, Type};
use super::value::{TypedValue, Value};
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::emit::time;
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Operation};
use crate::numbers::{distinguished, exact, for_people, tidy};
use crate::resolve::inherit::Placed;
use crate::resolve::scope::Place;
use crate::syntax::tree::{Clock, Ends, Entry, Expr, ExprKind, Ident, Reason, TaskStatement};

/// Most control steps in an episode.
pub(crate) const LONGEST_EPISODE: f64 = 1e8;

/// Failures, or ends that are none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Terminate,
    Finish,
}

impl Kind {
    fn of(self, statement: &TaskStatement) -> Option<&Ends> {
        match (self, statement) {
            (Self::Terminate, TaskStatement::Terminate(ends)) | (Self::Finish, TaskStatement::Finish(ends)) => Some(ends),
            _ => None,
        }
    }
}

impl<'a> Checker<'a> {
    /// The reasons of `terminate` with their conditions, checked at the first call.
    pub(crate) fn terminations(&mut self) -> Checked<Vec<End>> {
        self.ends_of(Kind::Terminate)
    }

    /// The reasons of `finish` with their conditions, checked at the first call.
    pub(crate) fn finishes(&mut self) -> Checked<Vec<End>> {
        self.ends_of(Kind::Finish)
    }

    fn known_ends(&mut self, kind: Kind) -> &mut Known {
        match kind {
            Kind::Terminate => &mut self.ends,
            Kind::Finish => &mut self.finishes,
        }
    }

    fn ends_of(&mut self, kind: Kind) -> Checked<Vec<End>> {
        let statements = self.statements;
        match self.known_ends(kind) {
            Known::Known(reasons) => return Ok(reasons.clone()),
            Known::Broken(reported) => return Err(*reported),
            Known::Busy => {
                let found = statements.iter().find_map(|placed| Some((placed.file, kind.of(&placed.statement)?.span)));
                let (file, span) = found.unwrap_or((self.task_place.file, Span::default()));
                let message = match kind {
                    Kind::Terminate => "a termination cannot depend on whether the episode terminates",
                    Kind::Finish => "a reason to finish cannot depend on whether the episode finishes",
                };
                let diagnostic = Diagnostic::new(codes::names::CYCLE, file, span, message);
                return Err(self.report(diagnostic));
            }
            Known::Unknown => *self.known_ends(kind) = Known::Busy,
        }
        // Ends are the task's own, also where they are read from within a library or an observation.
        let place = self.task_place;
        let path = std::mem::take(&mut self.path);
        let mode = ReadMode { after: false, ..self.mode };
        let reasons = self.in_mode(mode, |checker| checker.elsewhere(place, |checker| checker.reasons(statements, kind)));
        self.path = path;
        *self.known_ends(kind) = match &reasons {
            Ok(known) => Known::Known(known.clone()),
            Err(reported) => Known::Broken(*reported),
        };
        reasons
    }

    fn reasons(&mut self, statements: &'a [Placed], kind: Kind) -> Checked<Vec<End>> {
        let mut reasons: Vec<End> = Vec::new();
        let mut failures = Failures::default();
        for placed in statements {
            let Some(ends) = kind.of(&placed.statement) else { continue };
            let found = self.in_file(placed.file, |checker| checker.reasons_of(ends, kind, &mut reasons));
            failures.catch(found);
        }
        failures.or(reasons)
    }

    fn reasons_of(&mut self, ends: &'a Ends, kind: Kind, reasons: &mut Vec<End>) -> Checked<()> {
        let grace = ends.after.as_ref().map(|after| self.steps(after)).transpose();
        let mut failures = Failures::default();
        let grace = failures.catch(grace).flatten();
        for entry in &ends.reasons {
            let Some(reason) = self.plain_entry(entry, "reason") else { continue };
            if reasons.iter().any(|known| known.name == reason.name.text) {
                let message = format!("the termination reason `{}` is declared twice", reason.name.text);
                failures.add(self.error(codes::tasks::LABEL_TWICE, reason.name.span, message));
            }
            if let Some(word) = reason.bootstrap.filter(|_| kind == Kind::Terminate) {
                let message = format!("the failure `{}` cannot bootstrap: nothing of value follows it", reason.name.text);
                let diagnostic = self.diagnostic(codes::tasks::BOOTSTRAP, word, message);
                let help = "a reason that is no failure belongs in `finish { ... }`; the horizon bootstraps by itself";
                failures.add(self.report(diagnostic.help(help)));
            }
            match self.reason(reason, grace) {
                Ok(node) => reasons.push(End {
                    name: reason.name.text.clone(),
                    node,
                    bootstraps: reason.bootstrap.is_some(),
                    file: self.place.file,
                    span: reason.condition.span,
                }),
                Err(reported) => failures.add(reported),
            }
        }
        failures.or(())
    }

    /// A reason is named in results and in `ended by`, so failures and finishes share one namespace.
    pub(crate) fn must_not_share_reasons(&mut self, terminations: &[End], finishes: &[End]) {
        for finish in finishes {
            if let Some(first) = terminations.iter().find(|known| known.name == finish.name) {
                let message = format!("`{}` is declared both in `terminate` and in `finish`", finish.name);
                let diagnostic = Diagnostic::new(codes::tasks::LABEL_TWICE, finish.file, finish.span, message).label(
                    first.file,
                    first.span,
                    "the other",
                );
                self.report(diagnostic);
            }
        }
    }

    fn reason(&mut self, reason: &'a Reason, grace: Option<f64>) -> Checked<NodeId> {
        let condition = self.single_condition(&reason.condition)?;
        Ok(match grace {
            Some(grace) => time::after(&mut self.graph, grace, condition.node),
            None => condition.node,
        })
    }

    /// The entry itself; `remove` needs `extends`, which is reported.
    pub(crate) fn plain_entry<T>(&mut self, entry: &'a Entry<T>, what: &str) -> Option<&'a T> {
        match entry {
            Entry::Item(item) => Some(item),
            Entry::Allow(_) => None,
            Entry::Remove(remove) => {
                let message = format!("only a task that extends another can remove a {what}");
                self.error(codes::composition::OVERRIDES_NOTHING, remove.span, message);
                None
            }
        }
    }

    /// Whether one of the reasons holds.
    pub(crate) fn any_end(&mut self, reasons: &[End]) -> NodeId {
        let conditions: Vec<NodeId> = reasons.iter().map(|reason| reason.node).collect();
        time::any(&mut self.graph, &conditions)
    }

    /// `terminated`, `finished`, `truncated`, `ended`, `survived`.
    pub(crate) fn end_signal(&mut self, read: Read) -> Checked<TypedValue> {
        if read == Read::Finished {
            let finishes = self.finishes()?;
            return Ok(TypedValue::new(self.any_end(&finishes), ElementType::Bool));
        }
        let terminations = self.terminations()?;
        let terminated = self.any_end(&terminations);
        if read == Read::Terminated {
            return Ok(TypedValue::new(terminated, ElementType::Bool));
        }
        let mut others = terminated;
        if read != Read::Survived {
            let finishes = self.finishes()?;
            if !finishes.is_empty() {
                let finished = self.any_end(&finishes);
                others = self.graph.binary(Binary::Or, terminated, finished);
            }
        }
        let (graph, horizon) = (&mut self.graph, self.timing.horizon);
        let node = if read == Read::Ended {
            let complete = time::complete(graph, horizon);
            graph.binary(Binary::Or, others, complete)
        } else {
            time::complete_without(graph, horizon, others)
        };
        Ok(TypedValue::new(node, ElementType::Bool))
    }

    /// `ended by fallen`
    pub(crate) fn ended_by(&mut self, reason: &Ident) -> Checked<TypedValue> {
        let (finishes, terminations) = (self.finishes(), self.terminations());
        let reasons = [terminations?, finishes?].concat();
        if let Some(known) = reasons.iter().find(|known| known.name == reason.text) {
            return Ok(TypedValue::new(known.node, ElementType::Bool));
        }
        let mut names: Vec<String> = reasons.into_iter().map(|reason| reason.name).collect();
        names.dedup();
        Err(self.unknown_name(&reason.text, reason.span, names))
    }

    /// A time as a whole number of control steps known while compiling.
    pub(crate) fn steps(&mut self, expr: &'a Expr) -> Checked<f64> {
        let data = self.data(expr)?;
        let known = self.graph.constant_value(data.node);
        match (known, &data.kind) {
            (Some(steps), Type::One(ElementType::Steps)) if steps >= 0.0 => self.within_an_episode(steps, expr.span),
            (Some(seconds), Type::One(ElementType::Number(Dimension::TIME))) if seconds >= 0.0 => {
                self.whole_steps(seconds, expr.span)
            }
            (Some(0.0), Type::One(_)) if data.is_zero() => Ok(0.0),
            (None, Type::One(ElementType::Steps | ElementType::Number(Dimension::TIME))) => {
                Err(self.error(codes::types::NOT_CONSTANT, expr.span, "this duration must be a compile-time constant"))
            }
            _ => {
                let found = data.kind.described(self.vocabulary);
                let diagnostic = self
                    .diagnostic(codes::types::DURATION, expr.span, "expected a duration")
                    .expected("a duration: `25 steps` or `0.25 s`")
                    .found(found);
                let written = matches!(&expr.kind, ExprKind::Number(number) if number.whole && number.unit.is_none());
                let diagnostic = match known.filter(|_| written) {
                    Some(number) => {
                        let steps = format!("{} steps", exact(number));
                        diagnostic.suggest(format!("write `{steps}`"), expr.span, steps)
                    }
                    None => diagnostic,
                };
                Err(self.report(diagnostic))
            }
        }
    }

    fn whole_steps(&mut self, seconds: f64, span: Span) -> Checked<f64> {
        let steps = self.within_an_episode(seconds / self.timing.interval, span)?;
        let rounded = steps.round();
        // A quotient of two decimal fractions is off by a few roundings, never by a millionth of a step.
        if (steps - rounded).abs() < 1e-6 {
            return Ok(rounded);
        }
        let (below, above) = (steps.floor() * self.timing.interval, steps.ceil() * self.timing.interval);
        let diagnostic =
            self.diagnostic(codes::types::DURATION, span, "this is not a whole number of control steps").help(format!(
                "the nearest are {} s and {} s, {} and {} steps",
                tidy(below),
                tidy(above),
                exact(steps.floor()),
                exact(steps.ceil())
            ));
        Err(self.report(diagnostic))
    }

    /// A number of control steps that an episode may have.
    fn within_an_episode(&mut self, steps: f64, span: Span) -> Checked<f64> {
        if steps <= LONGEST_EPISODE {
            return Ok(steps);
        }
        let [most, found] = self.durations_in_words([LONGEST_EPISODE, steps]);
        let diagnostic = self
            .diagnostic(codes::types::DURATION, span, "this is longer than any episode")
            .expected(format!("at most {most}"))
            .found(found);
        Err(self.report(diagnostic))
    }

    /// Numbers of control steps that differ to the eye, and in seconds.
    pub(crate) fn durations_in_words(&self, durations: [f64; 2]) -> [String; 2] {
        let shown = distinguished(&durations);
        [0, 1].map(|place| {
            let seconds = for_people(durations[place] * self.timing.interval);
            format!("{} steps ({seconds} s)", shown[place])
        })
    }

    /// The value of a declared state: before its update in formulas, after it in observations.
    pub(crate) fn state(&mut self, name: &str, span: Span) -> Checked<Value> {
        let Some(index) = self.cells.iter().position(|cell| cell.name == name) else {
            return Err(match self.broken_states.get(name) {
                Some(reported) => *reported,
                None => {
                    let message = format!("the state `{name}` has no value here yet");
                    let diagnostic = self.diagnostic(codes::names::UNKNOWN_NAME, span, message);
                    self.report(diagnostic.help("the initial value of a state can read only states that are declared before it"))
                }
            });
        };
        let cell = self.cells[index].clone();
        let place = u32::try_from(index).unwrap_or(u32::MAX);
        let operation = if self.mode.after { Operation::StateAfter(place) } else { Operation::StateBefore(place) };
        let node = self.graph.add(operation, &[cell.initial]);
        Ok(Value::Typed(TypedValue::new(node, cell.kind)))
    }

    /// `clock phase at 1.1 Hz`: 2 pi f t, an angle that wraps.
    pub(crate) fn clock(&mut self, clock: &'a Clock, place: Place) -> Checked<TypedValue> {
        let frequency = self
            .elsewhere(place, |checker| checker.number_of(&clock.frequency, Dimension::FREQUENCY, "the frequency of a clock"))?;
        let node = time::clock(&mut self.graph, frequency.node, self.timing.interval);
        Ok(TypedValue::new(node, ElementType::WrappingAngle))
    }
}

//! `params`: numbers that may be set from outside, where a task is compiled or for every episode.

use super::context::{Checked, Checker, Failures};
use super::dimension::Dimension;
use super::offered::unit_of;
use super::random::KnownRandom;
use super::types::{ElementType, Type};
use super::value::{LiteralKind, TypedValue, Value};
use crate::diagnostics::{FileId, Span, codes};
use crate::emit::draws;
use crate::graph::NodeId;
use crate::graph::operation::Chance;
use crate::resolve::scope::Place;
use crate::spoken::{self, SpokenUnit};
use crate::syntax::tree::{Expr, ExprKind, TaskParameter, TaskStatement, UnaryOperator};
use crate::task::Parameter;

impl<'a> Checker<'a> {
    /// Checks every parameter of the task; one that nothing reads is an error, reported by [`Checker::parameters_in_use`].
    pub(crate) fn parameters(&mut self) -> Checked<Vec<Parameter>> {
        let statements = self.statements;
        let mut parameters: Vec<Parameter> = Vec::new();
        let mut failures = Failures::default();
        for placed in statements {
            let TaskStatement::Params(block) = &placed.statement else { continue };
            for entry in &block.entries {
                let found = self.in_file(placed.file, |checker| {
                    let parameter = checker.plain_entry(entry, "parameter")?;
                    Some(checker.parameter(parameter, placed.file))
                });
                match found {
                    Some(Ok((_, parameter))) => parameters.push(parameter),
                    Some(Err(reported)) => failures.add(reported),
                    // A removal outside of an extending task is reported; a lint allowed is no parameter.
                    None => {}
                }
            }
        }
        failures.or(parameters)
    }

    /// The value in force of a parameter that is read.
    pub(crate) fn parameter_value(&mut self, parameter: &'a TaskParameter, file: FileId) -> Checked<Value> {
        let key = (Place { file, in_task: true }, false, parameter.name.text.clone());
        if let Some(known) = self.memo.get(&key) {
            return known.clone();
        }
        let value = self.in_file(file, |checker| checker.parameter(parameter, file)).map(|(value, _)| value);
        self.memo.insert(key, value.clone());
        value
    }

    fn parameter(&mut self, parameter: &'a TaskParameter, file: FileId) -> Checked<(Value, Parameter)> {
        let errors = self.diagnostics.len();
        let found = self.parameter_here(parameter, file);
        // It is checked where it is declared and where it is first read; errors are reported once.
        let reported: Vec<_> = self.diagnostics.drain(errors..).collect();
        for diagnostic in reported {
            if !self.diagnostics.contains(&diagnostic) {
                self.diagnostics.push(diagnostic);
            }
        }
        found
    }

    fn parameter_here(&mut self, parameter: &'a TaskParameter, file: FileId) -> Checked<(Value, Parameter)> {
        let (default, dimension) = self.constant_number(&parameter.value, "a parameter is a constant number")?;
        let declared = TypedValue::new(self.graph.constant(default), self.number_type(&parameter.value, dimension));
        self.check_annotation(parameter.annotation.as_ref(), &Value::Typed(declared.clone()))?;
        let range = match &parameter.range {
            None => None,
            Some(range) => Some(self.parameter_range(range, dimension)?),
        };
        let unit = spoken::written(dimension, [&parameter.value]);
        self.must_lie_within(default, range, &parameter.name.text, (parameter.value.span, &unit))?;
        let mut value = default;
        for (expr, origin) in &parameter.set {
            value = self.in_file(*origin, |checker| {
                let value = checker.set_value(expr, parameter, dimension)?;
                checker.must_lie_within(value, range, &parameter.name.text, (expr.span, &unit))?;
                if declared.kind == Type::One(ElementType::Int) && value.fract() != 0.0 {
                    let message = format!("`{}` is a whole number", parameter.name.text);
                    return Err(checker.error(codes::types::WRONG_TYPE, expr.span, message));
                }
                Ok(value)
            })?;
        }
        let whole = declared.kind == Type::One(ElementType::Int);
        let node = match (parameter.per_episode, range) {
            (None, _) => self.graph.constant(value),
            (Some(_), Some(range)) => self.value_of_episode(&parameter.name.text, range, &declared.kind),
            (Some(span), None) => {
                let message = format!("the parameter `{}` changes from episode to episode and has no range", parameter.name.text);
                let help = "declare what it may be: `speed = 1.3 m/s (0.5..2 m/s) per episode`";
                let diagnostic = self.diagnostic(codes::tasks::MISSING, span, message).help(help);
                return Err(self.report(diagnostic));
            }
        };
        let checked = Parameter {
            name: parameter.name.text.clone(),
            value,
            default,
            range,
            unit: dimension.to_string(),
            per_episode: parameter.per_episode.is_some(),
            scale: unit_of(&parameter.value).unwrap_or(1.0),
            whole,
        };
        let _ = file;
        Ok((Value::Typed(TypedValue { node, kind: declared.kind, literal: LiteralKind::Plain }), checked))
    }

    /// The value of a parameter that every episode has of its own: a random that is always given. What bounds it is its range.
    fn value_of_episode(&mut self, name: &str, [low, high]: [f64; 2], kind: &Type) -> NodeId {
        if let Some(known) = self.randoms.iter().find(|known| known.parameter.is_some() && known.name == name) {
            return known.data.node;
        }
        let index = self.randoms.len();
        let whole = *kind == Type::One(ElementType::Int);
        let graph = &mut self.graph;
        let u = draws::noise(graph, index, Chance::Uniform, 1);
        let [from, width] = [low, high - low + f64::from(u8::from(whole))].map(|value| graph.constant(value));
        let candidate = draws::uniform(graph, from, width, whole, u);
        let node = draws::held(graph, index, &[candidate]);
        self.randoms.push(KnownRandom {
            name: name.to_owned(),
            data: TypedValue::new(node, kind.clone()),
            redraw: None,
            written: Some(["the caller".to_owned(), String::new()]),
            parameter: Some([low, high]),
        });
        node
    }

    /// A parameter written as a whole number is one, unless its type is written as another.
    fn number_type(&self, written: &Expr, dimension: Dimension) -> ElementType {
        let mut inner = written;
        while let ExprKind::Paren(within) | ExprKind::Unary { operator: UnaryOperator::Negate, operand: within } = &inner.kind {
            inner = within;
        }
        match &inner.kind {
            ExprKind::Number(number) if number.whole && number.unit.is_none() => ElementType::Int,
            _ => ElementType::Number(dimension),
        }
    }

    pub(super) fn constant_number(&mut self, expr: &'a Expr, wanted: &str) -> Checked<(f64, Dimension)> {
        let data = self.data(expr)?;
        let dimension = data.kind.dimension().filter(|_| data.kind.is_one_number());
        match (self.graph.constant_value(data.node), dimension) {
            (Some(value), Some(dimension)) if value.is_finite() => Ok((value, dimension)),
            _ => {
                let found = data.kind.described(self.vocabulary);
                let diagnostic = self.diagnostic(codes::types::NOT_CONSTANT, expr.span, wanted).found(found);
                Err(self.report(diagnostic))
            }
        }
    }

    fn parameter_range(&mut self, range: &'a Expr, dimension: Dimension) -> Checked<[f64; 2]> {
        let ExprKind::Range { low, high } = &range.kind else {
            return Err(self.error(codes::types::WRONG_TYPE, range.span, "the range of a parameter is `low .. high`"));
        };
        let wanted = "the bounds of a parameter are constant numbers";
        let (top, top_dimension) = self.constant_number(high, wanted)?;
        let (mut bottom, bottom_dimension) = self.constant_number(low, wanted)?;
        let mut fits = top_dimension == dimension && bottom_dimension == dimension;
        if !fits && top_dimension == dimension && bottom_dimension.is_none() {
            // A plain lower bound takes the unit of the upper.
            bottom *= unit_of(high).unwrap_or(1.0);
            fits = true;
        }
        if !fits {
            let diagnostic = self
                .diagnostic(codes::types::DIMENSIONS_DIFFER, range.span, "the bounds must have the unit of the parameter")
                .expected(dimension.described());
            return Err(self.report(diagnostic));
        }
        if bottom > top {
            return Err(self.error(codes::tasks::OUT_OF_RANGE, range.span, "the lower bound is above the upper one"));
        }
        Ok([bottom, top])
    }

    /// A value from outside: with its unit, or plain in the unit in which the parameter is written.
    fn set_value(&mut self, expr: &'a Expr, parameter: &TaskParameter, dimension: Dimension) -> Checked<f64> {
        let (value, found) = self.constant_number(expr, "a parameter takes a number")?;
        if found == dimension {
            return Ok(value);
        }
        if found.is_none() {
            return Ok(value * unit_of(&parameter.value).unwrap_or(1.0));
        }
        let diagnostic = self
            .diagnostic(codes::types::DIMENSIONS_DIFFER, expr.span, format!("`{}` has another unit", parameter.name.text))
            .expected(dimension.described())
            .found(found.described());
        Err(self.report(diagnostic))
    }

    fn must_lie_within(
        &mut self,
        value: f64,
        range: Option<[f64; 2]>,
        name: &str,
        (span, unit): (Span, &SpokenUnit),
    ) -> Checked<()> {
        match range {
            Some([low, high]) if !(low..=high).contains(&value) => {
                let (range, found) = unit.tell_beside([low, high], value);
                let diagnostic = self
                    .diagnostic(codes::tasks::OUT_OF_RANGE, span, format!("the parameter `{name}` is out of range"))
                    .expected(range)
                    .found(found);
                Err(self.report(diagnostic))
            }
            _ => Ok(()),
        }
    }

    /// A parameter that nothing reads could be set without any effect: an error.
    pub(crate) fn parameters_in_use(&mut self) {
        let names = self.names;
        for (name, declared) in names.of_task() {
            if matches!(declared.definition, crate::resolve::scope::Definition::Parameter(_)) && !self.used.contains(name) {
                let message = format!("unused parameter `{name}`: setting it would have no effect");
                let span = declared.definition.span();
                let diagnostic =
                    crate::diagnostics::Diagnostic::new(codes::composition::UNUSED_PARAMETER, declared.file, span, message);
                self.report(diagnostic);
            }
        }
    }
}

//! `random`: values that chance decides, drawn where an episode begins and anew at a redraw.
//!
//! A draw is a formula of raw numbers: `uniform(a..b)` is `a + (b - a) u`. The graph holds that formula, and the condition that
//! a draw must fulfil, as inputs of the random itself; the program tries them until one is taken.

use super::context::{Checked, Checker, Failures, ReadMode, Step};
use super::types::{ElementType, Frame, Type};
use super::value::{LiteralKind, TypedValue, Value};
use crate::diagnostics::{Span, codes};
use crate::emit::draws;
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Chance, Operation};
use crate::resolve::scope::{Declared, Definition};
use crate::syntax::tree::{Argument, Expr, ExprKind, Random, TaskStatement};

/// Dimensions that one random may have.
const MOST_RANGES: usize = 64;

/// A random whose draw is checked.
#[derive(Debug, Clone)]
pub(crate) struct KnownRandom {
    pub name: String,
    /// Its type and form; the node is the random before its redraw.
    pub data: TypedValue,
    /// When it is drawn anew.
    pub redraw: Option<NodeId>,
    /// What is drawn and when it is drawn anew, in words, where no statement declares it.
    pub written: Option<[String; 2]>,
    /// What a parameter may be that a caller sets for every episode, and chance never draws.
    pub parameter: Option<[f64; 2]>,
}

impl<'a> Checker<'a> {
    /// Checks all randoms in the order of the text, so that their numbers do not depend on who reads them first.
    pub(crate) fn randoms(&mut self) {
        let statements = self.statements;
        for placed in statements {
            if let TaskStatement::Random(random) = &placed.statement {
                let declared = Declared { definition: Definition::Random(random), file: placed.file };
                let _ = self.in_file(placed.file, |checker| checker.random(random, declared, random.name.span));
            }
        }
    }

    /// When randoms are drawn anew; after everything else is known, since that may read anything.
    pub(crate) fn redraws(&mut self) -> Checked<()> {
        let statements = self.statements;
        let mut failures = Failures::default();
        for placed in statements {
            let TaskStatement::Random(random) = &placed.statement else { continue };
            let Some(redraw) = &random.redraw else { continue };
            let when = self.in_file(placed.file, |checker| checker.single_condition(redraw));
            let known = self.randoms.iter_mut().find(|known| known.name == random.name.text);
            // A random that is not known is broken, which its declaration reported.
            if let (Some(when), Some(known)) = (failures.catch(when), known) {
                known.redraw = Some(when.node);
            }
        }
        failures.or(())
    }

    /// The value of a random: before its redraw in formulas, after it in observations.
    pub(crate) fn random(&mut self, random: &'a Random, declared: Declared<'a>, span: Span) -> Checked<Value> {
        let name = &random.name.text;
        if !self.randoms.iter().any(|known| known.name == *name) {
            let key = (self.task_place, false, name.clone());
            if let Some(Err(reported)) = self.memo.get(&key) {
                return Err(*reported);
            }
            self.enter(Step { name: name.clone(), file: self.place.file, span, call: false }, declared)?;
            let mode = ReadMode { after: false, ..self.mode };
            let drawn = self.in_mode(mode, |checker| checker.in_file(declared.file, |checker| checker.draw(random)));
            self.path.pop();
            match drawn {
                Ok(data) => {
                    let known = KnownRandom { name: name.clone(), data, redraw: None, written: None, parameter: None };
                    self.randoms.push(known);
                }
                Err(reported) => {
                    self.memo.insert(key, Err(reported));
                    return Err(reported);
                }
            }
        }
        let Some(index) = self.randoms.iter().position(|known| known.name == *name) else {
            return Err(self.error(codes::composition::DRAW, span, format!("`{name}` is not drawn yet here")));
        };
        let mut data = self.randoms[index].data.clone();
        if self.mode.after {
            data.node = draws::redrawn(&mut self.graph, index, data.node);
        }
        Ok(Value::Typed(data))
    }

    fn draw(&mut self, random: &'a Random) -> Checked<TypedValue> {
        let index = self.randoms.len();
        let candidate = self.what_is_drawn(&random.distribution, index)?;
        self.check_annotation(random.annotation.as_ref(), &Value::Typed(candidate.clone()))?;
        if self.randoms.len() != index {
            // Its arguments read a random that was not known yet: that one has taken this number.
            let message = "a draw may read only randoms that are declared above it";
            return Err(self.error(codes::composition::DRAW, random.distribution.span, message));
        }
        let mut inputs = vec![candidate.node];
        if let Some(accept) = &random.accept {
            self.locals.push(self.local(&random.name, Value::Typed(candidate.clone())));
            let condition = self.single_condition(accept);
            self.locals.pop();
            let condition = condition?;
            if self.randoms.len() != index {
                let message = "a condition of a draw may read only randoms that are declared above it";
                return Err(self.error(codes::composition::DRAW, accept.span, message));
            }
            self.must_not_remember(condition.node, index, accept.span)?;
            inputs.push(condition.node);
        }
        let node = draws::held(&mut self.graph, index, &inputs);
        Ok(TypedValue { node, ..candidate })
    }

    /// Operators advance once per step, tries are many: what a try gives cannot be remembered.
    fn must_not_remember(&mut self, condition: NodeId, index: usize, span: Span) -> Checked<()> {
        let index = draws::number(index);
        let mut tried = vec![false; self.graph.nodes().len()];
        let mut remembers = false;
        for id in self.graph.reachable([condition]) {
            let node = self.graph.node(id);
            let depends = match node.operation {
                Operation::Noise(own, ..) => own == index,
                Operation::Drawn(_) | Operation::DrawnAfter(_) => false,
                _ => node.inputs.iter().any(|input| tried[input.index()]),
            };
            tried[id.index()] = depends;
            remembers |= depends && matches!(node.operation, Operation::Memory(_));
        }
        if !remembers {
            return Ok(());
        }
        let message = "the condition of a draw is evaluated on a single draw: stateful operators are not allowed";
        Err(self.error(codes::composition::DRAW, span, message))
    }

    /// What a try gives.
    fn what_is_drawn(&mut self, expr: &'a Expr, index: usize) -> Checked<TypedValue> {
        if let ExprKind::Call { function, arguments } = &expr.kind
            && let ExprKind::Name(name) = &function.kind
            && let Some(misnamed) = arguments.iter().find_map(|argument| argument.name.as_ref())
        {
            let message = format!("`{}` takes no argument `{}`", name.text, misnamed.text);
            return Err(self.error(codes::types::ARGUMENTS, misnamed.span, message));
        }
        let called = match &expr.kind {
            ExprKind::Call { function, arguments } => match &function.kind {
                ExprKind::Name(name) => Some((name.text.as_str(), arguments.as_slice())),
                _ => None,
            },
            _ => None,
        };
        match called {
            Some(("uniform", ranges @ [_, ..])) if ranges.len() <= MOST_RANGES => self.draw_uniform(ranges, index, expr.span),
            Some(("normal", [mean, deviation])) => self.draw_normal(&mean.value, &deviation.value, index),
            Some(("choice", values @ [_, ..])) => self.draw_choice(values, index, expr.span),
            _ => {
                let diagnostic = self
                    .diagnostic(codes::composition::DRAW, expr.span, "not a distribution")
                    .expected("`uniform(low .. high)`, `uniform(low .. high, low .. high, ...)`, `normal(mean, deviation)` or `choice(a, b, ...)`");
                Err(self.report(diagnostic))
            }
        }
    }

    fn draw_uniform(&mut self, ranges: &'a [Argument], index: usize, span: Span) -> Checked<TypedValue> {
        let noise = draws::noise(&mut self.graph, index, Chance::Uniform, ranges.len());
        let mut parts = Vec::new();
        let mut failures = Failures::default();
        for (place, range) in ranges.iter().enumerate() {
            let u = self.graph.select([place], noise);
            match self.between(&range.value, u) {
                Ok(data) => parts.push((Ok(Value::Typed(data)), range.value.span)),
                Err(reported) => failures.add(reported),
            }
        }
        failures.or(())?;
        if let [(Ok(Value::Typed(only)), _)] = parts.as_slice() {
            return Ok(only.clone());
        }
        match self.bracket(parts, span)? {
            Value::Typed(data) => Ok(data),
            other => Err(self.not_numbers(&other, span)),
        }
    }

    /// `low + (high - low) u`; of whole numbers the upper end is excluded.
    fn between(&mut self, range: &'a Expr, u: NodeId) -> Checked<TypedValue> {
        let ExprKind::Range { low, high } = &range.kind else {
            let diagnostic =
                self.diagnostic(codes::composition::DRAW, range.span, "`uniform` takes ranges").expected("`low .. high`");
            return Err(self.report(diagnostic));
        };
        let (bottom, top) = (self.data(low), self.data(high));
        let (bottom, top) = (bottom?, top?);
        let bottom = self.lower_end(bottom, low, (&top, high));
        let (from, to, kind) = self.agree("draw between", (bottom, low), (top, high))?;
        if !kind.is_one_number() {
            let found = kind.described(self.vocabulary);
            let diagnostic =
                self.diagnostic(codes::types::WRONG_TYPE, range.span, "the bounds of a draw are numbers").found(found);
            return Err(self.report(diagnostic));
        }
        if let (Some(from), Some(to)) = (self.graph.constant_value(from), self.graph.constant_value(to))
            && (from > to || kind == Type::One(ElementType::Int) && from == to)
        {
            return Err(self.error(codes::tasks::OUT_OF_RANGE, range.span, "this range is empty"));
        }
        let width = self.graph.binary(Binary::Subtract, to, from);
        let node = draws::uniform(&mut self.graph, from, width, kind == Type::One(ElementType::Int), u);
        Ok(TypedValue::new(node, kind))
    }

    /// `mean + deviation z`, lane by lane.
    fn draw_normal(&mut self, mean: &'a Expr, deviation: &'a Expr, index: usize) -> Checked<TypedValue> {
        let (middle, width) = (self.data(mean), self.data(deviation));
        let (middle, width) = (middle?, width?);
        let numbers = middle
            .kind
            .all(|element| element.is_number() || matches!(element, ElementType::Vector { .. } | ElementType::Place(_)));
        let (dimension, own) = (middle.kind.dimension(), width.kind.dimension());
        let single = width.kind.is_one_number();
        if !numbers || !single || !(dimension == own || middle.is_zero() || width.is_zero()) {
            let diagnostic = self
                .diagnostic(codes::composition::DRAW, deviation.span, "mean and standard deviation have different units")
                .expected(middle.kind.described(self.vocabulary))
                .found(width.kind.described(self.vocabulary));
            return Err(self.report(diagnostic));
        }
        if self.graph.constant_value(width.node).is_some_and(|width| width < 0.0) {
            return Err(self.error(codes::tasks::OUT_OF_RANGE, deviation.span, "a standard deviation cannot be negative"));
        }
        let lanes = self.graph.width(middle.node);
        let noise = draws::noise(&mut self.graph, index, Chance::Normal, lanes);
        let node = draws::scaled(&mut self.graph, middle.node, width.node, noise);
        let kind = if middle.is_zero() && middle.kind.is_one_number() { width.kind } else { middle.kind.clone() };
        let plain = |element: ElementType| if element == ElementType::Int { ElementType::PLAIN } else { element };
        let kind = kind.map(|element| Some(plain(element))).unwrap_or(kind);
        let literal = if middle.is_bracket() { LiteralKind::Bracket } else { LiteralKind::Plain };
        Ok(TypedValue { node, kind, literal })
    }

    /// One of several values, or of the elements of a list, each as likely.
    fn draw_choice(&mut self, values: &'a [Argument], index: usize, span: Span) -> Checked<TypedValue> {
        let list = match values {
            [only] => self.data(&only.value)?,
            several => {
                let values = several.iter().map(|argument| (self.value(&argument.value), argument.value.span)).collect();
                self.elements(values, span)?
            }
        };
        let (Some(length), Some(element)) = (list.kind.length(), list.kind.met()) else {
            return Err(self.error(codes::composition::DRAW, span, "`choice` takes several values or a list"));
        };
        let u = draws::noise(&mut self.graph, index, Chance::Uniform, 1);
        let node = draws::choice(&mut self.graph, list.node, length, list.kind.element_lanes(), u);
        Ok(TypedValue::new(node, element))
    }

    /// Values of one kind as a list: brackets of numbers among them are vectors, not parts of a longer list.
    fn elements(&mut self, values: Vec<(Checked<Value>, Span)>, span: Span) -> Checked<TypedValue> {
        let vectors = values.into_iter().map(|(value, place)| {
            let value = value.map(|value| match value {
                Value::Typed(data) if data.is_bracket() => Value::Typed(self.as_vector(data, Frame::World)),
                other => other,
            });
            (value, place)
        });
        let vectors = vectors.collect();
        match self.bracket(vectors, span)? {
            Value::Typed(data) => Ok(data),
            other => Err(self.not_numbers(&other, span)),
        }
    }
}

//! Expressions: from the syntax tree to typed nodes of the graph.

use super::context::{Checked, Checker, Failures, Reported};
use super::tests::over_resets;
use super::types::{ElementType, Frame, Type};
use super::unit;
use super::value::{EntityRef, LiteralKind, TypedValue, Value};
use crate::diagnostics::{Span, codes};
use crate::emit::layout::{element, spread_each};
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Operation, Unary};
use crate::syntax::tree::{Expr, ExprKind, Quantity, UnaryOperator};

impl<'a> Checker<'a> {
    /// What an expression stands for.
    ///
    /// # Errors
    /// Whatever is wrong in it; both sides of an operator are looked at before giving up.
    pub(crate) fn value(&mut self, expr: &'a Expr) -> Checked<Value> {
        let id = self.hir.open(self.place.file, expr.span, (&expr.kind).into());
        let value = self.deeper(expr.span, |checker| checker.value_here(expr)).and_then(|value| self.verified(value, expr.span));
        self.hir.close(id, value.as_ref().ok());
        value
    }

    /// A value whose node is as wide as its type.
    fn verified(&mut self, value: Value, span: Span) -> Checked<Value> {
        if let Value::Typed(data) = &value {
            self.graph.verify_width(data.node, data.kind.lanes());
        }
        self.must_be_consistent(span)?;
        Ok(value)
    }

    fn value_here(&mut self, expr: &'a Expr) -> Checked<Value> {
        match &expr.kind {
            ExprKind::Number(quantity) => self.literal(quantity, expr.span).map(Value::Typed),
            ExprKind::Bool(truth) => {
                let node = self.graph.constant(f64::from(u8::from(*truth)));
                Ok(Value::Typed(TypedValue::new(node, ElementType::Bool)))
            }
            ExprKind::Name(name) => self.name(name),
            ExprKind::Selector { kind, pattern } => self.selector(kind, pattern),
            ExprKind::Field { base, name } => self.field(base, name, expr.span),
            ExprKind::Call { function, arguments } if self.in_tests.is_some() && over_resets(arguments).is_some() => {
                self.statistic(function, arguments, expr.span).map(Value::Typed)
            }
            ExprKind::Call { function, arguments } => self.call(function, arguments, expr.span),
            ExprKind::Index { base, index } => self.index(base, index, expr.span),
            ExprKind::List(elements) => {
                let values: Vec<_> = elements.iter().map(|element| (self.value(element), element.span)).collect();
                self.warn_repeated(elements, &values);
                self.bracket(values, expr.span)
            }
            ExprKind::Comprehension { element, variable, source } => self.comprehension(element, variable, source, expr.span),
            ExprKind::Paren(inner) => self.value(inner),
            ExprKind::Unary { operator: UnaryOperator::Negate, operand } => self.negate(operand).map(Value::Typed),
            ExprKind::Unary { operator: UnaryOperator::Not, operand } => {
                let operand = self.condition(operand)?;
                let node = self.graph.unary(Unary::Not, operand.node);
                Ok(Value::Typed(TypedValue::new(node, operand.kind)))
            }
            ExprKind::Binary { .. } => self.binary_chain(expr).map(Value::Typed),
            ExprKind::Compare { operands, operators } => self.comparison(operands, operators).map(Value::Typed),
            ExprKind::InFrame { value, frame } => self.in_frame(value, frame).map(Value::Typed),
            ExprKind::If { branches, otherwise } => self.if_else(branches, otherwise).map(Value::Typed),
            ExprKind::When { value, condition } => self.when(value, condition).map(Value::Typed),
            ExprKind::EndedBy(reason) => self.ended_by(reason).map(Value::Typed),
            ExprKind::Range { .. } => {
                Err(self.error(codes::types::WRONG_TYPE, expr.span, "a range is allowed only where bounds are expected"))
            }
            ExprKind::Text(_) => {
                let message = "a string has no value by itself";
                let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, message);
                let help = "name its kind: `muscle \"...\"`, `joint \"...\"` or `landmark \"...\"`";
                Err(self.report(diagnostic.help(help)))
            }
            // At which moment is the test's business.
            ExprKind::At { value, .. } if self.in_tests.is_some() => self.value(value),
            ExprKind::At { .. } => {
                Err(self.error(codes::types::WRONG_TYPE, expr.span, "`at` a pose is allowed only in `expect`"))
            }
            ExprKind::Error(reported) => Err(*reported),
        }
    }

    /// Reports what the graph's verifier has found since it was last asked: a mistake of the compiler.
    ///
    /// # Errors
    /// There was something.
    pub(crate) fn must_be_consistent(&mut self, span: Span) -> Checked<()> {
        match self.graph.take_finding() {
            Some(finding) => Err(self.internal_error(finding, span)),
            None => Ok(()),
        }
    }

    /// Reports a finding of the graph's verifier.
    pub(crate) fn internal_error(&mut self, finding: String, span: Span) -> Reported {
        let diagnostic = self
            .diagnostic(
                codes::tasks::INTERNAL,
                span,
                "internal compiler error: the layout of this formula does not match its type",
            )
            .found(finding)
            .help("this is a bug in the compiler; please report it, with the source text");
        self.report(diagnostic)
    }

    /// The numbers that an expression stands for.
    ///
    /// # Errors
    /// What [`Checker::value`] reports, and a part of the body where numbers are wanted.
    pub(crate) fn data(&mut self, expr: &'a Expr) -> Checked<TypedValue> {
        match self.value(expr)? {
            Value::Typed(data) => Ok(data),
            other => Err(self.not_numbers(&other, expr.span)),
        }
    }

    pub(crate) fn not_numbers(&mut self, value: &Value, span: Span) -> Reported {
        let (what, example) = match value {
            Value::Entity(thing) => (self.thing_name(*thing), self.property_example(*thing)),
            Value::Entities { members, .. } => (
                format!("a list of {} parts of the body", members.len()),
                members.first().map_or("position", |thing| self.property_example(*thing)),
            ),
            Value::Typed(_) => ("a number".to_owned(), "position"),
        };
        let message = format!("this is {what}, not a number");
        let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, span, message);
        self.report(diagnostic.help(format!("use one of its properties, such as `.{example}`")))
    }

    fn property_example(&self, thing: EntityRef) -> &'static str {
        match thing {
            EntityRef::Joint(_) => "q",
            EntityRef::Muscle(_) => "activation",
            EntityRef::Landmark(_) | EntityRef::CentreOfMass | EntityRef::Ground | EntityRef::Robot => "position",
        }
    }

    /// A condition or a list of them.
    ///
    /// # Errors
    /// Anything else.
    pub(crate) fn condition(&mut self, expr: &'a Expr) -> Checked<TypedValue> {
        let data = self.data(expr)?;
        if data.kind.element() == Some(ElementType::Bool) {
            return Ok(data);
        }
        Err(self.not_a_condition(&data, expr))
    }

    /// Reports something else where a condition is wanted.
    pub(crate) fn not_a_condition(&mut self, data: &TypedValue, expr: &Expr) -> Reported {
        let found = data.kind.described(self.vocabulary);
        let diagnostic = self
            .diagnostic(codes::types::WRONG_TYPE, expr.span, "expected a condition")
            .expected("a condition (true or false)")
            .found(found)
            .help("compare it with something: `x > 0.5 m`");
        self.report(diagnostic)
    }

    /// One condition.
    ///
    /// # Errors
    /// Anything else; a list needs `any` or `all`.
    pub(crate) fn single_condition(&mut self, expr: &'a Expr) -> Checked<TypedValue> {
        let data = self.condition(expr)?;
        if data.kind.length().is_none() {
            return Ok(data);
        }
        let found = data.kind.described(self.vocabulary);
        let diagnostic = self
            .diagnostic(codes::types::WRONG_TYPE, expr.span, "expected one condition, found a list")
            .found(found)
            .help("use `any(...)` or `all(...)`");
        Err(self.report(diagnostic))
    }

    fn literal(&mut self, quantity: &Quantity, span: Span) -> Checked<TypedValue> {
        let Some(written) = &quantity.unit else {
            let node = self.graph.constant(quantity.value);
            let kind = if quantity.whole { ElementType::Int } else { ElementType::PLAIN };
            let literal = if quantity.value == 0.0 { LiteralKind::Zero } else { LiteralKind::Plain };
            return Ok(TypedValue::new(node, kind).with_literal(literal));
        };
        if let [only] = written.factors.as_slice()
            && matches!(only.name.as_str(), "step" | "steps")
        {
            if quantity.whole && only.numerator == 1 && only.denominator == 1 {
                let node = self.graph.constant(quantity.value);
                return Ok(TypedValue::new(node, ElementType::Steps));
            }
            return Err(self.error(codes::types::DURATION, span, "a number of control steps must be whole"));
        }
        match unit::evaluate(written) {
            Ok(one) => {
                self.note_length(quantity.value * one.value, one.dimension, span);
                let node = self.graph.constant(quantity.value * one.value);
                Ok(TypedValue::new(node, ElementType::Number(one.dimension)))
            }
            Err(factor) => {
                let message = format!("`{}` cannot be used in a unit like this", factor.name);
                Err(self.error(codes::names::UNIT, factor.span, message))
            }
        }
    }

    fn negate(&mut self, operand: &'a Expr) -> Checked<TypedValue> {
        let data = self.data(operand)?;
        let signed =
            |element: ElementType| element.is_number() || matches!(element, ElementType::Steps | ElementType::Vector { .. });
        if data.kind.all(signed) {
            let node = self.graph.unary(Unary::Negate, data.node);
            return Ok(TypedValue { node, ..data });
        }
        let found = data.kind.described(self.vocabulary);
        let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, operand.span, "this value has no negative").found(found);
        Err(self.report(diagnostic))
    }

    /// A bracket: a list of numbers, vectors, places or parts of the body.
    pub(crate) fn bracket(&mut self, values: Vec<(Checked<Value>, Span)>, span: Span) -> Checked<Value> {
        let mut data: Vec<(TypedValue, Span)> = Vec::new();
        let mut things = Vec::new();
        let mut failures = Failures::default();
        for (value, place) in values {
            match value {
                Ok(Value::Typed(element)) => data.push((element, place)),
                Ok(Value::Entity(thing)) => things.push(thing),
                Ok(Value::Entities { members, .. }) => things.extend(members),
                Err(reported) => failures.add(reported),
            }
        }
        failures.or(())?;
        if data.is_empty() {
            return if things.is_empty() {
                Err(self.error(codes::types::WRONG_TYPE, span, "a list needs at least one element"))
            } else {
                Ok(Value::Entities { members: things, group: false })
            };
        }
        if !things.is_empty() {
            return Err(self.error(
                codes::types::WRONG_TYPE,
                span,
                "a list contains either numbers or parts of the body, not both",
            ));
        }
        self.list_of(data, span).map(Value::Typed)
    }

    fn list_of(&mut self, data: Vec<(TypedValue, Span)>, span: Span) -> Checked<TypedValue> {
        let scalars = data.iter().all(|(part, _)| part.kind.is_one_number());
        let frame = data.iter().find_map(|(part, _)| match part.kind.element() {
            Some(ElementType::Vector { frame, .. }) => Some(frame),
            _ => None,
        });
        // Brackets beside vectors are vectors.
        let vector = |(part, place): (TypedValue, Span)| (frame.map_or(part.clone(), |frame| self.as_vector(part, frame)), place);
        let data: Vec<(TypedValue, Span)> = data.into_iter().map(vector).collect();
        let Some((model, _)) = data.iter().find(|(part, _)| !part.is_zero()).or(data.first()) else {
            return Err(self.error(codes::types::WRONG_TYPE, span, "a list needs at least one element"));
        };
        let model = model.kind.clone();
        let mixed = data.iter().any(|(part, _)| part.kind.met().is_none());
        let mut elements = Vec::new();
        for (part, place) in &data {
            let shape = part.kind.shape();
            let fits = |element: ElementType| match model.met() {
                Some(wanted) => element.meet(wanted).is_some(),
                None => element.is_number(),
            };
            let gives_way = |wanted: ElementType| match part.kind.element() {
                Some(ElementType::Vector { size, .. }) => {
                    matches!(wanted, ElementType::Vector { size: other, .. } if size == other)
                }
                _ => wanted.is_number() || matches!(wanted, ElementType::Vector { .. }) && part.literal == LiteralKind::Zero,
            };
            let zero = model.met().filter(|wanted| part.is_zero() && gives_way(*wanted));
            if let Some(wanted) = zero {
                elements.extend(std::iter::repeat_n(wanted, shape.count()));
            } else if part.kind.all(fits) || mixed && part.kind.all(ElementType::is_number) {
                elements.extend((0..shape.count()).map(|place| part.kind.element_at(place)));
            } else {
                let expected = model.element_described(self.vocabulary);
                let found = part.kind.element_described(self.vocabulary);
                let diagnostic = self
                    .diagnostic(codes::types::DIMENSIONS_DIFFER, *place, "all elements of a list must have the same kind")
                    .expected(expected)
                    .found(found);
                return Err(self.report(diagnostic));
            }
        }
        if elements.contains(&ElementType::PLAIN) {
            // Whole numbers beside plain ones are plain.
            elements.iter_mut().filter(|element| **element == ElementType::Int).for_each(|element| *element = ElementType::PLAIN);
        }
        let Some(kind) = Type::list_of(elements) else {
            return Err(self.error(codes::types::DIMENSIONS_DIFFER, span, "all elements of a list must have the same kind"));
        };
        let lanes = kind.element_lanes();
        let nodes: Vec<NodeId> = data.iter().map(|(part, _)| spread_each(&mut self.graph, part, lanes)).collect();
        let node = self.graph.join(&nodes);
        self.spend(self.graph.width(node), span)?;
        let all_zero = data.iter().all(|(part, _)| part.is_zero());
        let literal = match (scalars && (2..=3).contains(&data.len()), all_zero) {
            (true, true) => LiteralKind::ZeroBracket,
            (true, false) => LiteralKind::Bracket,
            _ => LiteralKind::Plain,
        };
        Ok(TypedValue::new(node, kind).with_literal(literal))
    }

    /// A bracket of two or three numbers as a vector of the wanted frame; anything else as it is.
    pub(crate) fn as_vector(&self, data: TypedValue, frame: Frame) -> TypedValue {
        match (data.kind.dimension(), data.kind.length(), data.is_bracket()) {
            (Some(dimension), Some(size), true) => {
                let literal = if data.is_zero() { LiteralKind::Zero } else { LiteralKind::Plain };
                TypedValue { node: data.node, kind: ElementType::Vector { size, dimension, frame }.into(), literal }
            }
            _ => data,
        }
    }

    fn if_else(&mut self, branches: &'a [(Expr, Expr)], otherwise: &'a Expr) -> Checked<TypedValue> {
        let mut chosen = self.data(otherwise);
        for (condition, value) in branches.iter().rev() {
            let condition = self.single_condition(condition);
            let branch = self.data(value);
            chosen = match (condition, branch, chosen) {
                (Ok(condition), Ok(branch), Ok(rest)) => self.choose(&condition, (branch, value), (rest, otherwise)),
                (Err(reported), ..) | (_, Err(reported), _) | (.., Err(reported)) => Err(reported),
            };
        }
        chosen
    }

    fn choose(&mut self, condition: &TypedValue, yes: (TypedValue, &'a Expr), no: (TypedValue, &'a Expr)) -> Checked<TypedValue> {
        let span = yes.1.span.to(no.1.span);
        let (left, right, kind) = self.agree("choose between", yes, no)?;
        self.warn_identical(left, right, span);
        let node = self.graph.add(Operation::Choose, &[condition.node, left, right]);
        Ok(TypedValue::new(node, kind))
    }

    fn when(&mut self, value: &'a Expr, condition: &'a Expr) -> Checked<TypedValue> {
        let (value_data, condition_data) = (self.data(value), self.condition(condition));
        let (value_data, condition_data) = (value_data?, condition_data?);
        if matches!(value_data.kind.element(), Some(ElementType::Place(_) | ElementType::Rotation)) {
            let message = "`when` needs a number: a place or an orientation has no zero";
            return Err(self.error(codes::types::WRONG_TYPE, value.span, message));
        }
        if value_data.kind.element() == Some(ElementType::Bool) {
            let (left, right, kind) = self.agree("combine", (value_data, value), (condition_data, condition))?;
            let node = self.graph.binary(Binary::And, left, right);
            return Ok(TypedValue::new(node, kind));
        }
        let (nodes, shape) = self.laid_out(&[&value_data, &condition_data], condition.span)?;
        let zero = self.graph.constant(0.0);
        let node = self.graph.add(Operation::Choose, &[nodes[1], nodes[0], zero]);
        let kind =
            if value_data.kind.shape() == shape { value_data.kind } else { Type::new(value_data.kind.element_at(0), shape) };
        Ok(TypedValue::new(node, kind))
    }

    fn index(&mut self, base: &'a Expr, index: &'a Expr, span: Span) -> Checked<Value> {
        let (base, place) = (self.value(base), self.data(index));
        let (base, place) = (base?, place?);
        let length = match &base {
            Value::Typed(data) => data.kind.length(),
            Value::Entities { members, .. } => Some(members.len()),
            Value::Entity(_) => None,
        };
        let Some(length) = length else {
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, span, "only a list can be indexed")
                .help("use the names of components: `.x`, `.y`, `.z` in the world frame, `.forward`, `.left`, `.up` in the frame of a landmark");
            return Err(self.report(diagnostic));
        };
        if length == 0 {
            return Err(self.error(codes::names::NOTHING_FITS, span, "this set is empty on this body"));
        }
        let known = self.graph.constant_value(place.node).filter(|_| place.kind == Type::One(ElementType::Int));
        let Some(known) = known else { return self.index_at_run_time(base, &place, length, index) };
        if known < 0.0 || known >= length as f64 {
            let message = format!("the list has {length} elements, 0 to {}", length - 1);
            return Err(self.error(codes::types::INDEX, index.span, message));
        }
        let known = known as usize;
        Ok(match base {
            Value::Entities { members, .. } => Value::Entity(members[known]),
            Value::Typed(data) => {
                let node = element(&mut self.graph, &data, known);
                Value::Typed(TypedValue::new(node, data.kind.element_at(known)))
            }
            thing @ Value::Entity(_) => thing,
        })
    }

    /// `list[i]` where `i` is known only while the task runs: the ranges of what it reads must prove that it lies within.
    fn index_at_run_time(&mut self, base: Value, place: &TypedValue, length: usize, index: &'a Expr) -> Checked<Value> {
        if place.kind != Type::One(ElementType::Int) {
            let found = place.kind.described(self.vocabulary);
            let diagnostic = self.diagnostic(codes::types::NOT_CONSTANT, index.span, "an index is a whole number").found(found);
            return Err(self.report(diagnostic));
        }
        let met = if let Value::Typed(data) = &base { data.kind.met() } else { None };
        let (data, element) = match (base, met) {
            (Value::Typed(data), Some(element)) => (data, element),
            _ => {
                let message = "the body part must be a compile-time constant";
                let help = "read the property of all parts first, then select: `[pole_{0..9}].height[i]`";
                let diagnostic = self.diagnostic(codes::types::NOT_CONSTANT, index.span, message).help(help);
                return Err(self.report(diagnostic));
            }
        };
        let ranges = super::ranges::OperatingRange { vocabulary: self.vocabulary, queries: &self.queries, timing: self.timing };
        let bounds = crate::graph::interval::analyse_for(&self.graph, place.node, &ranges);
        let last = (length - 1) as f64;
        // A whole remainder stays below its divisor, where that of other numbers only comes near.
        let below = matches!(self.graph.node(place.node).operation, Operation::Binary(Binary::Modulo));
        let highest = if below { length as f64 } else { last };
        // An index is a whole number: what rounding may take from its bounds does not reach another.
        if !bounds.iter().all(|bounds| bounds.low.ceil() >= 0.0 && bounds.high.floor() <= highest) {
            let diagnostic = self
                .diagnostic(codes::types::INDEX, index.span, "the index is not proven to be within the list")
                .expected(format!("0 .. {last}"))
                .help(format!("define the result outside of the list: `clip(i, 0, {last})` or `mod(i, {length})`"));
            return Err(self.report(diagnostic));
        }
        let lanes = data.kind.element_lanes();
        let operation = Operation::Pick(u32::try_from(lanes).unwrap_or(u32::MAX));
        let node = self.graph.add(operation, &[data.node, place.node]);
        Ok(Value::Typed(TypedValue::new(node, element)))
    }

    fn comprehension(
        &mut self,
        formula: &'a Expr,
        variable: &'a crate::syntax::tree::Ident,
        source: &'a Expr,
        span: Span,
    ) -> Checked<Value> {
        let values = self.loop_values(source)?;
        let mut elements = Vec::with_capacity(values.len());
        for value in values {
            self.locals.push(self.local(variable, value));
            let one = self.value(formula);
            self.locals.pop();
            let broken = one.is_err();
            elements.push((one, formula.span));
            if broken {
                break;
            }
        }
        self.bracket(elements, span)
    }

    /// What a loop runs through: whole numbers, parts of the body, or elements of a list.
    pub(crate) fn loop_values(&mut self, source: &'a Expr) -> Checked<Vec<Value>> {
        if let ExprKind::Range { low, high } = &source.kind {
            let (low_value, high_value) = (self.whole(low), self.whole(high));
            let (low_value, high_value) = (low_value?, high_value?);
            if high_value <= low_value {
                return Err(self.error(codes::types::WRONG_TYPE, source.span, "this range is empty; its upper end is excluded"));
            }
            let count = (high_value - low_value) as usize;
            self.spend(count, source.span)?;
            let numbers = (0..count).map(|offset| low_value + offset as f64);
            return Ok(numbers
                .map(|number| Value::Typed(TypedValue::new(self.graph.constant(number), ElementType::Int)))
                .collect());
        }
        match self.value(source)? {
            Value::Entities { members, .. } => Ok(members.into_iter().map(Value::Entity).collect()),
            Value::Typed(data) if data.kind.length().is_some() => {
                let part = |place: usize| TypedValue::new(element(&mut self.graph, &data, place), data.kind.element_at(place));
                Ok((0..data.kind.shape().count()).map(part).map(Value::Typed).collect())
            }
            _ => Err(self.error(codes::types::WRONG_TYPE, source.span, "a loop iterates over a range or a list")),
        }
    }

    /// A whole number known while compiling.
    pub(crate) fn whole(&mut self, expr: &'a Expr) -> Checked<f64> {
        let data = self.data(expr)?;
        match (self.graph.constant_value(data.node), &data.kind) {
            (Some(value), Type::One(ElementType::Int)) => Ok(value),
            _ => Err(self.error(codes::types::NOT_CONSTANT, expr.span, "expected a constant whole number")),
        }
    }
}

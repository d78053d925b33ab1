//! Operators: which types meet, and the errors when they do not.

use super::context::{Checked, Checker, Reported};
use super::dimension::{Dimension, Rational};
use super::meeting::is_ordered;
use super::observe::spoken_unit;
use super::types::{ElementType, Shape, Type};
use super::unit;
use super::value::{TypedValue, Value};
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::emit::layout::wrapped;
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Operation, Unary};
use crate::numbers::{exact, for_people};
use crate::syntax::tree::{BinaryOperator, CompareOperator, Expr, ExprKind};
use msk_program::debug::Compared;

/// An operand with the expression it came from.
pub(super) type Operand<'a> = (TypedValue, &'a Expr);

impl<'a> Checker<'a> {
    /// A chain of infix operators; the left spine is walked without recursion, because it may be as long as a statement.
    pub(crate) fn binary_chain(&mut self, expr: &'a Expr) -> Checked<TypedValue> {
        let mut spine = Vec::new();
        let mut first = expr;
        while let ExprKind::Binary { operator, operator_span, left, right } = &first.kind {
            // The whole chain is open already: each operator within it is an expression of its own.
            let id = (!std::ptr::eq(first, expr)).then(|| self.hir.open(self.place.file, first.span, (&first.kind).into()));
            spine.push((first, id, *operator, *operator_span, &**right));
            first = left;
        }
        let mut result = self.data(first);
        let mut left_expr = first;
        for (whole, id, operator, operator_span, right_expr) in spine.into_iter().rev() {
            let right = match self.time_of_day(operator, left_expr, right_expr) {
                Some(diagnostic) => Err(self.report(diagnostic)),
                None => self.data(right_expr),
            };
            result = match (result, right) {
                (Ok(left), Ok(right)) => self.infix(operator, operator_span, (left, left_expr), (right, right_expr)),
                (Err(reported), _) | (_, Err(reported)) => Err(reported),
            };
            left_expr = whole;
            if let Some(id) = id {
                self.hir.close(id, result.clone().ok().map(Value::Typed).as_ref());
            }
        }
        result
    }

    /// `5 km/h`, read as a division by `h`: hours and minutes are no units here. The error gives the same speed in units that
    /// are.
    fn time_of_day(&self, operator: BinaryOperator, left: &Expr, right: &Expr) -> Option<Diagnostic> {
        let ExprKind::Name(word) = &right.kind else { return None };
        let seconds = match word.text.as_str() {
            "h" | "hour" => 3600.0,
            "min" | "minute" => 60.0,
            _ => return None,
        };
        let mut last = left;
        while let ExprKind::Binary { right, .. } = &last.kind {
            last = right;
        }
        let ExprKind::Number(number) = &last.kind else { return None };
        let unit = number.unit.as_ref()?;
        // The word touches the unit: with a blank between them something else was meant.
        let touching = operator == BinaryOperator::Divide && unit.span.end + 1 == right.span.start;
        if !touching || self.names.find(self.place, &word.text).is_some() {
            return None;
        }
        let one = unit::evaluate(unit).ok()?;
        let dimension = one.dimension.per(Dimension::TIME)?;
        let speed = format!("{} {dimension}", for_people(number.value * one.value / seconds));
        let message = format!("`{}` is not a unit", word.text);
        let diagnostic = self.diagnostic(codes::syntax::UNKNOWN_UNIT, right.span, message);
        let whole = format!("{} {}/{}", exact(number.value), unit.text, word.text);
        Some(diagnostic.suggest(format!("`{whole}` is `{speed}`"), last.span.to(right.span), speed))
    }

    fn infix(&mut self, operator: BinaryOperator, span: Span, left: Operand<'a>, right: Operand<'a>) -> Checked<TypedValue> {
        self.spend(1, span)?;
        match operator {
            BinaryOperator::Add | BinaryOperator::Subtract => self.sum(operator == BinaryOperator::Subtract, span, left, right),
            BinaryOperator::Multiply | BinaryOperator::Divide => {
                self.product(operator == BinaryOperator::Divide, span, left, right)
            }
            BinaryOperator::Power => self.power(left, right),
            BinaryOperator::And => self.logic(Binary::And, left, right),
            BinaryOperator::Or => self.logic(Binary::Or, left, right),
        }
    }

    fn logic(&mut self, function: Binary, left: Operand<'a>, right: Operand<'a>) -> Checked<TypedValue> {
        for (data, expr) in [&left, &right] {
            if data.kind.element() != Some(ElementType::Bool) {
                let found = data.kind.described(self.vocabulary);
                let diagnostic = self
                    .diagnostic(codes::types::WRONG_TYPE, expr.span, "`and` and `or` combine conditions")
                    .expected("a condition (true or false)")
                    .found(found);
                let diagnostic = match data.kind.element() {
                    Some(element) if element.is_number() => {
                        diagnostic.help("compare it, `x > 0.5`; to combine two rewards, multiply them, `x * y`")
                    }
                    _ => diagnostic,
                };
                return Err(self.report(diagnostic));
            }
        }
        let span = left.1.span.to(right.1.span);
        let (a, b, kind) = self.agree("join", left, right)?;
        self.warn_identical(a, b, span);
        self.warn_decided(function, [a, b], span);
        let node = self.graph.binary(function, a, b);
        Ok(TypedValue::new(node, kind))
    }

    fn sum(&mut self, subtract: bool, span: Span, left: Operand<'a>, right: Operand<'a>) -> Checked<TypedValue> {
        let verb = if subtract { "subtract" } else { "add" };
        let function = if subtract { Binary::Subtract } else { Binary::Add };
        if let Some(place) = self.sum_of_places(subtract, span, &left, &right)? {
            return Ok(place);
        }
        let (span_of_both, written) = (left.1.span.to(right.1.span), [left.1, right.1]);
        let (a, b, kind) = self.agree(verb, left, right)?;
        self.warn_beyond_range([a, b], subtract, &kind, written);
        self.note_height(a, written[1]);
        if subtract {
            self.warn_identical(a, b, span_of_both);
        }
        let node = self.graph.binary(function, a, b);
        // The difference of two headings goes the short way round.
        let node = if subtract { wrapped(&mut self.graph, node, &kind) } else { node };
        Ok(TypedValue::new(node, kind))
    }

    /// Place minus place is a vector, place plus vector a place, place plus place nothing.
    fn sum_of_places(
        &mut self,
        subtract: bool,
        span: Span,
        left: &Operand<'a>,
        right: &Operand<'a>,
    ) -> Checked<Option<TypedValue>> {
        let frame = match (left.0.kind.element(), right.0.kind.element()) {
            (Some(ElementType::Place(frame)), _) | (_, Some(ElementType::Place(frame))) => frame,
            _ => return Ok(None),
        };
        let (l, r) = (self.as_vector(left.0.clone(), frame), self.as_vector(right.0.clone(), frame));
        let vector = ElementType::Vector { size: 3, dimension: Dimension::LENGTH, frame };
        let offset = |data: &TypedValue| {
            matches!(data.kind.element(), Some(ElementType::Vector { size: 3, dimension, frame: own })
                if (dimension == Dimension::LENGTH || data.is_zero()) && own == frame)
        };
        let place = |data: &TypedValue| data.kind.element() == Some(ElementType::Place(frame));
        // After a minus, a bracket beside a place stands for a place: `p - [1 m, 0, 0.9 m]` is a vector.
        let point = |operand: &Operand<'a>, data: &TypedValue| place(data) || operand.0.is_bracket() && offset(data);
        let element = if subtract && point(left, &l) && point(right, &r) {
            vector
        } else if place(&l) && offset(&r) || !subtract && offset(&l) && place(&r) {
            ElementType::Place(frame)
        } else {
            return Err(self.places_do_not_add(subtract, left, right));
        };
        let (nodes, shape) = self.laid_out(&[&l, &r], span)?;
        let node = self.graph.add(Operation::Binary(if subtract { Binary::Subtract } else { Binary::Add }), &nodes);
        Ok(Some(TypedValue::new(node, Type::new(element, shape))))
    }

    fn places_do_not_add(&mut self, subtract: bool, left: &Operand<'a>, right: &Operand<'a>) -> Reported {
        let (a, b) = (left.0.kind.described(self.vocabulary), right.0.kind.described(self.vocabulary));
        let message = if subtract { format!("cannot subtract {b} from {a}") } else { format!("cannot add {a} and {b}") };
        let diagnostic = self
            .diagnostic(codes::types::PLACES, left.1.span.to(right.1.span), message)
            .help("place - place is a vector, place + vector is a place; both must be expressed in the same frame");
        let places = [left, right].map(|(data, _)| matches!(data.kind.element(), Some(ElementType::Place(_))));
        let between = !subtract && places == [true, true];
        self.report(if between {
            diagnostic.help("the point between several places is their mean: `mean([a, b])`")
        } else {
            diagnostic
        })
    }

    fn product(&mut self, divide: bool, span: Span, left: Operand<'a>, right: Operand<'a>) -> Checked<TypedValue> {
        self.warn_degrees(divide, left.1, right.1);
        let (verb, function) = if divide { ("divide", Binary::Divide) } else { ("multiply", Binary::Multiply) };
        for (data, expr) in [&left, &right] {
            self.must_be_numbers(verb, data, expr)?;
        }
        let (l, r) = (&left.0, &right.0);
        let vectors = [l, r].map(|data| matches!(data.kind.element(), Some(ElementType::Vector { .. })));
        if vectors[1] && (divide || vectors[0]) {
            let message = format!("cannot {verb} by a vector");
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, span, message)
                .help("`dot(a, b)` gives a number, `cross(a, b)` a vector, `norm(v)` the length");
            return Err(self.report(diagnostic));
        }
        let (nodes, _) = self.laid_out(&[l, r], right.1.span)?;
        let Some(kind) = l.kind.zip(&r.kind, |a, b| element_of_product(divide, a, b)) else {
            let message = "a mixed list contains numbers only, and exponents of units are bounded";
            return Err(self.error(codes::types::MIXED, left.1.span.to(right.1.span), message));
        };
        let node = self.graph.add(Operation::Binary(function), &nodes);
        Ok(TypedValue::new(node, kind))
    }

    fn must_be_numbers(&mut self, verb: &str, data: &TypedValue, expr: &Expr) -> Checked<()> {
        let help = match data.kind.element() {
            Some(ElementType::Bool) => "use `when` to gate a value by a condition: `x when c`",
            Some(ElementType::Place(_)) => "subtract two places, or use a component such as `.z`",
            Some(ElementType::Rotation) => "use `.pitch`, `.roll`, `.yaw` or an axis",
            Some(ElementType::Steps) => "write the time in seconds",
            _ => return Ok(()),
        };
        let found = data.kind.described(self.vocabulary);
        let message = format!("cannot {verb} {found}");
        let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, message).help(help);
        Err(self.report(diagnostic))
    }

    /// `base^exponent`, element by element; the unit of each follows from its exponent.
    fn power(&mut self, base: Operand<'a>, exponent: Operand<'a>) -> Checked<TypedValue> {
        let (base_data, base_expr) = base;
        self.must_be_numbers("raise", &base_data, base_expr)?;
        let power = &exponent.0;
        let plain = power.kind.all(|element| element.is_number() && element.dimension() == Some(Dimension::NONE));
        if !plain || !base_data.kind.all(ElementType::is_number) {
            let diagnostic = self
                .diagnostic(codes::types::POWER, exponent.1.span, "a power needs a number and a dimensionless exponent")
                .help("the square of a vector's length is `dot(v, v)`");
            return Err(self.report(diagnostic));
        }
        let (nodes, shape) = self.laid_out(&[&base_data, power], exponent.1.span)?;
        let known = self.graph.constant_lanes(power.node);
        let raised = |place: usize| {
            let power = known.as_ref().and_then(|lanes| lanes.get(place).or(lanes.first()).copied());
            element_of_power(base_data.kind.element_at(place), power)
        };
        let kind = match shape {
            Shape::One => raised(0).map(Type::One),
            Shape::List(length) => (0..length).map(raised).collect::<Option<_>>().and_then(Type::list_of),
        };
        let Some(kind) = kind else {
            let found = base_data.kind.described(self.vocabulary);
            let diagnostic = self
                .diagnostic(codes::types::POWER, exponent.1.span, "the unit of this power is not known at compile time")
                .found(format!("{found} with an exponent that is not a constant simple fraction"))
                .help("divide the base by a unit first: `(x / 1 m)^p`");
            return Err(self.report(diagnostic));
        };
        if known.as_deref() == Some(&[2.0]) {
            self.warn_cancelling(base_data.node, base_expr.span);
        }
        let node = self.graph.add(Operation::Binary(Binary::Power), &nodes);
        Ok(TypedValue::new(node, kind))
    }

    /// Conditions `a < b < c`: every neighbouring pair must hold.
    pub(crate) fn comparison(&mut self, operands: &'a [Expr], operators: &[(CompareOperator, Span)]) -> Checked<TypedValue> {
        let checked: Vec<Checked<TypedValue>> = operands.iter().map(|operand| self.data(operand)).collect();
        let checked: Vec<TypedValue> = checked.into_iter().collect::<Checked<_>>()?;
        let mut held: Option<TypedValue> = None;
        for (place, (operator, span)) in operators.iter().enumerate() {
            let left = (checked[place].clone(), &operands[place]);
            let right = (checked[place + 1].clone(), &operands[place + 1]);
            let pair = self.compare(*operator, *span, left, right)?;
            held = Some(match held {
                None => pair,
                Some(before) => {
                    let (nodes, shape) = self.laid_out(&[&before, &pair], operands[place + 1].span)?;
                    let node = self.graph.add(Operation::Binary(Binary::And), &nodes);
                    TypedValue::new(node, Type::new(ElementType::Bool, shape))
                }
            });
        }
        let span = operands.first().map_or(Span::default(), |operand| operand.span);
        held.ok_or_else(|| self.error(codes::types::WRONG_TYPE, span, "a comparison needs two sides"))
    }

    fn compare(&mut self, operator: CompareOperator, span: Span, left: Operand<'a>, right: Operand<'a>) -> Checked<TypedValue> {
        let equality = matches!(operator, CompareOperator::Equal | CompareOperator::NotEqual);
        let countable =
            |data: &TypedValue| matches!(data.kind.element(), Some(ElementType::Int | ElementType::Bool | ElementType::Steps));
        if equality && !(countable(&left.0) && countable(&right.0)) {
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, span, "measured numbers are never exactly equal")
                .help("`==` and `!=` are for whole numbers and conditions; write `abs(a - b) < tolerance`");
            return Err(self.report(diagnostic));
        }
        for (data, expr) in [&left, &right] {
            if !equality && !data.kind.all(is_ordered) {
                let found = data.kind.described(self.vocabulary);
                let help = match data.kind.element() {
                    Some(ElementType::Vector { .. }) => "use a component such as `.z`, or the length `norm(v)`",
                    Some(ElementType::Place(_)) => "use a component such as `.z`, or `distance(a, b)`",
                    Some(ElementType::Bool) => "a condition is already true or false",
                    _ => "use one of its numbers",
                };
                let message = format!("{found} cannot be ordered");
                let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, message).help(help);
                return Err(self.report(diagnostic));
            }
        }
        for (data, expr) in [&left, &right] {
            self.must_be_finite(data, expr)?;
        }
        let (span, written) = (left.1.span.to(right.1.span), [left.1, right.1]);
        let (a, b, kind) = self.agree("compare", left, right)?;
        self.warn_identical(a, b, span);
        let unit = spoken_unit(&kind, written);
        // What is below a height need not be about the thing whose top is as high: a body that falls, for example.
        if !matches!(operator, CompareOperator::Less | CompareOperator::LessEqual) {
            self.note_height(a, written[1]);
        }
        let node = match operator {
            CompareOperator::Less => self.graph.binary(Binary::Less, a, b),
            CompareOperator::LessEqual => self.graph.binary(Binary::LessEqual, a, b),
            CompareOperator::Greater => self.graph.binary(Binary::Less, b, a),
            CompareOperator::GreaterEqual => self.graph.binary(Binary::LessEqual, b, a),
            CompareOperator::Equal => self.graph.binary(Binary::Equal, a, b),
            CompareOperator::NotEqual => {
                let equal = self.graph.binary(Binary::Equal, a, b);
                self.graph.unary(Unary::Not, equal)
            }
        };
        if self.in_tests.is_none() && self.graph.constant_lanes(node).is_none() {
            self.comparisons.push(Compared { node, sides: [a, b], file: self.place.file, span, unit });
        }
        Ok(TypedValue::new(node, kind.with_element(ElementType::Bool)))
    }

    /// A side of a comparison that is infinite or no number in every state decides it, whatever the other side is.
    fn must_be_finite(&mut self, data: &TypedValue, expr: &Expr) -> Checked<()> {
        let lanes = self.graph.constant_lanes(data.node).unwrap_or_default();
        let Some(value) = lanes.into_iter().find(|value| !value.is_finite()) else { return Ok(()) };
        let message = format!("this side of the comparison is {} in every state", for_people(value));
        let diagnostic = self.diagnostic(codes::tasks::NOT_FINITE, expr.span, message);
        let verdict = if value.is_nan() { "no comparison with NaN holds" } else { "every number is on the same side of it" };
        Err(self.report(diagnostic.help(format!("{verdict}: look for a division by zero"))))
    }

    /// Warns of a thing that is compared with, subtracted from or joined to itself.
    pub(crate) fn warn_identical(&mut self, left: NodeId, right: NodeId, span: Span) {
        // The same thing at two moments is what tests compare.
        if left == right && self.in_tests.is_none() && self.graph.constant_lanes(left).is_none() {
            let message = "both operands are identical";
            let diagnostic =
                self.diagnostic(codes::lints::IDENTICAL, span, message).help("probably one of them was meant to be different");
            self.diagnostics.push(diagnostic);
        }
    }
}

/// What a number raised to a power is; nothing where its unit would not be known.
fn element_of_power(base: ElementType, power: Option<f64>) -> Option<ElementType> {
    let dimension = base.dimension()?;
    match power {
        Some(power) if base == ElementType::Int && power >= 0.0 && power.fract() == 0.0 => Some(ElementType::Int),
        _ if dimension.is_none() => Some(ElementType::PLAIN),
        Some(power) => Rational::from_f64(power).and_then(|power| dimension.power(power)).map(ElementType::Number),
        None => None,
    }
}

/// The element of a product or quotient; nothing if powers of units grow beyond reason.
fn element_of_product(divide: bool, a: ElementType, b: ElementType) -> Option<ElementType> {
    let (left, right) = (a.dimension()?, b.dimension()?);
    let dimension = if divide { left.per(right)? } else { left.times(right)? };
    Some(match (a, b) {
        (ElementType::Vector { .. }, _) => a.in_dimension(dimension),
        (_, ElementType::Vector { .. }) => b.in_dimension(dimension),
        (ElementType::Int, ElementType::Int) if !divide => ElementType::Int,
        // So many times an angle is known up to whole turns, as the angle is; any other factor would tear it.
        (ElementType::Int, ElementType::WrappingAngle) | (ElementType::WrappingAngle, ElementType::Int) if !divide => {
            ElementType::WrappingAngle
        }
        _ => ElementType::Number(dimension),
    })
}

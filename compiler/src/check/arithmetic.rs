//! Operators: which types meet, and what the error says when they do not.

use super::context::{Checked, Checker, Compared, Reported};
use super::dimension::{Dimension, Rational};
use super::observe::unit_of;
use super::types::Type;
use super::value::{Data, Form};
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::graph::NodeId;
use crate::graph::operation::{Binary, Unary};
use crate::syntax::tree::{BinaryOperator, CompareOperator, Expr, ExprKind};

/// An operand with the expression it came from.
type Operand<'a> = (Data, &'a Expr);

impl<'a> Checker<'a> {
    /// A chain of infix operators; the left spine is walked without recursion, because it may be as long as a statement.
    pub(crate) fn binary_chain(&mut self, expr: &'a Expr) -> Checked<Data> {
        let mut spine = Vec::new();
        let mut first = expr;
        while let ExprKind::Binary { operator, operator_span, left, right } = &first.kind {
            spine.push((first, *operator, *operator_span, &**right));
            first = left;
        }
        let mut result = self.data(first);
        let mut left_expr = first;
        for (whole, operator, operator_span, right_expr) in spine.into_iter().rev() {
            let right = self.data(right_expr);
            result = match (result, right) {
                (Ok(left), Ok(right)) => self.infix(operator, operator_span, (left, left_expr), (right, right_expr)),
                (Err(reported), _) | (_, Err(reported)) => Err(reported),
            };
            left_expr = whole;
        }
        result
    }

    fn infix(&mut self, operator: BinaryOperator, span: Span, left: Operand<'a>, right: Operand<'a>) -> Checked<Data> {
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

    fn logic(&mut self, function: Binary, left: Operand<'a>, right: Operand<'a>) -> Checked<Data> {
        for (data, expr) in [&left, &right] {
            if *data.kind.element() != Type::Bool {
                let found = data.kind.described(self.vocabulary);
                let diagnostic = self
                    .diagnostic(codes::types::WRONG_TYPE, expr.span, "`and` and `or` join conditions")
                    .expected("a condition (yes or no)")
                    .found(found);
                return Err(self.report(diagnostic));
            }
        }
        let span = left.1.span.to(right.1.span);
        let (a, b, kind) = self.agree("join", left, right)?;
        self.warn_identical(a, b, span);
        let node = self.graph.binary(function, a, b);
        Ok(Data::new(node, kind))
    }

    fn sum(&mut self, subtract: bool, span: Span, left: Operand<'a>, right: Operand<'a>) -> Checked<Data> {
        let verb = if subtract { "subtract" } else { "add" };
        let function = if subtract { Binary::Subtract } else { Binary::Add };
        if let Some(place) = self.sum_of_places(subtract, span, &left, &right)? {
            return Ok(place);
        }
        let span_of_both = left.1.span.to(right.1.span);
        let wraps = subtract && (left.0.form == Form::Wrapping || right.0.form == Form::Wrapping);
        let (a, b, kind) = self.agree(verb, left, right)?;
        if subtract {
            self.warn_identical(a, b, span_of_both);
        }
        let node = self.graph.binary(function, a, b);
        // The difference of two headings goes the short way round.
        let node = if wraps { self.graph.unary(Unary::Wrap, node) } else { node };
        Ok(Data::new(node, kind))
    }

    /// Place minus place is a vector, place plus vector a place, place plus place nothing.
    fn sum_of_places(&mut self, subtract: bool, span: Span, left: &Operand<'a>, right: &Operand<'a>) -> Checked<Option<Data>> {
        let frame = match (left.0.kind.element(), right.0.kind.element()) {
            (Type::Place(frame), _) | (_, Type::Place(frame)) => *frame,
            _ => return Ok(None),
        };
        let (l, r) = (self.as_vector(left.0.clone(), frame), self.as_vector(right.0.clone(), frame));
        let offset = |kind: &Type| {
            matches!(kind.element(), Type::Vector { size: 3, dimension, frame: own }
            if *dimension == Dimension::LENGTH && *own == frame)
        };
        let place = |kind: &Type| *kind.element() == Type::Place(frame);
        let vector = Type::Vector { size: 3, dimension: Dimension::LENGTH, frame };
        // After a minus, a bracket beside a place stands for a place: `p - [1 m, 0, 0.9 m]` is a vector.
        let point = |operand: &Operand<'a>, kind: &Type| place(kind) || operand.0.is_bracket() && offset(kind);
        let element = if subtract && point(left, &l.kind) && point(right, &r.kind) {
            vector
        } else if place(&l.kind) && offset(&r.kind) || !subtract && offset(&l.kind) && place(&r.kind) {
            Type::Place(frame)
        } else {
            return Err(self.places_do_not_add(subtract, left, right));
        };
        let length = self.common_length(&l.kind, &r.kind, span)?;
        let (a, b) = (self.spread(&l, length.unwrap_or(1), 3), self.spread(&r, length.unwrap_or(1), 3));
        let node = self.graph.binary(if subtract { Binary::Subtract } else { Binary::Add }, a, b);
        let kind = length.map_or(element.clone(), |length| Type::List(Box::new(element), length));
        Ok(Some(Data::new(node, kind)))
    }

    fn places_do_not_add(&mut self, subtract: bool, left: &Operand<'a>, right: &Operand<'a>) -> Reported {
        let (a, b) = (left.0.kind.described(self.vocabulary), right.0.kind.described(self.vocabulary));
        let message = if subtract { format!("cannot subtract {b} from {a}") } else { format!("cannot add {a} and {b}") };
        let diagnostic = self
            .diagnostic(codes::types::PLACES, left.1.span.to(right.1.span), message)
            .help("place - place is a vector, place + vector is a place; both must be counted in the same axes");
        self.report(diagnostic)
    }

    fn product(&mut self, divide: bool, span: Span, left: Operand<'a>, right: Operand<'a>) -> Checked<Data> {
        let (verb, function) = if divide { ("divide", Binary::Divide) } else { ("multiply", Binary::Multiply) };
        for (data, expr) in [&left, &right] {
            self.must_be_numbers(verb, data, expr)?;
        }
        let (l, r) = (&left.0, &right.0);
        let vectors = [l, r].map(|data| matches!(data.kind.element(), Type::Vector { .. }));
        if vectors[1] && (divide || vectors[0]) {
            let message = format!("cannot {verb} by a vector");
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, span, message)
                .help("`dot(a, b)` gives a number, `cross(a, b)` a vector, `norm(v)` the length");
            return Err(self.report(diagnostic));
        }
        let length = self.common_length(&l.kind, &r.kind, right.1.span)?;
        let combine = |a: Dimension, b: Dimension| if divide { a.per(b) } else { a.times(b) };
        let lanes = l.kind.element_lanes().max(r.kind.element_lanes());
        let kind = if let (Type::Mixed(dimensions), Some(other)) = (&l.kind, r.kind.dimension()) {
            dimensions.iter().map(|own| combine(*own, other)).collect::<Option<Vec<_>>>().map(Type::numbers)
        } else {
            let dimension = l.kind.dimension().zip(r.kind.dimension()).and_then(|(a, b)| combine(a, b));
            dimension.map(|dimension| {
                let element = match (l.kind.element(), r.kind.element()) {
                    (Type::Vector { size, frame, .. }, _) | (_, Type::Vector { size, frame, .. }) => {
                        Type::Vector { size: *size, dimension, frame: *frame }
                    }
                    (Type::Int, Type::Int) if !divide => Type::Int,
                    _ => Type::Number(dimension),
                };
                length.map_or(element.clone(), |length| Type::List(Box::new(element), length))
            })
        };
        let Some(kind) = kind else {
            let message = "a mixed list can only be scaled by one number, and powers of units must stay within reason";
            return Err(self.error(codes::types::MIXED, left.1.span.to(right.1.span), message));
        };
        let count = length.unwrap_or(1);
        let (a, b) = (self.spread(l, count, lanes), self.spread(r, count, lanes));
        let node = self.graph.binary(function, a, b);
        Ok(Data::new(node, kind))
    }

    fn must_be_numbers(&mut self, verb: &str, data: &Data, expr: &Expr) -> Checked<()> {
        let help = match data.kind.element() {
            Type::Bool => "a condition gates a value with `when`: `x when c`",
            Type::Place(_) => "subtract two places, or take a component such as `.z`",
            Type::Rotation => "read `.pitch`, `.roll`, `.yaw` or an axis",
            Type::Steps => "write the time in seconds",
            _ => return Ok(()),
        };
        let found = data.kind.described(self.vocabulary);
        let message = format!("cannot {verb} {found}");
        let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, message).help(help);
        Err(self.report(diagnostic))
    }

    fn power(&mut self, base: Operand<'a>, exponent: Operand<'a>) -> Checked<Data> {
        let (base_data, base_expr) = base;
        self.must_be_numbers("raise", &base_data, base_expr)?;
        let known = self.graph.constant_value(exponent.0.node);
        if exponent.0.kind.dimension() != Some(Dimension::NONE) || matches!(base_data.kind.element(), Type::Vector { .. }) {
            let diagnostic = self
                .diagnostic(codes::types::POWER, exponent.1.span, "only numbers can be raised, and only to a plain number")
                .help("the square of a vector's length is `dot(v, v)`");
            return Err(self.report(diagnostic));
        }
        let raised = |dimension: Dimension| match known {
            Some(value) => Rational::from_f64(value).and_then(|power| dimension.power(power)),
            None => dimension.is_none().then_some(dimension),
        };
        let dimension = base_data.kind.dimension();
        let Some(dimension) = dimension.and_then(raised) else {
            let found = base_data.kind.described(self.vocabulary);
            let diagnostic = self
                .diagnostic(codes::types::POWER, exponent.1.span, "the unit of this power would not be known")
                .found(format!("{found} raised to something that is no simple fraction known while compiling"))
                .help("divide the base by a unit first: `(x / 1 m)^p`");
            return Err(self.report(diagnostic));
        };
        let node = self.graph.binary(Binary::Power, base_data.node, exponent.0.node);
        let element = match base_data.kind.element() {
            Type::Int if known.is_some_and(|power| power >= 0.0 && power.fract() == 0.0) => Type::Int,
            _ => Type::Number(dimension),
        };
        Ok(Data::new(node, base_data.kind.with_element(element)))
    }

    /// Conditions `a < b < c`: every neighbouring pair must hold.
    pub(crate) fn comparison(&mut self, operands: &'a [Expr], operators: &[(CompareOperator, Span)]) -> Checked<Data> {
        let checked: Vec<Checked<Data>> = operands.iter().map(|operand| self.data(operand)).collect();
        let checked: Vec<Data> = checked.into_iter().collect::<Checked<_>>()?;
        let mut held: Option<Data> = None;
        for (place, (operator, span)) in operators.iter().enumerate() {
            let left = (checked[place].clone(), &operands[place]);
            let right = (checked[place + 1].clone(), &operands[place + 1]);
            let pair = self.compare(*operator, *span, left, right)?;
            held = Some(match held {
                None => pair,
                Some(before) => {
                    let node = self.graph.binary(Binary::And, before.node, pair.node);
                    Data::new(node, pair.kind)
                }
            });
        }
        let span = operands.first().map_or(Span::default(), |operand| operand.span);
        held.ok_or_else(|| self.error(codes::types::WRONG_TYPE, span, "a comparison has two sides"))
    }

    fn compare(&mut self, operator: CompareOperator, span: Span, left: Operand<'a>, right: Operand<'a>) -> Checked<Data> {
        let equality = matches!(operator, CompareOperator::Equal | CompareOperator::NotEqual);
        let countable = |data: &Data| matches!(data.kind.element(), Type::Int | Type::Bool | Type::Steps);
        if equality && !(countable(&left.0) && countable(&right.0)) {
            let diagnostic = self
                .diagnostic(codes::types::WRONG_TYPE, span, "measured numbers are never exactly equal")
                .help("`==` and `!=` are for whole numbers and conditions; write `abs(a - b) < tolerance`");
            return Err(self.report(diagnostic));
        }
        for (data, expr) in [&left, &right] {
            let orders = matches!(data.kind.element(), Type::Number(_) | Type::Int | Type::Steps) || equality;
            if !orders && !data.is_bracket() {
                let found = data.kind.described(self.vocabulary);
                let help = match data.kind.element() {
                    Type::Vector { .. } => "take a component such as `.z`, or the length `norm(v)`",
                    Type::Place(_) => "take a component such as `.z`, or `distance(a, b)`",
                    Type::Bool => "a condition is already yes or no",
                    _ => "read one of its numbers",
                };
                let message = format!("there is no greater or smaller among {found}");
                let diagnostic = self.diagnostic(codes::types::WRONG_TYPE, expr.span, message).help(help);
                return Err(self.report(diagnostic));
            }
        }
        let span = left.1.span.to(right.1.span);
        let (a, b, kind) = self.agree("compare", left, right)?;
        self.warn_identical(a, b, span);
        let unit = unit_of(&kind);
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
        Ok(Data::new(node, kind.with_element(Type::Bool)))
    }

    /// Warns of a thing that is compared with, subtracted from or joined to itself.
    pub(crate) fn warn_identical(&mut self, left: NodeId, right: NodeId, span: Span) {
        // The same thing at two moments is what tests compare.
        if left == right
            && self.in_tests.is_none()
            && self.graph.constant_lanes(left).is_none()
            && !self.allowed.contains("identical")
        {
            let message = "both sides are the same thing";
            let diagnostic =
                self.diagnostic(codes::lints::IDENTICAL, span, message).help("one of them was probably to be another");
            self.diagnostics.push(diagnostic);
        }
    }

    /// Two operands brought to one type: same dimension, same frame, same length.
    ///
    /// # Errors
    /// They differ; the error lines them up and offers the missing factor.
    pub(crate) fn agree(&mut self, verb: &str, left: Operand<'a>, right: Operand<'a>) -> Checked<(NodeId, NodeId, Type)> {
        let (mut l, mut r) = (left.0, right.0);
        if let Type::Vector { frame, .. } = l.kind.element() {
            r = self.as_vector(r, *frame);
        }
        if let Type::Vector { frame, .. } = r.kind.element() {
            l = self.as_vector(l, *frame);
        }
        let Some(element) = common_element(&l, &r) else {
            return Err(self.disagree(verb, (l, left.1), (r, right.1)));
        };
        let length = self.common_length(&l.kind, &r.kind, right.1.span)?;
        let lanes = l.kind.element_lanes().max(r.kind.element_lanes());
        let (a, b) = (self.spread(&l, length.unwrap_or(1), lanes), self.spread(&r, length.unwrap_or(1), lanes));
        let kind = match (length, &element) {
            (Some(_), Type::Mixed(_)) | (None, _) => element,
            (Some(length), _) => Type::List(Box::new(element), length),
        };
        Ok((a, b, kind))
    }

    /// The number of elements where one list meets another or a single value.
    pub(crate) fn common_length(&mut self, left: &Type, right: &Type, span: Span) -> Checked<Option<usize>> {
        match (left.length(), right.length()) {
            (Some(a), Some(b)) if a != b => {
                let message = format!("these lists have different lengths: {a} and {b}");
                Err(self.error(codes::types::LENGTHS_DIFFER, span, message))
            }
            (a, b) => Ok(a.or(b)),
        }
    }

    /// The lanes of `data` laid out for `length` elements of `lanes` lanes, where one lane may stand for all.
    pub(crate) fn spread(&mut self, data: &Data, length: usize, lanes: usize) -> NodeId {
        let own = data.kind.element_lanes();
        let elements = data.kind.length().unwrap_or(1);
        let width = self.graph.width(data.node);
        if width == 1 || width == length * lanes {
            return data.node;
        }
        let lane = |element: usize, lane: usize| {
            let element = if elements == 1 { 0 } else { element };
            element * own + if own == 1 { 0 } else { lane }
        };
        let wanted: Vec<usize> = (0..length).flat_map(|e| (0..lanes).map(move |l| lane(e, l))).collect();
        self.graph.select(wanted, data.node)
    }

    fn disagree(&mut self, verb: &str, left: Operand<'a>, right: Operand<'a>) -> Reported {
        let (a, b) = (left.0.kind.element().clone(), right.0.kind.element().clone());
        let (expected, found) = (a.described(self.vocabulary), b.described(self.vocabulary));
        let span = left.1.span.to(right.1.span);
        if let (Type::Vector { dimension: da, frame: fa, .. }, Type::Vector { dimension: db, frame: fb, .. }) = (&a, &b)
            && da == db
            && fa != fb
        {
            let frame = fa.name(self.vocabulary);
            let message = format!("cannot {verb} vectors counted in different axes");
            let diagnostic = self
                .diagnostic(codes::types::FRAMES_DIFFER, span, message)
                .expected(expected)
                .found(found)
                .help(format!("express the second in the axes of the first: `(... in {frame})`"));
            return self.report(diagnostic);
        }
        let message = format!("cannot {verb} {expected} and {found}");
        let mut diagnostic = self.diagnostic(codes::types::DIMENSIONS_DIFFER, span, message).expected(expected).found(found);
        if let (Some(da), Some(db)) = (a.dimension(), b.dimension()) {
            diagnostic = missing_factor(diagnostic, da, db, &right);
        } else if a == Type::Steps || b == Type::Steps {
            diagnostic = diagnostic.help("a whole number never meets a duration; `t` is the time in seconds, `step` a count");
        }
        self.report(diagnostic)
    }
}

/// Says by what the right operand would have to be multiplied, and offers to write it.
fn missing_factor(diagnostic: Diagnostic, left: Dimension, right: Dimension, operand: &Operand<'_>) -> Diagnostic {
    let Some(factor) = left.per(right) else { return diagnostic };
    let (data, expr) = operand;
    if let ExprKind::Number(quantity) = &expr.kind
        && right.is_none()
        && data.form != Form::Zero
    {
        let place = Span::at(quantity.digits.end as usize);
        return diagnostic.fix(format!("give it the unit `{left}`"), place, format!(" {left}"));
    }
    diagnostic
        .help(format!("the missing factor is one in `{factor}`: multiply the second by `1 {factor}`, or a constant like it"))
}

/// The element type of two operands that may meet; written zeros and whole numbers give way.
fn common_element(left: &Data, right: &Data) -> Option<Type> {
    let (a, b) = (left.kind.element(), right.kind.element());
    let numeric = |kind: &Type| matches!(kind, Type::Number(_) | Type::Int | Type::Steps | Type::Vector { .. } | Type::Mixed(_));
    match (a, b) {
        _ if a == b => Some(a.clone()),
        _ if right.is_zero() && numeric(a) => Some(a.clone()),
        _ if left.is_zero() && numeric(b) => Some(b.clone()),
        (Type::Int, Type::Number(d)) | (Type::Number(d), Type::Int) if d.is_none() => Some(Type::PLAIN),
        _ => None,
    }
}

//! How values meet: in one type, in one shape, laid out alike.

use super::arithmetic::Operand;
use super::context::{Checked, Checker, Reported};
use super::dimension::Dimension;
use super::offered::{is_bare, offer_unit};
use super::types::{ElementType, Shape, Type};
use super::value::{LiteralKind, TypedValue};
use crate::diagnostics::{Diagnostic, Span, codes};
use crate::emit::layout::spread;
use crate::graph::{Graph, NodeId};
use crate::numbers::exact;
use crate::syntax::tree::ExprKind;

impl<'a> Checker<'a> {
    /// Two operands brought to one type: same dimension, same frame, same length.
    ///
    /// # Errors
    /// They differ; the error lines them up and offers the missing factor.
    pub(crate) fn agree(&mut self, verb: &str, left: Operand<'a>, right: Operand<'a>) -> Checked<(NodeId, NodeId, Type)> {
        let frame = [&left, &right].into_iter().find_map(|(data, _)| match data.kind.element() {
            Some(ElementType::Vector { frame, .. }) => Some(frame),
            _ => None,
        });
        let vector = |(data, expr): Operand<'a>| (frame.map_or(data.clone(), |frame| self.as_vector(data, frame)), expr);
        let (left, right) = (vector(left), vector(right));
        let span = right.1.span;
        let operands = [left, right];
        let kind = self.common_type_of(verb, &operands[0], &operands[1..])?;
        let (nodes, _) = self.laid_out(&[&operands[0].0, &operands[1].0], span)?;
        Ok((nodes[0], nodes[1], kind))
    }

    /// The one type to which operands are brought.
    ///
    /// # Errors
    /// Two of them differ in dimension or axes, or two lists in length.
    pub(crate) fn common_type_of(&mut self, verb: &str, first: &Operand<'a>, rest: &[Operand<'a>]) -> Checked<Type> {
        let (mut met, mut last) = first.clone();
        for (data, expr) in rest {
            self.common_length(&[&met, data], expr.span)?;
            let Some(kind) = common_type(&met, data) else {
                return Err(self.disagree(verb, (met, last), (data.clone(), expr)));
            };
            let literal = if met.is_zero() { data.literal } else { met.literal };
            (met, last) = (TypedValue { kind, literal, ..met }, expr);
        }
        Ok(met.kind)
    }

    /// The shape in which values meet: one value meets every element of a list.
    ///
    /// # Errors
    /// Lists of different length.
    pub(crate) fn common_length(&mut self, values: &[&TypedValue], span: Span) -> Checked<Shape> {
        let mut shape = Shape::One;
        for value in values {
            match (shape, value.kind.shape()) {
                (Shape::List(a), Shape::List(b)) if a != b => {
                    let message = format!("these lists have different lengths: {a} and {b}");
                    return Err(self.error(codes::types::LENGTHS_DIFFER, span, message));
                }
                (Shape::One, own) => shape = own,
                _ => {}
            }
        }
        Ok(shape)
    }

    /// Values laid out for the shape in which they meet, each for the components of the widest; a node of one lane stands for
    /// all of them.
    ///
    /// # Errors
    /// Lists of different length.
    pub(crate) fn laid_out(&mut self, values: &[&TypedValue], span: Span) -> Checked<(Vec<NodeId>, Shape)> {
        let shape = self.common_length(values, span)?;
        let lanes = values.iter().map(|value| value.kind.element_lanes()).max().unwrap_or(1);
        Ok((values.iter().map(|value| spread(&mut self.graph, value, shape.count(), lanes)).collect(), shape))
    }

    /// Suggests how quantities of these dimensions could meet: a unit for a number without one, else what is probably meant.
    fn units_that_meet(
        &self,
        diagnostic: Diagnostic,
        left: (&Operand<'a>, Dimension),
        right: (&Operand<'a>, Dimension),
    ) -> Diagnostic {
        for ((number, own), (_, wanted)) in [(right, left), (left, right)] {
            let computed = wanted == Dimension::ANGLE && self.graph.constant_value(number.0.node).is_some();
            if own.is_none() && number.0.literal != LiteralKind::Zero && (is_bare(number.1) || computed) {
                return offer_unit(diagnostic, wanted, number.1);
            }
        }
        for ((count, own), ((time, seconds), other)) in [(left, right), (right, left)] {
            if own.is_none() && count.0.kind.all(|element| element == ElementType::Int) && other == Dimension::TIME {
                let known = self.graph.constant_value(time.node).map(|time| (time / self.timing.interval).round());
                let help = "`step` counts control steps, `t` is the time in seconds";
                let diagnostic = match &count.1.kind {
                    ExprKind::Name(name) if name.text == "step" => diagnostic.help(help).suggest("write `t`", count.1.span, "t"),
                    _ => diagnostic.help(help),
                };
                return match known {
                    Some(steps) => {
                        diagnostic.suggest(format!("write `{}`, the number of steps", exact(steps)), seconds.span, exact(steps))
                    }
                    None => diagnostic,
                };
            }
        }
        let (a, b) = (left.1, right.1);
        if a.per(Dimension::TIME) == Some(b) || b.per(Dimension::TIME) == Some(a) {
            return diagnostic.help(match [a, b].contains(&Dimension::ANGLE) {
                true => "one of them is the rate of the other: `.q` is the angle of a joint, `.qd` its angular velocity",
                false => "one of them is the rate of the other, as `.velocity` is that of `.position`",
            });
        }
        match a.per(b) {
            Some(factor) => diagnostic.help(format!(
                "a factor with unit `{factor}` is missing: multiply the second by `1 {factor}`, or by another constant of this unit"
            )),
            None => diagnostic,
        }
    }

    fn disagree(&mut self, verb: &str, left: Operand<'a>, right: Operand<'a>) -> Reported {
        let (a, b) = (left.0.kind.met(), right.0.kind.met());
        let described = |data: &TypedValue| data.kind.element_described(self.vocabulary);
        let (expected, found) = (described(&left.0), described(&right.0));
        let span = left.1.span.to(right.1.span);
        if let (
            Some(ElementType::Vector { dimension: da, frame: fa, .. }),
            Some(ElementType::Vector { dimension: db, frame: fb, .. }),
        ) = (a, b)
            && da == db
            && fa != fb
        {
            let frame = fa.name(self.vocabulary);
            let message = format!("cannot {verb} vectors in different frames");
            let diagnostic = self
                .diagnostic(codes::types::FRAMES_DIFFER, span, message)
                .expected(expected)
                .found(found)
                .help(format!("express the second in the frame of the first: `(... in {frame})`"));
            return self.report(diagnostic);
        }
        let message = format!("cannot {verb} {expected} and {found}");
        let mut diagnostic = self.diagnostic(codes::types::DIMENSIONS_DIFFER, span, message).expected(expected).found(found);
        let sizes = [a, b].map(|element| element.map(ElementType::lanes));
        if sizes[0] != sizes[1] && right.0.kind.element().is_some_and(|element| matches!(element, ElementType::Vector { .. })) {
            diagnostic = diagnostic.help("a bracketed list combined with a vector needs the same number of components");
        } else if let (Some(da), Some(db)) = (left.0.kind.dimension(), right.0.kind.dimension()) {
            diagnostic = self.units_that_meet(diagnostic, (&left, da), (&right, db));
        } else if [a, b].contains(&Some(ElementType::Steps)) {
            diagnostic =
                diagnostic.help("whole numbers and durations cannot be combined; `t` is the time in seconds, `step` a count");
        }
        self.report(diagnostic)
    }
}

impl TypedValue {
    /// This value as one of the type `ty`, which it may become where that is kept: a written zero and an angle that does not
    /// wrap may. The lanes are as many as the type has.
    pub(crate) fn kept_as(&self, graph: &mut Graph, ty: &Type) -> Option<NodeId> {
        let becomes =
            |own: ElementType, kept: ElementType| own == kept || own == ElementType::ANGLE && kept == ElementType::WrappingAngle;
        let same = self.kind.shape() == ty.shape() && self.kind.zip(ty, |a, b| becomes(a, b).then_some(b)).is_some();
        if same {
            return Some(self.node);
        }
        let number = ty.all(is_ordered);
        let has_zero = number || ty.all(|element| matches!(element, ElementType::Vector { .. }));
        match self.literal {
            LiteralKind::Zero if self.kind.is_one_number() && has_zero => Some(graph.constants(&vec![0.0; ty.lanes()])),
            LiteralKind::ZeroBracket if has_zero && self.kind.lanes() == ty.lanes() => Some(self.node),
            _ => None,
        }
    }
}

/// The type of two operands that may meet; written zeros and whole numbers give way.
fn common_type(left: &TypedValue, right: &TypedValue) -> Option<Type> {
    // A written zero is a number of any dimension, a bracket of zeros a vector of any, but of its own size.
    let gives_way = |zero: &TypedValue, to: ElementType| match zero.kind.element() {
        Some(ElementType::Vector { size, .. }) => matches!(to, ElementType::Vector { size: other, .. } if size == other),
        _ => is_ordered(to) || matches!(to, ElementType::Vector { .. }) && zero.literal == LiteralKind::Zero,
    };
    left.kind.zip(&right.kind, |a, b| match a.meet(b) {
        Some(met) => Some(met),
        None if right.is_zero() && gives_way(right, a) => Some(a),
        None if left.is_zero() && gives_way(left, b) => Some(b),
        None => None,
    })
}

/// Whether there is a greater and a smaller.
pub(super) fn is_ordered(element: ElementType) -> bool {
    element.is_number() || element == ElementType::Steps
}

//! Units for numbers that were written without one.

use super::context::Checker;
use super::dimension::Dimension;
use super::unit;
use super::value::TypedValue;
use crate::diagnostics::{Diagnostic, Span};
use crate::numbers::exact;
use crate::syntax::tree::{Argument, Expr, ExprKind, Quantity, UnaryOperator};
use std::f64::consts::TAU;

/// Offers units for a number that should be one of this dimension: those in which a number of its size is likely meant. 60 of an
/// angle are degrees, 1.2 may be degrees or radians.
pub(crate) fn offer_unit(diagnostic: Diagnostic, dimension: Dimension, number: &Expr) -> Diagnostic {
    let Some((value, end)) = bare(number) else {
        let unit = &likely(dimension, 1.0)[0];
        return diagnostic.help(match dimension {
            Dimension::ANGLE => "an angle has a unit, `40 deg`; multiply a value in radians by `1 rad`".to_owned(),
            _ => format!("give it the unit `{unit}`"),
        });
    };
    if !dimension.is_familiar() {
        return diagnostic.help(format!("`{dimension}` is unusual here: is one of the units wrong?"));
    }
    let units = likely(dimension, value.abs());
    let diagnostic = match dimension {
        Dimension::TIME if value >= 100.0 && value.fract() == 0.0 => {
            diagnostic.help("compare a number of control steps with `step`, not with `t`")
        }
        _ => diagnostic,
    };
    match units.as_slice() {
        [only] => diagnostic.fix(format!("give it the unit `{only}`"), end, format!(" {only}")),
        several => several.iter().fold(diagnostic, |diagnostic, unit| {
            diagnostic.suggest(format!("did you mean `{} {unit}`?", exact(value)), end, format!(" {unit}"))
        }),
    }
}

impl Checker<'_> {
    /// The lower end of a range `low .. high`: where only the upper end has a unit, it has the same.
    pub(crate) fn lower_end(&mut self, low: TypedValue, written: &Expr, high: (&TypedValue, &Expr)) -> TypedValue {
        let unit = unit_of(high.1);
        match (self.graph.constant_value(low.node), unit) {
            (Some(value), Some(one)) if is_bare(written) && !low.is_zero() && high.0.kind.is_one_number() => {
                TypedValue::new(self.graph.constant(value * one), high.0.kind.clone())
            }
            _ => low,
        }
    }
}

/// The SI value of the unit in which a number is written; nothing of a number without one and of anything else.
pub(crate) fn unit_of(expr: &Expr) -> Option<f64> {
    match &expr.kind {
        ExprKind::Paren(inner) | ExprKind::Unary { operand: inner, .. } => unit_of(inner),
        ExprKind::Number(number) => {
            number.unit.as_ref().and_then(|unit| unit::evaluate(unit).ok()).map(|quantity| quantity.value)
        }
        _ => None,
    }
}

/// Whether an expression is a number without a unit.
pub(crate) fn is_bare(expr: &Expr) -> bool {
    bare(expr).is_some()
}

/// The value of a number that is written without a unit, and where its digits end.
fn bare(expr: &Expr) -> Option<(f64, Span)> {
    match &expr.kind {
        ExprKind::Number(quantity) if quantity.unit.is_none() => Some((quantity.value, Span::at(quantity.digits.end as usize))),
        ExprKind::Unary { operator: UnaryOperator::Negate, operand } => bare(operand).map(|(value, end)| (-value, end)),
        _ => None,
    }
}

/// Offers a decimal point where one was written as a comma, which made two arguments of a number: `exp(-0,5 * x)`.
pub(crate) fn offer_decimal_point(diagnostic: Diagnostic, arguments: &[Argument]) -> Diagnostic {
    let split = arguments.windows(2).find_map(|pair| {
        let (whole, fraction) = (last_number(&pair[0].value)?, first_number(&pair[1].value)?);
        let touching = whole.digits.end + 1 == fraction.digits.start && whole.unit.is_none();
        (touching && whole.whole && fraction.whole).then_some((whole, fraction))
    });
    let Some((whole, fraction)) = split else { return diagnostic };
    let places = (fraction.digits.end - fraction.digits.start) as usize;
    let number = format!("{}.{:0places$}", exact(whole.value), fraction.value);
    diagnostic.suggest(format!("numbers have a decimal point: write `{number}`"), whole.digits.to(fraction.digits), number)
}

/// The number in which an expression ends.
fn last_number(expr: &Expr) -> Option<&Quantity> {
    match &expr.kind {
        ExprKind::Number(number) => Some(number),
        ExprKind::Binary { right, .. } => last_number(right),
        ExprKind::Unary { operand, .. } => last_number(operand),
        _ => None,
    }
}

/// The number with which an expression begins.
fn first_number(expr: &Expr) -> Option<&Quantity> {
    match &expr.kind {
        ExprKind::Number(number) => Some(number),
        ExprKind::Binary { left, .. } => first_number(left),
        _ => None,
    }
}

/// Units in which a quantity of this size is written, the likeliest first; at least one.
fn likely(dimension: Dimension, size: f64) -> Vec<String> {
    let units: &[&str] = match dimension {
        Dimension::ANGLE if size > TAU => &["deg"],
        Dimension::ANGLE => &["rad", "deg"],
        Dimension::ANGULAR_VELOCITY if size > 10.0 * TAU => &["deg/s"],
        Dimension::ANGULAR_VELOCITY => &["rad/s", "deg/s"],
        Dimension::LENGTH if size >= 250.0 => &["mm", "m"],
        Dimension::LENGTH if size >= 10.0 => &["cm", "m"],
        Dimension::TIME if size >= 100.0 => &["ms", "s"],
        Dimension::FREQUENCY => &["Hz"],
        other => return vec![other.to_string()],
    };
    units.iter().map(|unit| (*unit).to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_of_a_number_tells_its_unit() {
        assert_eq!(likely(Dimension::ANGLE, 60.0), ["deg"]);
        assert_eq!(likely(Dimension::ANGLE, 1.2), ["rad", "deg"]);
        assert_eq!(likely(Dimension::LENGTH, 0.6), ["m"]);
        assert_eq!(likely(Dimension::LENGTH, 60.0), ["cm", "m"]);
        assert_eq!(likely(Dimension::FREQUENCY, 1.1), ["Hz"]);
        assert_eq!(likely(Dimension::SPEED, 1.3), ["m/s"]);
    }
}

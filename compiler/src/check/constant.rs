//! Quantities that stand in declarations of bodies and initial states: numbers with units, signs, brackets and the four
//! operations.

use super::dimension::Dimension;
use super::unit::{self, Quantity};
use crate::diagnostics::{Code, Span, codes};
use crate::syntax::tree::{BinaryOperator, Expr, ExprKind, UnaryOperator};

/// Why an expression is no constant quantity.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NotConstant {
    pub code: &'static Code,
    pub span: Span,
    pub message: String,
}

impl NotConstant {
    fn new(span: Span, message: impl Into<String>) -> Self {
        Self { code: codes::types::NOT_CONSTANT, span, message: message.into() }
    }

    fn dimension(span: Span, message: impl Into<String>) -> Self {
        Self { code: codes::types::DIMENSIONS_DIFFER, span, message: message.into() }
    }
}

/// The value of an expression in SI units.
///
/// # Errors
/// The first part that is not a constant, or whose unit does not fit.
pub(crate) fn quantity(expr: &Expr) -> Result<Quantity, NotConstant> {
    let fail = |message: &str| Err(NotConstant::new(expr.span, message));
    match &expr.kind {
        ExprKind::Number(number) => match number.unit.as_ref().map(unit::evaluate) {
            None => Ok(Quantity { value: number.value, dimension: Dimension::NONE }),
            Some(Ok(one)) => Ok(Quantity { value: number.value * one.value, ..one }),
            Some(Err(factor)) => {
                Err(NotConstant::new(factor.span, format!("`{}` cannot be used in a unit like this", factor.name)))
            }
        },
        ExprKind::Paren(inner) => quantity(inner),
        ExprKind::Unary { operator: UnaryOperator::Negate, operand } => {
            quantity(operand).map(|found| Quantity { value: -found.value, ..found })
        }
        ExprKind::Binary { operator, left, right, .. } => {
            let (a, b) = (quantity(left)?, quantity(right)?);
            let dimension = match operator {
                BinaryOperator::Add | BinaryOperator::Subtract => (a.dimension == b.dimension).then_some(a.dimension),
                BinaryOperator::Multiply => a.dimension.times(b.dimension),
                BinaryOperator::Divide => a.dimension.per(b.dimension),
                _ => None,
            };
            let Some(dimension) = dimension else {
                return Err(NotConstant::dimension(expr.span, "these units cannot be combined"));
            };
            let value = match operator {
                BinaryOperator::Add => a.value + b.value,
                BinaryOperator::Subtract => a.value - b.value,
                BinaryOperator::Divide => a.value / b.value,
                _ => a.value * b.value,
            };
            Ok(Quantity { value, dimension })
        }
        _ => fail("expected a number with its unit"),
    }
}

/// The value in SI units of an expression of this dimension; a bare zero fits any.
///
/// # Errors
/// No constant, another dimension, or no finite number.
pub(crate) fn of_dimension(expr: &Expr, wanted: Dimension) -> Result<f64, NotConstant> {
    let found = quantity(expr)?;
    if found.dimension != wanted && !(found.value == 0.0 && found.dimension.is_none()) {
        let message = format!("found {}, expected {}", found.dimension.described(), wanted.described());
        return Err(NotConstant::dimension(expr.span, message));
    }
    if !found.value.is_finite() {
        return Err(NotConstant::new(expr.span, "not a finite number"));
    }
    Ok(found.value)
}

/// A whole number that is not negative.
///
/// # Errors
/// Anything else.
pub(crate) fn whole(expr: &Expr) -> Result<u64, NotConstant> {
    let found = of_dimension(expr, Dimension::NONE)?;
    if found >= 0.0 && found.fract() == 0.0 && found <= 9e15 {
        return Ok(found as u64);
    }
    Err(NotConstant::new(expr.span, "expected a whole number"))
}

/// The components of a bracket, each of this dimension.
///
/// # Errors
/// No bracket, another number of components, or what [`of_dimension`] refuses.
pub(crate) fn bracket<const SIZE: usize>(expr: &Expr, wanted: Dimension) -> Result<[f64; SIZE], NotConstant> {
    let ExprKind::List(elements) = &expr.kind else {
        let message = format!("expected a list of {SIZE} numbers");
        return Err(NotConstant::new(expr.span, message));
    };
    let values: Vec<f64> = elements.iter().map(|element| of_dimension(element, wanted)).collect::<Result<_, _>>()?;
    <[f64; SIZE]>::try_from(values)
        .map_err(|values| NotConstant::new(expr.span, format!("expected a list of {SIZE} numbers, found {}", values.len())))
}

//! The closed list of units and the value of unit expressions such as `N*m*s/rad`.

use super::dimension::{Dimension, Rational};
use crate::syntax::tree::{UnitExpr, UnitFactor};

/// A unit of the language.
#[derive(Debug, Clone, Copy)]
pub struct Unit {
    /// As written after a number.
    pub name: &'static str,
    /// SI value of one such unit.
    pub factor: f64,
    /// Its dimension.
    pub dimension: Dimension,
    /// What it is called.
    pub description: &'static str,
}

/// A number in SI units with its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// In SI units.
    pub value: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

const fn unit(name: &'static str, factor: f64, dimension: Dimension, description: &'static str) -> Unit {
    Unit { name, factor, dimension, description }
}

/// Every unit; whole `steps` are read apart. There is no `t`, `h`, `min` or `g`: too easily taken for a name.
pub const UNITS: &[Unit] = &[
    unit("m", 1.0, Dimension::LENGTH, "metre"),
    unit("km", 1e3, Dimension::LENGTH, "kilometre"),
    unit("cm", 1e-2, Dimension::LENGTH, "centimetre"),
    unit("mm", 1e-3, Dimension::LENGTH, "millimetre"),
    unit("um", 1e-6, Dimension::LENGTH, "micrometre"),
    unit("kg", 1.0, Dimension::MASS, "kilogram"),
    unit("s", 1.0, Dimension::TIME, "second"),
    unit("ms", 1e-3, Dimension::TIME, "millisecond"),
    unit("us", 1e-6, Dimension::TIME, "microsecond"),
    unit("rad", 1.0, Dimension::ANGLE, "radian"),
    unit("deg", std::f64::consts::PI / 180.0, Dimension::ANGLE, "degree"),
    unit("Hz", 1.0, Dimension::FREQUENCY, "hertz"),
    unit("kHz", 1e3, Dimension::FREQUENCY, "kilohertz"),
    unit("N", 1.0, Dimension::FORCE, "newton"),
    unit("kN", 1e3, Dimension::FORCE, "kilonewton"),
    unit("mN", 1e-3, Dimension::FORCE, "millinewton"),
    unit("J", 1.0, Dimension::TORQUE, "joule"),
    unit("kJ", 1e3, Dimension::TORQUE, "kilojoule"),
    unit("mJ", 1e-3, Dimension::TORQUE, "millijoule"),
    unit("W", 1.0, Dimension::POWER, "watt"),
    unit("kW", 1e3, Dimension::POWER, "kilowatt"),
    unit("mW", 1e-3, Dimension::POWER, "milliwatt"),
    unit("Pa", 1.0, Dimension::PRESSURE, "pascal"),
    unit("kPa", 1e3, Dimension::PRESSURE, "kilopascal"),
    unit("MPa", 1e6, Dimension::PRESSURE, "megapascal"),
    unit("%", 1e-2, Dimension::NONE, "per cent"),
];

/// The unit called `name`.
pub fn find(name: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.name == name)
}

/// The SI value and dimension of a unit expression. Whole `steps` are no unit of time: the caller looks for them first.
///
/// # Errors
/// The factor that is not a unit, or whose exponent grows beyond reason.
pub fn evaluate(expression: &UnitExpr) -> Result<Quantity, &UnitFactor> {
    let mut product = Quantity { value: 1.0, dimension: Dimension::NONE };
    for factor in &expression.factors {
        let power = Rational::new(factor.numerator, factor.denominator).ok_or(factor)?;
        let unit = find(&factor.name).ok_or(factor)?;
        let dimension = unit.dimension.power(power).and_then(|powered| product.dimension.times(powered)).ok_or(factor)?;
        // A division is exact where a multiplication by a reciprocal is not: 5 m/ms is 5000 m/s.
        let magnitude = libm::pow(unit.factor, f64::from(factor.numerator.abs()) / f64::from(factor.denominator));
        product.value = if factor.numerator < 0 { product.value / magnitude } else { product.value * magnitude };
        product.dimension = dimension;
    }
    Ok(product)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::Span;

    fn expression(factors: &[(&str, i32)]) -> UnitExpr {
        let factor = |&(name, numerator): &(&str, i32)| UnitFactor {
            name: name.to_owned(),
            numerator,
            denominator: 1,
            span: Span::default(),
        };
        UnitExpr { text: String::new(), factors: factors.iter().map(factor).collect(), span: Span::default() }
    }

    #[test]
    fn compound_units_multiply_out() {
        let damping = evaluate(&expression(&[("N", 1), ("m", 1), ("s", 1), ("rad", -1)])).unwrap();
        assert_eq!(damping, Quantity { value: 1.0, dimension: Dimension::of(2, 1, -1, -1) });
        assert_eq!(
            evaluate(&expression(&[("cm", 1), ("ms", -1)])).unwrap(),
            Quantity { value: 10.0, dimension: Dimension::SPEED }
        );
        let degree = evaluate(&expression(&[("deg", 1)])).unwrap();
        assert!((degree.value * 180.0 - std::f64::consts::PI).abs() < 1e-15);
    }

    #[test]
    fn every_unit_of_the_grammar_has_a_size() {
        for name in crate::syntax::UNITS {
            assert!(name == "steps" || find(name).is_some(), "{name}");
        }
        assert_eq!(UNITS.len() + 1, crate::syntax::UNITS.len());
    }

    #[test]
    fn what_is_no_unit_is_named() {
        assert_eq!(evaluate(&expression(&[("m", 1), ("foo", 1)])).unwrap_err().name, "foo");
        assert_eq!(evaluate(&expression(&[("m", 99)])).unwrap_err().name, "m");
    }
}

//! The closed list of units and the value of their products such as `N*m*s/rad`.

use super::dimension::{Dimension, Rational};

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

/// The SI value and dimension of a product of powers of units: name, numerator and denominator of each exponent. Whole `steps` are no
/// unit of time: the caller looks for them first.
///
/// # Errors
/// The place of the factor that is not a unit, or whose exponent grows beyond reason.
pub fn product<'a>(factors: impl IntoIterator<Item = (&'a str, i32, i32)>) -> Result<Quantity, usize> {
    let mut product = Quantity { value: 1.0, dimension: Dimension::NONE };
    for (place, (name, numerator, denominator)) in factors.into_iter().enumerate() {
        let power = Rational::new(numerator, denominator).ok_or(place)?;
        let unit = find(name).ok_or(place)?;
        let powered = if power == Rational::whole(1) { Some(unit.dimension) } else { unit.dimension.power(power) };
        let dimension = powered.and_then(|powered| product.dimension.times(powered)).ok_or(place)?;
        // A division is exact where a multiplication by a reciprocal is not: 5 m/ms is 5000 m/s.
        let magnitude = libm::pow(unit.factor, f64::from(numerator.abs()) / f64::from(denominator));
        product.value = if numerator < 0 { product.value / magnitude } else { product.value * magnitude };
        product.dimension = dimension;
    }
    Ok(product)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compound_units_multiply_out() {
        let damping = product([("N", 1, 1), ("m", 1, 1), ("s", 1, 1), ("rad", -1, 1)]).unwrap();
        assert_eq!(damping, Quantity { value: 1.0, dimension: Dimension::of(2, 1, -1, -1) });
        let speed = product([("cm", 1, 1), ("ms", -1, 1)]).unwrap();
        assert_eq!(speed, Quantity { value: 10.0, dimension: Dimension::SPEED });
        let degree = product([("deg", 1, 1)]).unwrap();
        assert!((degree.value * 180.0 - std::f64::consts::PI).abs() < 1e-15);
    }

    #[test]
    fn what_is_no_unit_is_named() {
        assert_eq!(product([("m", 1, 1), ("foo", 1, 1)]), Err(1));
        assert_eq!(product([("m", 99, 1)]), Err(0));
    }
}

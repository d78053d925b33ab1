//! Units in which quantities are printed for people: as they were written, else as is customary.

use crate::numbers::{distinguished, for_people};
use crate::quantity::dimension::Dimension;
use std::f64::consts::PI;

/// The unit of a quantity: of its SI value, and in which it is printed.
#[derive(Debug, Clone, PartialEq)]
pub struct SpokenUnit {
    /// Unit of the SI value; empty for plain numbers.
    pub si: String,
    /// The unit in which it is printed; empty for plain numbers.
    pub name: String,
    /// SI value of one of these units.
    pub factor: f64,
}

impl SpokenUnit {
    /// A unit that is printed as it is.
    pub fn si(unit: impl Into<String>) -> Self {
        let unit = unit.into();
        Self { si: unit.clone(), name: unit, factor: 1.0 }
    }

    /// The unit customary for a quantity of this dimension: angles in degrees, all else in SI units.
    pub fn of(dimension: Dimension) -> Self {
        let (name, factor) = match dimension {
            Dimension::ANGLE => ("deg", PI / 180.0),
            Dimension::FREQUENCY => ("Hz", 1.0),
            other => return Self::si(other.to_string()),
        };
        Self { si: dimension.to_string(), name: name.to_owned(), factor }
    }

    /// A value in SI units as printed for people: `40 deg`.
    pub fn tell(&self, value: f64) -> String {
        self.with_unit(&for_people(self.amount(value)))
    }

    /// The bounds of a range and a value beside it, printed so that they differ to the eye: `0 .. 120 deg` and `170 deg`.
    pub fn tell_beside(&self, [low, high]: [f64; 2], value: f64) -> (String, String) {
        let [low, high, value] = distinguished(&[low, high, value].map(|value| self.amount(value)));
        (self.with_unit(&format!("{low} .. {high}")), self.with_unit(&value))
    }

    /// How many of these units a value in SI units is, without the last bits of a conversion.
    pub fn amount(&self, value: f64) -> f64 {
        if self.factor == 1.0 {
            return value;
        }
        let amount = value / self.factor;
        let rounded = (amount * 1e9).round() / 1e9;
        if (rounded - amount).abs() <= 1e-12 * amount.abs() { rounded } else { amount }
    }

    /// Some text with the unit behind it.
    pub fn with_unit(&self, text: &str) -> String {
        if self.name.is_empty() { text.to_owned() } else { format!("{text} {}", self.name) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_printed_in_degrees_and_all_else_in_si_units() {
        let degrees = SpokenUnit::of(Dimension::ANGLE);
        assert_eq!(degrees.tell(PI / 3.0), "60 deg");
        assert_eq!(degrees.tell_beside([0.0, 120.0 * PI / 180.0], 170.0 * PI / 180.0), ("0 .. 120 deg".into(), "170 deg".into()));
        assert_eq!(SpokenUnit::of(Dimension::SPEED).tell(1.5), "1.5 m/s");
        assert_eq!(SpokenUnit::of(Dimension::NONE).tell(0.25), "0.25");
    }
}

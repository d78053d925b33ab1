//! A smooth curve as a table, because a muscle reads its curves several times in every step and their closed forms are sums of
//! exponentials and logarithms.
//!
//! Between two knots stands the cubic that has the curve's value and slope at both; it is off by at most d⁴ / 384 times the
//! curve's fourth derivative, d the distance of knots: about 1e-10 for the curves of fibres as they are laid out here.

use super::curves::{Sloped, active, velocity};

/// Values and slopes of a curve at equal distances, and the curve itself for what lies outside.
#[derive(Debug)]
pub struct Table {
    curve: fn(f64) -> Sloped,
    first: f64,
    /// Knots per unit of the argument.
    density: f64,
    /// Distances between knots.
    count: f64,
    /// Values, and slopes times the distance of the knots.
    knots: Box<[Sloped]>,
}

impl Table {
    /// The curve over `width` from `first`, with so many knots per unit.
    pub fn new(curve: fn(f64) -> Sloped, first: f64, width: u8, density: u16) -> Self {
        let density = f64::from(density);
        let count = f64::from(width) * density;
        let knot = |index: usize| {
            let [value, slope] = curve(first + index as f64 / density);
            [value, slope / density]
        };
        Self { curve, first, density, count, knots: (0..=count as usize).map(knot).collect() }
    }

    /// Value and slope at a place.
    #[inline(always)]
    pub fn at(&self, place: f64) -> Sloped {
        let scaled = (place - self.first) * self.density;
        // What is not a number is not within either.
        if !(0.0 <= scaled && scaled < self.count) {
            return (self.curve)(place);
        }
        let index = scaled as usize;
        let share = scaled - index as f64;
        let Some(&[[value, slope], [next, next_slope]]) = self.knots.get(index..index + 2).and_then(|pair| pair.first_chunk())
        else {
            return (self.curve)(place);
        };
        let rise = next - value;
        let square = 3.0 * rise - 2.0 * slope - next_slope;
        let cube = slope + next_slope - 2.0 * rise;
        let steepness = slope + share * (2.0 * square + 3.0 * share * cube);
        [value + share * (slope + share * (square + share * cube)), steepness * self.density]
    }
}

/// The published curves of a fibre that take long to compute.
#[derive(Debug)]
pub struct Tables {
    /// Active force over length.
    pub active: Table,
    /// Factor of the active force over velocity.
    pub velocity: Table,
}

impl Tables {
    /// Over all lengths and velocities of living fibres.
    pub fn new() -> Self {
        Self { active: Table::new(active, 0.0, 2, 1024), velocity: Table::new(velocity, -2.0, 4, 512) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_their_curves_inside_and_outside() {
        let Tables { active: by_length, velocity: by_velocity } = Tables::new();
        for step in -3000..3000 {
            let place = f64::from(step) / 1000.0 + 1e-4 * core::f64::consts::PI;
            for (name, table, curve) in
                [("length", &by_length, active as fn(f64) -> Sloped), ("velocity", &by_velocity, velocity)]
            {
                let (found, expected) = (table.at(place), curve(place));
                assert!((found[0] - expected[0]).abs() < 2e-10, "{name} {place}: {found:?} is not {expected:?}");
                assert!((found[1] - expected[1]).abs() < 1e-6, "{name} {place}: {found:?} is not {expected:?}");
            }
        }
        assert_eq!(by_length.at(2.0), active(2.0));
        assert!(by_velocity.at(f64::NAN)[0].is_nan());
    }
}

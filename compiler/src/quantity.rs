//! Physical quantities: dimensions, and the units in which they are written.

pub use msk_program::quantity::dimension;

/// The closed list of units and the value of unit expressions such as `N*m*s/rad`.
pub mod unit {
    use crate::syntax::tree::{UnitExpr, UnitFactor};

    pub use msk_program::quantity::unit::{Quantity, UNITS, Unit, find};

    /// The SI value and dimension of a unit expression. Whole `steps` are no unit of time: the caller looks for them first.
    ///
    /// # Errors
    /// The factor that is not a unit, or whose exponent grows beyond reason.
    pub fn evaluate(expression: &UnitExpr) -> Result<Quantity, &UnitFactor> {
        let factors = expression.factors.iter().map(|factor| (factor.name.as_str(), factor.numerator, factor.denominator));
        // The place is that of one of these factors.
        msk_program::quantity::unit::product(factors).map_err(|place| &expression.factors[place])
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn every_unit_of_the_grammar_has_a_size() {
            for name in crate::syntax::UNITS {
                assert!(name == "steps" || find(name).is_some(), "{name}");
            }
            assert_eq!(UNITS.len() + 1, crate::syntax::UNITS.len());
        }
    }
}

//! Physical dimensions: rational exponents over length, mass, time and angle.
//!
//! Angle is a base dimension, so a radian never passes silently for a plain number or a metre.

use std::fmt;

/// Largest numerator or denominator of an exponent; what goes beyond is a mistake, not physics.
const LARGEST: i32 = 96;

/// A reduced fraction with a positive denominator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Rational {
    numerator: i32,
    denominator: i32,
}

impl Rational {
    /// The whole number `value`.
    pub const fn whole(value: i32) -> Self {
        Self { numerator: value, denominator: 1 }
    }

    /// `numerator / denominator`, reduced; `None` for a zero denominator or a fraction outside the representable exponents.
    pub fn new(numerator: i32, denominator: i32) -> Option<Self> {
        if denominator == 0 {
            return None;
        }
        let divisor = greatest_common_divisor(i64::from(numerator), i64::from(denominator)) * i64::from(denominator.signum());
        let numerator = i32::try_from(i64::from(numerator) / divisor).ok()?;
        let denominator = i32::try_from(i64::from(denominator) / divisor).ok()?;
        (numerator.abs() <= LARGEST && denominator <= LARGEST).then_some(Self { numerator, denominator })
    }

    /// The fraction with a small denominator that equals `value`, if there is one.
    pub fn from_f64(value: f64) -> Option<Self> {
        (1..=12).find_map(|denominator| {
            let numerator = value * f64::from(denominator);
            let rounded = numerator.round();
            let near = (numerator - rounded).abs() < 1e-9 && rounded.abs() <= f64::from(LARGEST);
            if near { Self::new(rounded as i32, denominator) } else { None }
        })
    }

    fn plus(self, other: Self) -> Option<Self> {
        if self.is_zero() || other.is_zero() {
            // What most exponents are needs no reducing.
            return Some(if self.is_zero() { other } else { self });
        }
        Self::new(self.numerator * other.denominator + other.numerator * self.denominator, self.denominator * other.denominator)
    }

    fn times(self, other: Self) -> Option<Self> {
        Self::new(self.numerator * other.numerator, self.denominator * other.denominator)
    }

    fn negated(self) -> Self {
        Self { numerator: -self.numerator, denominator: self.denominator }
    }

    const fn is_zero(self) -> bool {
        self.numerator == 0
    }
}

fn greatest_common_divisor(a: i64, b: i64) -> i64 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.max(1)
}

impl fmt::Display for Rational {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.denominator == 1 {
            write!(formatter, "{}", self.numerator)
        } else {
            write!(formatter, "({}/{})", self.numerator, self.denominator)
        }
    }
}

/// A product of powers of length, mass, time and angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Dimension {
    exponents: [Rational; 4],
}

impl Dimension {
    /// A plain number.
    pub const NONE: Self = Self::of(0, 0, 0, 0);
    /// m.
    pub const LENGTH: Self = Self::of(1, 0, 0, 0);
    /// kg.
    pub const MASS: Self = Self::of(0, 1, 0, 0);
    /// s.
    pub const TIME: Self = Self::of(0, 0, 1, 0);
    /// rad.
    pub const ANGLE: Self = Self::of(0, 0, 0, 1);
    /// m/s.
    pub const SPEED: Self = Self::of(1, 0, -1, 0);
    /// m/s².
    pub const ACCELERATION: Self = Self::of(1, 0, -2, 0);
    /// rad/s.
    pub const ANGULAR_VELOCITY: Self = Self::of(0, 0, -1, 1);
    /// rad/s².
    pub const ANGULAR_ACCELERATION: Self = Self::of(0, 0, -2, 1);
    /// N.
    pub const FORCE: Self = Self::of(1, 1, -2, 0);
    /// N m.
    pub const TORQUE: Self = Self::of(2, 1, -2, 0);
    /// W.
    pub const POWER: Self = Self::of(2, 1, -3, 0);
    /// Pa.
    pub const PRESSURE: Self = Self::of(-1, 1, -2, 0);
    /// kg m²/s.
    pub const ANGULAR_MOMENTUM: Self = Self::of(2, 1, -1, 0);
    /// Hz.
    pub const FREQUENCY: Self = Self::of(0, 0, -1, 0);

    /// Whole exponents of length, mass, time and angle.
    pub const fn of(length: i32, mass: i32, time: i32, angle: i32) -> Self {
        Self { exponents: [Rational::whole(length), Rational::whole(mass), Rational::whole(time), Rational::whole(angle)] }
    }

    /// Whether this is a plain number.
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// The dimension of a product; `None` when an exponent grows beyond reason.
    pub fn times(self, other: Self) -> Option<Self> {
        let mut exponents = self.exponents;
        for (exponent, added) in exponents.iter_mut().zip(other.exponents) {
            *exponent = exponent.plus(added)?;
        }
        Some(Self { exponents })
    }

    /// The dimension of a quotient; `None` when an exponent grows beyond reason.
    pub fn per(self, other: Self) -> Option<Self> {
        self.times(other.inverse())
    }

    /// The dimension of the reciprocal.
    pub fn inverse(self) -> Self {
        Self { exponents: self.exponents.map(Rational::negated) }
    }

    /// The dimension of a power; `None` when an exponent grows beyond reason.
    pub fn power(self, by: Rational) -> Option<Self> {
        let mut exponents = self.exponents;
        for exponent in &mut exponents {
            *exponent = exponent.times(by)?;
        }
        Some(Self { exponents })
    }

    /// What a reader calls such a quantity: `a speed (m/s)`, `a plain number`.
    pub fn described(self) -> String {
        if self.is_none() {
            return "a dimensionless number".to_owned();
        }
        match NAMED.iter().find(|(_, dimension)| *dimension == self) {
            Some((name, _)) => {
                let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
                format!("{article} {} ({self})", name.replace('_', " "))
            }
            None => format!("a quantity in {self}"),
        }
    }

    /// Whether it, its inverse or its square root has a name: what is compared is rarely anything else.
    pub fn is_familiar(self) -> bool {
        let named = |dimension: Self| NAMED.iter().any(|(_, known)| *known == dimension);
        let root = Rational::new(1, 2).and_then(|half| self.power(half));
        named(self) || named(self.inverse()) || root.is_some_and(|root| named(root) || named(root.inverse()))
    }

    /// The dimension with a name that annotations may use (`length`, `velocity`, `angular_velocity`).
    pub fn named(name: &str) -> Option<Self> {
        NAMED.iter().find(|(known, _)| *known == name).map(|(_, dimension)| *dimension)
    }

    /// The names that annotations may use.
    pub fn names() -> impl Iterator<Item = &'static str> {
        NAMED.iter().map(|(name, _)| *name)
    }
}

/// Names of dimensions; the first name of a dimension is the one printed.
const NAMED: &[(&str, Dimension)] = &[
    ("number", Dimension::NONE),
    ("length", Dimension::LENGTH),
    ("mass", Dimension::MASS),
    ("time", Dimension::TIME),
    ("angle", Dimension::ANGLE),
    ("speed", Dimension::SPEED),
    ("velocity", Dimension::SPEED),
    ("acceleration", Dimension::ACCELERATION),
    ("angular_velocity", Dimension::ANGULAR_VELOCITY),
    ("angular_acceleration", Dimension::ANGULAR_ACCELERATION),
    ("area", Dimension::of(2, 0, 0, 0)),
    ("volume", Dimension::of(3, 0, 0, 0)),
    ("frequency", Dimension::FREQUENCY),
    ("force", Dimension::FORCE),
    ("torque", Dimension::TORQUE),
    ("energy", Dimension::TORQUE),
    ("power", Dimension::POWER),
    ("pressure", Dimension::PRESSURE),
    ("angular_momentum", Dimension::ANGULAR_MOMENTUM),
    ("momentum", Dimension::of(1, 1, -1, 0)),
];

/// Dimensions printed by the name of a derived unit.
const DERIVED: &[(&str, Dimension)] =
    &[("N", Dimension::FORCE), ("N*m", Dimension::TORQUE), ("W", Dimension::POWER), ("Pa", Dimension::PRESSURE)];

impl fmt::Display for Dimension {
    /// The coherent unit, as a literal would be written: `m/s`, `kg*m^2/s`; nothing for a plain number.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, _)) = DERIVED.iter().find(|(_, dimension)| dimension == self) {
            return formatter.write_str(name);
        }
        // Written in the customary order: kg*m^2/s, rad/s.
        let bases = [("rad", self.exponents[3]), ("kg", self.exponents[1]), ("m", self.exponents[0]), ("s", self.exponents[2])];
        let factor = |name: &str, exponent: Rational| match exponent {
            Rational { numerator: 1, denominator: 1 } => name.to_owned(),
            other => format!("{name}^{other}"),
        };
        let above: Vec<_> = bases.iter().filter(|(_, e)| e.numerator > 0).map(|(name, e)| factor(name, *e)).collect();
        let below: Vec<_> = bases.iter().filter(|(_, e)| e.numerator < 0).map(|(name, e)| (*name, *e)).collect();
        if above.is_empty() {
            let factors: Vec<_> = below.iter().map(|(name, e)| factor(name, *e)).collect();
            return formatter.write_str(&factors.join("*"));
        }
        formatter.write_str(&above.join("*"))?;
        for (name, exponent) in below.iter().filter(|(_, exponent)| !exponent.is_zero()) {
            write!(formatter, "/{}", factor(name, exponent.negated()))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_print_as_the_unit_a_literal_would_carry() {
        assert_eq!(Dimension::SPEED.to_string(), "m/s");
        assert_eq!(Dimension::ANGULAR_VELOCITY.to_string(), "rad/s");
        assert_eq!(Dimension::SPEED.inverse().to_string(), "s/m");
        assert_eq!(Dimension::of(-2, 0, 0, 0).to_string(), "m^-2");
        assert_eq!(Dimension::ANGULAR_MOMENTUM.to_string(), "kg*m^2/s");
        assert_eq!(Dimension::FORCE.to_string(), "N");
        assert_eq!(Dimension::NONE.to_string(), "");
    }

    #[test]
    fn a_square_root_halves_exponents_and_an_absurd_power_is_refused() {
        let area = Dimension::of(2, 0, 0, 0);
        assert_eq!(area.power(Rational::new(1, 2).unwrap()), Some(Dimension::LENGTH));
        assert_eq!(Dimension::LENGTH.power(Rational::new(1, 3).unwrap()).unwrap().to_string(), "m^(1/3)");
        assert_eq!(area.power(Rational::whole(90)), None);
        assert_eq!(Rational::from_f64(0.5), Rational::new(1, 2));
        assert_eq!(Rational::from_f64(0.123), None);
        assert_eq!(Rational::from_f64(f64::NAN), None);
    }
}

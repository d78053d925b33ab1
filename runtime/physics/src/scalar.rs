//! The number the physics is written over.
//!
//! Every per-step quantity of the simulator is generic over [`Real`], so that the same source runs one episode in `f64`
//! and eight in the lanes of one [`Lanes`](crate::lanes::Lanes). Two rules make that possible:
//!
//! * data-dependent choices go through [`Real::select`] on a mask where both sides are cheap, and through
//!   [`Real::any`] where a whole stage may be skipped;
//! * transcendental functions are `libm`'s, so that lanes, threads and machines give the same bits
//!   (`sqrt` is exact by IEEE 754 and stays the hardware's).
//!
//! Bits agree between machines only where every operation has one answer. The standard library leaves several open:
//! `f64::max` and `f64::min` may return either zero of `0.0` and `-0.0`, `powi` may multiply in any order, `sin`, `exp`,
//! `powf` and their like are the platform's. [`Real::at_least`], [`Real::at_most`], [`Real::clip`], [`Real::squared`] and
//! the functions of this trait take their places, for plain `f64` too; `clippy.toml` rejects the others.

use core::fmt::Debug;
use num_traits::{Num, NumAssign};

/// A real number, or several in lanes, that the physics computes with.
pub trait Real:
    nalgebra::Scalar + Copy + Num + NumAssign + core::ops::Neg<Output = Self> + Debug + Send + Sync + 'static
{
    /// One boolean per lane.
    type Mask: Copy + Debug;

    /// The number of episodes carried by one value.
    const LANES: usize;

    /// The same constant in every lane.
    fn splat(value: f64) -> Self;
    /// The value in lane `index < LANES`.
    fn lane(&self, index: usize) -> f64;
    /// Replaces the value in lane `index < LANES`.
    fn set_lane(&mut self, index: usize, value: f64);

    /// `self < other`, lane by lane.
    fn less(self, other: Self) -> Self::Mask;
    /// `self <= other`, lane by lane: not where either is NaN.
    fn is_at_most(self, other: Self) -> Self::Mask;
    /// The mask that holds in the lanes for which `holds` does.
    fn mask(holds: impl Fn(usize) -> bool) -> Self::Mask;
    /// Whether the mask holds in lane `index < LANES`.
    fn holds(mask: Self::Mask, index: usize) -> bool;
    /// `a` where the mask holds, `b` elsewhere.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Both masks.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Either mask.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Where the mask does not hold.
    fn not(mask: Self::Mask) -> Self::Mask;
    /// Whether the mask holds in any lane.
    fn any(mask: Self::Mask) -> bool;
    /// Whether the mask holds in every lane.
    fn all(mask: Self::Mask) -> bool;

    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// `low` where `self < low`, otherwise `self`: the larger of two, of equal ones the first. So the zeros `0.0` and `-0.0`
    /// keep the sign of `self`, a `self` that is NaN stays NaN, and a `low` that is NaN bounds nothing.
    #[inline(always)]
    fn at_least(self, low: Self) -> Self {
        Self::select(self.less(low), low, self)
    }
    /// `high` where `high < self`, otherwise `self`: the smaller of two, with zeros and NaN as in [`Real::at_least`].
    #[inline(always)]
    fn at_most(self, high: Self) -> Self {
        Self::select(high.less(self), high, self)
    }
    /// `self` moved into `low..=high`: first [`Real::at_least`], then [`Real::at_most`]. NaN stays NaN; where `low > high` the
    /// answer is `high`.
    #[inline(always)]
    fn clip(self, low: Self, high: Self) -> Self {
        self.at_least(low).at_most(high)
    }
    /// The product of `self` with itself.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
    /// For the beginning of a hot loop's body over a list of numbers: nothing for one lane. With several it keeps the compiler from
    /// turning the loop across the list, which would gather lanes from places far apart.
    #[inline(always)]
    fn apart() {}
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Arc cosine in radians, the argument clipped to [-1, 1].
    fn acos(self) -> Self;
    /// Arc sine in radians, the argument clipped to [-1, 1].
    fn asin(self) -> Self;
    /// Angle of the vector (`other`, `self`) in radians.
    fn atan2(self, other: Self) -> Self;
    /// e to the power of `self`.
    fn exp(self) -> Self;
    /// `self` to the power of `exponent`.
    fn powf(self, exponent: Self) -> Self;
    /// Whether every lane is neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

impl Real for f64 {
    type Mask = bool;
    const LANES: usize = 1;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn lane(&self, _index: usize) -> f64 {
        *self
    }
    #[inline(always)]
    fn set_lane(&mut self, _index: usize, value: f64) {
        *self = value;
    }
    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn is_at_most(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn mask(holds: impl Fn(usize) -> bool) -> bool {
        holds(0)
    }
    #[inline(always)]
    fn holds(mask: bool, _index: usize) -> bool {
        mask
    }
    #[inline(always)]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn and(a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn or(a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn not(mask: bool) -> bool {
        !mask
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn all(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        libm::acos(self.clip(-1.0, 1.0))
    }
    #[inline(always)]
    fn asin(self) -> Self {
        libm::asin(self.clip(-1.0, 1.0))
    }
    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        libm::atan2(self, other)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        libm::exp(self)
    }
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        libm::pow(self, exponent)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}

#[cfg(test)]
mod tests {
    use super::Real;

    /// Bits, so that the two zeros differ and a NaN is itself.
    fn same(found: f64, expected: f64) -> bool {
        found.to_bits() == expected.to_bits()
    }

    #[test]
    fn bounds_move_what_is_beyond_them_and_nothing_else() {
        assert_eq!([-2.0, 0.5, 2.0].map(|x: f64| x.at_least(-1.0)), [-1.0, 0.5, 2.0]);
        assert_eq!([-2.0, 0.5, 2.0].map(|x: f64| x.at_most(1.0)), [-2.0, 0.5, 1.0]);
        assert_eq!([-2.0, 0.5, 2.0].map(|x: f64| x.clip(-1.0, 1.0)), [-1.0, 0.5, 1.0]);
        assert_eq!([f64::NEG_INFINITY, f64::INFINITY].map(|x| x.clip(-1.0, 1.0)), [-1.0, 1.0]);
    }

    #[test]
    fn of_two_zeros_the_first_stays() {
        for bound in [0.0, -0.0] {
            for x in [0.0_f64, -0.0] {
                assert!(same(x.at_least(bound), x) && same(x.at_most(bound), x) && same(x.clip(bound, 1.0), x));
            }
        }
    }

    #[test]
    fn nan_stays_and_bounds_nothing() {
        assert!(f64::NAN.at_least(0.0).is_nan() && f64::NAN.at_most(0.0).is_nan() && f64::NAN.clip(-1.0, 1.0).is_nan());
        assert!(same(1.5_f64.at_least(f64::NAN), 1.5) && same(1.5_f64.at_most(f64::NAN), 1.5));
        assert!(same(1.5_f64.clip(f64::NAN, f64::NAN), 1.5));
        // The extremes of a list ignore NaN, wherever it stands.
        for values in [[f64::NAN, 2.0, 1.0], [2.0, 1.0, f64::NAN]] {
            assert_eq!(values.into_iter().fold(f64::NEG_INFINITY, Real::at_least), 2.0);
            assert_eq!(values.into_iter().fold(f64::INFINITY, Real::at_most), 1.0);
        }
    }

    #[test]
    fn bounds_that_cross_give_the_upper_one() {
        assert_eq!([0.0, 1.5, 3.0].map(|x: f64| x.clip(2.0, 1.0)), [1.0; 3]);
    }
}

//! The number the physics is written over.
//!
//! Every per-step quantity of the simulator is generic over [`Real`], so that the same source runs one episode in `f64`
//! and, later, several episodes in the lanes of one SIMD register. Two rules keep that door open:
//!
//! * data-dependent choices go through [`Real::select`] on a mask where both sides are cheap, and through
//!   [`Real::any`] where a whole stage may be skipped;
//! * transcendental functions are `libm`'s, so that lanes, threads and machines give the same bits
//!   (`sqrt` is exact by IEEE 754 and stays the hardware's).

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
    fn lane(self, index: usize) -> f64;
    /// Replaces the value in lane `index < LANES`.
    fn set_lane(&mut self, index: usize, value: f64);

    /// `self < other`, lane by lane.
    fn less(self, other: Self) -> Self::Mask;
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
    /// Smaller of two.
    fn min(self, other: Self) -> Self;
    /// Larger of two.
    fn max(self, other: Self) -> Self;
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
    fn lane(self, _index: usize) -> f64 {
        self
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
    fn min(self, other: Self) -> Self {
        f64::min(self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        f64::max(self, other)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        libm::acos(self.clamp(-1.0, 1.0))
    }
    #[inline(always)]
    fn asin(self) -> Self {
        libm::asin(self.clamp(-1.0, 1.0))
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

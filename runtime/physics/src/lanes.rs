//! Eight episodes in one number.
//!
//! A plain array: the compiler turns its loops into the widest instructions that the surrounding function may use, one register
//! of AVX-512, two of AVX2, four of SSE2 or NEON. There are always eight lanes, so nothing depends on the machine.

mod elementary;

use crate::scalar::Real;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign};
use num_traits::{Num, One, Zero};

/// Number of lanes.
pub const WIDTH: usize = 8;

/// One number of each of eight episodes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct Lanes([f64; WIDTH]);

impl Lanes {
    /// The number in lane `index` < [`WIDTH`], to be changed in place.
    #[inline(always)]
    pub fn lane_mut(&mut self, index: usize) -> &mut f64 {
        &mut self.0[index]
    }
}

/// One bit pattern per lane: all ones where the mask holds, else zero.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub struct Mask([u64; WIDTH]);

/// Writes the same expression for every lane: no loop that an optimiser could leave a loop.
macro_rules! each {
    ($lane:ident => $value:expr) => {
        [
            {
                const $lane: usize = 0;
                $value
            },
            {
                const $lane: usize = 1;
                $value
            },
            {
                const $lane: usize = 2;
                $value
            },
            {
                const $lane: usize = 3;
                $value
            },
            {
                const $lane: usize = 4;
                $value
            },
            {
                const $lane: usize = 5;
                $value
            },
            {
                const $lane: usize = 6;
                $value
            },
            {
                const $lane: usize = 7;
                $value
            },
        ]
    };
}

macro_rules! arithmetic {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident $sign:tt),*) => {$(
        impl $operator for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(each!(LANE => self.0[LANE] $sign other.0[LANE]))
            }
        }
        impl $assign for Lanes {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
    )*};
}
arithmetic!(Add add AddAssign add_assign +, Sub sub SubAssign sub_assign -, Mul mul MulAssign mul_assign *,
            Div div DivAssign div_assign /, Rem rem RemAssign rem_assign %);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(each!(LANE => -self.0[LANE]))
    }
}

impl Zero for Lanes {
    fn zero() -> Self {
        Self([0.0; WIDTH])
    }
    fn is_zero(&self) -> bool {
        self.0 == [0.0; WIDTH]
    }
}

impl One for Lanes {
    fn one() -> Self {
        Self([1.0; WIDTH])
    }
}

impl Num for Lanes {
    type FromStrRadixErr = num_traits::ParseFloatError;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self::splat)
    }
}

impl Real for Lanes {
    type Mask = Mask;
    const LANES: usize = WIDTH;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; WIDTH])
    }
    #[inline(always)]
    fn lane(&self, index: usize) -> f64 {
        self.0[index]
    }
    #[inline(always)]
    fn set_lane(&mut self, index: usize, value: f64) {
        self.0[index] = value;
    }
    #[inline(always)]
    fn less(self, other: Self) -> Mask {
        Mask(each!(LANE => if self.0[LANE] < other.0[LANE] { u64::MAX } else { 0 }))
    }
    #[inline(always)]
    fn is_at_most(self, other: Self) -> Mask {
        Mask(each!(LANE => if self.0[LANE] <= other.0[LANE] { u64::MAX } else { 0 }))
    }
    #[inline(always)]
    fn mask(holds: impl Fn(usize) -> bool) -> Mask {
        Mask(each!(LANE => if holds(LANE) { u64::MAX } else { 0 }))
    }
    #[inline(always)]
    fn holds(mask: Mask, index: usize) -> bool {
        mask.0[index] != 0
    }
    #[inline(always)]
    fn select(mask: Mask, a: Self, b: Self) -> Self {
        Self(each!(LANE => f64::from_bits((a.0[LANE].to_bits() & mask.0[LANE]) | (b.0[LANE].to_bits() & !mask.0[LANE]))))
    }
    #[inline(always)]
    fn and(a: Mask, b: Mask) -> Mask {
        Mask(each!(LANE => a.0[LANE] & b.0[LANE]))
    }
    #[inline(always)]
    fn or(a: Mask, b: Mask) -> Mask {
        Mask(each!(LANE => a.0[LANE] | b.0[LANE]))
    }
    #[inline(always)]
    fn not(mask: Mask) -> Mask {
        Mask(each!(LANE => !mask.0[LANE]))
    }
    #[inline(always)]
    fn any(mask: Mask) -> bool {
        let [a, b, c, d, e, f, g, h] = mask.0;
        ((a | b) | (c | d)) | ((e | f) | (g | h)) != 0
    }
    #[inline(always)]
    fn all(mask: Mask) -> bool {
        let [a, b, c, d, e, f, g, h] = mask.0;
        ((a & b) & (c & d)) & ((e & f) & (g & h)) != 0
    }
    #[inline(always)]
    fn apart() {
        core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(each!(LANE => self.0[LANE].sqrt()))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(each!(LANE => f64::from_bits(self.0[LANE].to_bits() & (u64::MAX >> 1))))
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (mut sin, mut cos, done) = elementary::sin_cos(self);
        if !Self::all(done) {
            for lane in (0..WIDTH).filter(|&lane| !Self::holds(done, lane)) {
                (sin.0[lane], cos.0[lane]) = Real::sin_cos(self.0[lane]);
            }
        }
        (sin, cos)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        Self(self.0.map(Real::acos))
    }
    #[inline(always)]
    fn asin(self) -> Self {
        Self(self.0.map(Real::asin))
    }
    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        let (mut angle, done) = elementary::atan2(self, other);
        if !Self::all(done) {
            for lane in (0..WIDTH).filter(|&lane| !Self::holds(done, lane)) {
                angle.0[lane] = Real::atan2(self.0[lane], other.0[lane]);
            }
        }
        angle
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Self(self.0.map(Real::exp))
    }
    #[inline(always)]
    fn powf(mut self, exponent: Self) -> Self {
        for lane in 0..WIDTH {
            self.0[lane] = Real::powf(self.0[lane], exponent.0[lane]);
        }
        self
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.0.iter().all(|value| value.is_finite())
    }
}

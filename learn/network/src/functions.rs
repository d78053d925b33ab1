//! Elementary functions of single precision without branches, so that compilers compute many at once; no operation is fused, so the
//! bits are the same everywhere.

/// What follows a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Activation {
    /// Hyperbolic tangent.
    Tanh,
    /// max(x, 0).
    Relu,
    /// x where it is positive, else e^x - 1.
    Elu,
    /// x times the logistic function of x.
    Silu,
}

impl Activation {
    /// All of them, as files name them.
    pub const NAMED: [(&'static str, Self); 4] =
        [("tanh", Self::Tanh), ("relu", Self::Relu), ("elu", Self::Elu), ("silu", Self::Silu)];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tanh => "tanh",
            Self::Relu => "relu",
            Self::Elu => "elu",
            Self::Silu => "silu",
        }
    }
}

/// log2(e).
const LOG2_E: f32 = core::f32::consts::LOG2_E;
/// ln 2 in two parts (Cody and Waite 1980): the first has nine bits, so that its products with whole numbers are exact.
const LN_2_HIGH: f32 = 355.0 / 512.0;
const LN_2_LOW: f32 = -2.121_944_4e-4;
/// Adding it rounds to a whole number, whose sum with the bias of an exponent then stands in the lowest bits.
const ROUND: f32 = 12_582_912.0 + 127.0;

/// x where it lies within bounds, else the nearer bound; NaN stays NaN.
#[inline(always)]
pub fn clip(x: f32, low: f32, high: f32) -> f32 {
    let x = if x < low { low } else { x };
    if x > high { high } else { x }
}

/// 2^n and e^r - 1 with n ln 2 + r = x, |r| at most (ln 2) / 2, for x from -87 to 88.
#[inline(always)]
fn parts(x: f32) -> (f32, f32) {
    let shifted = x * LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    // Taylor's series: the first term left out is r^8 / 8!, less than 6e-9.
    let series = 1.0 / 720.0 + r * (1.0 / 5040.0);
    let series = 1.0 / 24.0 + r * (1.0 / 120.0 + r * series);
    let series = r + r * r * (0.5 + r * (1.0 / 6.0 + r * series));
    (f32::from_bits(shifted.to_bits() << 23), series)
}

/// e^x, for x from -87 to 88; beyond them the value at the bound.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    let (scale, rest) = parts(clip(x, -87.0, 88.0));
    scale + scale * rest
}

/// e^x - 1, likewise, with its full relative precision near 0.
#[inline(always)]
fn exp_minus_1(x: f32) -> f32 {
    let (scale, rest) = parts(clip(x, -87.0, 88.0));
    scale * rest + (scale - 1.0)
}

/// The hyperbolic tangent.
#[inline(always)]
pub fn tanh(x: f32) -> f32 {
    // From 10 on it is 1 to the last bit.
    let m = exp_minus_1(2.0 * clip(x, -10.0, 10.0));
    m / (m + 2.0)
}

/// The logistic function.
#[inline(always)]
fn logistic(x: f32) -> f32 {
    1.0 / (1.0 + exp(-x))
}

/// ln(1 + e^x).
#[inline(always)]
pub fn softplus(x: f32) -> f32 {
    let above = if x > 0.0 { x } else { 0.0 };
    let magnitude = if x > 0.0 { x } else { -x };
    above + libm::log1pf(exp(-magnitude))
}

/// The derivative of [`softplus`].
#[inline(always)]
pub fn softplus_slope(x: f32) -> f32 {
    logistic(x)
}

/// Functions with their slopes, each a type so that loops are compiled for each.
pub trait Function {
    /// The value at x.
    fn value(x: f32) -> f32;
    /// The derivative where the argument is x and the value y.
    fn slope(x: f32, y: f32) -> f32;
}

/// See [`Activation::Tanh`].
pub struct Tanh;
/// See [`Activation::Relu`].
pub struct Relu;
/// See [`Activation::Elu`].
pub struct Elu;
/// See [`Activation::Silu`].
pub struct Silu;

impl Function for Tanh {
    #[inline(always)]
    fn value(x: f32) -> f32 {
        tanh(x)
    }
    #[inline(always)]
    fn slope(_: f32, y: f32) -> f32 {
        1.0 - y * y
    }
}

impl Function for Relu {
    // NaN must stay NaN, so that it is found.
    #[inline(always)]
    fn value(x: f32) -> f32 {
        if x < 0.0 { 0.0 } else { x }
    }
    #[inline(always)]
    fn slope(x: f32, _: f32) -> f32 {
        if x > 0.0 { 1.0 } else { 0.0 }
    }
}

impl Function for Elu {
    #[inline(always)]
    fn value(x: f32) -> f32 {
        if x > 0.0 { x } else { exp_minus_1(x) }
    }
    #[inline(always)]
    fn slope(x: f32, y: f32) -> f32 {
        if x > 0.0 { 1.0 } else { y + 1.0 }
    }
}

impl Function for Silu {
    #[inline(always)]
    fn value(x: f32) -> f32 {
        x * logistic(x)
    }
    #[inline(always)]
    fn slope(x: f32, y: f32) -> f32 {
        let share = logistic(x);
        share + y * (1.0 - share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest distance from a function in double precision, in units of the last place of the exact value.
    fn distance(found: impl Fn(f32) -> f32, exact: impl Fn(f64) -> f64, [low, high]: [f32; 2]) -> f64 {
        let at = |index: u32| low + (high - low) * index as f32 / 100_000.0;
        let error = |x: f32| {
            let exact = exact(f64::from(x));
            let place = f64::from(f32::EPSILON) * exact.abs().max(f64::from(f32::MIN_POSITIVE));
            (f64::from(found(x)) - exact).abs() / place
        };
        (0..=100_000).map(at).map(error).fold(0.0, f64::max)
    }

    #[test]
    fn functions_are_exact_to_a_few_units_of_the_last_place() {
        assert!(distance(exp, f64::exp, [-86.9, 87.9]) < 2.0);
        assert!(distance(exp_minus_1, f64::exp_m1, [-20.0, 20.0]) < 3.0);
        assert!(distance(tanh, f64::tanh, [-12.0, 12.0]) < 4.0);
        assert!(distance(tanh, f64::tanh, [-1e-3, 1e-3]) < 4.0);
        assert!(distance(softplus, |x| x.exp().ln_1p(), [-80.0, 80.0]) < 4.0);
    }

    #[test]
    fn bounds_hold_and_nan_stays_nan() {
        for function in [exp, exp_minus_1, tanh, logistic, softplus, Relu::value, Elu::value, Silu::value] {
            assert!(function(f32::NAN).is_nan());
        }
        assert!(exp(1e30).is_finite() && exp(f32::NEG_INFINITY) < 1e-37);
        assert_eq!([tanh(1e30), tanh(-1e30), tanh(0.0)], [1.0, -1.0, 0.0]);
        assert_eq!(softplus(1e30), 1e30);
    }
}

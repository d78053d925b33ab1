//! Elementary functions of eight numbers at once, to the bits that `libm` gives each of them.
//!
//! The methods, their coefficients and the order of every operation are those of FreeBSD's msun (Sun Microsystems, 1993), which `libm` follows,
//! too. Where one number takes one branch or another, lanes take all of them and select. Arguments for which msun has further branches
//! (zero, infinite, far apart, large) are reported, to be computed one by one.

use crate::scalar::Real;

/// atan(1/2), atan(1), atan(3/2) and pi/2, each with what the number leaves out.
const ATAN_OF_MIDDLES: [(f64, f64); 4] = [
    (f64::from_bits(0x3fdd_ac67_0561_bb4f), f64::from_bits(0x3c7a_2b7f_222f_65e2)),
    (f64::from_bits(0x3fe9_21fb_5444_2d18), f64::from_bits(0x3c81_a626_3314_5c07)),
    (f64::from_bits(0x3fef_730b_d281_f69b), f64::from_bits(0x3c70_0788_7af0_cbbd)),
    (f64::from_bits(0x3ff9_21fb_5444_2d18), f64::from_bits(0x3c91_a626_3314_5c07)),
];

/// Coefficients of 1 - atan(x)/x in powers of x².
const ATAN: [f64; 11] = [
    f64::from_bits(0x3fd5_5555_5555_550d),
    f64::from_bits(0xbfc9_9999_9998_ebc4),
    f64::from_bits(0x3fc2_4924_9200_83ff),
    f64::from_bits(0xbfbc_71c6_fe23_1671),
    f64::from_bits(0x3fb7_45cd_c54c_206e),
    f64::from_bits(0xbfb3_b0f2_af74_9a6d),
    f64::from_bits(0x3fb1_0d66_a0d0_3d51),
    f64::from_bits(0xbfad_de2d_52de_fd9a),
    f64::from_bits(0x3fa9_7b4b_2476_0deb),
    f64::from_bits(0xbfa2_b444_2c6a_6c2f),
    f64::from_bits(0x3f90_ad3a_e322_da11),
];

/// Coefficients of sin(x)/x - 1 and of cos(x) - 1 + x²/2 in powers of x².
const SIN: [f64; 6] = [
    f64::from_bits(0xbfc5_5555_5555_5549),
    f64::from_bits(0x3f81_1111_1110_f8a6),
    f64::from_bits(0xbf2a_01a0_19c1_61d5),
    f64::from_bits(0x3ec7_1de3_57b1_fe7d),
    f64::from_bits(0xbe5a_e5e6_8a2b_9ceb),
    f64::from_bits(0x3de5_d93a_5acf_d57c),
];
const COS: [f64; 6] = [
    f64::from_bits(0x3fa5_5555_5555_554c),
    f64::from_bits(0xbf56_c16c_16c1_5177),
    f64::from_bits(0x3efa_01a0_19cb_1590),
    f64::from_bits(0xbe92_7e4f_809c_52ad),
    f64::from_bits(0x3e21_ee9e_bdb4_b1c4),
    f64::from_bits(0xbda8_fae9_be88_38d4),
];

/// The first 33 bits of pi/2, and the rest of it.
const HALF_TURN: (f64, f64) = (f64::from_bits(0x3ff9_21fb_5440_0000), f64::from_bits(0x3dd0_b461_1a62_6331));

/// pi, and what the number leaves out.
const TURN: (f64, f64) = (f64::from_bits(0x4009_21fb_5444_2d18), f64::from_bits(0x3ca1_a626_3314_5c07));

// Closures would be compiled for the least of all processors, so there are none.

/// The first value where the first mask holds, else the second where the second does, and so on.
#[inline(always)]
fn pick<T: Real>(masks: &[T::Mask; 4], [a, b, c, d, e]: [T; 5]) -> T {
    T::select(masks[0], a, T::select(masks[1], b, T::select(masks[2], c, T::select(masks[3], d, e))))
}

/// The arc tangent of positive numbers up to 2⁶⁶.
#[inline(always)]
fn atan_of_positive<T: Real>(x: T) -> T {
    let (zero, one, two, and_half) = (T::splat(0.0), T::splat(1.0), T::splat(2.0), T::splat(1.5));
    let below = [x.less(T::splat(0.4375)), x.less(T::splat(0.6875)), x.less(T::splat(1.1875)), x.less(T::splat(2.4375))];
    let [b, c, d, e] = ATAN_OF_MIDDLES;
    let middle = pick(&below, [zero, T::splat(b.0), T::splat(c.0), T::splat(d.0), T::splat(e.0)]);
    let left_out = pick(&below, [zero, T::splat(b.1), T::splat(c.1), T::splat(d.1), T::splat(e.1)]);
    // atan(x) = atan(m) + atan((x - m) / (1 + m x)).
    let over = pick(&below, [x, two * x - one, x - one, x - and_half, -one]);
    let reduced = over / pick(&below, [one, two + x, x + one, one + and_half * x, x]);
    let a = ATAN;
    let z = reduced * reduced;
    let w = z * z;
    let mut odd = T::splat(a[10]);
    let mut even = T::splat(a[9]);
    for power in [8, 6, 4, 2] {
        odd = T::splat(a[power]) + w * odd;
    }
    for power in [7, 5, 3, 1] {
        even = T::splat(a[power]) + w * even;
    }
    let (odd, even) = (z * (T::splat(a[0]) + w * odd), w * even);
    middle - (reduced * (odd + even) - left_out - reduced)
}

/// Whether a positive number is between the bounds, far from overflow and underflow.
#[inline(always)]
fn is_ordinary<T: Real>(value: T, low: f64, high: f64) -> T::Mask {
    T::and(T::splat(low).less(value), value.less(T::splat(high)))
}

/// The angle of (`x`, `y`), and in which lanes it is that.
#[inline(always)]
pub(super) fn atan2<T: Real>(y: T, x: T) -> (T, T::Mask) {
    let zero = T::splat(0.0);
    let ratio = (y / x).abs();
    let ordinary = T::and(is_ordinary(x.abs(), 1e-100, 1e100), is_ordinary(y.abs(), 1e-100, 1e100));
    let ordinary = T::and(ordinary, is_ordinary(ratio, 1e-18, 1e18));
    let angle = atan_of_positive(ratio);
    let (turn, rest) = (T::splat(TURN.0), T::splat(TURN.1));
    let (down, left) = (y.less(zero), x.less(zero));
    let ahead = T::select(down, -angle, angle);
    let behind = T::select(down, (angle - rest) - turn, turn - (angle - rest));
    (T::select(left, behind, ahead), ordinary)
}

/// Whether the upper half of a positive number, which msun compares, is at most this.
#[inline(always)]
fn upper_is_at_most<T: Real>(value: T, upper: u64) -> T::Mask {
    value.less(T::splat(f64::from_bits((upper + 1) << 32)))
}

/// Sine and cosine of angles up to 3/4 pi but near pi/2, and in which lanes they are that.
#[inline(always)]
pub(super) fn sin_cos<T: Real>(angle: T) -> (T, T, T::Mask) {
    let (zero, one, half) = (T::splat(0.0), T::splat(1.0), T::splat(0.5));
    let size = angle.abs();
    let (near, far) = (upper_is_at_most(size, 0x3fe9_21fb), upper_is_at_most(size, 0x4002_d97c));
    let right_angle = T::and(T::not(upper_is_at_most(size, 0x3ff9_21fa)), upper_is_at_most(size, 0x3ff9_21fb));
    // Farther away an angle is taken from pi/2, in two parts.
    let (most, rest) = (T::splat(HALF_TURN.0), T::splat(HALF_TURN.1));
    let over = size - most;
    let turned = over - rest;
    let left_out = (over - turned) - rest;
    let (x, tail) = (T::select(near, size, turned), T::select(near, zero, left_out));

    let z = x * x;
    let w = z * z;
    let [s1, s2, s3, s4, s5, s6] = SIN;
    let r = T::splat(s2) + z * (T::splat(s3) + z * T::splat(s4)) + z * w * (T::splat(s5) + z * T::splat(s6));
    let (v, s1) = (z * x, T::splat(s1));
    let sine = T::select(near, x + v * (s1 + z * r), x - ((z * (half * tail - v * r) - tail) - v * s1));
    let [c1, c2, c3, c4, c5, c6] = COS;
    let r = z * (T::splat(c1) + z * (T::splat(c2) + z * T::splat(c3)));
    let r = r + w * w * (T::splat(c4) + z * (T::splat(c5) + z * T::splat(c6)));
    let bend = half * z;
    let w = one - bend;
    let cosine = w + (((one - w) - bend) + (z * r - x * tail));

    // sin(pi/2 + x) = cos(x), cos(pi/2 + x) = -sin(x).
    let (sine, cosine) = (T::select(near, sine, cosine), T::select(near, cosine, -sine));
    let sine = T::select(angle.less(zero), -sine, sine);
    // Of tiny angles, zero among them, the sine is the angle.
    let sine = T::select(size.less(T::splat(f64::from_bits(0x3e40_0000_0000_0000))), angle, sine);
    (sine, cosine, T::and(far, T::not(right_angle)))
}

#[cfg(test)]
mod tests {
    use super::super::{Lanes, WIDTH};
    use crate::scalar::Real;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    /// Numbers of every size, those that need care, and near neighbours of where branches meet.
    fn number() -> impl Strategy<Value = f64> {
        let edges = [0.4375, 0.6875, 1.1875, 2.4375, PI / 4.0, PI / 2.0, 0.75 * PI, PI, 1.25 * PI, 1.0, 7.450580596923828e-9];
        prop_oneof![
            4 => -4.0..4.0f64,
            1 => prop::num::f64::ANY,
            1 => prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MIN_POSITIVE, 1e300]),
            2 => (prop::sample::select(edges.to_vec()), -3i64..4, any::<bool>()).prop_map(|(edge, steps, minus)| {
                let near = f64::from_bits(edge.to_bits().wrapping_add_signed(steps));
                if minus { -near } else { near }
            }),
            1 => (prop::sample::select(edges.to_vec()), -1e-5..1e-5f64).prop_map(|(edge, by)| edge * (1.0 + by)),
        ]
    }

    fn lanes(values: &[f64]) -> Lanes {
        let mut lanes = Lanes::splat(0.0);
        (0..WIDTH).for_each(|lane| lanes.set_lane(lane, values[lane]));
        lanes
    }

    /// The bits, where all that is no number is the same.
    fn bits(value: f64) -> Option<u64> {
        (!value.is_nan()).then(|| value.to_bits())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn every_lane_has_the_bits_of_a_number_alone(
            first in prop::collection::vec(number(), WIDTH), second in prop::collection::vec(number(), WIDTH),
        ) {
            let angles = lanes(&first).atan2(lanes(&second));
            let (sines, cosines) = lanes(&first).sin_cos();
            for lane in 0..WIDTH {
                let (y, x) = (first[lane], second[lane]);
                prop_assert_eq!(bits(angles.lane(lane)), bits(libm::atan2(y, x)), "atan2({:e}, {:e})", y, x);
                let (sine, cosine) = libm::sincos(y);
                prop_assert_eq!(bits(sines.lane(lane)), bits(sine), "sin({:e})", y);
                prop_assert_eq!(bits(cosines.lane(lane)), bits(cosine), "cos({:e})", y);
            }
        }
    }
}

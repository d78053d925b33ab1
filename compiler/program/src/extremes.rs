//! The lesser and the greater of two numbers, with the same bits on every machine.
//!
//! `f64::min` and `f64::max` leave open which zero they give of two, and swallow what is no number; these do neither.

/// The lesser; the second where they are equal, also of two zeros. What is no number comes through.
#[inline]
pub fn minimum(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}

/// The greater; the second where they are equal, also of two zeros. What is no number comes through.
#[inline]
pub fn maximum(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// The number brought between `low` and `high`; itself where it lies there, or is no number.
#[inline]
pub fn between(x: f64, low: f64, high: f64) -> f64 {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_and_what_is_no_number_are_settled() {
        assert!(minimum(0.0, -0.0).is_sign_negative() && minimum(-0.0, 0.0).is_sign_positive());
        assert!(maximum(0.0, -0.0).is_sign_negative() && maximum(-0.0, 0.0).is_sign_positive());
        assert!([minimum, maximum].iter().all(|of| of(f64::NAN, 1.0).is_nan() && of(1.0, f64::NAN).is_nan()));
        assert!(between(f64::NAN, 0.0, 1.0).is_nan() && between(-0.0, 0.0, 1.0).is_sign_negative());
        assert_eq!([-1.0, 0.5, 2.0].map(|x| between(x, 0.0, 1.0)), [0.0, 0.5, 1.0]);
    }
}

//! The least cost along a search direction.
//!
//! The cost is convex and piecewise quadratic in the step length, so its slope is rising and piecewise linear. Newton's
//! method on the slope lands exactly on the root once no row changes its piece; a bracket around the root guards it. Sliding
//! contacts with elliptic cones add pieces that are not quadratic; there Newton's method converges as usual, and the bracket
//! is halved where it does not shrink by itself.

use crate::constraint::cone::Cone;
use crate::scalar::Real;

/// The cost along the direction: a quadratic part, the rows' clipped springs and the elliptic cones.
pub(super) struct Line<'a> {
    /// Slope of the quadratic part at zero.
    pub slope: f64,
    /// Its curvature.
    pub curvature: f64,
    /// J a - a_ref of all rows at zero.
    pub residual: &'a [f64],
    /// Its rate of change.
    pub rate: &'a [f64],
    /// Inverse regularisation of the rows.
    pub weight: &'a [f64],
    /// Least force of the rows.
    pub lower: &'a [f64],
    /// Largest force of the rows.
    pub upper: &'a [f64],
    /// Elliptic friction cones.
    pub cones: &'a [Cone],
}

impl Line<'_> {
    /// Slope and curvature of the cost at `step`.
    #[inline(always)]
    fn derivatives(&self, step: f64) -> [f64; 2] {
        let (mut slope, mut curvature) = (self.slope + step * self.curvature, self.curvature);
        let rows = self.residual.iter().zip(self.rate).zip(self.weight).zip(self.lower.iter().zip(self.upper));
        for (((residual, rate), weight), (lower, upper)) in rows {
            let free = -weight * (residual + step * rate);
            slope -= free.at_least(*lower).at_most(*upper) * rate;
            curvature += if free > *lower && free < *upper { weight * rate * rate } else { 0.0 };
        }
        for cone in self.cones {
            let [rise, bend] = cone.along(self.residual, self.rate, self.weight, step);
            slope += rise;
            curvature += bend;
        }
        [slope, curvature]
    }

    /// The step length where the slope is at most `tolerance` in size, after at most `iterations` evaluations; zero if the
    /// cost does not fall along the direction.
    #[inline(always)]
    pub fn minimize(&self, tolerance: f64, iterations: usize) -> f64 {
        let [mut slope, mut curvature] = self.derivatives(0.0);
        if slope >= 0.0 {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut step = 0.0;
        // The bracket's width two evaluations ago, to see whether it shrinks.
        let mut widths = [f64::INFINITY; 2];
        for _ in 0..iterations {
            let mut next = step - slope / curvature;
            let slow = !self.cones.is_empty() && high.is_finite() && high - low > 0.5 * widths[0];
            widths = [widths[1], high - low];
            if slow || next.is_nan() || next <= low || next >= high {
                next = 0.5 * (low + high.at_most(2.0 * low + 1.0));
            }
            if next == step {
                break;
            }
            step = next;
            [slope, curvature] = self.derivatives(step);
            if slope.abs() <= tolerance {
                break;
            }
            if slope < 0.0 {
                low = step;
            } else {
                high = step;
            }
        }
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_kink_crossing_minimum() {
        // (x - 3)² / 2 and a one-sided spring that pushes back from x = 1 on: x - 3 + 4 (x - 1) = 0.
        let line = Line {
            slope: -3.0,
            curvature: 1.0,
            residual: &[1.0],
            rate: &[-1.0],
            weight: &[4.0],
            lower: &[0.0],
            upper: &[f64::INFINITY],
            cones: &[],
        };
        assert!((line.minimize(1e-14, 50) - 7.0 / 5.0).abs() < 1e-14);
    }

    #[test]
    fn does_not_move_uphill() {
        let line = Line { slope: 1.0, curvature: 1.0, residual: &[], rate: &[], weight: &[], lower: &[], upper: &[], cones: &[] };
        assert_eq!(line.minimize(1e-14, 50), 0.0);
    }
}

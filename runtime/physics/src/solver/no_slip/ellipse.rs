//! The least value of a quadratic function in an ellipse.

use nalgebra::{SMatrix, SVector};

/// Largest number of directions of a contact's friction: two of sliding, one of turning, two of rolling.
pub(super) const MOST_FRICTIONS: usize = 5;

/// Ends Newton's method: a violation of the constraint in N², a step of the multiplier.
const TOLERANCE: f64 = 1e-10;
const ITERATIONS: usize = 20;

/// Minimises 1/2 v' A v + b' v over the first `count` numbers with sum (v / friction)² <= strength².
///
/// With x = v / friction the constraint is a ball, and on its surface (A + λ) x = -b, with the multiplier λ from Newton's method on
/// |x|² = strength². A matrix that is not positive has the minimum zero, as in MuJoCo.
pub(super) fn minimum_in_ellipse(
    matrix: &[[f64; MOST_FRICTIONS]; MOST_FRICTIONS],
    offset: &[f64; MOST_FRICTIONS],
    friction: &[f64; MOST_FRICTIONS],
    strength: f64,
    count: usize,
) -> [f64; MOST_FRICTIONS] {
    let within = |row: usize, column: usize| row < count && column < count;
    let scaled = SMatrix::<f64, MOST_FRICTIONS, MOST_FRICTIONS>::from_fn(|row, column| match within(row, column) {
        true => matrix[row][column] * friction[row] * friction[column],
        false => f64::from(u8::from(row == column)),
    });
    let pull = SVector::<f64, MOST_FRICTIONS>::from_fn(|row, _| if row < count { offset[row] * friction[row] } else { 0.0 });
    let mut multiplier = 0.0;
    let mut found = SVector::zeros();
    for _ in 0..ITERATIONS {
        let Some(factor) = (scaled + SMatrix::identity() * multiplier).cholesky() else { return [0.0; MOST_FRICTIONS] };
        found = -factor.solve(&pull);
        let excess = found.norm_squared() - strength * strength;
        if excess < TOLERANCE {
            break;
        }
        let step = excess / (2.0 * found.dot(&factor.solve(&found)));
        if step < TOLERANCE {
            break;
        }
        multiplier += step;
    }
    if multiplier != 0.0 {
        // On the surface, also where Newton's method has ended close to it.
        found *= strength / found.norm();
    }
    core::array::from_fn(|row| if row < count { found[row] * friction[row] } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In and on the ellipse, no point nearby is better.
    #[test]
    fn nothing_in_the_ellipse_is_better() {
        let matrix = [
            [2.0, 0.3, -0.1, 0.0, 0.2],
            [0.3, 1.0, 0.2, 0.1, 0.0],
            [-0.1, 0.2, 3.0, 0.4, 0.1],
            [0.0, 0.1, 0.4, 0.7, 0.0],
            [0.2, 0.0, 0.1, 0.0, 1.5],
        ];
        let (offset, friction) = ([3.0, -1.0, 0.5, 0.2, -0.4], [0.8, 0.8, 0.05, 0.01, 0.01]);
        for count in [1, 2, 3, 5] {
            for strength in [0.1, 2.0, 400.0] {
                let cost = |v: &[f64; 5]| -> f64 {
                    let row = |i: usize| (0..count).map(|j| matrix[i][j] * v[j]).sum::<f64>();
                    (0..count).map(|i| v[i] * (0.5 * row(i) + offset[i])).sum()
                };
                let size = |v: &[f64; 5]| (0..count).map(|i| (v[i] / friction[i]).powi(2)).sum::<f64>().sqrt();
                let best = minimum_in_ellipse(&matrix, &offset, &friction, strength, count);
                assert!(size(&best) <= strength * (1.0 + 1e-12), "{count} {strength}");
                for k in 0..200 {
                    let mut other: [f64; 5] =
                        core::array::from_fn(|i| best[i] + 0.1 * strength * friction[i] * libm::sin((17 * k + 5 * i) as f64));
                    let outside = size(&other) / strength;
                    if outside > 1.0 {
                        other = other.map(|value| value / outside);
                    }
                    assert!(cost(&other) >= cost(&best) - 1e-9 * cost(&best).abs(), "{count} {strength} {k}");
                }
            }
        }
    }
}

//! Curves over a cycle: cubic resampling, means with deviations, normalisation.

use msk_physics::scalar::Real;

/// Points of a cycle from 0 to 100 %.
pub const POINTS: usize = 101;

/// Resamples values at equal distances to `points` values at equal distances, the first and the last at the ends, by the cubic spline
/// that has a continuous third derivative at its second and last but one knot ("not a knot"; de Boor, "A Practical Guide to Splines",
/// chapter IV). Of three values the parabola, of two the line, of one the constant.
pub fn resample(values: &[f64], points: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let slopes = slopes(values);
    let at = |point: usize| {
        let place = if points > 1 { point as f64 * last as f64 / (points - 1) as f64 } else { 0.0 };
        let knot = (place.floor() as usize).min(last.saturating_sub(1));
        let part = place - knot as f64;
        match values.get(knot + 1) {
            None => values.get(knot).copied().unwrap_or(f64::NAN),
            Some(&next) => hermite([values[knot], next], [slopes[knot], slopes[knot + 1]], part),
        }
    };
    (0..points).map(at).collect()
}

/// The cubic between two knots of distance 1 with these values and slopes.
fn hermite([from, to]: [f64; 2], [first, second]: [f64; 2], part: f64) -> f64 {
    let rise = to - from;
    let (second_order, third_order) = (3.0 * rise - 2.0 * first - second, first + second - 2.0 * rise);
    from + part * (first + part * (second_order + part * third_order))
}

/// Slopes of the spline at its knots, which are 1 apart.
fn slopes(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let rise: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    match count {
        0 | 1 => return vec![0.0; count],
        2 => return vec![rise[0]; 2],
        // The parabola through three values.
        3 => return vec![1.5 * rise[0] - 0.5 * rise[1], 0.5 * (rise[0] + rise[1]), 1.5 * rise[1] - 0.5 * rise[0]],
        _ => {}
    }
    // Rows lower, diagonal, upper, right-hand side; equal knots give 1, 4, 1 inside and 1, 2 at the ends.
    let mut rows: Vec<[f64; 4]> = Vec::with_capacity(count);
    rows.push([0.0, 1.0, 2.0, 0.5 * (5.0 * rise[0] + rise[1])]);
    rows.extend(rise.windows(2).map(|pair| [1.0, 4.0, 1.0, 3.0 * (pair[0] + pair[1])]));
    rows.push([2.0, 1.0, 0.0, 0.5 * (5.0 * rise[count - 2] + rise[count - 3])]);
    for row in 1..count {
        let [_, diagonal, upper, right] = rows[row - 1];
        let factor = rows[row][0] / diagonal;
        rows[row][1] -= factor * upper;
        rows[row][3] -= factor * right;
    }
    let mut slopes = vec![0.0; count];
    for row in (0..count).rev() {
        let next = slopes.get(row + 1).copied().unwrap_or(0.0);
        slopes[row] = (rows[row][3] - rows[row][2] * next) / rows[row][1];
    }
    slopes
}

/// Mean and standard deviation (of the population) over curves of the same length, point by point; `None` without curves.
pub fn mean_and_deviation(curves: &[Vec<f64>]) -> Option<(Vec<f64>, Vec<f64>)> {
    let first = curves.first()?;
    let count = curves.len() as f64;
    let of = |point: usize| {
        let mean = curves.iter().map(|curve| curve[point]).sum::<f64>() / count;
        let squares: f64 = curves.iter().map(|curve| (curve[point] - mean) * (curve[point] - mean)).sum();
        (mean, (squares / count).sqrt())
    };
    Some((0..first.len()).map(of).unzip())
}

/// Smallest and largest value; `None` of a curve that is constant or has a value that is not finite.
pub fn range(curve: &[f64]) -> Option<[f64; 2]> {
    let [low, high] = curve.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &value| {
        [if value < low { value } else { low }, if value > high { value } else { high }]
    });
    (curve.iter().all(|value| value.is_finite()) && high - low > 1e-12).then_some([low, high])
}

/// The curve from 0 to 1: minus its smallest value, over its range.
pub fn normalized(curve: &[f64]) -> Option<Vec<f64>> {
    let [low, high] = range(curve)?;
    Some(curve.iter().map(|value| (value - low) / (high - low)).collect())
}

/// Pearson's correlation of two curves of the same length; `None` where one is constant.
pub fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let mean = |curve: &[f64]| curve.iter().sum::<f64>() / curve.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let sum = |f: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| f(a - mean_a, b - mean_b)).sum::<f64>();
    let (aa, bb, ab) = (sum(&|a, _| a * a), sum(&|_, b| b * b), sum(&|a, b| a * b));
    (aa > 1e-24 && bb > 1e-24).then(|| (ab / (aa * bb).sqrt()).clip(-1.0, 1.0))
}

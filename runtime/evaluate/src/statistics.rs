//! The few statistics that the results need.

use serde::{Deserialize, Serialize};

/// Mean and sample standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation with n - 1 in the denominator; `None` for a single value.
    pub deviation: Option<f64>,
}

impl Spread {
    /// Of `values`; `None` if there are none.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut moments = Moments::default();
        values.iter().for_each(|value| moments.add(*value));
        moments.spread()
    }
}

/// Mean and sum of squared distances from it of numbers that come one after the other, by Welford's recurrence (Technometrics 4, 1962):
/// none of them is kept.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Moments {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Adds a number.
    pub fn add(&mut self, value: f64) {
        self.count += 1.0;
        let before = value - self.mean;
        self.mean += before / self.count;
        self.squares += before * (value - self.mean);
    }

    /// Numbers so far.
    pub fn count(&self) -> u64 {
        // Counted up from 0 by 1.
        self.count as u64
    }

    /// Their mean; 0 without any.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Their variance, with n in the denominator; 0 without any.
    pub fn variance(&self) -> f64 {
        if self.count > 0.0 { self.squares / self.count } else { 0.0 }
    }

    /// Mean and sample standard deviation; `None` without numbers.
    pub fn spread(&self) -> Option<Spread> {
        let deviation = (self.count > 1.0).then(|| (self.squares / (self.count - 1.0)).sqrt());
        (self.count > 0.0).then_some(Spread { mean: self.mean, deviation })
    }
}

/// A quantile of sorted values, with linear interpolation between them as in NumPy; there must be some.
pub(crate) fn quantile(sorted: &[f64], part: f64) -> f64 {
    let place = part * (sorted.len() - 1) as f64;
    let below = place.floor();
    let (low, high) = (sorted[below as usize], sorted[(below as usize + 1).min(sorted.len() - 1)]);
    low + (place - below) * (high - low)
}

/// Wilson's score interval (1927) at 95 % for a proportion: [low, high] in 0..1. Unlike the normal approximation it is sound
/// for few trials and for proportions near 0 and 1. Without trials it is [0, 1].
pub fn wilson_interval(successes: u64, trials: u64) -> [f64; 2] {
    /// 97.5 % quantile of the standard normal distribution.
    const Z: f64 = 1.959_963_984_540_054;
    if trials == 0 {
        return [0.0, 1.0];
    }
    let n = trials as f64;
    let p = successes as f64 / n;
    let centre = p + Z * Z / (2.0 * n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + Z * Z / n;
    // At the ends the bounds are 0 and 1 exactly; rounding would miss them by a hair.
    let low = if successes == 0 { 0.0 } else { (centre - half) / scale };
    let high = if successes == trials { 1.0 } else { (centre + half) / scale };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: [f64; 2], expected: [f64; 2]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-5), "{found:?} is not {expected:?}");
    }

    #[test]
    fn the_interval_is_wilsons() {
        // Worked values: Newcombe 1998, Statistics in Medicine 17:857, table I, method 3.
        close(wilson_interval(81, 263), [0.2553, 0.3662]);
        close(wilson_interval(15, 148), [0.0624, 0.1605]);
        close(wilson_interval(0, 20), [0.0, 0.1611]);
        close(wilson_interval(1, 29), [0.0061, 0.1718]);
    }

    /// `tests/oracle/metrics.py`: `scipy.stats.binomtest(...).proportion_ci(0.95, method="wilson")`.
    #[test]
    fn the_interval_is_scipys_to_the_last_digits() {
        let all = [
            ((0, 30), [0.0, 0.113_513_393_173_968_75]),
            ((1, 50), [0.003_539_259_271_646_222, 0.104_954_435_896_378_14]),
            ((27, 30), [0.743_789_174_208_159_2, 0.965_400_111_252_665_7]),
            ((50, 50), [0.928_652_400_866_641_2, 1.0]),
        ];
        for ((successes, trials), expected) in all {
            let found = wilson_interval(successes, trials);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} is not {expected:?}");
        }
    }

    #[test]
    fn the_interval_stays_inside_and_is_widest_without_trials() {
        assert_eq!(wilson_interval(0, 0), [0.0, 1.0]);
        assert_eq!(wilson_interval(50, 50)[1], 1.0);
        assert_eq!(wilson_interval(0, 50)[0], 0.0);
    }

    #[test]
    fn spread_is_the_sample_standard_deviation() {
        assert_eq!(Spread::of(&[1.0, 2.0, 3.0]), Some(Spread { mean: 2.0, deviation: Some(1.0) }));
        assert_eq!(Spread::of(&[4.0]), Some(Spread { mean: 4.0, deviation: None }));
        assert_eq!(Spread::of(&[]), None);
    }
}

//! How closely a session follows the reference motion of its task.

use crate::statistics::quantile;
use crate::trace::{Quantity, Trace};
use serde::{Deserialize, Serialize};

/// Quantile of the errors of a reference episode above which an error is large.
const LARGE: f64 = 0.95;
/// Consecutive control steps with large errors that make a divergence.
const STEPS: usize = 5;

/// Tracking errors of an episode, with the times at which it had them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Errors {
    /// Times, s, rising.
    pub times: Vec<f64>,
    /// Root mean square distances of the landmarks from where the reference has them, m.
    pub errors: Vec<f64>,
}

/// A session compared with a policy that follows the same motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Name of the policy.
    pub policy: String,
    /// Control steps of the session when it was compared: with more it is another one.
    pub steps: u32,
    /// When the session diverged from the policy, s; none if it has not.
    pub diverged: Option<f64>,
}

/// Tracking errors summed up.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tracking {
    /// Root mean square over all steps, m.
    pub rmse: f64,
    /// At the last step, m.
    pub last: f64,
    /// The largest, m.
    pub largest: f64,
}

impl Errors {
    /// Of a trace; `None` if its task follows no motion, or it lacks these columns.
    pub fn of(trace: &Trace) -> Option<Self> {
        let errors = trace.column(Quantity::TrackingError, 0)?;
        let mut found = Self::default();
        trace.times().into_iter().zip(errors).for_each(|(time, error)| found.add(time, error));
        Some(found)
    }

    /// Adds the error at the next time; what is no number, where a task follows nothing, is left out.
    pub fn add(&mut self, time: f64, error: f64) {
        if error.is_finite() {
            self.times.push(time);
            self.errors.push(error);
        }
    }

    /// Summed up; `None` without any.
    pub fn summary(&self) -> Option<Tracking> {
        let last = *self.errors.last()?;
        let squares: f64 = self.errors.iter().map(|error| error * error).sum();
        let largest = self.errors.iter().copied().max_by(f64::total_cmp)?;
        Some(Tracking { rmse: (squares / self.errors.len() as f64).sqrt(), last, largest })
    }

    /// When the episode diverged from another that follows the same motion: the first time at which five consecutive errors were larger
    /// than the 0.95 quantile of the other's errors, and than the other's error at the same time, s.
    pub fn divergence(&self, reference: &Self) -> Option<f64> {
        let mut sorted = reference.errors.clone();
        sorted.sort_by(f64::total_cmp);
        if sorted.is_empty() {
            return None;
        }
        let large = quantile(&sorted, LARGE);
        let is_large = |(time, error): (&f64, &f64)| *error > large && *error > reference.at(*time);
        let flags: Vec<bool> = self.times.iter().zip(&self.errors).map(is_large).collect();
        let first = flags.windows(STEPS).position(|window| window.iter().all(|large| *large))?;
        self.times.get(first).copied()
    }

    /// The error at a time: linear between steps, the first and the last beyond them.
    fn at(&self, time: f64) -> f64 {
        let after = self.times.partition_point(|known| *known < time).min(self.errors.len() - 1);
        let before = after.saturating_sub(1);
        let (start, end) = (self.times[before], self.times[after]);
        if end <= start || time >= end {
            return self.errors[after];
        }
        self.errors[before] + (time - start) / (end - start) * (self.errors[after] - self.errors[before])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(values: &[f64]) -> Errors {
        Errors { times: (0..values.len()).map(|step| step as f64 * 0.1).collect(), errors: values.to_vec() }
    }

    #[test]
    fn errors_are_summed_up() {
        assert_eq!(errors(&[3.0, 4.0, 0.0]).summary(), Some(Tracking { rmse: (25.0_f64 / 3.0).sqrt(), last: 0.0, largest: 4.0 }));
        assert_eq!(Errors::default().summary(), None);
    }

    #[test]
    fn times_without_a_reference_are_left_out() {
        let mut found = Errors::default();
        [(0.0, 1.0), (0.1, f64::NAN), (0.2, 3.0)].into_iter().for_each(|(time, error)| found.add(time, error));
        assert_eq!((found.times.as_slice(), found.errors.as_slice()), (&[0.0, 0.2][..], &[1.0, 3.0][..]));
    }

    #[test]
    fn five_large_errors_in_a_row_are_a_divergence() {
        let reference = errors(&[0.1; 20]);
        let mut values = [0.05; 20];
        values[3..7].fill(0.2);
        assert_eq!(errors(&values).divergence(&reference), None, "four are not enough");
        values[9..14].fill(0.2);
        assert!((errors(&values).divergence(&reference).unwrap() - 0.9).abs() < 1e-12);
        // Larger than most of the reference's errors, and not larger than its errors at that time.
        let mut late = [0.1; 200];
        late[196..].fill(1.0);
        let mut found = [0.05; 200];
        found[195..].fill(0.5);
        assert_eq!(errors(&found).divergence(&errors(&late)), None);
        assert_eq!(errors(&values).divergence(&Errors::default()), None);
    }

    #[test]
    fn the_reference_is_interpolated_and_held() {
        let reference = errors(&[0.0, 1.0, 3.0]);
        for (time, expected) in [(-1.0, 0.0), (0.0, 0.0), (0.05, 0.5), (0.1, 1.0), (0.15, 2.0), (0.2, 3.0), (9.0, 3.0)] {
            assert!((reference.at(time) - expected).abs() < 1e-12, "{time}");
        }
    }
}

//! Running means and deviations of what a network sees.

use serde::{Deserialize, Serialize};

/// Added to a variance before its root is taken: what never changes is divided by 1e-4 and not by 0.
const EPSILON: f64 = 1e-8;

/// Mean and variance of numbers that come batch by batch (Chan, Golub and LeVeque 1983).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    /// How many numbers have come.
    pub count: f64,
    /// Their mean.
    pub mean: f64,
    /// Sum of the squares of their distances from the mean.
    pub squares: f64,
}

impl Moments {
    /// Takes a number in.
    pub fn add(&mut self, value: f64) {
        self.count += 1.0;
        let distance = value - self.mean;
        self.mean += distance / self.count;
        self.squares += distance * (value - self.mean);
    }

    /// Those of a mean and a [deviation](Self::deviation), as if so many numbers had come.
    pub fn of(mean: f64, deviation: f64, count: f64) -> Self {
        let variance = deviation * deviation - EPSILON;
        Self { count, mean, squares: if variance > 0.0 { variance * count } else { 0.0 } }
    }

    /// The variance of what has come; 1 before anything has.
    pub fn variance(&self) -> f64 {
        if self.count > 0.0 { self.squares / self.count } else { 1.0 }
    }

    /// The root of the variance, never 0.
    pub fn deviation(&self) -> f64 {
        (self.variance() + EPSILON).sqrt()
    }
}

/// `clip((x - mean) / std, -clip, clip)` for each entry of a row, with moments that are taken over all rows seen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Normaliser {
    moments: Vec<Moments>,
    clip: f64,
}

impl Normaliser {
    /// For rows of so many entries, none of which has been seen: it changes nothing but what lies beyond `clip`.
    pub fn new(width: usize, clip: f64) -> Self {
        Self { moments: vec![Moments::default(); width], clip }
    }

    /// Entries of a row.
    pub fn width(&self) -> usize {
        self.moments.len()
    }

    /// The bound of what it gives.
    pub fn clip(&self) -> f64 {
        self.clip
    }

    /// The moments, entry by entry.
    pub fn moments(&self) -> &[Moments] {
        &self.moments
    }

    /// Takes rows in, one after the other.
    pub fn update(&mut self, rows: &[f64]) {
        for row in rows.chunks_exact(self.moments.len().max(1)) {
            self.moments.iter_mut().zip(row).for_each(|(moments, value)| moments.add(*value));
        }
    }

    /// Takes in the first entries of a row alone.
    pub fn update_first(&mut self, entries: &[f32]) {
        self.moments.iter_mut().zip(entries).for_each(|(moments, value)| moments.add(f64::from(*value)));
    }

    /// Replaces the moments of the first entries.
    pub fn begin_with(&mut self, moments: impl IntoIterator<Item = Moments>) {
        self.moments.iter_mut().zip(moments).for_each(|(own, moments)| *own = moments);
    }

    /// Writes normalised rows.
    pub fn apply(&self, rows: &[f64], out: &mut [f32]) {
        self.apply_first(self.moments.len(), rows, out);
    }

    /// Writes normalised rows that have the first `width` entries alone.
    pub fn apply_first(&self, width: usize, rows: &[f64], out: &mut [f32]) {
        let width = width.max(1);
        for (row, out) in rows.chunks_exact(width).zip(out.chunks_exact_mut(width)) {
            for ((value, moments), out) in row.iter().zip(&self.moments).zip(out) {
                let scaled = (value - moments.mean) / moments.deviation();
                let low = if scaled < -self.clip { -self.clip } else { scaled };
                *out = (if low > self.clip { self.clip } else { low }) as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_get_mean_0_and_deviation_1() {
        let rows: Vec<f64> = (0..2000).map(|index| f64::from(index % 7) * if index % 2 == 0 { 1.0 } else { 1e3 } + 5.0).collect();
        let mut normaliser = Normaliser::new(2, 10.0);
        normaliser.update(&rows);
        let mut out = vec![0.0; rows.len()];
        normaliser.apply(&rows, &mut out);
        for entry in 0..2 {
            let of_entry: Vec<f64> = out.iter().skip(entry).step_by(2).map(|value| f64::from(*value)).collect();
            let mean = of_entry.iter().sum::<f64>() / 1000.0;
            let square = of_entry.iter().map(|value| value * value).sum::<f64>() / 1000.0;
            assert!(mean.abs() < 1e-5 && (square - 1.0).abs() < 1e-5, "{mean} {square}");
        }
    }

    #[test]
    fn before_anything_was_seen_it_only_clips() {
        let mut out = [0.0; 3];
        Normaliser::new(3, 10.0).apply(&[0.5, -100.0, 1e300], &mut out);
        assert_eq!(out, [0.5, -10.0, 10.0]);
    }

    #[test]
    fn what_never_changes_stays_finite() {
        let mut normaliser = Normaliser::new(1, 10.0);
        normaliser.update(&[3.0; 10]);
        let mut out = [1.0];
        normaliser.apply(&[3.0], &mut out);
        assert_eq!(out, [0.0]);
    }
}

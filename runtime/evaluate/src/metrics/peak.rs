//! Peak-efficiency steps: the least number of environment steps at which the mean return of a training is largest.
//!
//! T_max = min argmax_T R(T), where R(T) is the mean over all rows with T steps: of several seeds, several at once. Rows without a
//! finite number of steps that is not negative, or without a finite return, do not count.

use std::collections::BTreeMap;

/// Steps and mean return of the peak; `None` without a row that counts.
pub fn peak(rows: impl IntoIterator<Item = (f64, f64)>) -> Option<(f64, f64)> {
    let mut sums: BTreeMap<u64, (f64, f64)> = BTreeMap::new();
    for (steps, total) in rows {
        if steps.is_finite() && steps >= 0.0 && total.is_finite() {
            // Numbers that are not negative are in the order of their bits; -0 is 0.
            let entry = sums.entry((steps + 0.0).to_bits()).or_default();
            *entry = (entry.0 + total, entry.1 + 1.0);
        }
    }
    let means = sums.into_iter().map(|(steps, (sum, count))| (f64::from_bits(steps), sum / count));
    means.fold(None, |best, (steps, mean)| match best {
        Some((_, largest)) if mean <= largest => best,
        _ => Some((steps, mean)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_peaks_counts_and_seeds_are_averaged() {
        assert_eq!(peak([(0.0, 1.0), (100.0, 5.0), (200.0, 5.0), (300.0, 4.0)]), Some((100.0, 5.0)));
        // The seeds at 200 are 9 and 2, 5.5 on average, those at 100 are 6 and 6.
        assert_eq!(peak([(200.0, 9.0), (100.0, 6.0), (200.0, 2.0), (100.0, 6.0)]), Some((100.0, 6.0)));
        assert_eq!(peak([(f64::NAN, 1.0), (-1.0, 9.0), (5.0, f64::INFINITY)]), None);
        assert_eq!(peak([(-0.0, 1.0), (0.0, 3.0)]), Some((0.0, 2.0)));
    }
}

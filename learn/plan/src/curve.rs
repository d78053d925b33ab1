//! Curves over time through knots: what a plan asks for at each moment of its horizon.

use crate::settings::Interpolation;
use core::ops::Range;
use msk_physics::scalar::Real;

/// Knots at equal distances in time, each with one value in [-1, 1] for every entry of an action. They reach over the horizon, and stay
/// where they are while it moves on, so that what is left of a plan keeps its values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    /// Knot after knot.
    pub values: Vec<f64>,
    /// Entries of an action.
    pub width: usize,
    pub interpolation: Interpolation,
    /// Where the present is, in distances of knots after the first one: from 0 to 1.
    pub now: f64,
}

impl Curve {
    /// The same value everywhere.
    pub fn constant(value: f64, knots: usize, width: usize, interpolation: Interpolation) -> Self {
        Self { values: vec![value; knots * width], width, interpolation, now: 0.0 }
    }

    /// Gives each of these entries one value at all knots.
    pub fn hold(&mut self, entries: Range<usize>, mut value: impl FnMut() -> f64) {
        for entry in entries {
            let value = value();
            self.values.iter_mut().skip(entry).step_by(self.width.max(1)).for_each(|kept| *kept = value);
        }
    }

    /// The same curve, with `rest` in these entries at all knots.
    pub fn without(&self, entries: Range<usize>, rest: f64) -> Self {
        let mut without = self.clone();
        without.hold(entries, || rest);
        without
    }

    /// Mean distance of these entries from `rest`.
    pub fn mean_distance(&self, entries: Range<usize>, rest: f64) -> f64 {
        let distances = self.values.chunks(self.width.max(1)).flat_map(|knot| knot.get(entries.clone()).unwrap_or_default());
        let (count, sum) = distances.fold((0_u32, 0.0), |(count, sum), value| (count + 1, sum + (value - rest).abs()));
        sum / f64::from(count.max(1))
    }

    /// Mean square of the distance of its values from `rest`.
    pub fn mean_square(&self, rest: f64) -> f64 {
        self.values.iter().map(|value| (value - rest) * (value - rest)).sum::<f64>() / self.values.len().max(1) as f64
    }

    /// The same curve, which returns to `rest` by its end.
    pub fn fading(&self, rest: f64) -> Self {
        let last = self.knots().saturating_sub(1).max(1) as f64;
        let faded = self.values.iter().enumerate().map(|(place, value)| {
            let left = 1.0 - (place / self.width.max(1)) as f64 / last;
            rest + left * (value - rest)
        });
        Self { values: faded.collect(), ..self.clone() }
    }

    /// Number of knots.
    pub fn knots(&self) -> usize {
        self.values.len().checked_div(self.width).unwrap_or(0)
    }

    /// Distances of knots in the horizon: the last one is beyond it unless the present is at the first.
    fn distances(&self) -> f64 {
        self.knots().saturating_sub(2).max(1) as f64
    }

    /// Writes the values at `share` of the horizon, from 0 to 1; those after the last knot are its own.
    pub fn at(&self, share: f64, entries: &mut [f64]) {
        let last = self.knots().saturating_sub(1);
        let place = (self.now + share.at_least(0.0) * self.distances()).at_most(last as f64);
        // The place lies between 0 and the number of knots.
        let before = (place.floor() as usize).min(last.saturating_sub(1));
        let part = place - before as f64;
        let knot = |index: usize| &self.values[index.min(last) * self.width..][..self.width];
        let [a, b] = [knot(before), knot(before + 1)];
        match self.interpolation {
            Interpolation::Linear => {
                entries.iter_mut().zip(a.iter().zip(b)).for_each(|(entry, (a, b))| *entry = a + part * (b - a));
            }
            // Catmull and Rom: the slope at a knot is that between its neighbours.
            Interpolation::Cubic => {
                let [first, second] = [knot(before.saturating_sub(1)), knot(before + 2)];
                let (square, cube) = (part * part, part * part * part);
                for (index, entry) in entries.iter_mut().enumerate() {
                    let (a, b) = (a[index], b[index]);
                    let slopes = [0.5 * (b - first[index]), 0.5 * (second[index] - a)];
                    let value = (2.0 * cube - 3.0 * square + 1.0) * a + (3.0 * square - 2.0 * cube) * b;
                    let bend = (cube - 2.0 * square + part) * slopes[0] + (cube - square) * slopes[1];
                    *entry = (value + bend).clip(-1.0, 1.0);
                }
            }
        }
    }

    /// Goes on by `share` of the horizon: knots that have passed are dropped, the last one is repeated, closer to `rest` by the
    /// factor `decay`.
    pub fn advance(&mut self, share: f64, rest: f64, decay: f64) {
        self.now += share * self.distances();
        // A share beyond all knots leaves nothing of them.
        for _ in 0..self.knots() {
            if self.now < 1.0 || self.knots() < 2 {
                break;
            }
            self.now -= 1.0;
            self.values.rotate_left(self.width);
            let kept = self.values.len() - self.width;
            let (before, last) = self.values.split_at_mut(kept);
            let held = &before[kept - self.width..];
            last.iter_mut().zip(held).for_each(|(last, held)| *last = rest + decay * (held - rest));
        }
        self.now = self.now.clip(0.0, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(interpolation: Interpolation) -> Curve {
        Curve { values: vec![0.0, 1.0, 0.3, 0.7, 0.6, 0.4, 0.9, 0.1], width: 2, interpolation, now: 0.0 }
    }

    fn close(found: &[f64], expected: &[f64]) -> bool {
        found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn a_curve_goes_through_its_knots_and_a_line_stays_one() {
        for interpolation in [Interpolation::Linear, Interpolation::Cubic] {
            let curve = line(interpolation);
            let mut found = [0.0; 2];
            for (index, knot) in curve.values.chunks(2).enumerate() {
                curve.at(index as f64 / 2.0, &mut found);
                assert!(found.iter().zip(knot).all(|(found, knot)| (found - knot).abs() < 1e-12), "{found:?} {knot:?}");
            }
            curve.at(0.75, &mut found);
            assert!((found[0] - 0.45).abs() < 1e-12 && (found[1] - 0.55).abs() < 1e-12, "{found:?}");
            curve.at(7.0, &mut found);
            assert!(close(&found, &[0.9, 0.1]), "{found:?}");
        }
    }

    #[test]
    fn what_is_left_of_a_curve_keeps_its_values() {
        let curve = line(Interpolation::Linear);
        for share in [0.2, 0.5, 0.6, 1.1] {
            let mut left = curve.clone();
            left.advance(share, 0.0, 1.0);
            let [mut now, mut before] = [[0.0; 2]; 2];
            for further in [0.0, 0.15, 0.3, 0.7, 1.0] {
                left.at(further, &mut now);
                curve.at(share + further, &mut before);
                assert!(now.iter().zip(before).all(|(now, before)| (now - before).abs() < 1e-12), "{share} + {further}");
            }
        }
    }

    #[test]
    fn what_comes_after_a_curve_goes_to_rest() {
        let mut curve = line(Interpolation::Linear);
        curve.advance(0.5, 0.2, 0.5);
        assert!(close(&curve.values, &[0.3, 0.7, 0.6, 0.4, 0.9, 0.1, 0.55, 0.15]), "{:?}", curve.values);
        curve.advance(1e9, 0.2, 0.0);
        assert_eq!(curve.values, [0.2; 8]);
    }

    #[test]
    fn some_entries_are_brought_to_rest_and_measured_from_there() {
        let curve = line(Interpolation::Linear);
        assert!((curve.mean_distance(1..2, 0.5) - 0.3).abs() < 1e-12);
        let without = curve.without(1..2, 0.5);
        assert_eq!(without.values, [0.0, 0.5, 0.3, 0.5, 0.6, 0.5, 0.9, 0.5]);
        assert_eq!([without.mean_distance(1..2, 0.5), curve.mean_distance(2..2, 0.5)], [0.0; 2]);
    }

    #[test]
    fn one_knot_is_held() {
        let mut curve = Curve::constant(0.4, 1, 3, Interpolation::Cubic);
        let mut found = [0.0; 3];
        curve.at(0.7, &mut found);
        assert_eq!(found, [0.4; 3]);
        curve.advance(0.5, 0.0, 1.0);
        curve.at(0.7, &mut found);
        assert_eq!(found, [0.4; 3]);
    }
}

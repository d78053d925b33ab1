//! Curves over time through knots: what a plan asks for at each moment of its horizon.

use crate::settings::Interpolation;
use msk_physics::scalar::Real;

/// Knots at equal distances from now to the end of the horizon, each with one value in [-1, 1] for every entry of an action.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    /// Knot after knot.
    pub values: Vec<f64>,
    /// Entries of an action.
    pub width: usize,
    pub interpolation: Interpolation,
}

impl Curve {
    /// The same value everywhere.
    pub fn constant(value: f64, knots: usize, width: usize, interpolation: Interpolation) -> Self {
        Self { values: vec![value; knots * width], width, interpolation }
    }

    /// Number of knots.
    pub fn knots(&self) -> usize {
        self.values.len().checked_div(self.width).unwrap_or(0)
    }

    /// Writes the values at `share` of the horizon, from 0 to 1; later ones are those of the end.
    pub fn at(&self, share: f64, entries: &mut [f64]) {
        let last = self.knots().saturating_sub(1);
        let place = share.clip(0.0, 1.0) * last as f64;
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

    /// The rest of the curve after `share` of the horizon, its end held; every value comes closer to `rest` by the factor `decay`.
    pub fn shifted(&self, share: f64, rest: f64, decay: f64) -> Self {
        let mut shifted = self.clone();
        let last = self.knots().saturating_sub(1).max(1) as f64;
        for (index, knot) in shifted.values.chunks_mut(self.width.max(1)).enumerate() {
            self.at(index as f64 / last + share, knot);
            knot.iter_mut().for_each(|value| *value = rest + decay * (*value - rest));
        }
        shifted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(interpolation: Interpolation) -> Curve {
        Curve { values: vec![0.0, 1.0, 0.3, 0.7, 0.6, 0.4, 0.9, 0.1], width: 2, interpolation }
    }

    #[test]
    fn a_curve_goes_through_its_knots_and_a_line_stays_one() {
        for interpolation in [Interpolation::Linear, Interpolation::Cubic] {
            let curve = line(interpolation);
            let mut found = [0.0; 2];
            for (index, knot) in curve.values.chunks(2).enumerate() {
                curve.at(index as f64 / 3.0, &mut found);
                assert!(found.iter().zip(knot).all(|(found, knot)| (found - knot).abs() < 1e-12), "{found:?} {knot:?}");
            }
            curve.at(0.5, &mut found);
            assert!((found[0] - 0.45).abs() < 1e-12 && (found[1] - 0.55).abs() < 1e-12, "{found:?}");
            curve.at(7.0, &mut found);
            assert_eq!(found, [0.9, 0.1]);
        }
    }

    #[test]
    fn what_is_left_of_a_curve_has_its_values() {
        let curve = line(Interpolation::Linear);
        let shifted = curve.shifted(0.2, 0.0, 1.0);
        let [mut now, mut before] = [[0.0; 2]; 2];
        for knot in 0..4 {
            let share = f64::from(knot) / 3.0;
            shifted.at(share, &mut now);
            curve.at(share + 0.2, &mut before);
            assert!(now.iter().zip(before).all(|(now, before)| (now - before).abs() < 1e-12));
        }
        assert_eq!(curve.shifted(0.0, 0.5, 0.0).values, vec![0.5; 8]);
    }

    #[test]
    fn one_knot_is_held() {
        let curve = Curve::constant(0.4, 1, 3, Interpolation::Cubic);
        let mut found = [0.0; 3];
        curve.at(0.7, &mut found);
        assert_eq!(found, [0.4; 3]);
        assert_eq!(curve.shifted(0.5, 0.0, 1.0), curve);
    }
}

//! The two steps of an improvement of the policy: E weighs samples of actions, M fits the policy to them.

use msk_network::{Tape, Variable};

/// Samples of actions for each row, with what the target critic says of them.
pub(super) struct Samples {
    /// Sample after sample of a row, row after row.
    pub actions: Vec<f32>,
    pub values: Vec<f32>,
    /// Mean and deviation of the target policy, row by row.
    pub mean: Vec<f32>,
    pub std: Vec<f32>,
}

/// Step M: minus the weighted likelihood of the samples, where mean and deviation are fitted one with the other of the target policy, and
/// the divergences from it, entry by entry, times the duals of their bounds (equation 8 of arXiv 1812.02256). Of the samples only mean and
/// spread count.
pub(super) fn objective(
    tape: &mut Tape,
    [mean, std]: [Variable; 2],
    samples: &Samples,
    fit: &Fit,
    bounds: &[Vec<f32>; 2],
) -> (Variable, [Variable; 2]) {
    let [rows, entries] = tape.size(mean);
    let precision = tape.constant(rows, entries, samples.std.iter().map(|std| 1.0 / std));
    // Half the squared distance of the mean, in old deviations.
    let distance = |tape: &mut Tape, from: &[f32]| {
        let from = tape.constant(rows, entries, from.iter().copied());
        let difference = tape.subtract(mean, from);
        let unit = tape.multiply(difference, precision);
        let square = tape.square(unit);
        tape.affine(square, 0.5, 0.0)
    };
    let (fits, moved) = (distance(tape, &fit.mean), distance(tape, &samples.mean));
    let logarithm = tape.ln(std);
    let narrow = tape.affine(logarithm, -2.0, 0.0);
    let inverse = tape.exp(narrow);
    let spread = tape.constant(rows, entries, fit.spread.iter().map(|spread| 0.5 * spread));
    let spread = tape.multiply(spread, inverse);
    // The weights of a row sum up to 2.
    let likely = tape.affine(logarithm, 2.0, 0.0);
    let likely = tape.add(likely, spread);
    // The divergence of deviations: ln(new / old) + old^2 / (2 new^2) - 1 / 2.
    let variance = tape.constant(rows, entries, samples.std.iter().map(|std| 0.5 * std * std));
    let ratio = tape.multiply(variance, inverse);
    let old = tape.constant(rows, entries, samples.std.iter().map(|std| libm::logf(*std) + 0.5));
    let widened = tape.subtract(logarithm, old);
    let widened = tape.add(widened, ratio);
    let fits = tape.affine(fits, 2.0, 0.0);
    let mut loss = tape.add(fits, likely);
    for (divergence, bound) in [moved, widened].into_iter().zip(bounds) {
        let weight = tape.constant(rows, entries, (0..rows).flat_map(|_| bound.iter().copied()));
        let part = tape.multiply(divergence, weight);
        loss = tape.add(loss, part);
    }
    let loss = tape.sum_columns(loss);
    (tape.mean(loss), [moved, widened])
}

/// Minus how far an action lies out of bounds.
pub(super) fn cost(action: &[f32]) -> f32 {
    let beyond = action.iter().map(|entry| if entry.abs() > 1.0 { entry.abs() - 1.0 } else { 0.0 });
    -beyond.map(|distance| distance * distance).sum::<f32>().sqrt()
}

/// Step E: weights exp(q / eta) of the samples of each state, which sum up to 1, and the derivative of the dual
/// eta (epsilon + E ln mean exp(q / eta)) with respect to the temperature eta (equation 9 of arXiv 1806.06920).
pub(super) fn weights(values: &[f32], samples: usize, temperature: f32, epsilon: f64) -> (Vec<f64>, f32) {
    let eta = f64::from(temperature);
    let (mut weights, mut slope) = (Vec::with_capacity(values.len()), 0.0);
    for values in values.chunks_exact(samples) {
        let scaled = || values.iter().map(|value| f64::from(*value) / eta);
        let most = scaled().fold(f64::NEG_INFINITY, |most, value| if value > most { value } else { most });
        let sum: f64 = scaled().map(|value| libm::exp(value - most)).sum();
        let begin = weights.len();
        weights.extend(scaled().map(|value| libm::exp(value - most) / sum));
        let mean: f64 = weights[begin..].iter().zip(scaled()).map(|(weight, value)| weight * value).sum();
        slope += most + libm::log(sum / samples as f64) - mean;
    }
    let states = (values.len() / samples.max(1)).max(1) as f64;
    (weights, (epsilon + slope / states) as f32)
}

/// What weighted samples ask for, row by row: the sum of the weights of a row is 2.
pub(super) struct Fit {
    pub mean: Vec<f32>,
    /// Sum of weight times square of the distance from the mean of the target policy.
    pub spread: Vec<f32>,
}

impl Fit {
    pub fn of(samples: &Samples, weights: &[f64], [entries, count]: [usize; 2]) -> Self {
        let (mut mean, mut spread) = (Vec::new(), Vec::new());
        let rows = samples.actions.chunks_exact(entries * count).zip(weights.chunks_exact(count));
        for ((actions, weights), old) in rows.zip(samples.mean.chunks_exact(entries)) {
            for (entry, old) in old.iter().enumerate() {
                let of = || actions.iter().skip(entry).step_by(entries).zip(weights);
                mean.push(of().map(|(action, weight)| 0.5 * weight * f64::from(*action)).sum::<f64>() as f32);
                let distance = |action: f32| f64::from(action) - f64::from(*old);
                let square = |(action, weight): (&f32, &f64)| weight * distance(*action) * distance(*action);
                spread.push(of().map(square).sum::<f64>() as f32);
            }
        }
        Self { mean, spread }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use msk_network::Parameters;
    use std::sync::Arc;

    #[test]
    fn the_derivative_of_the_temperature_is_that_of_its_dual() {
        let values: Vec<f32> = (0..12).map(|index| libm::sinf(index as f32 * 1.7) * 3.0).collect();
        let dual = |eta: f64| {
            let per_state = values.chunks_exact(4).map(|values| {
                let mean = values.iter().map(|value| libm::exp(f64::from(*value) / eta)).sum::<f64>() / 4.0;
                libm::log(mean)
            });
            eta * (0.1 + per_state.sum::<f64>() / 3.0)
        };
        let (weights, slope) = weights(&values, 4, 1.3, 0.1);
        let eta = f64::from(1.3_f32);
        let expected = (dual(eta + 1e-5) - dual(eta - 1e-5)) / 2e-5;
        assert!((f64::from(slope) - expected).abs() < 1e-6, "{slope}, expected {expected}");
        assert!(weights.chunks_exact(4).all(|weights| (weights.iter().sum::<f64>() - 1.0).abs() < 1e-12));
    }

    /// Numbers that `tests/oracle/mpo.py` has, too.
    fn filled(count: usize, salt: usize, scale: f64, shift: f64) -> Vec<f32> {
        let number = |index: usize| ((index * 7919 + salt * 104_729) % 10007) as f64 / 10007.0 - 0.5;
        (0..count).map(|index| (scale * number(index) + shift) as f32).collect()
    }

    #[test]
    fn the_step_m_is_that_of_pytorch_over_all_samples() {
        let golden: serde_json::Value = serde_json::from_str(include_str!("../../tests/golden/mpo.json")).unwrap();
        let (rows, entries, count) = (4, 3, 5);
        let size = rows * entries;
        let samples = Samples {
            actions: filled(size * count, 5, 3.0, 0.0),
            values: filled(rows * count, 6, 4.0, 0.0),
            mean: filled(size, 3, 1.6, 0.0),
            std: filled(size, 4, 0.8, 0.6),
        };
        let costs: Vec<f32> = samples.actions.chunks_exact(entries).map(cost).collect();
        let parts = [weights(&samples.values, count, 0.7, 0.1).0, weights(&costs, count, 1.5, 0.1).0];
        let counts: Vec<f64> = parts[0].iter().zip(&parts[1]).map(|(a, b)| a + b).collect();
        let fit = Fit::of(&samples, &counts, [entries, count]);
        let mut tape = Tape::new(Arc::new(msk_network::Processor::new(std::num::NonZeroUsize::MIN).unwrap()));
        let mean = tape.watched(rows, entries, filled(size, 1, 1.6, 0.0));
        let std = tape.watched(rows, entries, filled(size, 2, 0.8, 0.6));
        let bounds = [filled(entries, 7, 1.0, 1.0), filled(entries, 8, 1.0, 5.0)];
        let (loss, divergences) = objective(&mut tape, [mean, std], &samples, &fit, &bounds);
        tape.backward(loss, &Parameters::default(), &mut []);
        let agree = |name: &str, found: &[f32], expected: &serde_json::Value| {
            let expected: Vec<f64> = expected.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
            let largest = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                assert!((f64::from(*found) - expected).abs() < 1e-5 * largest, "{name}: {found}, expected {expected}");
            }
        };
        agree("derivatives of means", tape.slopes(mean), &golden["mean"]);
        agree("derivatives of deviations", tape.slopes(std), &golden["std"]);
        for (place, divergence) in divergences.into_iter().enumerate() {
            let values = tape.values(divergence);
            let of = |entry: usize| values.iter().skip(entry).step_by(entries).sum::<f32>() / rows as f32;
            let means: Vec<f32> = (0..entries).map(of).collect();
            agree("divergences", &means, &golden["divergences"][place]);
        }
    }

    #[test]
    fn what_lies_out_of_bounds_costs() {
        assert_eq!(cost(&[0.5, -1.0]), 0.0);
        assert_eq!(cost(&[4.0, -5.0]), -5.0);
    }
}

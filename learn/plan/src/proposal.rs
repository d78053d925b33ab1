//! Proposals: other plans around the present one.
//!
//! Noise of one size on all entries finds either large changes of little or small changes of everything. Here sizes go round a ladder,
//! and every other proposal changes a random part of the entries only. Noise is coloured in time: neighbouring knots move together.

use crate::curve::Curve;
use msk_physics::scalar::Real;
use msk_runtime::episode::Stream;

/// Sizes that proposals take in turn, in shares of the deviation.
const LADDER: [f64; 4] = [1.0, 0.5, 1.6, 0.25];

/// How proposals are drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    /// Correlation of neighbouring knots, 0 to 1.
    pub colour: f64,
    /// The chance of each entry to be changed where not all are.
    pub part: f64,
}

impl Noise {
    /// The plan number `index` of a round around `mean`, with a standard deviation for each of its values.
    pub fn propose(&self, index: usize, mean: &Curve, deviation: &[f64], stream: &mut Stream) -> Curve {
        let mut proposal = mean.clone();
        let width = mean.width;
        // Shifted by one each time round: what cycles with the index meets every size.
        let size = LADDER[(index + index / LADDER.len()) % LADDER.len()];
        let fresh = libm::sqrt(1.0 - self.colour * self.colour);
        let partial = stream.uniform() < 0.5;
        for entry in 0..width {
            // Every entry takes as many draws, changed or not.
            let changed = stream.uniform() < self.part || !partial;
            let mut noise = 0.0;
            for knot in 0..mean.knots() {
                let draw = stream.normal();
                noise = if knot == 0 { draw } else { self.colour * noise + fresh * draw };
                if changed {
                    let place = knot * width + entry;
                    let value = &mut proposal.values[place];
                    *value = (*value + size * deviation[place] * noise).clip(-1.0, 1.0);
                }
            }
        }
        proposal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Interpolation;
    use msk_runtime::episode::EpisodeKey;

    fn proposals(noise: Noise, index: usize) -> Vec<Curve> {
        let mean = Curve::constant(0.0, 4, 30, Interpolation::Linear);
        let draw = |seed| noise.propose(index, &mean, &[0.1; 120], &mut Stream::new(EpisodeKey { seed, episode: 0 }, "noise"));
        (0..400).map(draw).collect()
    }

    #[test]
    fn noise_has_its_size_and_colour() {
        let found = proposals(Noise { colour: 0.8, part: 0.3 }, 0);
        let whole = found.iter().filter(|curve| curve.values[..30].iter().all(|value| *value != 0.0));
        let pairs: Vec<[f64; 2]> = whole.map(|curve| [curve.values[5], curve.values[35]]).collect();
        let mean = |of: &dyn Fn(&[f64; 2]) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
        let (variance, covariance) = (mean(&|pair| pair[1] * pair[1]), mean(&|pair| pair[0] * pair[1]));
        assert!((variance / 0.01 - 1.0).abs() < 0.35 && (covariance / variance - 0.8).abs() < 0.15, "{variance} {covariance}");
    }

    #[test]
    fn half_of_the_proposals_change_a_part() {
        let found = proposals(Noise { colour: 0.5, part: 0.3 }, 0);
        let changed: Vec<usize> =
            found.iter().map(|curve| curve.values[..30].iter().filter(|value| **value != 0.0).count()).collect();
        let partly: Vec<usize> = changed.into_iter().filter(|count| *count < 30).collect();
        let share = partly.iter().sum::<usize>() as f64 / (30.0 * partly.len() as f64);
        assert!((partly.len() as f64 / 400.0 - 0.5).abs() < 0.1 && (share - 0.3).abs() < 0.03, "{} {share}", partly.len());
    }
}

//! Proposals: other plans around the present one.
//!
//! Noise of one size on all entries finds either large changes of little or small changes of everything. Here sizes go round a ladder,
//! and proposals change all entries, a random part of them, or a run of neighbours, by turns: neighbours move the same limb, so that an
//! arm can reach while the legs go on as they do. Noise is coloured in time: neighbouring knots move together.

use crate::curve::Curve;
use msk_physics::scalar::Real;
use msk_runtime::episode::Stream;

/// Sizes that proposals take in turn, in shares of the deviation.
const LADDER: [f64; 4] = [1.0, 0.5, 2.0, 0.25];

/// How proposals are drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    /// Correlation of neighbouring knots, 0 to 1.
    pub colour: f64,
    /// The chance of each entry to be changed where a random part is, and the longest run as a share of all.
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
        let longest = (self.part * width as f64).at_least(1.0);
        let [start, length] = [stream.uniform() * width as f64, 1.0 + stream.uniform() * (longest - 1.0)];
        for entry in 0..width {
            // Every entry takes as many draws, changed or not.
            let chosen = stream.uniform() < self.part;
            let changed = match index % 3 {
                0 => true,
                1 => chosen,
                _ => (0.0..length).contains(&(entry as f64 - libm::floor(start))),
            };
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

    /// The entries that each proposal changes.
    fn changed(index: usize) -> Vec<Vec<usize>> {
        let found = proposals(Noise { colour: 0.5, part: 0.3 }, index);
        found.iter().map(|curve| (0..30).filter(|&entry| curve.values[entry] != 0.0).collect()).collect()
    }

    #[test]
    fn one_in_three_changes_a_random_part() {
        let changed = changed(1);
        let share = changed.iter().map(Vec::len).sum::<usize>() as f64 / (30.0 * changed.len() as f64);
        assert!((share - 0.3).abs() < 0.03, "{share}");
    }

    #[test]
    fn one_in_three_changes_neighbours() {
        let changed = changed(2);
        assert!(changed.iter().all(|entries| entries.windows(2).all(|pair| pair[1] == pair[0] + 1)));
        let longest = changed.iter().map(Vec::len).max();
        assert_eq!(longest, Some(9));
        assert!((0..30).all(|entry| changed.iter().any(|entries| entries.contains(&entry))));
    }
}

//! The noise by which a learner's actions differ from those without chance.

use crate::numbers::Numbers;
use msk_runtime::episode::Stream;

/// Standard normal numbers, one for each entry of an action of each slot, that may be correlated in time: an autoregressive process of
/// first order, x' = rho x + sqrt(1 - rho^2) n, whose variance stays 1.
///
/// What acts slowly, such as muscles or the pace of a gait, averages noise that is new every time, and hardly moves. With
/// correlated noise an off-policy learner learns from what it sees as from any other data (Eberhard et al. 2023). PPO goes on
/// to weigh each action by its density alone, as if there were no others (Hollenstein et al. 2024, arXiv 2312.11091).
#[derive(Debug, Default)]
pub(crate) struct Noise {
    /// rho: the share of a number that is left in the next one.
    correlation: f32,
    /// Those of the last action, slot by slot; none before the first.
    last: Vec<f32>,
}

impl Noise {
    pub fn new(correlation: f64) -> Self {
        Self { correlation: correlation as f32, last: Vec::new() }
    }

    /// The numbers of the next action: `count` of them, always as many.
    pub fn next(&mut self, count: usize, chance: &mut Stream) -> &[f32] {
        // The first are drawn like all others: the process begins as it goes on.
        let kept = if self.last.is_empty() { 0.0 } else { self.correlation };
        let fresh = (1.0 - kept * kept).sqrt();
        self.last.resize(count, 0.0);
        self.last.iter_mut().zip(normal(chance)).for_each(|(number, new)| *number = kept * *number + fresh * new);
        &self.last
    }

    pub fn state(&self) -> Numbers {
        Numbers(self.last.clone())
    }

    pub fn restore(&mut self, state: Numbers) {
        self.last = state.0;
    }
}

/// Standard normal numbers, each by itself.
pub(crate) fn normal(chance: &mut Stream) -> impl Iterator<Item = f32> {
    std::iter::repeat_with(|| chance.normal() as f32)
}

/// Entries of actions, all equally likely.
pub(crate) fn uniform(chance: &mut Stream) -> impl Iterator<Item = f32> {
    std::iter::repeat_with(|| (2.0 * chance.uniform() - 1.0) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use msk_runtime::episode::EpisodeKey;

    /// Mean square, and mean product with the next number, over many actions of two entries.
    fn moments(correlation: f64) -> [f64; 2] {
        let (mut noise, mut chance) = (Noise::new(correlation), Stream::new(EpisodeKey::default(), "test"));
        let steps: Vec<Vec<f32>> = (0..100_000).map(|_| noise.next(2, &mut chance).to_vec()).collect();
        let mean = |products: &mut dyn Iterator<Item = f64>| products.sum::<f64>() / 2e5;
        let product = |one: &[f32], other: &[f32]| one.iter().zip(other).map(|(one, other)| f64::from(one * other)).sum::<f64>();
        [
            mean(&mut steps.iter().map(|step| product(step, step))),
            mean(&mut steps.windows(2).map(|pair| product(&pair[0], &pair[1]))),
        ]
    }

    #[test]
    fn its_variance_is_one_and_its_correlation_as_set() {
        for correlation in [0.0, 0.5, 0.95] {
            let [square, product] = moments(correlation);
            // Standard errors of both are sqrt(2 / n (1 + rho^2) / (1 - rho^2)) at most.
            assert!((square - 1.0).abs() < 0.05, "{correlation}: {square}");
            assert!((product - correlation).abs() < 0.05, "{correlation}: {product}");
        }
    }

    #[test]
    fn a_restored_process_goes_on_with_the_same_numbers() {
        let (mut noise, mut chance) = (Noise::new(0.9), Stream::new(EpisodeKey::default(), "test"));
        noise.next(3, &mut chance);
        let (state, mut same) = (noise.state(), chance.clone());
        let mut restored = Noise::new(0.9);
        restored.restore(state);
        assert_eq!(noise.next(3, &mut chance), restored.next(3, &mut same));
    }
}

//! Random streams, each keyed by (seed, episode, name): adding one never shifts another.
//!
//! The key is hashed (SHA-256) into state and increment of a PCG generator (O'Neill 2014, pcg64), so streams of neighbouring
//! seeds or episodes have nothing in common. Transcendentals come from `libm`, so a stream has the same bits on every machine.

use msk_program::evaluation::Draws;
use msk_program::task::RandomValue;
use rand::Rng;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Which episode of which seed: together with a name this is all that chance depends on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct EpisodeKey {
    /// Seed of the evaluation.
    pub seed: u64,
    /// Index of the episode, from 0.
    pub episode: u64,
}

/// A stream of random numbers. `Clone` is a snapshot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stream {
    generator: Pcg64,
}

impl Stream {
    /// The stream `name` of an episode, from its beginning.
    pub fn new(key: EpisodeKey, name: &str) -> Self {
        let mut hasher = Sha256::new();
        hasher.update(key.seed.to_le_bytes());
        hasher.update(key.episode.to_le_bytes());
        hasher.update(name.as_bytes());
        let digest = hasher.finalize();
        let word = |index: usize| digest[16 * index..16 * (index + 1)].iter().fold(0, |word, &byte| word << 8 | u128::from(byte));
        Self { generator: Pcg64::new(word(0), word(1)) }
    }

    /// Skips `count` draws of [`uniform`](Self::uniform), in the time of a few.
    pub fn skip(&mut self, count: u128) {
        self.generator.advance(count);
    }

    /// The next number of a uniform distribution on [0, 1), with 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
        (self.generator.next_u64() >> 11) as f64 * STEP
    }

    /// The next number of the standard normal distribution (Box and Muller 1958); takes two draws.
    pub fn normal(&mut self) -> f64 {
        // 1 - u lies in (0, 1], so that the logarithm is finite.
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
        radius * libm::cos(core::f64::consts::TAU * self.uniform())
    }
}

/// The streams of a task's randoms, in its order: part of an episode's snapshot.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Streams(Vec<Stream>);

impl Streams {
    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Streams for randoms of an imagined episode, which have nothing in common with those of the episode itself.
    pub(super) fn imagined(key: EpisodeKey, name: &str, randoms: &[RandomValue]) -> Self {
        Self(randoms.iter().map(|random| Stream::new(key, &format!("imagined/{name}/{}", random.name))).collect())
    }

    /// Every stream from its beginning.
    pub(super) fn start(&mut self, key: EpisodeKey, randoms: &[RandomValue]) {
        self.0.clear();
        self.0.extend(randoms.iter().map(|random| Stream::new(key, &format!("random/{}", random.name))));
    }
}

impl Draws for Streams {
    fn uniform(&mut self, random: usize) -> f64 {
        self.0[random].uniform()
    }

    fn normal(&mut self, random: usize) -> f64 {
        self.0[random].normal()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: EpisodeKey = EpisodeKey { seed: 7, episode: 3 };

    fn first(key: EpisodeKey, name: &str) -> f64 {
        Stream::new(key, name).uniform()
    }

    #[test]
    fn a_stream_depends_on_seed_episode_and_name_only() {
        assert_eq!(first(KEY, "joints"), first(KEY, "joints"));
        assert_ne!(first(KEY, "joints"), first(KEY, "velocities"));
        assert_ne!(first(KEY, "joints"), first(EpisodeKey { seed: 8, ..KEY }, "joints"));
        assert_ne!(first(KEY, "joints"), first(EpisodeKey { episode: 4, ..KEY }, "joints"));
        // Seed and episode are not interchangeable.
        assert_ne!(first(KEY, "joints"), first(EpisodeKey { seed: 3, episode: 7 }, "joints"));
    }

    #[test]
    fn the_bits_of_a_stream_are_fixed_for_ever() {
        let mut stream = Stream::new(KEY, "joints");
        let draws = [stream.uniform(), stream.uniform(), stream.normal()];
        // Computed once with another implementation of SHA-256 and pcg64.
        assert_eq!(draws.map(f64::to_bits), [4594487381031875212, 4600742758635988714, 4604479432792819401]);
    }

    #[test]
    fn skipping_is_the_same_as_drawing() {
        let mut drawn = Stream::new(KEY, "joints");
        for _ in 0..1000 {
            drawn.uniform();
        }
        let mut skipped = Stream::new(KEY, "joints");
        skipped.skip(1000);
        assert_eq!(drawn, skipped);
    }

    #[test]
    fn normal_draws_have_mean_zero_and_variance_one() {
        let mut stream = Stream::new(KEY, "joints");
        let draws: Vec<f64> = (0..100_000).map(|_| stream.normal()).collect();
        let mean = draws.iter().sum::<f64>() / draws.len() as f64;
        let variance = draws.iter().map(|draw| (draw - mean).powi(2)).sum::<f64>() / draws.len() as f64;
        // Five standard errors of mean (1/√n) and variance (√(2/n)).
        assert!(mean.abs() < 0.016, "mean {mean}");
        assert!((variance - 1.0).abs() < 0.023, "variance {variance}");
        assert!(draws.iter().all(|draw| draw.is_finite()));
    }
}

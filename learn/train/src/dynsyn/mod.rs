//! `DynSyn` (He et al., ICML 2024, arXiv 2407.11472): muscles whose lengths change together share an action, which each of them scales by
//! a weight of its own that is near 1. Soft actor-critic learns both: see [`Head`](crate::head::Head).
//!
//! The action of entry i in group k is clip(w_i tanh(g_k), -1, 1), with w_i = 1 + clip(c tanh(m_i), -A, A). The network gives g and m;
//! the first entry of a group has the weight 1. A grows from 0, so that groups learn first.

mod groups;
mod medoids;

pub(crate) use groups::find;

use crate::learner::draw_squashed;
use crate::settings::DynsynSettings;
use msk_network::{Tape, Variable};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Logarithm of the deviation of the noise on m while it learns.
const WEIGHT_LOG_STD: f32 = 0.5;

/// Groups of entries of an action, and how far their weights may be from 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub struct Synergies {
    /// The group of each entry; groups are numbered in the order of their first entries.
    group: Arc<[usize]>,
    count: usize,
    /// 0 for the first entry of a group, whose weight is 1, and 1 for the others.
    free: Vec<f32>,
    /// What a weight is moved by at most: c.
    scale: f32,
    /// What it may be moved by at present: A.
    bound: f32,
}

/// As files have it.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    group: Vec<usize>,
    scale: f32,
    bound: f32,
}

impl TryFrom<Written> for Synergies {
    type Error = String;

    fn try_from(Written { group, scale, bound }: Written) -> Result<Self, String> {
        let mut count = 0;
        for (entry, group) in group.iter().enumerate() {
            if *group > count {
                return Err(format!("entry {entry} is of group {group}, expected one from 0 to {count}"));
            }
            count = count.max(group + 1);
        }
        if count == 0 || ![scale, bound].iter().all(|number| (0.0..=1.0).contains(number)) {
            return Err(format!(
                "{} entries, scale {scale}, bound {bound}: expected entries, and numbers from 0 to 1",
                group.len()
            ));
        }
        Ok(Self { scale, bound, ..Self::new(&group) })
    }
}

impl From<Synergies> for Written {
    fn from(Synergies { group, scale, bound, .. }: Synergies) -> Self {
        Self { group: group.to_vec(), scale, bound }
    }
}

impl fmt::Display for Synergies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} groups of {} entries, weights from {} to {}",
            self.count,
            self.entries(),
            1.0 - self.bound,
            1.0 + self.bound
        )
    }
}

impl Synergies {
    /// Of the group of each entry; weights are 1.
    fn new(group: &[usize]) -> Self {
        let count = group.iter().max().map_or(0, |last| last + 1);
        let mut met = vec![false; count];
        let free = group.iter().map(|group| if std::mem::replace(&mut met[*group], true) { 1.0 } else { 0.0 }).collect();
        Self { group: Arc::from(group), count, free, scale: 0.0, bound: 0.0 }
    }

    /// Groups with the weights of a share of a training.
    #[must_use]
    pub(crate) fn at(mut self, settings: &DynsynSettings, progress: f64) -> Self {
        let freed = (progress - settings.release) / (1.0 - settings.release);
        self.scale = settings.amplitude as f32;
        self.bound = if freed > 0.0 { (settings.amplitude * freed) as f32 } else { 0.0 };
        self
    }

    /// How many groups there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Entries of an action.
    pub(crate) fn entries(&self) -> usize {
        self.group.len()
    }

    /// Numbers of a network that acts: an action for each group, then a weight for each entry.
    pub(crate) fn outputs(&self) -> usize {
        self.count + self.entries()
    }

    /// The group of each entry.
    pub(crate) fn group(&self) -> &[usize] {
        &self.group
    }

    /// Which weights are free (1), what they are moved by at most, and at present.
    pub(crate) fn weights(&self) -> (&[f32], f32, f32) {
        (&self.free, self.scale, self.bound)
    }

    /// Actions without chance: [rows, entries].
    pub(crate) fn act(&self, tape: &mut Tape, output: Variable) -> Variable {
        let raw = tape.columns(output, 0..self.count);
        let groups = tape.tanh(raw);
        let weights = tape.columns(output, self.count..self.outputs());
        self.weigh(tape, groups, weights)
    }

    /// Actions with chance, and the logarithm of the density of the groups': [rows, entries] and [rows, 1]. The output has the logarithm
    /// of the deviation of each group besides. The noise of weights is not counted, and comes after that of groups.
    pub(crate) fn sample(&self, tape: &mut Tape, output: Variable, noise: &mut dyn Iterator<Item = f32>) -> [Variable; 2] {
        let (mean, log_std) = (0..self.count, self.outputs()..self.outputs() + self.count);
        let (mean, log_std) = (tape.columns(output, mean), tape.columns(output, log_std));
        let [groups, density] = draw_squashed(tape, mean, log_std, noise);
        let weights = tape.columns(output, self.count..self.outputs());
        let [rows, entries] = tape.size(weights);
        let std = libm::expf(WEIGHT_LOG_STD);
        let noise = tape.constant(rows, entries, noise.take(rows * entries).map(|noise| std * noise));
        let weights = tape.add(weights, noise);
        [self.weigh(tape, groups, weights), density]
    }

    fn weigh(&self, tape: &mut Tape, groups: Variable, weights: Variable) -> Variable {
        let [rows, entries] = tape.size(weights);
        let moved = tape.tanh(weights);
        let moved = tape.affine(moved, self.scale, 0.0);
        let moved = tape.clip(moved, -self.bound, self.bound);
        let free = tape.constant(rows, entries, (0..rows).flat_map(|_| self.free.iter().copied()));
        let moved = tape.multiply(moved, free);
        let weight = tape.affine(moved, 1.0, 1.0);
        let shared = tape.gather(groups, &self.group);
        let product = tape.multiply(weight, shared);
        tape.clip(product, -1.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::normal;
    use msk_network::Processor;
    use msk_runtime::episode::{EpisodeKey, Stream};
    use std::num::NonZeroUsize;

    fn tape() -> Tape {
        Tape::new(Arc::new(Processor::new(NonZeroUsize::MIN).unwrap()))
    }

    fn settings() -> DynsynSettings {
        DynsynSettings { amplitude: 0.1, release: 0.6, ..DynsynSettings::default() }
    }

    /// The formula at the head of this file.
    fn by_hand(output: &[f32], group: &[usize], count: usize, bound: f32) -> Vec<f32> {
        let weight = |entry: usize| match group[..entry].contains(&group[entry]) {
            true => 1.0 + (0.1 * output[count + entry].tanh()).clamp(-bound, bound),
            false => 1.0,
        };
        (0..group.len()).map(|entry| (weight(entry) * output[group[entry]].tanh()).clamp(-1.0, 1.0)).collect()
    }

    #[test]
    fn entries_of_a_group_act_together_until_their_weights_are_freed() {
        let group = [0, 1, 0, 1, 1];
        let output = [0.7, -3.0, 9.0, 9.0, 0.4, -9.0, 9.0_f32];
        for (progress, bound) in [(0.0, 0.0), (0.6, 0.0), (0.8, 0.05), (1.0, 0.1)] {
            let synergies = Synergies::new(&group).at(&settings(), progress);
            assert!((synergies.bound - bound).abs() < 1e-7);
            let mut tape = tape();
            let seen = tape.constant(1, 7, output);
            let acts = synergies.act(&mut tape, seen);
            let expected = by_hand(&output, &group, 2, bound);
            for (found, expected) in tape.values(acts).iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-6, "{progress}: {:?}, expected {expected:?}", tape.values(acts));
            }
        }
    }

    #[test]
    fn only_groups_have_a_density() {
        let synergies = Synergies::new(&[0, 1, 0]).at(&settings(), 1.0);
        let density = |weights: f32| {
            let mut tape = tape();
            let output = [0.1, -0.2, weights, weights, weights, -1.0, -2.0];
            let seen = tape.constant(1, 7, output);
            let mut chance = Stream::new(EpisodeKey::default(), "test");
            let [action, density] = synergies.sample(&mut tape, seen, &mut normal(&mut chance));
            assert_eq!(tape.size(action), [1, 3]);
            tape.values(density)[0].to_bits()
        };
        assert_eq!(density(-3.0), density(3.0));
    }

    #[test]
    fn files_with_other_groups_are_refused() {
        let read = |text: &str| serde_json::from_str::<Synergies>(text).map_err(|error| error.to_string());
        let synergies = Synergies::new(&[0, 1, 0]).at(&settings(), 1.0);
        assert_eq!(read(&serde_json::to_string(&synergies).unwrap()), Ok(synergies));
        assert!(read(r#"{"group":[0,2],"scale":0.1,"bound":0.1}"#).unwrap_err().starts_with("entry 1 is of group 2"));
        assert!(read(r#"{"group":[],"scale":0.1,"bound":0.1}"#).unwrap_err().starts_with("0 entries"));
        assert!(read(r#"{"group":[0],"scale":0.1,"bound":7}"#).unwrap_err().contains("bound 7"));
    }
}

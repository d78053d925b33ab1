//! Parts of an evaluation, for several machines.

use super::Job;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Every so many-th episode of a plan, counted over all its tasks: all shards have nearly as many episodes of every task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Shard {
    /// From 1.
    number: u64,
    of: u64,
}

/// Why words name no shard.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("expected NUMBER/COUNT with a number from 1 to the count, as in 2/5")]
pub struct ShardError;

impl Shard {
    /// The whole plan.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Whether it is the whole plan.
    pub fn is_whole(&self) -> bool {
        self.of == 1
    }

    /// Whether it has an episode of a plan with so many `episodes` of each task.
    pub fn has(&self, (task, episode): Job, episodes: u64) -> bool {
        // The count may exceed what numbers hold; remainders do not.
        let before = u128::from(episodes) * (task as u128) + u128::from(episode);
        before % u128::from(self.of) == u128::from(self.number - 1)
    }

    /// The place of its first episode from the place `from` on, both counted over all tasks; `None` if there are no such numbers.
    pub(crate) fn first_from(&self, from: u64) -> Option<u64> {
        let (own, at) = (self.number - 1, from % self.of);
        from.checked_add(if at <= own { own - at } else { self.of - at + own })
    }

    /// How many of the first `count` episodes of a plan it has.
    pub fn among(&self, count: u64) -> u64 {
        count.saturating_sub(self.number - 1).div_ceil(self.of)
    }

    /// How many of the `episodes` of a task it has.
    pub fn of_task(&self, task: usize, episodes: u64) -> u64 {
        let before = |tasks: usize| self.among(episodes.saturating_mul(tasks as u64));
        before(task + 1) - before(task)
    }
}

impl Default for Shard {
    fn default() -> Self {
        Self::WHOLE
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let (number, of) = text.split_once('/').ok_or(ShardError)?;
        let [number, of] = [number, of].map(|digits| digits.parse::<u64>().map_err(|_| ShardError));
        let (number, of) = (number?, of?);
        if (1..=of).contains(&number) { Ok(Self { number, of }) } else { Err(ShardError) }
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl TryFrom<String> for Shard {
    type Error = ShardError;

    fn try_from(text: String) -> Result<Self, ShardError> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_episode_is_in_one_shard() {
        let (tasks, episodes) = (3, 7);
        for of in 1..=25 {
            let shards: Vec<Shard> = (1..=of).map(|number| format!("{number}/{of}").parse().unwrap()).collect();
            let jobs: Vec<Job> = (0..tasks).flat_map(|task| (0..episodes).map(move |episode| (task, episode))).collect();
            for job in &jobs {
                assert_eq!(shards.iter().filter(|shard| shard.has(*job, episodes)).count(), 1);
            }
            for shard in shards {
                let from = |place: u64| (place..).find(|place| place % of == shard.number - 1);
                assert!((0..60).all(|place| shard.first_from(place) == from(place)), "{shard}");
                for count in 0..=jobs.len() {
                    let counted = jobs[..count].iter().filter(|job| shard.has(**job, episodes)).count();
                    assert_eq!(shard.among(count as u64), counted as u64, "{shard} of {count}");
                }
            }
        }
    }

    #[test]
    fn what_names_no_shard_is_refused() {
        for text in ["", "1", "0/3", "4/3", "1/0", "-1/3", "1/3/5", "a/b", "1/99999999999999999999"] {
            assert_eq!(text.parse::<Shard>(), Err(ShardError), "{text}");
        }
        assert!("1/1".parse::<Shard>().unwrap().is_whole());
        let last: Shard = format!("{0}/{0}", u64::MAX).parse().unwrap();
        assert!(
            last.has((2, u64::MAX - 2), u64::MAX - 1)
                == ((3_u128 * u128::from(u64::MAX) - 4) % u128::from(u64::MAX) == u128::from(u64::MAX) - 1)
        );
        assert_eq!((last.among(u64::MAX), last.among(0)), (1, 0));
    }
}

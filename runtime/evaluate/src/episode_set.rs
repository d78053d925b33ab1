//! Which episodes of a plan are there.

use std::collections::BTreeMap;

/// An episode of a plan: place of its task among the tasks, and index.
pub type Job = (usize, u64);

/// A set of episodes, kept as ranges: as long as episodes come in order, one range for each task.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct EpisodeSet {
    /// Beginnings of ranges of indices, with the index behind each, by task.
    ranges: BTreeMap<usize, BTreeMap<u64, u64>>,
}

impl EpisodeSet {
    /// Adds an episode; gives whether it was not there.
    pub fn insert(&mut self, (task, episode): Job) -> bool {
        let ranges = self.ranges.entry(task).or_default();
        let before = ranges.range(..=episode).next_back().map(|(start, end)| (*start, *end));
        if before.is_some_and(|(_, end)| episode < end) {
            return false;
        }
        // The last index that there is has no successor; nothing lies behind it either.
        let after = episode.saturating_add(1);
        let end = ranges.remove(&after).unwrap_or(after);
        let start = before.filter(|(_, end)| *end == episode).map_or(episode, |(start, _)| start);
        ranges.insert(start, end);
        true
    }

    /// Whether it has an episode.
    pub fn contains(&self, (task, episode): Job) -> bool {
        let ranges = self.ranges.get(&task);
        ranges.and_then(|ranges| ranges.range(..=episode).next_back()).is_some_and(|(_, end)| episode < *end)
    }

    /// Episodes of a task.
    pub fn count(&self, task: usize) -> u64 {
        self.ranges.get(&task).into_iter().flatten().map(|(start, end)| end - start).sum()
    }

    /// Episodes of all tasks.
    pub fn len(&self) -> u64 {
        self.ranges.keys().map(|task| self.count(*task)).sum()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn it_is_a_set_and_its_ranges_grow_together() {
        let mut set = EpisodeSet::default();
        let mut reference = BTreeSet::new();
        // In an order in which ranges are begun, continued at both ends, and joined.
        for index in (0..97).map(|step| step * 31 % 97).chain([5, 96]) {
            assert_eq!(set.insert((1, index)), reference.insert(index), "{index}");
            assert_eq!((set.len(), set.count(1), set.count(0)), (reference.len() as u64, reference.len() as u64, 0));
            for known in 0..100 {
                assert_eq!(set.contains((1, known)), reference.contains(&known), "{known} after {index}");
            }
        }
        assert_eq!(set.ranges[&1], BTreeMap::from([(0, 97)]));
        assert!(!set.contains((0, 5)) && set.insert((0, 5)));
    }

    #[test]
    fn the_last_index_that_there_is_does_not_overflow() {
        let mut set = EpisodeSet::default();
        assert!(set.insert((0, u64::MAX)) && set.insert((0, u64::MAX - 1)));
        assert!(set.len() == 1 && set.contains((0, u64::MAX - 1)));
    }
}

//! Transitions that an off-policy learner has seen: the latest, as many as fit.

use crate::numbers::Numbers;
use msk_runtime::episode::Stream;
use serde::{Deserialize, Serialize};

/// A ring of transitions. Observations are kept as measured, in single precision: they are normalised when they are drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Replay {
    capacity: usize,
    /// Numbers of a row of observations and of an action.
    widths: [usize; 2],
    /// Row, action, next row, reward, and what the value of the next row is multiplied with: one after the other.
    numbers: Vec<f32>,
    /// Where the next transition is written, once the ring is full.
    next: usize,
}

/// What of it a checkpoint keeps.
#[derive(Serialize, Deserialize)]
pub(crate) struct ReplayState {
    numbers: Numbers,
    next: usize,
}

/// A transition in a ring.
pub(crate) struct Transition<'a> {
    pub row: &'a [f32],
    pub action: &'a [f32],
    pub next: &'a [f32],
    pub reward: f32,
    /// What the value of the next row is multiplied with; 0 where the end was one that ends all value.
    pub discount: f32,
}

impl Replay {
    pub fn new(capacity: usize, widths: [usize; 2]) -> Self {
        Self { capacity, widths, numbers: Vec::new(), next: 0 }
    }

    /// Numbers of a transition.
    fn length(&self) -> usize {
        2 * self.widths[0] + self.widths[1] + 2
    }

    pub fn len(&self) -> usize {
        self.numbers.len() / self.length()
    }

    pub fn push(&mut self, row: &[f64], action: &[f32], next: &[f64], reward: f64, discount: f32) {
        let single = |value: &f64| msk_runtime::episode::single_precision(*value);
        let rest = [single(&reward), discount];
        let numbers = row.iter().map(single).chain(action.iter().copied()).chain(next.iter().map(single)).chain(rest);
        if self.len() < self.capacity {
            self.numbers.extend(numbers);
            return;
        }
        let begin = self.next * self.length();
        self.numbers[begin..].iter_mut().zip(numbers).for_each(|(old, new)| *old = new);
        self.next = (self.next + 1) % self.capacity;
    }

    /// Draws one of the transitions; there must be one.
    pub fn draw(&self, chance: &mut Stream) -> Transition<'_> {
        let index = ((chance.uniform() * self.len() as f64) as usize).min(self.len() - 1);
        let [width, entries] = self.widths;
        let numbers = &self.numbers[index * self.length()..(index + 1) * self.length()];
        let (row, rest) = numbers.split_at(width);
        let (action, rest) = rest.split_at(entries);
        let (next, rest) = rest.split_at(width);
        Transition { row, action, next, reward: rest[0], discount: rest[1] }
    }

    pub fn state(&self) -> ReplayState {
        ReplayState { numbers: Numbers(self.numbers.clone()), next: self.next }
    }

    /// # Errors
    /// Other sizes.
    pub fn restore(&mut self, state: ReplayState) -> Result<(), String> {
        let numbers = state.numbers.0;
        let fits = numbers.len().is_multiple_of(self.length()) && numbers.len() / self.length() <= self.capacity;
        if !fits || state.next >= self.capacity.max(1) {
            return Err("its replay buffer has another size".into());
        }
        (self.numbers, self.next) = (numbers, state.next);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use msk_runtime::episode::EpisodeKey;

    #[test]
    fn the_latest_transitions_stay() {
        let mut replay = Replay::new(3, [1, 1]);
        let drawn = |replay: &Replay| {
            let mut chance = Stream::new(EpisodeKey::default(), "draw");
            let mut rewards: Vec<f32> = (0..100).map(|_| replay.draw(&mut chance).reward).collect();
            rewards.sort_by(f32::total_cmp);
            rewards.dedup();
            rewards
        };
        for index in 0..5 {
            let number = f64::from(index);
            replay.push(&[number], &[0.5], &[number + 1.0], number, if index == 4 { 0.0 } else { 0.9 });
            assert_eq!(replay.len(), 3.min(index as usize + 1));
        }
        assert_eq!(drawn(&replay), [2.0, 3.0, 4.0]);
        let mut chance = Stream::new(EpisodeKey::default(), "draw");
        for _ in 0..20 {
            let Transition { row, action, next, reward, discount } = replay.draw(&mut chance);
            assert_eq!((row, action, next), (&[reward][..], &[0.5][..], &[reward + 1.0][..]));
            assert_eq!(discount, if reward == 4.0 { 0.0 } else { 0.9 });
        }
        let mut other = Replay::new(3, [1, 1]);
        other.restore(replay.state()).unwrap();
        assert_eq!(other, replay);
        assert!(Replay::new(3, [2, 1]).restore(replay.state()).is_err());
    }
}

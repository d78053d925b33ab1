//! Transitions that an off-policy learner has seen: the latest, as many as fit.
//!
//! They come and go in blocks. A full block may be compact: 16 bits for each number, an integer between the least and the largest number
//! of its column in the block, so that no number is off by more than 1 / 131070 of what the column spans there.

use crate::numbers::{Bytes, Numbers};
use crate::settings::{Precision, Settings};
use msk_runtime::episode::{Stream, single_precision};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Most transitions of a block.
const BLOCK: usize = 1024;
/// Least number of blocks of a buffer: when it is full, so many parts of it are forgotten one after the other.
const BLOCKS: usize = 16;
/// The largest integer of a compact number.
const LARGEST: f64 = u16::MAX as f64;

/// A buffer of transitions. Observations are kept as measured: they are normalised when they are drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Replay {
    layout: Layout,
    /// All but the last are full.
    blocks: VecDeque<Block>,
}

/// What a buffer holds, and how.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Layout {
    /// Most transitions.
    capacity: usize,
    /// Numbers of a row of observations, of an action, and terms.
    widths: [usize; 3],
    precision: Precision,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Block {
    /// Row, next row and action of each transition, one after the other.
    numbers: Bytes,
    /// Of each column the least number and how far above it the largest is, where numbers are compact.
    spans: Vec<[f32; 2]>,
    /// Of each transition what the value of the next row is multiplied with, and the value of each term before its weight: rewards follow
    /// from them by the weights in force when they are drawn.
    outcomes: Numbers,
    transitions: usize,
}

/// Transitions drawn from a buffer, row by row.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Drawn {
    pub rows: Vec<f64>,
    pub next: Vec<f64>,
    pub actions: Vec<f32>,
    /// Of each term before its weight.
    pub values: Vec<f32>,
    /// What the value of the next row is multiplied with; 0 where the end was one that ends all value.
    pub discounts: Vec<f32>,
}

impl Replay {
    /// For at most so many transitions, of rows, actions and terms of so many numbers, and for as many as the settings have memory for.
    pub fn new(settings: &Settings, most: usize, widths: [usize; 3]) -> Self {
        let precision = settings.replay_precision;
        let fitting = (settings.replay_memory * f64::from(1_u32 << 30) / transition_bytes(widths, precision) as f64) as usize;
        Self { layout: Layout { capacity: most.min(fitting), widths, precision }, blocks: VecDeque::new() }
    }

    /// For so many transitions, all of which stay, as far as the settings have memory for them.
    pub fn with_room(settings: &Settings, count: usize, widths: [usize; 3]) -> Self {
        Self::new(settings, count.next_multiple_of(BLOCK), widths)
    }

    /// Numbers of a row of observations, of an action, and terms.
    pub fn widths(&self) -> [usize; 3] {
        self.layout.widths
    }

    /// Most transitions that it holds.
    pub fn capacity(&self) -> usize {
        self.layout.capacity
    }

    /// Transitions that it holds when the next one makes it forget: whole blocks.
    pub fn room(&self) -> usize {
        self.layout.capacity - self.layout.capacity % self.layout.block()
    }

    pub fn len(&self) -> usize {
        let last = self.blocks.back().map_or(0, |block| block.transitions);
        self.blocks.len().saturating_sub(1) * self.layout.block() + last
    }

    /// Keeps a transition, and forgets the oldest block where there is no room for another one.
    pub fn push(&mut self, row: &[f64], action: &[f32], next: &[f64], values: &[f64], discount: f32) {
        let block = self.layout.block();
        if self.blocks.back().is_none_or(|last| last.transitions == block) {
            if let Some(last) = self.blocks.back_mut()
                && self.layout.precision == Precision::Compact
            {
                last.compact(self.layout.columns());
            }
            if (self.blocks.len() + 1) * block > self.layout.capacity {
                self.blocks.pop_front();
            }
            self.blocks.push_back(Block::default());
        }
        let Some(last) = self.blocks.back_mut() else { return };
        let rows = row.iter().chain(next).map(|value| single_precision(*value));
        last.numbers.0.extend(rows.chain(action.iter().copied()).flat_map(f32::to_le_bytes));
        last.outcomes.0.push(discount);
        last.outcomes.0.extend(values.iter().map(|value| single_precision(*value)));
        last.transitions += 1;
    }

    /// Draws so many of the transitions, each of them from all; there must be one.
    pub fn draw(&self, count: usize, chance: &mut Stream) -> Drawn {
        let ([width, _, terms], block, length) = (self.layout.widths, self.layout.block(), self.len());
        let (mut drawn, mut numbers) = (Drawn::default(), Vec::with_capacity(self.layout.columns()));
        for _ in 0..count {
            let index = ((chance.uniform() * length as f64) as usize).min(length - 1);
            let (block, place) = (&self.blocks[index / block], index % block);
            numbers.clear();
            block.numbers_of(place, self.layout.columns(), &mut numbers);
            let (rows, action) = numbers.split_at(2 * width);
            let (row, next) = rows.split_at(width);
            drawn.rows.extend(row.iter().map(|value| f64::from(*value)));
            drawn.next.extend(next.iter().map(|value| f64::from(*value)));
            drawn.actions.extend_from_slice(action);
            let outcome = &block.outcomes.0[place * (terms + 1)..(place + 1) * (terms + 1)];
            drawn.discounts.push(outcome[0]);
            drawn.values.extend_from_slice(&outcome[1..]);
        }
        drawn
    }

    /// Takes over what another one holds.
    ///
    /// # Errors
    /// Other sizes.
    pub fn restore(&mut self, other: Self) -> Result<(), String> {
        let block = self.layout.block();
        let fits = |place: usize, found: &Block| {
            let (count, columns) = (found.transitions, self.layout.columns());
            let compact = !found.spans.is_empty();
            let last = place + 1 == other.blocks.len();
            (count == block || last && (1..=block).contains(&count))
                && (!compact || found.spans.len() == columns)
                && found.outcomes.0.len() == count * (self.layout.widths[2] + 1)
                && found.numbers.0.len() == count * columns * if compact { 2 } else { 4 }
        };
        let room = other.blocks.len() * block <= self.layout.capacity;
        if other.layout != self.layout || !room || !other.blocks.iter().enumerate().all(|(place, block)| fits(place, block)) {
            return Err("its replay buffer has another size".into());
        }
        *self = other;
        Ok(())
    }
}

/// Bytes of a transition of rows, actions and terms of so many numbers.
pub(crate) fn transition_bytes([width, entries, terms]: [usize; 3], precision: Precision) -> usize {
    let number = match precision {
        Precision::Single => 4,
        Precision::Compact => 2,
    };
    (2 * width + entries) * number + (terms + 1) * 4
}

impl Drawn {
    /// Appends others.
    pub fn append(&mut self, other: Self) {
        self.rows.extend(other.rows);
        self.next.extend(other.next);
        self.actions.extend(other.actions);
        self.values.extend(other.values);
        self.discounts.extend(other.discounts);
    }
}

impl Layout {
    /// Numbers of a transition, but for discount and terms.
    fn columns(&self) -> usize {
        2 * self.widths[0] + self.widths[1]
    }

    /// Transitions of a full block.
    fn block(&self) -> usize {
        (self.capacity / BLOCKS).clamp(1, BLOCK)
    }
}

impl Block {
    /// Rounds the numbers of a full block to integers within the span of their column.
    fn compact(&mut self, columns: usize) {
        let singles: Vec<f32> = singles(&self.numbers.0).collect();
        self.spans = (0..columns)
            .map(|column| {
                let of = || singles.iter().skip(column).step_by(columns).copied();
                let least = of().fold(f32::INFINITY, |least, value| if value < least { value } else { least });
                let largest = of().fold(f32::NEG_INFINITY, |largest, value| if value > largest { value } else { largest });
                // The span of numbers of opposite signs may be too large for single precision.
                [least, single_precision(f64::from(largest) - f64::from(least))]
            })
            .collect();
        let spans = self.spans.iter().cycle();
        let integers = singles.iter().zip(spans).map(|(value, [least, span])| {
            let share = if *span > 0.0 { (f64::from(*value) - f64::from(*least)) / f64::from(*span) } else { 0.0 };
            // A share is at most 1 but for rounding, and a conversion saturates.
            (share * LARGEST).round() as u16
        });
        self.numbers = Bytes(integers.flat_map(u16::to_le_bytes).collect());
    }

    /// Appends the numbers of a transition.
    fn numbers_of(&self, place: usize, columns: usize, out: &mut Vec<f32>) {
        if self.spans.is_empty() {
            out.extend(singles(&self.numbers.0[4 * place * columns..4 * (place + 1) * columns]));
            return;
        }
        let (integers, _) = self.numbers.0[2 * place * columns..2 * (place + 1) * columns].as_chunks::<2>();
        out.extend(integers.iter().zip(&self.spans).map(|(bytes, [least, span])| {
            let share = f64::from(u16::from_le_bytes(*bytes)) / LARGEST;
            (f64::from(*least) + share * f64::from(*span)) as f32
        }));
    }
}

/// The numbers of bytes in single precision.
fn singles(bytes: &[u8]) -> impl Iterator<Item = f32> {
    bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use msk_runtime::episode::EpisodeKey;
    use proptest::prelude::*;

    fn replay(most: usize, [width, entries]: [usize; 2], precision: Precision) -> Replay {
        Replay::new(&Settings { replay_precision: precision, ..Settings::default() }, most, [width, entries, 1])
    }

    fn chance() -> Stream {
        Stream::new(EpisodeKey::default(), "draw")
    }

    #[test]
    fn the_latest_transitions_stay() {
        let mut replay = replay(3, [1, 1], Precision::Single);
        for index in 0..5 {
            let number = f64::from(index);
            replay.push(&[number], &[0.5], &[number + 1.0], &[number], if index == 4 { 0.0 } else { 0.9 });
            assert_eq!(replay.len(), 3.min(index as usize + 1));
        }
        let drawn = replay.draw(100, &mut chance());
        let mut values = drawn.values.clone();
        values.sort_by(f32::total_cmp);
        values.dedup();
        assert_eq!(values, [2.0, 3.0, 4.0]);
        for (index, value) in drawn.values.iter().enumerate() {
            let found = (drawn.rows[index], drawn.actions[index], drawn.next[index]);
            assert_eq!(found, (f64::from(*value), 0.5, f64::from(*value) + 1.0));
            assert_eq!(drawn.discounts[index], if *value == 4.0 { 0.0 } else { 0.9 });
        }
    }

    #[test]
    fn another_one_goes_on_with_it_if_it_has_its_size() {
        let mut first = replay(40, [1, 1], Precision::Compact);
        for index in 0..55 {
            first.push(&[f64::from(index)], &[0.0], &[1.0], &[1.0], 0.9);
        }
        let bytes = rmp_serde::to_vec(&first).unwrap();
        let read = || rmp_serde::from_slice::<Replay>(&bytes).unwrap();
        let mut second = replay(40, [1, 1], Precision::Compact);
        second.restore(read()).unwrap();
        assert_eq!(second, first);
        for mut other in [
            replay(40, [2, 1], Precision::Compact),
            replay(41, [1, 1], Precision::Compact),
            replay(40, [1, 1], Precision::Single),
        ] {
            assert!(other.restore(read()).is_err());
        }
        let mut shorter = read();
        shorter.blocks[0].numbers.0.pop();
        assert!(second.restore(shorter).is_err());
    }

    #[test]
    fn it_forgets_when_its_room_is_full() {
        // Blocks of 1, 2 and 2.
        for (most, room) in [(31, 31), (40, 40), (41, 40)] {
            let mut replay = replay(most, [1, 1], Precision::Single);
            assert_eq!(replay.room(), room);
            let mut push = || {
                replay.push(&[0.0], &[0.0], &[0.0], &[0.0], 0.9);
                replay.len()
            };
            assert_eq!((0..room).map(|_| push()).last(), Some(room));
            assert!(push() <= room);
        }
    }

    #[test]
    fn memory_bounds_it() {
        let of = |precision| {
            let settings = Settings { replay_memory: 1.0, replay_precision: precision, ..Settings::default() };
            Replay::new(&settings, 1_000_000, [1000, 400, 1]).capacity()
        };
        assert_eq!([of(Precision::Single), of(Precision::Compact)], [111_754, 223_324]);
        assert_eq!(replay(1000, [1000, 400], Precision::Single).capacity(), 1000);
    }

    proptest! {
        /// A number that was kept as 16 bits is off by at most half a step of its column, and the bounds of a column are exact.
        #[test]
        fn compact_numbers_are_near(columns in prop::collection::vec(prop::array::uniform8(-1e30_f32..1e30), 1..4)) {
            let mut block = Block::default();
            let numbers: Vec<f32> = (0..8).flat_map(|row| columns.iter().map(move |column| column[row])).collect();
            block.numbers.0.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
            block.compact(columns.len());
            prop_assert_eq!(block.numbers.0.len(), 2 * numbers.len());
            let mut found = Vec::new();
            (0..8).for_each(|row| block.numbers_of(row, columns.len(), &mut found));
            for (place, (found, number)) in found.iter().zip(&numbers).enumerate() {
                let [least, span] = block.spans[place % columns.len()].map(f64::from);
                let (found, number) = (f64::from(*found), f64::from(*number));
                // Beside the step, the numbers themselves are rounded to single precision.
                let rounding = f64::from(f32::EPSILON) * (least.abs() + span);
                prop_assert!((found - number).abs() <= span / 131_070.0 + rounding, "{found} for {number}");
            }
        }
    }
}

//! What the lanes have built alone, merged into slots.

use super::{Row, Slot, Slots};
use crate::{
    collision,
    constrained::ConstraintState,
    constraint::{Constraints, RowKind, contacts::acts, jacobian::Block},
    scalar::Real,
};

/// Which constraint of the model a block is: class, element, and which of several of that element. Packed, so that the least of
/// several is found without branches.
pub(super) type Key = u64;

/// After all keys.
pub(super) const END: Key = Key::MAX;

/// The key of a row's block, but for the number of a contact in its pair.
pub(super) const fn key(kind: RowKind, upper: bool) -> Key {
    // A model has fewer than 2^40 elements of a kind, and a pair of shapes fewer than 2^16 contacts.
    let (class, element) = match kind {
        RowKind::Equality(index) => (0, index),
        RowKind::DofFriction(index) => (1, index),
        RowKind::TendonFriction(index) => (2, index),
        RowKind::JointLimit(index) => (3, index),
        RowKind::TendonLimit(index) => (4, index),
        RowKind::Contact(candidate) => (5, candidate),
    };
    class << 56 | (element as Key) << 16 | upper as Key
}

/// Appends the keys of a lane's blocks, ascending.
pub(super) fn keys_of(constraints: &Constraints, keys: &mut Vec<Key>) {
    for block in &constraints.jacobian.blocks {
        keys.push(match constraints.rows.kind[block.rows.start] {
            RowKind::Contact(index) => contact_key(constraints.contacts[index].candidate, keys.last().copied()),
            kind => key(kind, block.upper),
        });
    }
}

/// The key of the next contact with rows, after the last key.
fn contact_key(candidate: usize, last: Option<Key>) -> Key {
    let first = key(RowKind::Contact(candidate), false);
    // Contacts of one pair follow each other.
    last.filter(|last| last >> 16 == first >> 16).map_or(first, |last| last + 1)
}

/// The candidate of a contact, from its key.
pub(super) const fn candidate_of(key: Key) -> usize {
    (key << 8 >> 24) as usize
}

/// How far each lane's blocks and contacts have been merged.
#[derive(Debug, Clone)]
pub(super) struct Merge {
    /// The keys of each lane, ascending, and [`END`]; with each the index of its block or contact.
    keys: Vec<Vec<(Key, usize)>>,
    /// How many keys of each lane have been taken.
    taken: Vec<usize>,
    /// The next key of each lane.
    next: Vec<Key>,
    scratch: Vec<Key>,
}

impl Merge {
    pub fn new(lanes: usize) -> Self {
        Self { keys: vec![Vec::new(); lanes], taken: vec![0; lanes], next: vec![END; lanes], scratch: Vec::new() }
    }

    /// Begins with what the lanes have for which `lives` holds.
    pub fn begin(&mut self, pairs: &collision::Plan, lanes: &[ConstraintState], lives: impl Fn(usize) -> bool) {
        for (lane, own) in lanes.iter().enumerate().take(self.keys.len()) {
            let keys = &mut self.keys[lane];
            keys.clear();
            if lives(lane) {
                self.scratch.clear();
                keys_of(&own.constraints, &mut self.scratch);
                keys.extend(self.scratch.iter().enumerate().map(|(block, key)| (*key, block)));
                for (index, contact) in own.constraints.contacts.iter().enumerate() {
                    if acts(&pairs.candidates[contact.candidate], contact) {
                        keys.push((contact_key(contact.candidate, keys.last().map(|(key, _)| *key)), index));
                    }
                }
            }
            keys.push((END, 0));
            self.taken[lane] = 0;
            self.next[lane] = keys[0].0;
        }
    }

    /// The least of the next keys.
    #[inline(always)]
    pub fn least(&self) -> Key {
        let mut least = END;
        for &key in &self.next {
            least = if key < least { key } else { least };
        }
        least
    }

    /// Takes a key of a lane, if it is the next: the index of its block or contact.
    #[inline(always)]
    pub fn take(&mut self, lane: usize, key: Key) -> Option<usize> {
        if self.next[lane] != key {
            return None;
        }
        let taken = self.taken[lane];
        self.taken[lane] = taken + 1;
        self.next[lane] = self.keys[lane][taken + 1].0;
        Some(self.keys[lane][taken].1)
    }
}

impl<T: Real> Slots<T> {
    /// Merges the blocks of the lanes whose keys are less than `end`.
    #[inline(always)]
    pub(super) fn merge_until(&mut self, end: Key, lanes: &[ConstraintState]) {
        // Every lane's keys ascend: the least of the next ones is the next slot.
        loop {
            let key = self.merge.least();
            if key >= end {
                return;
            }
            self.merge_one(key, lanes);
        }
    }

    /// Appends the slot of a key.
    fn merge_one(&mut self, key: Key, lanes: &[ConstraintState]) {
        let slot = self.slots.len();
        for (lane, own) in lanes.iter().enumerate().take(T::LANES) {
            let Some(block) = self.merge.take(lane, key) else { continue };
            let block = &own.constraints.jacobian.blocks[block];
            if self.slots.len() == slot {
                self.open(key, &own.constraints, block);
            }
            self.fill(&own.constraints, block, slot, lane);
        }
    }

    /// Appends a slot like `block`, of base rows that are rows, empty in every lane.
    fn open(&mut self, key: Key, constraints: &Constraints, block: &Block) {
        let (columns, row, values) = (self.columns.len(), self.rows.len(), self.values.len());
        self.columns.extend_from_slice(constraints.jacobian.columns_of(block));
        let width = self.columns.len() - columns;
        self.values.resize(values + width * block.dimension, T::splat(0.0));
        self.rows.resize(row + block.dimension, Row::empty());
        let (rows, columns) = (row..self.rows.len(), columns..self.columns.len());
        self.slots.push(Slot { rows, columns, values, dimension: block.dimension, pyramid: false, frictions: 0 });
        self.keys.push(key);
    }

    /// Writes a lane's block into its slot.
    fn fill(&mut self, constraints: &Constraints, block: &Block, slot: usize, lane: usize) {
        let Slot { rows, columns, values, dimension, .. } = &self.slots[slot];
        let width = columns.len();
        for row in 0..*dimension {
            let to = &mut self.values[*values + row * width..][..width];
            for (to, from) in to.iter_mut().zip(constraints.jacobian.base_row(block, row)) {
                to.set_lane(lane, *from);
            }
        }
        let from = &constraints.rows;
        let [weight, regularization, reference, lower, upper] =
            [&from.weight, &from.regularization, &from.reference, &from.lower, &from.upper].map(|all| &all[block.rows.clone()]);
        for (row, to) in self.rows[rows.clone()].iter_mut().enumerate() {
            to.weight.set_lane(lane, weight[row]);
            to.regularization.set_lane(lane, regularization[row]);
            to.reference.set_lane(lane, reference[row]);
            to.lower.set_lane(lane, lower[row]);
            to.upper.set_lane(lane, upper[row]);
        }
    }
}

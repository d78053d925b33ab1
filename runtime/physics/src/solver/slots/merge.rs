//! What the lanes have built alone, merged into slots.

use super::{Row, Slot, Slots};
use crate::{
    constrained::ConstraintState,
    constraint::{
        Constraints, RowKind,
        jacobian::{Block, Shape},
    },
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
            RowKind::Contact(index) => {
                let first = key(RowKind::Contact(constraints.contacts[index].candidate), false);
                // Contacts of one pair follow each other.
                keys.last().map_or(first, |last| if last >> 16 == first >> 16 { last + 1 } else { first })
            }
            kind => key(kind, block.upper),
        });
    }
}

/// How far each lane's blocks have been merged.
#[derive(Debug, Clone)]
pub(super) struct Merge {
    /// The keys of each lane's blocks, ascending, and [`END`].
    keys: Vec<Vec<Key>>,
    /// The next block of each lane.
    place: Vec<usize>,
    /// Its key.
    next: Vec<Key>,
}

impl Merge {
    pub fn new(lanes: usize) -> Self {
        Self { keys: vec![Vec::new(); lanes], place: vec![0; lanes], next: vec![END; lanes] }
    }

    /// Begins with the blocks of the lanes for which `lives` holds.
    pub fn begin(&mut self, lanes: &[ConstraintState], lives: impl Fn(usize) -> bool) {
        for (lane, own) in lanes.iter().enumerate().take(self.keys.len()) {
            let keys = &mut self.keys[lane];
            keys.clear();
            if lives(lane) {
                keys_of(&own.constraints, keys);
            }
            keys.push(END);
            self.place[lane] = 0;
            self.next[lane] = keys[0];
        }
    }

    /// The least of the next keys.
    #[inline(always)]
    fn least(&self) -> Key {
        let mut least = END;
        for &key in &self.next {
            least = if key < least { key } else { least };
        }
        least
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
            if self.merge.next[lane] != key {
                continue;
            }
            let place = self.merge.place[lane];
            let block = &own.constraints.jacobian.blocks[place];
            if self.slots.len() == slot {
                self.open(key, &own.constraints, block);
            }
            self.fill(&own.constraints, block, slot, lane);
            self.merge.place[lane] = place + 1;
            self.merge.next[lane] = self.merge.keys[lane][place + 1];
        }
    }

    /// Appends a slot like `block`, empty in every lane.
    fn open(&mut self, key: Key, constraints: &Constraints, block: &Block) {
        let (columns, row, values, zero) = (self.columns.len(), self.rows.len(), self.values.len(), T::splat(0.0));
        self.columns.extend_from_slice(constraints.jacobian.columns_of(block));
        let width = self.columns.len() - columns;
        let rows = row..row + block.rows.len();
        self.values.resize(values + width * block.dimension, zero);
        self.rows.resize(rows.end, Row::empty());
        let (frictions, pyramid) = (self.frictions.len(), block.shape == Shape::Pyramid);
        if pyramid {
            self.frictions.resize(frictions + block.dimension - 1, zero);
        }
        let columns = columns..self.columns.len();
        self.slots.push(Slot { rows, columns, values, dimension: block.dimension, pyramid, frictions });
        self.keys.push(key);
    }

    /// Writes a lane's block into its slot.
    fn fill(&mut self, constraints: &Constraints, block: &Block, slot: usize, lane: usize) {
        let Slot { rows, columns, values, dimension, pyramid, frictions } = &self.slots[slot];
        if *pyramid {
            let to = &mut self.frictions[*frictions..][..dimension - 1];
            to.iter_mut().zip(block.friction).for_each(|(to, from)| to.set_lane(lane, from));
        }
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

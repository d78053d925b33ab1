//! The constraints of several lanes side by side: every block that any lane has gets a slot.
//!
//! Slots stand in the order that the model gives: equalities, friction losses, limits, contacts by pair and then as found. A lane
//! without a block has weight zero in its slot, so that its sums take in zeros and nothing else: its bits do not depend on which
//! slots its neighbours need.

use crate::{
    constrained::ConstraintState,
    constraint::{
        Constraints, CrossCoupling, RowKind,
        jacobian::{Block, MOST_BASE_ROWS, Shape},
    },
    scalar::Real,
};
use core::ops::Range;

/// Which constraint of the model a block is: class, element, and which of several of that element. Packed, so that the least of
/// several is found without branches.
type Key = u64;

/// After all keys.
const END: Key = Key::MAX;

/// One constraint in all lanes.
#[derive(Debug, Clone)]
pub(super) struct Slot<T> {
    pub rows: Range<usize>,
    /// In [`Slots::columns`], ascending.
    pub columns: Range<usize>,
    /// Start of its base rows in [`Slots::values`], row after row.
    values: usize,
    pub dimension: usize,
    pub pyramid: bool,
    /// Lanes may differ.
    friction: [T; 5],
}

/// One row in all lanes, as in [`Rows`](crate::constraint::Rows).
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<T> {
    pub weight: T,
    pub regularization: T,
    pub reference: T,
    pub lower: T,
    pub upper: T,
    pub force: T,
}

impl<T: Real> Row<T> {
    /// The force at a residual J a - a_ref.
    #[inline(always)]
    pub fn force_at(&self, residual: T) -> T {
        (-self.weight * residual).at_least(self.lower).at_most(self.upper)
    }
}

/// All slots and their rows.
#[derive(Debug, Clone)]
pub(super) struct Slots<T> {
    pub slots: Vec<Slot<T>>,
    pub rows: Vec<Row<T>>,
    pub columns: Vec<usize>,
    pub values: Vec<T>,
    /// What couples several chains in any lane, ascending.
    pub cross_couplings: Vec<CrossCoupling>,
    /// Which slot each block of each lane has.
    places: Vec<Vec<usize>>,
    /// The keys of each lane's blocks, ascending, and [`END`].
    keys: Vec<Vec<Key>>,
    /// The next key of each lane.
    next: Vec<Key>,
}

impl<T: Real> Slots<T> {
    pub fn new() -> Self {
        Self {
            slots: Vec::new(),
            rows: Vec::new(),
            columns: Vec::new(),
            values: Vec::new(),
            cross_couplings: Vec::new(),
            places: vec![Vec::new(); T::LANES],
            keys: vec![Vec::new(); T::LANES],
            next: vec![END; T::LANES],
        }
    }

    /// Gathers the rows of the lanes for which `takes_part` holds.
    pub fn gather(&mut self, lanes: &[ConstraintState], takes_part: &[bool]) {
        self.slots.clear();
        self.rows.clear();
        self.columns.clear();
        self.values.clear();
        self.cross_couplings.clear();
        for (lane, (own, takes_part)) in lanes.iter().zip(takes_part).enumerate() {
            let keys = &mut self.keys[lane];
            keys.clear();
            self.places[lane].clear();
            if *takes_part {
                keys_of(&own.constraints, keys);
                for coupling in &own.constraints.cross_couplings {
                    if !self.cross_couplings.contains(coupling) {
                        self.cross_couplings.push(*coupling);
                    }
                }
            }
            keys.push(END);
            self.next[lane] = keys[0];
        }
        self.cross_couplings.sort_unstable();
        // Every lane's keys ascend: the least of the next ones is the next slot.
        loop {
            let key = self.next.iter().fold(END, |least, key| if *key < least { *key } else { least });
            if key == END {
                return;
            }
            let slot = self.slots.len();
            for (lane, own) in lanes.iter().enumerate().take(T::LANES) {
                if self.next[lane] != key {
                    continue;
                }
                let place = self.places[lane].len();
                let block = &own.constraints.jacobian.blocks[place];
                if self.slots.len() == slot {
                    self.open(&own.constraints, block);
                }
                self.fill(&own.constraints, block, slot, lane);
                self.places[lane].push(slot);
                self.next[lane] = self.keys[lane][place + 1];
            }
        }
    }

    /// Appends a slot like `block`, empty in every lane.
    fn open(&mut self, constraints: &Constraints, block: &Block) {
        let (columns, row, values, zero) = (self.columns.len(), self.rows.len(), self.values.len(), T::splat(0.0));
        self.columns.extend_from_slice(constraints.jacobian.columns_of(block));
        let width = self.columns.len() - columns;
        let rows = row..row + block.rows.len();
        self.values.resize(values + width * block.dimension, zero);
        let empty = Row { weight: zero, regularization: zero, reference: zero, lower: zero, upper: zero, force: zero };
        self.rows.resize(rows.end, empty);
        self.slots.push(Slot {
            rows,
            columns: columns..self.columns.len(),
            values,
            dimension: block.dimension,
            pyramid: block.shape == Shape::Pyramid,
            friction: [zero; 5],
        });
    }

    /// Writes a lane's block into its slot.
    fn fill(&mut self, constraints: &Constraints, block: &Block, slot: usize, lane: usize) {
        let Slot { rows, columns, values, dimension, pyramid, friction } = &mut self.slots[slot];
        if *pyramid {
            friction.iter_mut().zip(block.friction).for_each(|(to, from)| to.set_lane(lane, from));
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

    /// Writes the forces of a lane back to its rows.
    pub fn scatter_forces(&self, constraints: &mut Constraints, lane: usize) {
        for (block, &slot) in constraints.jacobian.blocks.iter().zip(&self.places[lane]) {
            for (row, from) in block.rows.clone().zip(self.slots[slot].rows.clone()) {
                constraints.rows.force[row] = self.rows[from].force.lane(lane);
            }
        }
    }

    /// The dofs of a slot.
    #[inline(always)]
    pub fn columns_of(&self, slot: &Slot<T>) -> &[usize] {
        &self.columns[slot.columns.clone()]
    }

    /// Base row `row` of a slot.
    #[inline(always)]
    pub fn base_row(&self, slot: &Slot<T>, row: usize) -> &[T] {
        let width = slot.columns.len();
        &self.values[slot.values + row * width..][..width]
    }

    /// out = J x.
    #[inline(always)]
    pub fn multiply(&self, x: &[T], out: &mut [T]) {
        for slot in &self.slots {
            let columns = self.columns_of(slot);
            let rows = &mut out[slot.rows.clone()];
            if !slot.pyramid {
                for (row, value) in rows.iter_mut().enumerate() {
                    *value = along(self.base_row(slot, row), columns, x);
                }
                continue;
            }
            let normal = along(self.base_row(slot, 0), columns, x);
            for (index, edges) in rows.chunks_exact_mut(2).enumerate() {
                let tangent = slot.friction[index] * along(self.base_row(slot, index + 1), columns, x);
                edges[0] = normal + tangent;
                edges[1] = normal - tangent;
            }
        }
    }

    /// out += J' force.
    #[inline(always)]
    pub fn add_transposed(&self, out: &mut [T]) {
        for slot in &self.slots {
            let rows = &self.rows[slot.rows.clone()];
            let mut base = [T::splat(0.0); MOST_BASE_ROWS];
            if slot.pyramid {
                for (index, edges) in rows.chunks_exact(2).enumerate() {
                    base[0] += edges[0].force + edges[1].force;
                    base[index + 1] = slot.friction[index] * (edges[0].force - edges[1].force);
                }
            } else {
                base.iter_mut().zip(rows).for_each(|(base, row)| *base = row.force);
            }
            for (row, &force) in base[..slot.dimension].iter().enumerate() {
                for (value, &dof) in self.base_row(slot, row).iter().zip(self.columns_of(slot)) {
                    T::apart();
                    out[dof] += *value * force;
                }
            }
        }
    }

    /// Second derivative of the cost along a slot's base rows, given that of each row.
    #[inline(always)]
    pub fn base_weight(&self, slot: &Slot<T>, weights: &[T]) -> [[T; MOST_BASE_ROWS]; MOST_BASE_ROWS] {
        let rows = &weights[slot.rows.clone()];
        let mut base = [[T::splat(0.0); MOST_BASE_ROWS]; MOST_BASE_ROWS];
        if !slot.pyramid {
            rows.iter().enumerate().for_each(|(row, weight)| base[row][row] = *weight);
            return base;
        }
        for (index, edges) in rows.chunks_exact(2).enumerate() {
            let friction = slot.friction[index];
            base[0][0] += edges[0] + edges[1];
            base[0][index + 1] = friction * (edges[0] - edges[1]);
            base[index + 1][0] = base[0][index + 1];
            base[index + 1][index + 1] = friction * friction * (edges[0] + edges[1]);
        }
        base
    }

    /// Calls `visit` with the dofs and values of one constraint row, the `local`-th of its slot.
    #[inline(always)]
    pub fn each_value(&self, slot: &Slot<T>, local: usize, mut visit: impl FnMut(usize, T)) {
        let (first, tangent, factor) = if slot.pyramid {
            (0, 1 + local / 2, slot.friction[local / 2] * T::splat(if local.is_multiple_of(2) { 1.0 } else { -1.0 }))
        } else {
            (local, local, T::splat(0.0))
        };
        let pairs = self.base_row(slot, first).iter().zip(self.base_row(slot, tangent));
        for ((normal, tangent), &dof) in pairs.zip(self.columns_of(slot)) {
            visit(dof, *normal + factor * *tangent);
        }
    }
}

/// A base row times x; the sum of a list begins with the negative zero.
#[inline(always)]
fn along<T: Real>(row: &[T], columns: &[usize], x: &[T]) -> T {
    let mut sum = T::splat(-0.0);
    for (value, &dof) in row.iter().zip(columns) {
        T::apart();
        sum += *value * x[dof];
    }
    sum
}

/// Appends the keys of a lane's blocks, ascending.
fn keys_of(constraints: &Constraints, keys: &mut Vec<Key>) {
    // A model has fewer than 2^40 elements of a kind, and a pair of shapes fewer than 2^16 contacts.
    let key = |class: Key, element: usize, number: Key| class << 56 | (element as Key) << 16 | number;
    for block in &constraints.jacobian.blocks {
        let upper = Key::from(block.upper);
        keys.push(match constraints.rows.kind[block.rows.start] {
            RowKind::Equality(index) => key(0, index, 0),
            RowKind::DofFriction(index) => key(1, index, 0),
            RowKind::TendonFriction(index) => key(2, index, 0),
            RowKind::JointLimit(index) => key(3, index, upper),
            RowKind::TendonLimit(index) => key(4, index, upper),
            RowKind::Contact(index) => {
                let first = key(5, constraints.contacts[index].candidate, 0);
                // Contacts of one pair follow each other.
                keys.last().map_or(first, |last| if last >> 16 == first >> 16 { last + 1 } else { first })
            }
        });
    }
}

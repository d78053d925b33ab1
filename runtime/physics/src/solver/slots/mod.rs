//! The constraints of several lanes side by side: every block that any lane has gets a slot.
//!
//! Slots stand in the order that the model gives: equalities, friction losses, limits, contacts by pair and then as found. A lane
//! without a block has weight zero in its slot, so that its sums take in zeros and nothing else: its bits do not depend on which
//! slots its neighbours need. Most rows are computed in all lanes at once (`shared`, `contacts`); what is rare each lane builds alone, and it
//! is merged (`merge`).

mod contacts;
mod merge;
mod shared;

use super::outer::{self, BaseWeight};
use crate::{
    constraint::{Constraints, CrossCoupling, jacobian::MOST_BASE_ROWS},
    path_matrix::PathPattern,
    scalar::Real,
};
use core::ops::Range;
use merge::{Key, Merge, keys_of};
pub(crate) use shared::Source;

/// One constraint in all lanes.
#[derive(Debug, Clone)]
pub(super) struct Slot {
    pub rows: Range<usize>,
    /// In [`Slots::columns`], ascending.
    pub columns: Range<usize>,
    /// Start of its base rows in [`Slots::values`], row after row.
    values: usize,
    pub dimension: usize,
    pub pyramid: bool,
    /// Start of a pyramid's friction coefficients in [`Slots::frictions`], one for each base row but the first.
    frictions: usize,
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
    /// One that no lane has.
    fn empty() -> Self {
        let zero = T::splat(0.0);
        Self { weight: zero, regularization: zero, reference: zero, lower: zero, upper: zero, force: zero }
    }

    /// One in the lanes of the mask.
    #[inline(always)]
    fn new(has: T::Mask, regularization: T, reference: T, [lower, upper]: [f64; 2]) -> Self {
        let zero = T::splat(0.0);
        Self {
            weight: T::select(has, T::splat(1.0) / regularization, zero),
            regularization: T::select(has, regularization, zero),
            reference: T::select(has, reference, zero),
            lower: T::select(has, T::splat(lower), zero),
            upper: T::select(has, T::splat(upper), zero),
            force: zero,
        }
    }

    /// The force at a residual J a - a_ref.
    #[inline(always)]
    pub fn force_at(&self, residual: T) -> T {
        (-self.weight * residual).at_least(self.lower).at_most(self.upper)
    }
}

/// All slots and their rows.
#[derive(Debug, Clone)]
pub(super) struct Slots<T: Real> {
    pub slots: Vec<Slot>,
    pub rows: Vec<Row<T>>,
    pub columns: Vec<usize>,
    pub values: Vec<T>,
    /// What couples several chains in any lane, ascending.
    pub cross_couplings: Vec<CrossCoupling>,
    /// The lanes that have a row.
    pub occupied: T::Mask,
    frictions: Vec<T>,
    /// The key of each slot.
    keys: Vec<Key>,
    merge: Merge,
    /// The keys of a lane whose forces are written back.
    own_keys: Vec<Key>,
}

impl<T: Real> Slots<T> {
    pub fn new() -> Self {
        Self {
            slots: Vec::new(),
            rows: Vec::new(),
            columns: Vec::new(),
            values: Vec::new(),
            cross_couplings: Vec::new(),
            occupied: T::mask(|_| false),
            frictions: Vec::new(),
            keys: Vec::new(),
            merge: Merge::new(T::LANES),
            own_keys: Vec::new(),
        }
    }

    fn clear(&mut self) {
        self.slots.clear();
        self.rows.clear();
        self.columns.clear();
        self.values.clear();
        self.cross_couplings.clear();
        self.occupied = T::mask(|_| false);
        self.frictions.clear();
        self.keys.clear();
    }

    /// Writes the forces of a lane back to its rows, all of which it has.
    pub fn scatter_forces(&mut self, constraints: &mut Constraints, lane: usize) {
        self.own_keys.clear();
        keys_of(constraints, &mut self.own_keys);
        let mut slots = self.keys.iter().zip(&self.slots);
        for (block, key) in constraints.jacobian.blocks.iter().zip(&self.own_keys) {
            let Some((_, slot)) = slots.find(|(known, _)| *known == key) else { return };
            for (row, from) in block.rows.clone().zip(slot.rows.clone()) {
                constraints.rows.force[row] = self.rows[from].force.lane(lane);
            }
        }
    }

    /// The dofs of a slot.
    #[inline(always)]
    pub fn columns_of(&self, slot: &Slot) -> &[usize] {
        &self.columns[slot.columns.clone()]
    }

    /// The friction coefficients of a pyramid.
    #[inline(always)]
    fn frictions_of(&self, slot: &Slot) -> &[T] {
        &self.frictions[slot.frictions..][..slot.dimension - 1]
    }

    /// Base row `row` of a slot.
    #[inline(always)]
    pub fn base_row(&self, slot: &Slot, row: usize) -> &[T] {
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
            let frictions = self.frictions_of(slot);
            for (index, edges) in rows.chunks_exact_mut(2).enumerate() {
                let tangent = frictions[index] * along(self.base_row(slot, index + 1), columns, x);
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
                let frictions = self.frictions_of(slot);
                for (index, edges) in rows.chunks_exact(2).enumerate() {
                    base[0] += edges[0].force + edges[1].force;
                    base[index + 1] = frictions[index] * (edges[0].force - edges[1].force);
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

    /// Adds J'WJ of a slot to a matrix, given the second derivative of the cost over each row. Of few rows it is a small W.
    #[inline(always)]
    pub fn add_outer(&self, pattern: &PathPattern, matrix: &mut [T], slot: &Slot, weights: &[T]) {
        match slot.dimension {
            1 => self.add_outer_of::<1>(pattern, matrix, slot, weights),
            3 => self.add_outer_of::<3>(pattern, matrix, slot, weights),
            _ => self.add_outer_of::<MOST_BASE_ROWS>(pattern, matrix, slot, weights),
        }
    }

    /// [`add_outer`](Self::add_outer) of a slot with at most `ROWS` base rows.
    #[inline(always)]
    fn add_outer_of<const ROWS: usize>(&self, pattern: &PathPattern, matrix: &mut [T], slot: &Slot, weights: &[T]) {
        let mut base: [&[T]; ROWS] = [&[]; ROWS];
        for (row, base) in base.iter_mut().enumerate().take(slot.dimension) {
            *base = self.base_row(slot, row);
        }
        let weight = self.base_weight::<ROWS>(slot, weights);
        outer::add(pattern, matrix, self.columns_of(slot), &base[..slot.dimension], &weight);
    }

    /// Second derivative of the cost along a slot's base rows, given that of each row.
    #[inline(always)]
    fn base_weight<const ROWS: usize>(&self, slot: &Slot, weights: &[T]) -> BaseWeight<T, ROWS> {
        let rows = &weights[slot.rows.clone()];
        let mut base = [[T::splat(0.0); ROWS]; ROWS];
        if !slot.pyramid {
            for (row, weight) in rows.iter().enumerate() {
                base[row][row] = *weight;
            }
            return base;
        }
        let frictions = self.frictions_of(slot);
        for (index, edges) in rows.chunks_exact(2).enumerate() {
            let friction = frictions[index];
            base[0][0] += edges[0] + edges[1];
            base[0][index + 1] = friction * (edges[0] - edges[1]);
            base[index + 1][0] = base[0][index + 1];
            base[index + 1][index + 1] = friction * friction * (edges[0] + edges[1]);
        }
        base
    }

    /// Calls `visit` with the dofs and values of one constraint row, the `local`-th of its slot.
    #[inline(always)]
    pub fn each_value(&self, slot: &Slot, local: usize, mut visit: impl FnMut(usize, T)) {
        let (first, tangent, factor) = if slot.pyramid {
            (0, 1 + local / 2, self.frictions_of(slot)[local / 2] * T::splat(if local.is_multiple_of(2) { 1.0 } else { -1.0 }))
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

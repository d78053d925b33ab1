//! Symmetric positive definite systems of the size of the independent coordinates.
//!
//! Eight rows stand in the lanes of one number, so that the factorisation works on them together. Every sum runs over the columns in
//! their order, one after the other, so the bits are those of plain loops over single rows, on every machine; a library that picks its
//! kernel by the processor's vector width gives others.

use msk_physics::lanes::{Lanes, WIDTH};
use msk_physics::scalar::Real;
use msk_physics::{Instructions, LaneWork};

/// A symmetric matrix, stored as its lower triangle in blocks of eight rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Symmetric {
    size: usize,
    /// Block after block, of each the columns up to its last row: one number for each column, one lane for each row.
    /// What lies above the diagonal is zero.
    entries: Vec<Lanes>,
}

/// The pivot that stands in for one that is not positive: the unknown comes out as good as zero.
const LAST_RESORT: f64 = 1e30;

/// Where a block starts.
#[inline(always)]
fn start(block: usize) -> usize {
    WIDTH * block * (block + 1) / 2
}

impl Symmetric {
    /// The zero matrix.
    pub fn new(size: usize) -> Self {
        Self { size, entries: vec![Lanes::splat(0.0); start(size.div_ceil(WIDTH))] }
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        self.entries.fill(Lanes::splat(0.0));
    }

    /// Adds to the entry at (`row`, `column`), `column` <= `row`.
    #[inline(always)]
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        *self.entries[start(row / WIDTH) + column].lane_mut(row % WIDTH) += value;
    }

    /// The columns of a block of rows, up to its diagonal.
    #[inline(always)]
    fn block(&self, block: usize) -> &[Lanes] {
        &self.entries[start(block)..start(block + 1)]
    }

    /// The blocks, with the index of the first row and the number of rows of each.
    fn blocks(&self) -> impl DoubleEndedIterator<Item = (&[Lanes], usize, usize)> {
        let rows = |first: usize| (self.size - first).min(WIDTH);
        (0..self.size.div_ceil(WIDTH)).map(move |block| (self.block(block), WIDTH * block, rows(WIDTH * block)))
    }

    /// Replaces the matrix by its Cholesky factor L, with L L' the matrix.
    pub fn factor(&mut self) {
        Instructions::default().run(Factor(self));
    }

    /// Solves L L' x = b in place, after [`factor`](Self::factor).
    pub fn solve(&self, x: &mut [f64]) {
        for (block, first, rows) in self.blocks() {
            let mut sums = Lanes::splat(0.0);
            for (entry, value) in block[..first].iter().zip(&*x) {
                sums += *entry * Lanes::splat(*value);
            }
            for row in 0..rows {
                let mut sum = sums.lane(row);
                (first..first + row).for_each(|column| sum += block[column].lane(row) * x[column]);
                x[first + row] = (x[first + row] - sum) / block[first + row].lane(row);
            }
        }
        for (block, first, rows) in self.blocks().rev() {
            let (before, own) = x.split_at_mut(first);
            for row in (0..rows).rev() {
                own[row] /= block[first + row].lane(row);
                (0..row).for_each(|column| own[column] -= block[first + column].lane(row) * own[row]);
            }
            for (entry, other) in block.iter().zip(before) {
                (0..rows).rev().for_each(|row| *other -= entry.lane(row) * own[row]);
            }
        }
    }
}

struct Factor<'a>(&'a mut Symmetric);

impl LaneWork for Factor<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Symmetric { size, entries } = self.0;
        for block in 0..size.div_ceil(WIDTH) {
            let first = WIDTH * block;
            let (above, rest) = entries.split_at_mut(start(block));
            let rows = &mut rest[..first + WIDTH];
            for earlier in 0..block {
                eliminate(rows, WIDTH * earlier, &above[start(earlier)..start(earlier + 1)]);
            }
            factor_diagonal(rows, first, (*size - first).min(WIDTH));
        }
    }
}

/// The sums over the columns before `first` of the products of rows in lanes with each of eight other rows.
#[inline(always)]
fn products(rows: &[Lanes], others: &[Lanes], first: usize) -> [Lanes; WIDTH] {
    let mut sums = [Lanes::splat(0.0); WIDTH];
    for (row, other) in rows[..first].iter().zip(others) {
        for (index, sum) in sums.iter_mut().enumerate() {
            *sum += *row * Lanes::splat(other.lane(index));
        }
    }
    sums
}

/// Fills the eight columns from `first` on in rows below the diagonal block there; `others` are its rows, which are done.
#[inline(always)]
fn eliminate(rows: &mut [Lanes], first: usize, others: &[Lanes]) {
    let sums = products(rows, others, first);
    for (index, mut sum) in sums.into_iter().enumerate() {
        for column in first..first + index {
            sum += rows[column] * Lanes::splat(others[column].lane(index));
        }
        let column = first + index;
        rows[column] = (rows[column] - sum) / Lanes::splat(others[column].lane(index));
    }
}

/// Fills the diagonal block of `count` rows.
#[inline(always)]
fn factor_diagonal(rows: &mut [Lanes], first: usize, count: usize) {
    let sums = products(rows, rows, first);
    for (index, mut sum) in sums.into_iter().enumerate().take(count) {
        for column in &rows[first..first + index] {
            sum += *column * Lanes::splat(column.lane(index));
        }
        let left = rows[first + index] - sum;
        let pivot = left.lane(index);
        let pivot = if pivot > 0.0 { pivot.sqrt() } else { LAST_RESORT };
        let below = left / Lanes::splat(pivot);
        let mut column = Lanes::splat(0.0);
        column.set_lane(index, pivot);
        for row in index + 1..count {
            column.set_lane(row, below.lane(row));
        }
        rows[first + index] = column;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIZE: usize = 7;

    /// The factor by plain loops over single rows.
    fn plain(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut factor = matrix.to_vec();
        for row in 0..matrix.len() {
            for column in 0..row {
                let sum = (0..column).fold(0.0, |sum, k| sum + factor[row][k] * factor[column][k]);
                factor[row][column] = (factor[row][column] - sum) / factor[column][column];
            }
            let sum = (0..row).fold(0.0, |sum, k| sum + factor[row][k] * factor[row][k]);
            let pivot = factor[row][row] - sum;
            factor[row][row] = if pivot > 0.0 { pivot.sqrt() } else { LAST_RESORT };
        }
        factor
    }

    #[test]
    fn rows_in_lanes_have_the_bits_of_single_rows() {
        for size in [1, 7, 8, 9, 31, 64, 70] {
            let value = |row: usize, column: usize| {
                let off = libm::sin((row * 31 + column * 17) as f64);
                // The last pivot but one is negative, where there are many.
                let diagonal = if size > 60 && row + 2 == size { -1.0 } else { size as f64 };
                if row == column { diagonal } else { off }
            };
            let entries: Vec<Vec<f64>> = (0..size).map(|row| (0..=row).map(|column| value(row, column)).collect()).collect();
            let vector: Vec<f64> = (0..size).map(|row| libm::cos(row as f64)).collect();
            let mut matrix = Symmetric::new(size);
            for (row, entries) in entries.iter().enumerate() {
                entries.iter().enumerate().for_each(|(column, entry)| matrix.add(row, column, *entry));
            }
            matrix.factor();
            let factor = plain(&entries);
            for (row, expected) in factor.iter().enumerate() {
                let found: Vec<f64> = (0..=row).map(|column| matrix.block(row / WIDTH)[column].lane(row % WIDTH)).collect();
                assert_eq!(found, *expected, "row {row} of {size}");
            }
            let mut x = vector.clone();
            matrix.solve(&mut x);
            let mut expected = vector;
            for row in 0..size {
                let sum = (0..row).fold(0.0, |sum, k| sum + factor[row][k] * expected[k]);
                expected[row] = (expected[row] - sum) / factor[row][row];
            }
            for row in (0..size).rev() {
                expected[row] /= factor[row][row];
                for column in 0..row {
                    expected[column] -= factor[row][column] * expected[row];
                }
            }
            assert_eq!(x, expected, "{size}");
        }
    }

    proptest! {
        #[test]
        fn the_factor_solves_the_system(
            columns in prop::collection::vec(prop::array::uniform7(-1.0..1.0), SIZE),
            wanted in prop::array::uniform7(-1.0..1.0_f64),
        ) {
            let mut matrix = Symmetric::new(SIZE);
            for row in 0..SIZE {
                for column in 0..=row {
                    let product: f64 = columns.iter().map(|v: &[f64; SIZE]| v[row] * v[column]).sum();
                    matrix.add(row, column, product + if row == column { 0.1 } else { 0.0 });
                }
            }
            let entry = |row: usize, column: usize| matrix.block(row / WIDTH)[column].lane(row % WIDTH);
            let product = |row: usize| (0..SIZE).map(|column| entry(row.max(column), row.min(column)) * wanted[column]).sum();
            let mut x: [f64; SIZE] = core::array::from_fn(product);
            matrix.factor();
            matrix.solve(&mut x);
            for (found, wanted) in x.iter().zip(wanted) {
                prop_assert!((found - wanted).abs() < 1e-9);
            }
        }
    }
}

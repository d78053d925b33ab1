//! Symmetric positive matrices on the sparsity of a tree.
//!
//! The lower triangle is stored by rows. Row i holds one entry for every node on the path from the root to i, the diagonal
//! last, so that the row of an ancestor covers the first columns of the rows of its descendants, and the rows of nodes that
//! follow each other on a path lie one after another. Eliminating from the leaves to the root, H = L'DL, fills no entry
//! outside this pattern (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.5).
//!
//! All loops run over contiguous entries of a few rows at a time and are written over [`Real`]: with lanes every operation
//! serves several episodes.

use crate::scalar::Real;
use core::ops::Range;

/// Where the entries lie.
#[derive(Debug, Clone, Copy)]
pub struct Layout<'a> {
    /// Each row's entries.
    pub row: &'a [Range<usize>],
    /// Column of each entry, ascending within a row, the diagonal last.
    pub column: &'a [usize],
}

/// Rows eliminated together at most: the update of an ancestor's row then does four multiplications for one load and store.
const LONGEST_CHAIN: usize = 4;

impl Layout<'_> {
    /// The node before `node` on its path is the node of the row before.
    #[inline(always)]
    fn follows_previous(&self, node: usize) -> bool {
        let row = &self.row[node];
        row.len() > 1 && self.column[row.end - 2] + 1 == node
    }

    /// Columns of a row without the diagonal.
    #[inline(always)]
    fn ancestors(&self, node: usize) -> &[usize] {
        &self.column[self.row[node].start..self.row[node].end - 1]
    }

    /// Factors in place: L below the diagonal, D on it. A pivot that is not positive is left for the caller to find.
    #[inline(always)]
    pub fn factor<T: Real>(&self, matrix: &mut [T]) {
        let mut end = self.row.len();
        while end > 0 {
            let mut first = end - 1;
            while end - first < LONGEST_CHAIN && self.follows_previous(first) {
                first -= 1;
            }
            let (above, rest) = matrix.split_at_mut(self.row[first].start);
            let (row0, rest) = rest.split_at_mut(self.row[first].len());
            match end - first {
                1 => self.eliminate(first, above, [row0]),
                2 => self.eliminate(first, above, [row0, &mut rest[..self.row[first + 1].len()]]),
                count => {
                    let (row1, rest) = rest.split_at_mut(self.row[first + 1].len());
                    let (row2, rest) = rest.split_at_mut(self.row[first + 2].len());
                    match count {
                        3 => self.eliminate(first, above, [row0, row1, row2]),
                        _ => self.eliminate(first, above, [row0, row1, row2, &mut rest[..self.row[first + 3].len()]]),
                    }
                }
            }
            end = first;
        }
    }

    /// Eliminates a chain of nodes from the rows of its ancestors, given its first node and the rows of all.
    #[inline(always)]
    fn eliminate<T: Real, const N: usize>(&self, first: usize, above: &mut [T], mut rows: [&mut [T]; N]) {
        let common = rows[0].len() - 1;
        let mut inverses = [T::splat(0.0); N];
        for last in (0..N).rev() {
            let (before, from) = rows.split_at_mut(last);
            let entries = &*from[0];
            inverses[last] = T::splat(1.0) / entries[common + last];
            for (place, row) in before.iter_mut().enumerate() {
                let weight = entries[common + place] * inverses[last];
                for (target, &entry) in row.iter_mut().zip(entries) {
                    T::apart();
                    *target -= weight * entry;
                }
            }
        }
        let chain: [&[T]; N] = core::array::from_fn(|k| &rows[k][..common]);
        for (place, &ancestor) in self.ancestors(first).iter().enumerate() {
            // A loop, because `core::array::from_fn` is a call that is not compiled for the instructions in use.
            let mut weights = inverses;
            for k in 0..N {
                weights[k] *= chain[k][place];
            }
            let start = self.row[ancestor].start;
            subtract(&mut above[start..=start + place], chain.map(|entries| &entries[..=place]), weights);
        }
        for (k, row) in rows.into_iter().enumerate() {
            for entry in &mut row[..common + k] {
                T::apart();
                *entry *= inverses[k];
            }
        }
    }

    /// Solves H x = b in place, given the factor.
    #[inline(always)]
    pub fn solve<T: Real>(&self, factor: &[T], x: &mut [T]) {
        self.solve_transposed(factor, x);
        for (value, row) in x.iter_mut().zip(self.row) {
            *value /= factor[row.end - 1];
        }
        self.solve_lower(factor, x);
    }

    /// x <- L'^-1 x.
    #[inline(always)]
    pub fn solve_transposed<T: Real>(&self, factor: &[T], x: &mut [T]) {
        for node in (0..self.row.len()).rev() {
            let value = x[node];
            for (&column, &entry) in self.ancestors(node).iter().zip(&factor[self.row[node].clone()]) {
                T::apart();
                x[column] -= entry * value;
            }
        }
    }

    /// x <- L^-1 x.
    #[inline(always)]
    pub fn solve_lower<T: Real>(&self, factor: &[T], x: &mut [T]) {
        for node in 0..self.row.len() {
            let mut value = x[node];
            for (&column, &entry) in self.ancestors(node).iter().zip(&factor[self.row[node].clone()]) {
                T::apart();
                value -= entry * x[column];
            }
            x[node] = value;
        }
    }

    /// y = H x.
    #[inline(always)]
    pub fn multiply<T: Real>(&self, matrix: &[T], x: &[T], y: &mut [T]) {
        for node in 0..self.row.len() {
            let row = self.row[node].clone();
            let mut sum = matrix[row.end - 1] * x[node];
            for (&column, &entry) in self.ancestors(node).iter().zip(&matrix[row]) {
                T::apart();
                sum += entry * x[column];
                y[column] += entry * x[node];
            }
            y[node] = sum;
        }
    }
}

/// target -= weights times rows, one row after the other from the last: so the order of a sum does not depend on which rows are
/// eliminated together, and a row of zeros changes nothing.
#[inline(always)]
fn subtract<T: Real, const N: usize>(target: &mut [T], rows: [&[T]; N], weights: [T; N]) {
    let rows = rows.map(|row| &row[..target.len()]);
    for (index, value) in target.iter_mut().enumerate() {
        T::apart();
        let mut rest = *value;
        for k in (0..N).rev() {
            rest -= weights[k] * rows[k][index];
        }
        *value = rest;
    }
}

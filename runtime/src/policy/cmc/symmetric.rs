//! Symmetric positive definite systems of the size of the independent coordinates.
//!
//! The factorisation is written out in plain loops: it is small beside the rest of a control step, needs no memory, and gives
//! the same bits on every machine, which a library that picks its kernel by the processor's vector width does not.

/// A symmetric matrix, stored as the rows of its lower triangle.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Symmetric {
    size: usize,
    /// Row i starts at i (i + 1) / 2.
    entries: Vec<f64>,
}

/// The pivot that stands in for one that is not positive: the unknown comes out as good as zero.
const LAST_RESORT: f64 = 1e30;

impl Symmetric {
    /// The zero matrix.
    pub fn new(size: usize) -> Self {
        Self { size, entries: vec![0.0; size * (size + 1) / 2] }
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// Becomes a copy of `other`, which has the same size.
    pub fn copy_from(&mut self, other: &Self) {
        self.entries.copy_from_slice(&other.entries);
    }

    /// The entry at (`row`, `column`), `column` <= `row`.
    pub fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.entries[row * (row + 1) / 2 + column]
    }

    fn row(&self, row: usize) -> &[f64] {
        let start = row * (row + 1) / 2;
        &self.entries[start..=start + row]
    }

    /// `out` = this matrix times `vector`.
    pub fn multiply(&self, vector: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for row in 0..self.size {
            let (off_diagonal, diagonal) = self.row(row).split_at(row);
            let mut sum = diagonal[0] * vector[row];
            for ((entry, factor), other) in off_diagonal.iter().zip(vector).zip(&mut *out) {
                sum += entry * factor;
                *other += entry * vector[row];
            }
            out[row] += sum;
        }
    }

    /// Replaces the matrix by its Cholesky factor L, with L L' the matrix.
    pub fn factor(&mut self) {
        for row in 0..self.size {
            let start = row * (row + 1) / 2;
            let (above, rest) = self.entries.split_at_mut(start);
            let mine = &mut rest[..=row];
            for column in 0..row {
                let first = column * (column + 1) / 2;
                let theirs = &above[first..=first + column];
                let sum: f64 = mine[..column].iter().zip(theirs).map(|(a, b)| a * b).sum();
                mine[column] = (mine[column] - sum) / theirs[column];
            }
            let pivot = mine[row] - mine[..row].iter().map(|a| a * a).sum::<f64>();
            mine[row] = if pivot > 0.0 { pivot.sqrt() } else { LAST_RESORT };
        }
    }

    /// Solves L L' x = b in place, after [`factor`](Self::factor).
    pub fn solve(&self, x: &mut [f64]) {
        for row in 0..self.size {
            let (off_diagonal, diagonal) = self.row(row).split_at(row);
            let sum: f64 = off_diagonal.iter().zip(&*x).map(|(a, b)| a * b).sum();
            x[row] = (x[row] - sum) / diagonal[0];
        }
        for row in (0..self.size).rev() {
            let (off_diagonal, diagonal) = self.row(row).split_at(row);
            let value = x[row] / diagonal[0];
            x[row] = value;
            for (entry, other) in off_diagonal.iter().zip(&mut *x) {
                *other -= entry * value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIZE: usize = 7;

    proptest! {
        #[test]
        fn the_factor_solves_the_system(
            columns in prop::collection::vec(prop::array::uniform7(-1.0..1.0), SIZE),
            wanted in prop::array::uniform7(-1.0..1.0),
        ) {
            let mut matrix = Symmetric::new(SIZE);
            for row in 0..SIZE {
                for column in 0..=row {
                    let product: f64 = columns.iter().map(|v: &[f64; SIZE]| v[row] * v[column]).sum();
                    *matrix.entry(row, column) = product + if row == column { 0.1 } else { 0.0 };
                }
            }
            let mut x = [0.0; SIZE];
            matrix.multiply(&wanted, &mut x);
            matrix.factor();
            matrix.solve(&mut x);
            for (found, wanted) in x.iter().zip(wanted) {
                prop_assert!((found - wanted).abs() < 1e-9);
            }
        }
    }
}

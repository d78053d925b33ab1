//! Short columns: most muscles cross few joints, and a foot moves with one leg only.

use msk_physics::path_matrix::PathPattern;
use msk_physics::scalar::Real;

/// A matrix kept as sparse columns, rebuilt at every control step in memory that is allocated once. Where a column has entries is the same
/// in all lanes.
#[derive(Debug, Clone)]
pub(in crate::cmc) struct Columns<T> {
    /// First entry of every column, and one past the last.
    start: Vec<usize>,
    /// Row of each entry, ascending within a column.
    row: Vec<usize>,
    /// The depth of that row in the pattern on which the squares of columns have entries.
    depth: Vec<usize>,
    value: Vec<T>,
}

impl<T> Default for Columns<T> {
    fn default() -> Self {
        Self { start: vec![0], row: Vec::new(), depth: Vec::new(), value: Vec::new() }
    }
}

impl<T: Real> Columns<T> {
    /// Forgets all columns but the first `count`.
    #[inline(always)]
    pub fn truncate(&mut self, count: usize) {
        self.start.truncate(count + 1);
        let entries = self.start[count];
        self.row.truncate(entries);
        self.depth.truncate(entries);
        self.value.truncate(entries);
    }

    /// Appends a column of (row, value) entries, rows ascending on one path of the pattern.
    #[inline(always)]
    pub fn push(&mut self, pattern: &PathPattern, entries: impl Iterator<Item = (usize, T)>) {
        for (row, value) in entries {
            self.row.push(row);
            self.depth.push(pattern.depth(row));
            self.value.push(value);
        }
        self.start.push(self.row.len());
    }

    /// Rows and values of a column, rows ascending.
    #[inline(always)]
    pub fn column(&self, column: usize) -> (&[usize], &[T]) {
        let range = self.start[column]..self.start[column + 1];
        (&self.row[range.clone()], &self.value[range])
    }

    /// Values of a column, to be replaced.
    #[inline(always)]
    pub fn values_mut(&mut self, column: usize) -> &mut [T] {
        &mut self.value[self.start[column]..self.start[column + 1]]
    }

    /// The scalar product of a column with a dense vector.
    #[inline(always)]
    pub fn dot(&self, column: usize, vector: &[T]) -> T {
        let (rows, values) = self.column(column);
        let mut sum = T::splat(0.0);
        for (&row, &value) in rows.iter().zip(values) {
            T::apart();
            sum += value * vector[row];
        }
        sum
    }

    /// `out` += `scale` times a column.
    #[inline(always)]
    pub fn add_scaled(&self, column: usize, scale: T, out: &mut [T]) {
        let (rows, values) = self.column(column);
        for (&row, &value) in rows.iter().zip(values) {
            T::apart();
            out[row] += scale * value;
        }
    }

    /// `matrix` += `scale` times a column times its transpose, on the pattern.
    #[inline(always)]
    pub fn add_square(&self, column: usize, scale: T, pattern: &PathPattern, matrix: &mut [T]) {
        let (rows, values) = self.column(column);
        let depths = &self.depth[self.start[column]..self.start[column + 1]];
        for (count, (&row, &value)) in rows.iter().zip(values).enumerate() {
            let target = &mut matrix[pattern.row[row].clone()];
            let scaled = scale * value;
            for (&depth, &other) in depths[..=count].iter().zip(values) {
                T::apart();
                target[depth] += scaled * other;
            }
        }
    }
}

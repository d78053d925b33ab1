//! Short columns: most muscles cross few joints, and a foot moves with one leg only.

use super::symmetric::Symmetric;

/// A matrix kept as sparse columns, rebuilt at every control step in memory that is allocated once.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    /// First entry of every column, and one past the last.
    start: Vec<usize>,
    /// Row of each entry, ascending within a column.
    row: Vec<usize>,
    value: Vec<f64>,
}

impl Default for Columns {
    fn default() -> Self {
        Self { start: vec![0], row: Vec::new(), value: Vec::new() }
    }
}

impl Columns {
    /// Forgets all columns.
    pub fn clear(&mut self) {
        self.start.truncate(1);
        self.row.clear();
        self.value.clear();
    }

    /// Appends a column of (row, value) entries, rows ascending; zeros are dropped.
    pub fn push(&mut self, entries: impl Iterator<Item = (usize, f64)>) {
        for (row, value) in entries.filter(|(_, value)| *value != 0.0) {
            self.row.push(row);
            self.value.push(value);
        }
        self.start.push(self.row.len());
    }

    /// The entries of a column, rows ascending.
    pub fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        let range = self.start[column]..self.start[column + 1];
        self.row[range.clone()].iter().copied().zip(self.value[range].iter().copied())
    }

    /// The scalar product of a column with a dense vector.
    pub fn dot(&self, column: usize, vector: &[f64]) -> f64 {
        self.column(column).map(|(row, value)| value * vector[row]).sum()
    }

    /// `out` += `scale` times a column.
    pub fn add_scaled(&self, column: usize, scale: f64, out: &mut [f64]) {
        for (row, value) in self.column(column) {
            out[row] += scale * value;
        }
    }

    /// `out` += `scale` times a column times its transpose.
    pub fn add_square(&self, column: usize, scale: f64, out: &mut Symmetric) {
        let range = self.start[column]..self.start[column + 1];
        out.add_square(scale, &self.row[range.clone()], &self.value[range]);
    }
}

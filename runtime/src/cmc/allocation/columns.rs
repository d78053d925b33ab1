//! Short columns: most muscles cross few joints, and a foot moves with one leg only.
//!
//! Half of the human body's muscles cross the same three coordinates of the trunk. So columns that follow each other and have entries in the
//! same rows are one [`Run`]: what a sum over them comes to stays in registers, in the order of the columns.

use core::ops::Range;
use msk_physics::path_matrix::PathPattern;
use msk_physics::scalar::Real;

/// A matrix A kept as sparse columns, rebuilt at every control step in memory that is allocated once. Where a column has entries is the same
/// in all lanes.
#[derive(Debug, Clone)]
pub(in crate::cmc) struct Columns<T> {
    runs: Vec<Run>,
    /// Rows of all runs.
    row: Vec<usize>,
    /// The depth of each in the pattern on which the squares of columns have entries.
    depth: Vec<usize>,
    /// Entries of all columns.
    value: Vec<T>,
}

impl<T> Default for Columns<T> {
    fn default() -> Self {
        Self { runs: Vec::new(), row: Vec::new(), depth: Vec::new(), value: Vec::new() }
    }
}

/// Columns with entries in the same rows.
#[derive(Debug, Clone)]
struct Run {
    columns: Range<usize>,
    /// Its rows, ascending, among those of all runs.
    rows: Range<usize>,
    /// The entries, column by column.
    values: Range<usize>,
}

/// What to do with a run, whose number of rows is known to the compiler where it is small.
macro_rules! by_rows {
    ($rows:expr, $values:expr, $few:ident, $many:ident, $($argument:expr),+) => {
        match $rows.len() {
            1 => $few::<T, 1>($rows, $values, $($argument),+),
            2 => $few::<T, 2>($rows, $values, $($argument),+),
            3 => $few::<T, 3>($rows, $values, $($argument),+),
            4 => $few::<T, 4>($rows, $values, $($argument),+),
            _ => $many($rows, $values, $($argument),+),
        }
    };
}

impl<T: Real> Columns<T> {
    /// Number of columns.
    #[inline(always)]
    fn count(&self) -> usize {
        self.runs.last().map_or(0, |run| run.columns.end)
    }

    /// Forgets all columns but the first `count`.
    pub fn truncate(&mut self, count: usize) {
        while let Some(mut run) = self.runs.pop() {
            if run.columns.start < count {
                run.columns.end = run.columns.end.min(count);
                run.values.end = run.values.start + run.columns.len() * run.rows.len();
                self.row.truncate(run.rows.end);
                self.depth.truncate(run.rows.end);
                self.value.truncate(run.values.end);
                self.runs.push(run);
                return;
            }
        }
        self.row.clear();
        self.depth.clear();
        self.value.clear();
    }

    /// Appends a column of (row, value) entries, rows ascending on one path of the pattern.
    #[inline(always)]
    pub fn push(&mut self, pattern: &PathPattern, entries: impl Iterator<Item = (usize, T)>) {
        let (column, rows, values) = (self.count(), self.row.len(), self.value.len());
        for (row, value) in entries {
            self.row.push(row);
            self.value.push(value);
        }
        let (rows, values) = (rows..self.row.len(), values..self.value.len());
        match self.runs.last_mut() {
            Some(run) if self.row[run.rows.clone()] == self.row[rows.clone()] => {
                run.columns.end += 1;
                run.values.end = values.end;
                self.row.truncate(rows.start);
            }
            _ => {
                self.depth.extend(self.row[rows.clone()].iter().map(|&row| pattern.depth(row)));
                self.runs.push(Run { columns: column..column + 1, rows, values });
            }
        }
    }

    /// The entries of all columns, one column after the other, to be replaced.
    #[inline(always)]
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.value
    }

    /// `out` = A' `vector`: the scalar product of each column with a vector.
    #[inline(always)]
    pub fn dots(&self, vector: &[T], out: &mut [T]) {
        for run in &self.runs {
            let (rows, values) = (&self.row[run.rows.clone()], &self.value[run.values.clone()]);
            by_rows!(rows, values, dots_of_few, dots_of_many, vector, &mut out[run.columns.clone()]);
        }
    }

    /// `out` += A `factors`.
    #[inline(always)]
    pub fn add_scaled(&self, factors: &[T], out: &mut [T]) {
        for run in &self.runs {
            let (rows, values) = (&self.row[run.rows.clone()], &self.value[run.values.clone()]);
            by_rows!(rows, values, add_few, add_many, &factors[run.columns.clone()], out);
        }
    }

    /// Both `out` += A `factors`, in one pass over the columns.
    #[inline(always)]
    pub fn add_scaled_pair(&self, factors: [&[T]; 2], out: [&mut [T]; 2]) {
        let [first, second] = out;
        for run in &self.runs {
            let (rows, values) = (&self.row[run.rows.clone()], &self.value[run.values.clone()]);
            let factors = factors.map(|factors| &factors[run.columns.clone()]);
            by_rows!(rows, values, add_pair_of_few, add_pair_of_many, factors, [&mut *first, &mut *second]);
        }
    }

    /// `matrix` += A diag(`weights`) A', on the pattern.
    #[inline(always)]
    pub fn add_squares(&self, weights: &[T], pattern: &PathPattern, matrix: &mut [T]) {
        for run in &self.runs {
            let (rows, values) = (&self.row[run.rows.clone()], &self.value[run.values.clone()]);
            let place = (pattern, &self.depth[run.rows.clone()]);
            by_rows!(rows, values, add_squares_of_few, add_squares_of_many, &weights[run.columns.clone()], place, matrix);
        }
    }
}

#[inline(always)]
fn dots_of_few<T: Real, const N: usize>(rows: &[usize], values: &[T], vector: &[T], out: &mut [T]) {
    let mut known = [T::splat(0.0); N];
    for (known, &row) in known.iter_mut().zip(rows) {
        *known = vector[row];
    }
    for (out, column) in out.iter_mut().zip(values.as_chunks::<N>().0) {
        let mut sum = T::splat(0.0);
        for k in 0..N {
            T::apart();
            sum += column[k] * known[k];
        }
        *out = sum;
    }
}

#[inline(always)]
fn dots_of_many<T: Real>(rows: &[usize], values: &[T], vector: &[T], out: &mut [T]) {
    for (index, out) in out.iter_mut().enumerate() {
        let column = &values[index * rows.len()..][..rows.len()];
        let mut sum = T::splat(0.0);
        for (&row, &value) in rows.iter().zip(column) {
            T::apart();
            sum += value * vector[row];
        }
        *out = sum;
    }
}

#[inline(always)]
fn add_few<T: Real, const N: usize>(rows: &[usize], values: &[T], factors: &[T], out: &mut [T]) {
    let mut sums = [T::splat(0.0); N];
    for (sum, &row) in sums.iter_mut().zip(rows) {
        *sum = out[row];
    }
    for (&factor, column) in factors.iter().zip(values.as_chunks::<N>().0) {
        for k in 0..N {
            T::apart();
            sums[k] += factor * column[k];
        }
    }
    for (&sum, &row) in sums.iter().zip(rows) {
        out[row] = sum;
    }
}

#[inline(always)]
fn add_many<T: Real>(rows: &[usize], values: &[T], factors: &[T], out: &mut [T]) {
    for (index, &factor) in factors.iter().enumerate() {
        let column = &values[index * rows.len()..][..rows.len()];
        for (&row, &value) in rows.iter().zip(column) {
            T::apart();
            out[row] += factor * value;
        }
    }
}

#[inline(always)]
fn add_pair_of_few<T: Real, const N: usize>(rows: &[usize], values: &[T], factors: [&[T]; 2], out: [&mut [T]; 2]) {
    let mut sums = [[T::splat(0.0); 2]; N];
    for (sum, &row) in sums.iter_mut().zip(rows) {
        *sum = [out[0][row], out[1][row]];
    }
    for ((&first, &second), column) in factors[0].iter().zip(factors[1]).zip(values.as_chunks::<N>().0) {
        for k in 0..N {
            T::apart();
            sums[k][0] += first * column[k];
            sums[k][1] += second * column[k];
        }
    }
    for (&sum, &row) in sums.iter().zip(rows) {
        [out[0][row], out[1][row]] = sum;
    }
}

#[inline(always)]
fn add_pair_of_many<T: Real>(rows: &[usize], values: &[T], factors: [&[T]; 2], out: [&mut [T]; 2]) {
    for (index, (&first, &second)) in factors[0].iter().zip(factors[1]).enumerate() {
        let column = &values[index * rows.len()..][..rows.len()];
        for (&row, &value) in rows.iter().zip(column) {
            T::apart();
            out[0][row] += first * value;
            out[1][row] += second * value;
        }
    }
}

#[inline(always)]
fn add_squares_of_few<T: Real, const N: usize>(
    rows: &[usize],
    values: &[T],
    weights: &[T],
    (pattern, depths): (&PathPattern, &[usize]),
    matrix: &mut [T],
) {
    let mut sums = [[T::splat(0.0); N]; N];
    for i in 0..N {
        for j in 0..=i {
            sums[i][j] = matrix[pattern.row[rows[i]].start + depths[j]];
        }
    }
    for (&weight, column) in weights.iter().zip(values.as_chunks::<N>().0) {
        for i in 0..N {
            let scaled = weight * column[i];
            for j in 0..=i {
                T::apart();
                sums[i][j] += scaled * column[j];
            }
        }
    }
    for i in 0..N {
        for j in 0..=i {
            matrix[pattern.row[rows[i]].start + depths[j]] = sums[i][j];
        }
    }
}

#[inline(always)]
fn add_squares_of_many<T: Real>(rows: &[usize], values: &[T], weights: &[T], place: (&PathPattern, &[usize]), matrix: &mut [T]) {
    let (of_four, others) = weights.as_chunks::<4>();
    for (index, weights) in of_four.iter().enumerate() {
        add_squares_of_some(rows, &values[4 * index * rows.len()..], weights, place, matrix);
    }
    for (index, &weight) in others.iter().enumerate() {
        add_squares_of_some(rows, &values[(4 * of_four.len() + index) * rows.len()..], &[weight], place, matrix);
    }
}

/// The squares of the first `N` columns.
#[inline(always)]
fn add_squares_of_some<T: Real, const N: usize>(
    rows: &[usize],
    values: &[T],
    weights: &[T; N],
    (pattern, depths): (&PathPattern, &[usize]),
    matrix: &mut [T],
) {
    let mut columns = [values; N];
    for (k, column) in columns.iter_mut().enumerate() {
        *column = &values[k * rows.len()..][..rows.len()];
    }
    for (i, &row) in rows.iter().enumerate() {
        let target = &mut matrix[pattern.row[row].clone()];
        let mut scaled = *weights;
        for k in 0..N {
            scaled[k] *= columns[k][i];
        }
        for (j, &depth) in depths[..=i].iter().enumerate() {
            T::apart();
            let mut sum = target[depth];
            for k in 0..N {
                sum += scaled[k] * columns[k][j];
            }
            target[depth] = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ROWS: usize = 8;

    /// Runs of columns: how many, the rows that they have entries in, and a number from which entries follow.
    fn runs() -> impl Strategy<Value = Vec<(usize, Vec<usize>, f64)>> {
        prop::collection::vec((1..7usize, prop::sample::subsequence((0..ROWS).collect::<Vec<_>>(), 0..=6), -2.0..2.0f64), 1..5)
    }

    proptest! {
        #[test]
        fn all_products_are_those_of_the_dense_matrix(runs in runs(), kept in 0..20usize, vector in prop::collection::vec(-1.0..1.0f64, ROWS)) {
            let mut pattern = PathPattern::default();
            pattern.rebuild(&[None; ROWS], [&[0, 1, 2, 3, 4, 5, 6, 7][..]].into_iter());
            let (mut columns, mut dense) = (Columns::default(), Vec::new());
            for (count, rows, value) in &runs {
                for index in 0..*count {
                    let entry = |row: usize| value * (1.0 + row as f64) - 0.3 * index as f64;
                    columns.push(&pattern, rows.iter().map(|&row| (row, entry(row))));
                    let mut column = [0.0; ROWS];
                    rows.iter().for_each(|&row| column[row] = entry(row));
                    dense.push(column);
                }
            }
            // Those that are forgotten and pushed again leave nothing behind.
            let kept = kept.min(dense.len());
            columns.truncate(kept);
            for column in &dense[kept..] {
                columns.push(&pattern, column.iter().copied().enumerate());
            }
            let factors: Vec<f64> = (0..dense.len()).map(|index| 0.7 - 0.2 * index as f64).collect();

            let (mut dots, mut sums) = (vec![0.0; dense.len()], vector.clone());
            let mut matrix = vec![0.5; pattern.column.len()];
            columns.dots(&vector, &mut dots);
            columns.add_scaled(&factors, &mut sums);
            let (negated, mut pair) = (factors.iter().map(|factor| -factor).collect::<Vec<_>>(), [vector.clone(), vector.clone()]);
            let [first, second] = &mut pair;
            columns.add_scaled_pair([&factors, &negated], [first, second]);
            columns.add_squares(&factors, &pattern, &mut matrix);
            for (dot, column) in dots.iter().zip(&dense) {
                let expected: f64 = column.iter().zip(&vector).map(|(entry, value)| entry * value).sum();
                prop_assert!((dot - expected).abs() < 1e-9);
            }
            for row in 0..ROWS {
                let of = |other: usize| dense.iter().zip(&factors).map(|(column, factor)| factor * column[row] * column[other]).sum::<f64>();
                let sum: f64 = vector[row] + dense.iter().zip(&factors).map(|(column, factor)| factor * column[row]).sum::<f64>();
                prop_assert!((sums[row] - sum).abs() < 1e-9);
                prop_assert_eq!(pair[0][row], sums[row]);
                prop_assert!((pair[1][row] - (2.0 * vector[row] - sum)).abs() < 1e-9);
                for other in 0..=row {
                    prop_assert!((matrix[pattern.row[row].start + pattern.depth(other)] - 0.5 - of(other)).abs() < 1e-9);
                }
            }
        }
    }
}

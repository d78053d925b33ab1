//! J'WJ of one constraint, added to a matrix on its pattern: for one episode and for several in lanes, in the same order.

use crate::{constraint::jacobian::MOST_BASE_ROWS, path_matrix::PathPattern, scalar::Real};

/// Second derivative of the cost over the base rows of a constraint.
pub(super) type BaseWeight<T> = [[T; MOST_BASE_ROWS]; MOST_BASE_ROWS];

/// Adds J'WJ, given the base rows J over `columns` and their weight W. The columns lie on one path, so each row's entries are found by
/// their depth; the columns of what touches the world are the whole path, entry beside entry.
#[inline(always)]
pub(super) fn add<T: Real>(pattern: &PathPattern, matrix: &mut [T], columns: &[usize], base: &[&[T]], weight: &BaseWeight<T>) {
    let whole_path = columns.last().is_some_and(|&last| pattern.depth(last) + 1 == columns.len());
    for (place, &dof) in columns.iter().enumerate() {
        let target = &mut matrix[pattern.row[dof].clone()];
        let before = if whole_path { Before::All } else { Before::Some(pattern, &columns[..=place]) };
        let pull = |row: usize| {
            let weights = weight[row].iter().zip(base);
            weights.fold(T::splat(-0.0), |sum, (weight, values)| sum + *weight * values[place])
        };
        match base {
            // A contact with friction: one load and store for three products.
            [a, b, c] => {
                let [p, q, r] = [pull(0), pull(1), pull(2)];
                let values = a.iter().zip(*b).zip(*c);
                before.each(target, values, |entry, ((a, b), c)| *entry = *entry + p * *a + q * *b + r * *c);
            }
            _ => {
                for (row, values) in base.iter().enumerate() {
                    let pull = pull(row);
                    before.each(target, values.iter(), |entry, value| *entry += pull * *value);
                }
            }
        }
    }
}

/// The entries of a row up to its diagonal.
enum Before<'a> {
    All,
    /// Those in these columns.
    Some(&'a PathPattern, &'a [usize]),
}

impl Before<'_> {
    /// Calls `add` with each entry and its value.
    #[inline(always)]
    fn each<T: Real, V>(&self, target: &mut [T], values: impl Iterator<Item = V>, add: impl Fn(&mut T, V)) {
        match self {
            Self::All => {
                for (entry, value) in target.iter_mut().zip(values) {
                    T::apart();
                    add(entry, value);
                }
            }
            Self::Some(pattern, columns) => {
                for (&column, value) in columns.iter().zip(values) {
                    T::apart();
                    add(&mut target[pattern.depth(column)], value);
                }
            }
        }
    }
}

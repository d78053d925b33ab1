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
        match base {
            // A contact with friction: one load and store for three products.
            [a, b, c] => {
                let p = pull(&weight[0], base, place);
                let q = pull(&weight[1], base, place);
                let r = pull(&weight[2], base, place);
                let values = a.iter().zip(*b).zip(*c);
                before.each(target, values, |entry, ((a, b), c)| *entry = *entry + p * *a + q * *b + r * *c);
            }
            _ => {
                for (row, values) in base.iter().enumerate() {
                    let pull = pull(&weight[row], base, place);
                    before.each(target, values.iter(), |entry, value| *entry += pull * *value);
                }
            }
        }
    }
}

/// A row of W times J, in one column.
#[inline(always)]
fn pull<T: Real>(weights: &[T; MOST_BASE_ROWS], base: &[&[T]], place: usize) -> T {
    let mut sum = T::splat(-0.0);
    for (weight, values) in weights.iter().zip(base) {
        sum += *weight * values[place];
    }
    sum
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

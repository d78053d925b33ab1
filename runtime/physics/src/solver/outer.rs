//! J'WJ of one constraint, added to a matrix on its pattern: for one episode and for several in lanes, in the same order.

use crate::{path_matrix::PathPattern, scalar::Real};

/// Second derivative of the cost over the base rows of a constraint, of which there may be fewer.
pub(super) type BaseWeight<T, const ROWS: usize> = [[T; ROWS]; ROWS];

/// Adds J'WJ, given the base rows J over `columns` and their weight W. The columns lie on one path, so each row's entries are found by
/// their depth; the columns of what touches the world are the whole path, entry beside entry.
#[inline(always)]
pub(super) fn add<T: Real, const ROWS: usize>(
    pattern: &PathPattern,
    matrix: &mut [T],
    columns: &[usize],
    base: &[&[T]],
    weight: &BaseWeight<T, ROWS>,
) {
    let whole_path = columns.last().is_some_and(|&last| pattern.depth(last) + 1 == columns.len());
    for (place, &dof) in columns.iter().enumerate() {
        let target = &mut matrix[pattern.row[dof].clone()];
        let before = if whole_path { Before::All } else { Before::Some(pattern, &columns[..=place]) };
        match base {
            // A contact with friction: one load and store for three products.
            [a, b, c] => {
                let pulls = [pull(&weight[0], base, place), pull(&weight[1], base, place), pull(&weight[2], base, place)];
                add_three(target, &before, &pulls, a.iter().zip(*b).zip(*c));
            }
            _ => {
                for (row, values) in base.iter().enumerate() {
                    add_one(target, &before, pull(&weight[row], base, place), values);
                }
            }
        }
    }
}

/// A row of W times J, in one column.
#[inline(always)]
fn pull<T: Real, const ROWS: usize>(weights: &[T; ROWS], base: &[&[T]], place: usize) -> T {
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

/// Adds one base row times its pull. (A closure for what both loops do would be compiled for SSE2 and called.)
#[inline(always)]
fn add_one<T: Real>(target: &mut [T], before: &Before<'_>, pull: T, values: &[T]) {
    match before {
        Before::All => {
            for (entry, value) in target.iter_mut().zip(values) {
                T::apart();
                *entry += pull * *value;
            }
        }
        Before::Some(pattern, columns) => {
            for (&column, value) in columns.iter().zip(values) {
                T::apart();
                target[pattern.depth(column)] += pull * *value;
            }
        }
    }
}

/// Adds three base rows times their pulls.
#[inline(always)]
fn add_three<'a, T: Real>(
    target: &mut [T],
    before: &Before<'_>,
    [p, q, r]: &[T; 3],
    values: impl Iterator<Item = ((&'a T, &'a T), &'a T)>,
) {
    match before {
        Before::All => {
            for (entry, ((a, b), c)) in target.iter_mut().zip(values) {
                T::apart();
                *entry = *entry + *p * *a + *q * *b + *r * *c;
            }
        }
        Before::Some(pattern, columns) => {
            for (&column, ((a, b), c)) in columns.iter().zip(values) {
                T::apart();
                let entry = &mut target[pattern.depth(column)];
                *entry = *entry + *p * *a + *q * *b + *r * *c;
            }
        }
    }
}

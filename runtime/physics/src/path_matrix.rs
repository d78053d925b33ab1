//! The sparsity of a mass matrix with couplings: a tree again, but one in which what is coupled lies on one path.
//!
//! The mass matrix has the sparsity of the kinematic tree ([`tree_matrix`](crate::tree_matrix)). A constraint, or a muscle, adds entries between
//! all dofs that it couples. If they lie on one root path nothing changes; if they lie
//! on two chains, eliminating them hangs the deeper chain onto the other one: the elimination tree of the sum (J. W. H. Liu,
//! "The role of elimination trees in sparse factorization") is again a tree, with longer paths for some dofs. Padding every
//! row to its whole path in that tree keeps all kernels below unchanged and contiguous: a row's entries are a prefix of the
//! rows of its descendants.

use crate::tree_matrix::Layout;
use core::ops::Range;

/// The pattern: a tree over the dofs, parents before children.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PathPattern {
    /// Entries of every row among the values.
    pub row: Vec<Range<usize>>,
    /// Columns of all rows, ascending within a row, the diagonal last.
    pub column: Vec<usize>,
    /// Scratch of the elimination tree.
    ancestor: Vec<usize>,
    parent: Vec<usize>,
    edges: Vec<(usize, usize)>,
}

/// Stands for "no parent".
const NONE: usize = usize::MAX;

impl PathPattern {
    /// The tree with the given parents, its rows enlarged so that the dofs of each of `cliques` (ascending) lie on one path.
    pub fn rebuild<'a>(&mut self, parents: &[Option<usize>], cliques: impl Iterator<Item = &'a [usize]>) {
        let size = parents.len();
        self.edges.clear();
        self.edges.extend(parents.iter().enumerate().filter_map(|(dof, parent)| parent.map(|parent| (parent, dof))));
        for clique in cliques {
            // Neighbours suffice: each becomes an ancestor of the next, which makes the whole clique a path.
            self.edges.extend(clique.windows(2).map(|pair| (pair[0], pair[1])));
        }
        self.edges.sort_unstable_by(|a, b| b.cmp(a));
        self.ancestor.clear();
        self.ancestor.resize(size, NONE);
        self.parent.clear();
        self.parent.resize(size, NONE);
        for &(upper, lower) in &self.edges {
            // Climbs from the lower dof to the root of what is eliminated so far, shortening the path for later climbs.
            let mut dof = lower;
            while self.ancestor[dof] != NONE && self.ancestor[dof] != upper {
                dof = core::mem::replace(&mut self.ancestor[dof], upper);
            }
            if self.ancestor[dof] == NONE && dof != upper {
                self.ancestor[dof] = upper;
                self.parent[dof] = upper;
            }
        }
        self.lay_out(size);
    }

    fn lay_out(&mut self, size: usize) {
        self.row.clear();
        self.column.clear();
        for dof in 0..size {
            let start = self.column.len();
            if self.parent[dof] != NONE {
                self.column.extend_from_within(self.row[self.parent[dof]].clone());
            }
            self.column.push(dof);
            self.row.push(start..self.column.len());
        }
    }

    /// The pattern as the kernels want it.
    pub fn layout(&self) -> Layout<'_> {
        Layout { row: &self.row, column: &self.column }
    }

    /// Columns of a row, the diagonal last.
    pub fn columns(&self, dof: usize) -> &[usize] {
        &self.column[self.row[dof].clone()]
    }

    /// Number of proper ancestors of a dof: the place of its column in the rows of its descendants.
    #[inline]
    pub fn depth(&self, dof: usize) -> usize {
        self.row[dof].len() - 1
    }

    /// Factors in place.
    ///
    /// # Errors
    /// The first dof whose pivot is not positive and finite.
    #[inline(always)]
    pub(crate) fn factor(&self, values: &mut [f64]) -> Result<(), usize> {
        self.layout().factor(values);
        let invalid = |row: &Range<usize>| !(values[row.end - 1] > 0.0 && values[row.end - 1].is_finite());
        self.row.iter().position(invalid).map_or(Ok(()), Err)
    }

    /// Changes the factors of H into those of H + `weight` w w' where w is nonzero only on the path of `dof`: `vector` holds
    /// its entries in the order of that row and is overwritten. (P. Gill and others, "Methods for modifying matrix
    /// factorizations", method C1, from the leaves.)
    ///
    /// # Errors
    /// The dof whose pivot is not positive and finite.
    #[inline(always)]
    pub(crate) fn update(&self, factor: &mut [f64], dof: usize, vector: &mut [f64], mut weight: f64) -> Result<(), usize> {
        for (place, &row) in self.columns(dof).iter().enumerate().rev() {
            let first = vector[place];
            if first == 0.0 {
                continue;
            }
            let entries = &mut factor[self.row[row].clone()];
            let (above, diagonal) = entries.split_at_mut(place);
            let old = diagonal[0];
            let new = old + weight * first * first;
            if !(new > 0.0 && new.is_finite()) {
                return Err(row);
            }
            let change = weight * first / new;
            weight *= old / new;
            diagonal[0] = new;
            for (entry, value) in above.iter_mut().zip(&mut vector[..place]) {
                *value -= first * *entry;
                *entry += change * *value;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A random tree, cliques across it, and a positive matrix with the entries that both need.
    fn dense(pattern: &PathPattern, values: &[f64]) -> Vec<Vec<f64>> {
        let mut full = vec![vec![0.0; pattern.row.len()]; pattern.row.len()];
        for row in 0..pattern.row.len() {
            for (place, &column) in pattern.columns(row).iter().enumerate() {
                full[row][column] = values[pattern.row[row].start + place];
                full[column][row] = full[row][column];
            }
        }
        full
    }

    fn residual(full: &[Vec<f64>], x: &[f64], right: &[f64]) -> f64 {
        let row = |i: usize| full[i].iter().zip(x).map(|(a, b)| a * b).sum::<f64>() - right[i];
        (0..x.len()).map(|i| row(i).abs()).fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn factor_solves_and_update_equals_refactoring(
            choices in prop::collection::vec((0usize..1000, -1.0f64..1.0), 2..24),
            ends in prop::collection::vec((0usize..1000, 0usize..1000), 0..3),
            weight in 0.01f64..10.0,
        ) {
            let size = choices.len();
            let parents: Vec<Option<usize>> = choices.iter().enumerate().map(|(i, (p, _))| if i == 0 || p % 5 == 0 { None } else { Some(p % i) }).collect();
            let cliques: Vec<Vec<usize>> = ends.iter().map(|&(a, b)| { let mut c = vec![a % size, b % size]; c.sort_unstable(); c.dedup(); c }).collect();
            let mut pattern = PathPattern::default();
            pattern.rebuild(&parents, cliques.iter().map(Vec::as_slice));
            for clique in &cliques {
                let path = pattern.columns(*clique.last().unwrap());
                prop_assert!(clique.iter().all(|dof| path.contains(dof)));
            }
            let mut values = vec![0.0; pattern.column.len()];
            for row in 0..size {
                for place in 0..pattern.depth(row) {
                    values[pattern.row[row].start + place] = choices[(row + place) % size].1;
                }
                values[pattern.row[row].start + pattern.depth(row)] = size as f64 + 1.0;
            }
            let right: Vec<f64> = choices.iter().map(|c| c.1).collect();
            let mut factor = values.clone();
            prop_assert!(pattern.factor(&mut factor).is_ok());
            let mut x = right.clone();
            pattern.layout().solve(&factor, &mut x);
            prop_assert!(residual(&dense(&pattern, &values), &x, &right) < 1e-10);

            let last = size - 1;
            let vector: Vec<f64> = (0..=pattern.depth(last)).map(|i| choices[i % size].1).collect();
            prop_assert!(pattern.update(&mut factor, last, &mut vector.clone(), weight).is_ok());
            let mut changed = values.clone();
            for (i, &row) in pattern.columns(last).iter().enumerate() {
                for j in 0..=i {
                    changed[pattern.row[row].start + j] += weight * vector[i] * vector[j];
                }
            }
            let mut x = right.clone();
            pattern.layout().solve(&factor, &mut x);
            prop_assert!(residual(&dense(&pattern, &changed), &x, &right) < 1e-8);
        }
    }
}

//! The Hessian M + J'WJ of the active set: assembled and factored on its pattern, brought up to date, mended where
//! rounding has spoilt it.

use super::{
    Newton, Parts,
    outer::{self, BaseWeight},
    together::{factor_limit, update_cost},
};
use crate::{
    constraint::{
        cone::Zone,
        jacobian::{Block, Jacobian, MOST_BASE_ROWS, Shape},
    },
    model::Model,
    path_matrix::PathPattern,
};

/// Multiples of the Hessian's diagonal that are added where it fails: the first, the factor between two, and the last.
const DAMPING: [f64; 3] = [1e-12, 1e3, 1e6];

impl Newton {
    /// Raises the multiple of its diagonal that is added to the Hessian; whether there is a higher one.
    pub(super) fn damp(&mut self) -> bool {
        let [first, growth, last] = DAMPING;
        self.damping = if self.damping == 0.0 { first } else { self.damping * growth };
        self.damping <= last
    }

    /// Factors M + J'DJ of the rows of the active set, with as much of its diagonal added as that takes.
    #[inline(always)]
    pub(super) fn factor_all(&mut self, model: &Model, mass: &[f64], parts: &Parts<'_>) -> Result<(), usize> {
        loop {
            self.assemble(model, mass, parts);
            match self.pattern.factor(&mut self.factor) {
                Ok(()) => return Ok(()),
                Err(dof) if !self.damp() => return Err(dof),
                Err(_) => {}
            }
        }
    }

    /// Writes M + J'DJ of the rows of the active set over the factor.
    #[inline(always)]
    fn assemble(&mut self, model: &Model, mass: &[f64], parts: &Parts<'_>) {
        let Self { pattern, factor, active, .. } = self;
        for dof in 0..model.nv {
            let entries = &mass[model.dofs.row[dof].clone()];
            let row = &mut factor[pattern.row[dof].clone()];
            if row.len() == entries.len() {
                row.copy_from_slice(entries);
            } else {
                row.fill(0.0);
                for (entry, &column) in entries.iter().zip(&model.dofs.column[model.dofs.row[dof].clone()]) {
                    row[pattern.depth(column)] = *entry;
                }
            }
        }
        let Parts { jacobian, rows, cones } = parts;
        for block in &jacobian.blocks {
            if active[block.rows.clone()].iter().any(|weight| *weight != 0.0) {
                add_block(pattern, factor, jacobian, block, &jacobian.base_weight(block, active));
            } else if let Shape::Cone(cone) = block.shape
                && cones[cone].zone(&self.residual) == Zone::Sliding
            {
                add_block(pattern, factor, jacobian, block, &cones[cone].curvature(&self.residual, &rows.weight));
            }
        }
        if self.damping > 0.0 {
            for row in &pattern.row {
                factor[row.end - 1] *= 1.0 + self.damping;
            }
        }
        self.factored.clone_from(&self.active);
        self.sliding[1] = self.sliding[0];
    }

    /// Brings the factor up to date with the rows that entered or left the active set.
    #[inline(always)]
    pub(super) fn refresh_factor(&mut self, model: &Model, mass: &[f64], parts: &Parts<'_>) -> Result<(), usize> {
        if self.sliding != [false; 2] || self.damping > 0.0 {
            return self.factor_all(model, mass, parts);
        }
        let jacobian = &parts.jacobian;
        let last_dof = |row: usize| jacobian.columns_of(jacobian.block_of(row)).last().copied().unwrap_or(0);
        let update = |row: usize| update_cost(model, jacobian.columns_of(jacobian.block_of(row)));
        let changes = self.factored.iter().zip(&self.active).enumerate().filter(|(_, (before, now))| before != now);
        let cost: f64 = changes.map(|(row, _)| update(row)).sum();
        if cost > factor_limit(model) {
            return self.factor_all(model, mass, parts);
        }
        for row in 0..self.active.len() {
            if self.factored[row] == self.active[row] {
                continue;
            }
            let dof = last_dof(row);
            let vector = &mut self.vector[..=self.pattern.depth(dof)];
            vector.fill(0.0);
            for (column, value) in jacobian.row_values(jacobian.block_of(row), row) {
                vector[self.pattern.depth(column)] = value;
            }
            let change = self.active[row] - self.factored[row];
            if self.pattern.update(&mut self.factor, dof, vector, change).is_err() {
                // Cancellation in a down-date; a fresh factorisation is exact.
                return self.factor_all(model, mass, parts);
            }
        }
        self.factored.clone_from(&self.active);
        Ok(())
    }
}

/// Adds a block's J'WJ to the matrix, with the weight W of its base rows.
#[inline(always)]
fn add_block(
    pattern: &PathPattern,
    matrix: &mut [f64],
    jacobian: &Jacobian,
    block: &Block,
    weight: &BaseWeight<f64, MOST_BASE_ROWS>,
) {
    let base: [&[f64]; MOST_BASE_ROWS] =
        core::array::from_fn(|row| if row < block.dimension { jacobian.base_row(block, row) } else { &[] });
    outer::add(pattern, matrix, jacobian.columns_of(block), &base[..block.dimension], weight);
}

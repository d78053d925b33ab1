//! The constraint Jacobian in blocks.
//!
//! A block is one constraint: a few base rows over the dofs that move it. Equalities, friction losses, limits and contacts with
//! elliptic cones have their base rows for constraint rows. A contact's base rows are the velocities along and about its frame's axes, and the edges of its
//! friction pyramid are combinations of them (J_normal ± μ J_tangent), so products need half the work of the full rows and
//! the Hessian takes a small dense weight per contact, as that of an elliptic cone does.

use core::ops::Range;

/// Largest number of base rows: force and torque in a contact frame.
pub(crate) const MOST_BASE_ROWS: usize = 6;

/// How constraint rows follow from base rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    /// They are the base rows, each with its own law.
    Plain,
    /// They are the edges of a friction pyramid.
    Pyramid,
    /// They are the base rows, under the common law of this elliptic cone.
    Cone(usize),
}

/// One constraint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Block {
    /// Its constraint rows.
    pub rows: Range<usize>,
    /// Its columns in [`Jacobian::columns`].
    pub columns: Range<usize>,
    /// Start of its base rows in [`Jacobian::values`], row after row.
    values: usize,
    /// Number of base rows.
    pub dimension: usize,
    /// What they make.
    pub shape: Shape,
    /// Friction coefficients of a pyramid: of each base row but the first.
    pub friction: [f64; 5],
    /// Whether it is an upper limit: a joint or tendon may have a lower one, too.
    pub upper: bool,
}

/// All blocks, in the order of their rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Jacobian {
    /// The constraints.
    pub blocks: Vec<Block>,
    /// Dofs of all blocks, ascending within each.
    pub columns: Vec<usize>,
    values: Vec<f64>,
    rows: usize,
}

impl Jacobian {
    /// Forgets all blocks.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.columns.clear();
        self.values.clear();
        self.rows = 0;
    }

    /// Appends a constraint with one row, given as (dof, coefficient) in any order.
    pub fn push_row(&mut self, entries: &mut [(usize, f64)]) {
        entries.sort_unstable_by_key(|(dof, _)| *dof);
        let (columns, values) = (self.columns.len(), self.values.len());
        self.columns.extend(entries.iter().map(|(dof, _)| *dof));
        self.values.extend(entries.iter().map(|(_, value)| *value));
        self.push_block(columns, values, 1, Shape::Plain, [0.0; 5]);
    }

    /// Appends a constraint with one row over `columns`, ascending.
    pub fn push_over(&mut self, columns: &[usize], entry: impl Fn(usize) -> f64) {
        let (start, values) = (self.columns.len(), self.values.len());
        self.columns.extend_from_slice(columns);
        self.values.extend(columns.iter().map(|&dof| entry(dof)));
        self.push_block(start, values, 1, Shape::Plain, [0.0; 5]);
    }

    /// Appends a constraint with `dimension` base rows over `columns`; `base` gives the entries of all of them in one column.
    pub fn push_rows(
        &mut self,
        columns: &[usize],
        dimension: usize,
        shape: Shape,
        friction: [f64; 5],
        base: impl Fn(usize) -> [f64; MOST_BASE_ROWS],
    ) {
        let (start, values) = (self.columns.len(), self.values.len());
        self.columns.extend_from_slice(columns);
        self.values.resize(values + dimension * columns.len(), 0.0);
        for index in 0..columns.len() {
            for (row, value) in base(index)[..dimension].iter().enumerate() {
                self.values[values + row * columns.len() + index] = *value;
            }
        }
        self.push_block(start, values, dimension, shape, friction);
    }

    /// Notes that the last constraint is an upper limit.
    pub fn mark_upper(&mut self) {
        if let Some(block) = self.blocks.last_mut() {
            block.upper = true;
        }
    }

    fn push_block(&mut self, columns: usize, values: usize, dimension: usize, shape: Shape, friction: [f64; 5]) {
        let rows = if shape == Shape::Pyramid { 2 * (dimension - 1) } else { dimension };
        self.blocks.push(Block {
            rows: self.rows..self.rows + rows,
            columns: columns..self.columns.len(),
            values,
            dimension,
            shape,
            friction,
            upper: false,
        });
        self.rows += rows;
    }

    /// The dofs of a block.
    #[inline]
    pub fn columns_of(&self, block: &Block) -> &[usize] {
        &self.columns[block.columns.clone()]
    }

    /// Base row `row` of a block.
    #[inline]
    pub fn base_row(&self, block: &Block, row: usize) -> &[f64] {
        let width = block.columns.len();
        &self.values[block.values + row * width..][..width]
    }

    /// out = J x.
    #[inline(always)]
    pub fn multiply(&self, x: &[f64], out: &mut [f64]) {
        for block in &self.blocks {
            let columns = self.columns_of(block);
            let along =
                |row: usize| self.base_row(block, row).iter().zip(columns).map(|(value, &dof)| value * x[dof]).sum::<f64>();
            let rows = &mut out[block.rows.clone()];
            if block.shape != Shape::Pyramid {
                rows.iter_mut().enumerate().for_each(|(row, value)| *value = along(row));
                continue;
            }
            let normal = along(0);
            for (index, edges) in rows.chunks_exact_mut(2).enumerate() {
                let tangent = block.friction[index] * along(index + 1);
                edges[0] = normal + tangent;
                edges[1] = normal - tangent;
            }
        }
    }

    /// Force of a block along its base rows, given the forces of all rows.
    #[inline(always)]
    pub fn base_force(&self, block: &Block, forces: &[f64]) -> [f64; MOST_BASE_ROWS] {
        let rows = &forces[block.rows.clone()];
        let mut base = [0.0; MOST_BASE_ROWS];
        if block.shape != Shape::Pyramid {
            base[..block.dimension].copy_from_slice(rows);
        } else {
            for (index, edges) in rows.chunks_exact(2).enumerate() {
                base[0] += edges[0] + edges[1];
                base[index + 1] = block.friction[index] * (edges[0] - edges[1]);
            }
        }
        base
    }

    /// out += J' forces.
    #[inline(always)]
    pub fn add_transposed(&self, forces: &[f64], out: &mut [f64]) {
        for block in &self.blocks {
            let base = self.base_force(block, forces);
            for (row, &force) in base[..block.dimension].iter().enumerate().filter(|(_, force)| **force != 0.0) {
                for (value, &dof) in self.base_row(block, row).iter().zip(self.columns_of(block)) {
                    out[dof] += value * force;
                }
            }
        }
    }

    /// Second derivative of the cost along a block's base rows, given that of each row: E diag(weights) E' for the pyramid's
    /// edges E. Where an elliptic contact slides, its cone has the answer.
    #[inline]
    pub fn base_weight(&self, block: &Block, weights: &[f64]) -> [[f64; MOST_BASE_ROWS]; MOST_BASE_ROWS] {
        let rows = &weights[block.rows.clone()];
        let mut base = [[0.0; MOST_BASE_ROWS]; MOST_BASE_ROWS];
        if block.shape != Shape::Pyramid {
            rows.iter().enumerate().for_each(|(row, weight)| base[row][row] = *weight);
        } else {
            for (index, edges) in rows.chunks_exact(2).enumerate() {
                let friction = block.friction[index];
                base[0][0] += edges[0] + edges[1];
                base[0][index + 1] = friction * (edges[0] - edges[1]);
                base[index + 1][0] = base[0][index + 1];
                base[index + 1][index + 1] = friction * friction * (edges[0] + edges[1]);
            }
        }
        base
    }

    /// Entries of one constraint row: (dof, value) over its block's columns.
    pub fn row_values(&self, block: &Block, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let local = row - block.rows.start;
        let (first, tangent, factor) = match block.shape {
            Shape::Pyramid => (0, 1 + local / 2, block.friction[local / 2] * if local.is_multiple_of(2) { 1.0 } else { -1.0 }),
            Shape::Plain | Shape::Cone(_) => (local, local, 0.0),
        };
        let pairs = self.base_row(block, first).iter().zip(self.base_row(block, tangent));
        self.columns_of(block).iter().copied().zip(pairs.map(move |(normal, tangent)| normal + factor * tangent))
    }

    /// The block that holds a row.
    #[inline]
    pub fn block_of(&self, row: usize) -> &Block {
        &self.blocks[self.blocks.partition_point(|block| block.rows.end <= row)]
    }
}

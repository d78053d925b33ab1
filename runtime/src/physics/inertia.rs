//! Inertia: composite rigid bodies, the mass matrix on the tree's own sparsity, and its factor.
//!
//! The mass matrix is kept as the rows of its lower triangle ([`Dofs::row`](crate::model::Dofs::row),
//! [`Dofs::column`](crate::model::Dofs::column)). Row i holds one entry for every dof on the path from the root to i, so the
//! row of an ancestor is a prefix of the rows of its descendants, and M = L'DL has no entry outside this pattern
//! (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.5).

use super::{
    kinematics::Kinematics,
    spatial::{Spatial, SpatialInertia, constant, pair},
};
use crate::{model::Model, scalar::Real};

/// The mass matrix and what it is made of.
#[derive(Debug, Clone)]
pub struct Inertia<T: Real> {
    /// Inertia of each body about the centre of mass of its tree (`cinert`).
    pub body: Vec<SpatialInertia<T>>,
    /// Inertia of each body and all its descendants (`crb`).
    pub composite: Vec<SpatialInertia<T>>,
    /// Mass matrix, sparse lower triangle in the layout of the model's dofs (`qM`): kg, kg m, kg m².
    pub matrix: Vec<T>,
    /// Factor M = L'DL in the same layout: L below the diagonal, D on it (`qLD`).
    pub factor: Vec<T>,
}

impl<T: Real> Inertia<T> {
    /// Memory for `model`.
    pub fn new(model: &Model) -> Self {
        let bodies = model.bodies.parent.len();
        let entries = model.dofs.column.len();
        Self {
            body: vec![SpatialInertia::zero(); bodies],
            composite: vec![SpatialInertia::zero(); bodies],
            matrix: vec![T::splat(0.0); entries],
            factor: vec![T::splat(0.0); entries],
        }
    }
}

/// Fills body inertias, composite inertias, the mass matrix and its factor.
pub fn update<T: Real>(model: &Model, kinematics: &Kinematics<T>, out: &mut Inertia<T>) {
    body_inertias(model, kinematics, out);
    mass_matrix(model, kinematics, out);
    out.factor.copy_from_slice(&out.matrix);
    factor(model, &mut out.factor);
}

fn body_inertias<T: Real>(model: &Model, kinematics: &Kinematics<T>, out: &mut Inertia<T>) {
    for body in 1..model.bodies.parent.len() {
        let offset = kinematics.inertial_position[body] - kinematics.reference(model, body);
        out.body[body] = SpatialInertia::of_body(
            T::splat(model.bodies.mass[body]),
            &constant(&model.bodies.inertia[body]),
            &kinematics.inertial_rotation[body],
            &offset,
        );
    }
}

/// The composite-rigid-body algorithm.
fn mass_matrix<T: Real>(model: &Model, kinematics: &Kinematics<T>, out: &mut Inertia<T>) {
    out.composite.copy_from_slice(&out.body);
    for body in (1..model.bodies.parent.len()).rev() {
        let parent = model.bodies.parent[body];
        if parent > 0 {
            let inertia = out.composite[body];
            out.composite[parent].add(&inertia);
        }
    }
    let mut momentum: Spatial<T>;
    for dof in 0..model.nv {
        let row = model.dofs.row[dof].clone();
        momentum = out.composite[model.dofs.body[dof]].momentum(&kinematics.dof_axis[dof]);
        let entries = &mut out.matrix[row.clone()];
        for (entry, &column) in entries.iter_mut().zip(&model.dofs.column[row]) {
            *entry = pair(&kinematics.dof_axis[column], &momentum);
        }
        if let Some(diagonal) = entries.last_mut() {
            *diagonal += T::splat(model.dofs.armature[dof]);
        }
    }
}

/// Factors in place a symmetric matrix with the mass matrix's sparsity: M = L'DL, L unit lower triangular.
///
/// `matrix` holds M's sparse lower triangle on entry, L below and D on the diagonal on return. A pivot that is not positive
/// (a massless dof without armature) shows as a non-finite acceleration.
pub fn factor<T: Real>(model: &Model, matrix: &mut [T]) {
    let dofs = &model.dofs;
    let mut dof = model.nv;
    while dof > 0 {
        dof -= 1;
        let row = dofs.row[dof].clone();
        // Rows of ancestors come before this one, and the parent's, if it is the one just before, is its prefix: such pairs
        // are eliminated together, which touches the rows of their common ancestors once instead of twice.
        let (above, rest) = matrix.split_at_mut(row.start);
        let (entries, pivot) = rest[..row.len()].split_at_mut(row.len() - 1);
        let inverse = T::splat(1.0) / pivot[0];
        if dof > 0 && dofs.parent[dof] == Some(dof - 1) {
            let parent = dofs.row[dof - 1].clone();
            let (above, rest) = above.split_at_mut(parent.start);
            let parent_row = &mut rest[..parent.len()];
            subtract(parent_row, entries, entries[entries.len() - 1] * inverse);
            let (parent_entries, parent_pivot) = parent_row.split_at_mut(parent.len() - 1);
            let parent_inverse = T::splat(1.0) / parent_pivot[0];
            for (index, &ancestor) in dofs.column[parent.start..parent.end - 1].iter().enumerate() {
                let weights = [entries[index] * inverse, parent_entries[index] * parent_inverse];
                let start = dofs.row[ancestor].start;
                subtract_both(&mut above[start..=start + index], entries, parent_entries, weights);
            }
            scale_row(parent_entries, parent_inverse);
            dof -= 1;
        } else {
            for (index, &ancestor) in dofs.column[row.start..row.end - 1].iter().enumerate() {
                let start = dofs.row[ancestor].start;
                subtract(&mut above[start..=start + index], entries, entries[index] * inverse);
            }
        }
        scale_row(entries, inverse);
    }
}

#[inline(always)]
fn subtract<T: Real>(target: &mut [T], row: &[T], weight: T) {
    for (target, &entry) in target.iter_mut().zip(row) {
        *target -= weight * entry;
    }
}

#[inline(always)]
fn subtract_both<T: Real>(target: &mut [T], first: &[T], second: &[T], weights: [T; 2]) {
    for ((target, &first), &second) in target.iter_mut().zip(first).zip(second) {
        *target -= weights[0] * first + weights[1] * second;
    }
}

#[inline(always)]
fn scale_row<T: Real>(row: &mut [T], factor: T) {
    for entry in row {
        *entry *= factor;
    }
}

/// Solves M x = b in place, given [`factor`]'s result.
pub fn solve<T: Real>(model: &Model, factor: &[T], x: &mut [T]) {
    solve_transposed(model, factor, x);
    for dof in 0..model.nv {
        x[dof] /= factor[model.dofs.row[dof].end - 1];
    }
    solve_lower(model, factor, x);
}

/// x <- L'^-1 x, for L of [`factor`].
pub fn solve_transposed<T: Real>(model: &Model, factor: &[T], x: &mut [T]) {
    for dof in (0..model.nv).rev() {
        let row = model.dofs.row[dof].clone();
        let below = row.start..row.end - 1;
        let value = x[dof];
        for (&entry, &column) in factor[below.clone()].iter().zip(&model.dofs.column[below]) {
            x[column] -= entry * value;
        }
    }
}

/// x <- L^-1 x, for L of [`factor`].
pub fn solve_lower<T: Real>(model: &Model, factor: &[T], x: &mut [T]) {
    for dof in 0..model.nv {
        let row = model.dofs.row[dof].clone();
        let below = row.start..row.end - 1;
        let mut value = x[dof];
        for (&entry, &column) in factor[below.clone()].iter().zip(&model.dofs.column[below]) {
            value -= entry * x[column];
        }
        x[dof] = value;
    }
}

/// y = M x for a symmetric matrix in the mass matrix's layout.
pub fn multiply<T: Real>(model: &Model, matrix: &[T], x: &[T], y: &mut [T]) {
    y.fill(T::splat(0.0));
    for dof in 0..model.nv {
        let row = model.dofs.row[dof].clone();
        let below = row.start..row.end - 1;
        let mut sum = matrix[row.end - 1] * x[dof];
        for (&entry, &column) in matrix[below.clone()].iter().zip(&model.dofs.column[below]) {
            sum += entry * x[column];
            y[column] += entry * x[dof];
        }
        y[dof] += sum;
    }
}

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
    for dof in (0..model.nv).rev() {
        let row = model.dofs.row[dof].clone();
        let last = row.len() - 1;
        // The rows of ancestors come before this one.
        let (ancestors, rest) = matrix.split_at_mut(row.start);
        let (entries, diagonal) = rest[..=last].split_at_mut(last);
        let inverse = T::splat(1.0) / diagonal[0];
        let columns = &model.dofs.column[row.start..row.start + last];
        for (index, &ancestor) in columns.iter().enumerate() {
            let weight = entries[index] * inverse;
            let start = model.dofs.row[ancestor].start;
            for (target, &entry) in ancestors[start..=start + index].iter_mut().zip(&entries[..=index]) {
                *target -= weight * entry;
            }
        }
        for entry in entries {
            *entry *= inverse;
        }
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

//! Inertia: composite rigid bodies, the mass matrix on the tree's own sparsity, and its factor.
//!
//! The mass matrix is kept as the rows of its lower triangle ([`Dofs::row`](crate::model::Dofs::row),
//! [`Dofs::column`](crate::model::Dofs::column)), in the layout of [`tree_matrix`](super::tree_matrix).

use super::{
    kinematics::Kinematics,
    spatial::{Spatial, SpatialInertia, pair, scale},
    state::State,
    tree_matrix::Layout,
};
use crate::{
    batch::one_lane,
    model::{Model, PathPoint},
    scalar::Real,
};
use std::sync::Arc;

/// The mass matrix and what it is made of.
#[derive(Debug, Clone)]
pub struct Inertia<T: Real> {
    /// Inertia of each body about the centre of mass of its tree (`cinert`).
    pub body: Vec<SpatialInertia<T>>,
    /// Inertia of each body and all its descendants (`crb`).
    pub composite: Vec<SpatialInertia<T>>,
    /// Mass matrix, sparse lower triangle in the layout of the model's dofs (`qM`): kg, kg m, kg m².
    pub matrix: Vec<T>,
    /// Factor M = L'DL in the same layout: L below the diagonal, D on it (`qLD`), once [`factorize`] has filled it.
    pub factor: Vec<T>,
    /// What the armature of tendons adds to entries of the mass matrix.
    armature: Arc<[(usize, f64)]>,
}

one_lane!(Inertia { body, composite, matrix; but factor, armature });

impl<T: Real> Inertia<T> {
    /// Memory for `model`.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &tendon_armature(model))
    }

    pub(crate) fn of(model: &Model, armature: &Arc<[(usize, f64)]>) -> Self {
        let bodies = model.bodies.parent.len();
        let entries = model.dofs.column.len();
        Self {
            body: vec![SpatialInertia::zero(); bodies],
            composite: vec![SpatialInertia::zero(); bodies],
            matrix: vec![T::splat(0.0); entries],
            factor: vec![T::splat(0.0); entries],
            armature: Arc::clone(armature),
        }
    }
}

/// Entries m J'J of all tendons with armature m. Such tendons are fixed (J is constant), their joints on one path to the root,
/// so that the later of two dofs has an entry for the earlier one in its row.
pub(crate) fn tendon_armature(model: &Model) -> Arc<[(usize, f64)]> {
    let tendons = &model.tendons;
    let mut entries = Vec::new();
    for tendon in (0..tendons.armature.len()).filter(|&tendon| tendons.armature[tendon] > 0.0) {
        let terms = || {
            tendons.path_points[tendons.path[tendon].clone()].iter().filter_map(|point| match point {
                PathPoint::Joint { joint, coefficient } => Some((model.joints.dof_address[*joint], *coefficient)),
                _ => None,
            })
        };
        for (later, first) in terms() {
            for (earlier, second) in terms().filter(|(earlier, _)| *earlier <= later) {
                let row = &model.dofs.row;
                let entry = row[later].start + row[earlier].len() - 1;
                entries.push((entry, tendons.armature[tendon] * first * second));
            }
        }
    }
    entries.into()
}

/// Fills body inertias, composite inertias and the mass matrix.
#[inline(always)]
pub fn update<T: Real>(model: &Model, state: &State<T>, kinematics: &Kinematics<T>, out: &mut Inertia<T>) {
    body_inertias(model, state, kinematics, out);
    mass_matrix(model, kinematics, out);
}

/// Fills the factor of the mass matrix.
#[inline(always)]
pub fn factorize<T: Real>(model: &Model, out: &mut Inertia<T>) {
    out.factor.copy_from_slice(&out.matrix);
    factor(model, &mut out.factor);
}

#[inline(always)]
fn body_inertias<T: Real>(model: &Model, state: &State<T>, kinematics: &Kinematics<T>, out: &mut Inertia<T>) {
    for body in 1..model.bodies.parent.len() {
        let offset = kinematics.inertial_position[body] - kinematics.reference(model, body);
        out.body[body] = SpatialInertia::of_body(
            kinematics.mass[body],
            &scale(&kinematics.overrides.moments(model, body), state.mass_scale[body]),
            &kinematics.inertial_rotation[body],
            &offset,
        );
    }
}

/// The composite-rigid-body algorithm.
#[inline(always)]
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
    for &(entry, armature) in out.armature.iter() {
        out.matrix[entry] += T::splat(armature);
    }
}

#[inline(always)]
fn layout(model: &Model) -> Layout<'_> {
    Layout { row: &model.dofs.row, column: &model.dofs.column }
}

/// Factors in place a symmetric matrix with the mass matrix's sparsity: M = L'DL, L unit lower triangular.
///
/// `matrix` holds M's sparse lower triangle on entry, L below and D on the diagonal on return. A pivot that is not positive
/// (a massless dof without armature) shows as a non-finite acceleration.
#[inline(always)]
pub fn factor<T: Real>(model: &Model, matrix: &mut [T]) {
    layout(model).factor(matrix);
}

/// Solves M x = b in place, given [`factor`]'s result.
#[inline(always)]
pub fn solve<T: Real>(model: &Model, factor: &[T], x: &mut [T]) {
    layout(model).solve(factor, x);
}

/// x <- L'^-1 x, for L of [`factor`].
pub fn solve_transposed<T: Real>(model: &Model, factor: &[T], x: &mut [T]) {
    layout(model).solve_transposed(factor, x);
}

/// x <- L^-1 x, for L of [`factor`].
pub fn solve_lower<T: Real>(model: &Model, factor: &[T], x: &mut [T]) {
    layout(model).solve_lower(factor, x);
}

/// y = M x for a symmetric matrix in the mass matrix's layout.
#[inline(always)]
pub fn multiply<T: Real>(model: &Model, matrix: &[T], x: &[T], y: &mut [T]) {
    layout(model).multiply(matrix, x, y);
}

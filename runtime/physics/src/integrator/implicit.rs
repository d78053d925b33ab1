//! Implicit in velocity, without Coriolis forces: (M + h B) a = force, where B holds the slopes over velocity of joint
//! dampers, tendon dampers, drag and actuators.
//!
//! B keeps the sparsity of the tree, as MuJoCo's does: what a tendon or actuator between two branches adds to pairs of dofs
//! on different branches is left out. A free body on which no joint hangs is decoupled from the rest; its gyroscopic forces
//! can make it gain energy, so their slope enters there, and its six equations are solved again, unsymmetric.

use super::{add_joint_damping, total_force};
use crate::{
    Workspace, actuation, inertia,
    model::{JointKind, Model},
    scalar::Real,
    spatial::{cross, dot, rotate_back, scale},
    state::State,
    tendons::moment_arms,
};
use nalgebra::Vector3;
use std::sync::Arc;

/// What the integrator keeps between steps: scratch memory, and the bodies that float alone.
#[derive(Debug, Clone)]
pub struct Implicit<T: Real> {
    /// Bodies with a free joint and no joint below.
    floating: Arc<[usize]>,
    /// The matrix on the six dofs of each of them, symmetric, lower triangle by rows.
    blocks: Vec<[T; 21]>,
    moment: Vec<T>,
}

impl<T: Real> Implicit<T> {
    /// Memory for `model`, whose floating bodies these are.
    pub(crate) fn of(model: &Model, floating: &Arc<[usize]>) -> Self {
        let floating = Arc::clone(floating);
        Self { blocks: vec![[T::splat(0.0); 21]; floating.len()], floating, moment: vec![T::splat(0.0); model.nv] }
    }
}

/// Bodies with a free joint and no joint below.
pub(crate) fn floating_bodies(model: &Model) -> Arc<[usize]> {
    let alone = |body: &usize| {
        let joints = model.bodies.joints[*body].clone();
        let free = joints.len() == 1 && model.joints.kind[joints.start] == JointKind::Free;
        let last = model.bodies.dofs[*body].clone().next_back();
        free && !model.dofs.parent.iter().any(|parent| parent.is_some() && *parent == last)
    };
    (1..model.bodies.parent.len()).filter(alone).collect()
}

/// Fills the damped acceleration.
#[inline(always)]
pub(super) fn acceleration<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>) {
    let Some(mut scratch) = workspace.implicit.take() else { return };
    let mut matrix = core::mem::take(&mut workspace.inertia.factor);
    matrix.copy_from_slice(&workspace.inertia.matrix);
    add_joint_damping(model, state, &mut matrix);
    let step = T::splat(model.options.timestep);
    let Workspace { kinematics, tendons, velocities, actuation, forces, .. } = &*workspace;
    for (tendon, damping) in model.tendons.damping.iter().enumerate().filter(|(_, damping)| **damping != 0.0) {
        moment_arms(model, kinematics, tendons, tendon, &mut scratch.moment);
        add_outer(model, &scratch.moment, step * T::splat(*damping), &mut matrix);
    }
    let mut add = |moment: &[T], slope: T| add_outer(model, moment, -step * slope, &mut matrix);
    forces.medium.each_slope(model, kinematics, velocities, &mut scratch.moment, &mut add);
    actuation::each_slope(model, state, kinematics, tendons, actuation, &forces.actuator, &mut scratch.moment, add);
    for (&body, block) in scratch.floating.iter().zip(&mut scratch.blocks) {
        let first = model.dofs.row[model.bodies.dofs[body].start].start;
        block.copy_from_slice(&matrix[first..first + 21]);
    }
    inertia::factor(model, &mut matrix);
    total_force(workspace);
    for (&body, block) in scratch.floating.iter().zip(&scratch.blocks) {
        let first = model.bodies.dofs[body].start;
        let solution = float(model, workspace, body, block);
        scratch.moment[first..first + 6].copy_from_slice(&solution);
    }
    inertia::solve(model, &matrix, &mut workspace.damped_acceleration);
    for &body in scratch.floating.iter() {
        let dofs = model.bodies.dofs[body].clone();
        workspace.damped_acceleration[dofs.clone()].copy_from_slice(&scratch.moment[dofs]);
    }
    workspace.inertia.factor = matrix;
    workspace.implicit = Some(scratch);
}

/// matrix += weight times moment moment', where the matrix has entries.
#[inline(always)]
fn add_outer<T: Real>(model: &Model, moment: &[T], weight: T, matrix: &mut [T]) {
    let zero = T::splat(0.0);
    for (&entry, row) in moment.iter().zip(&model.dofs.row).filter(|(entry, _)| **entry != zero) {
        for (slot, &column) in matrix[row.clone()].iter_mut().zip(&model.dofs.column[row.clone()]) {
            *slot += weight * entry * moment[column];
        }
    }
}

/// The acceleration of a body that floats alone: (block + h dc/dv) a = force, with c its Coriolis and centrifugal forces.
///
/// With w the angular velocity, r the arm from the body's origin to its centre of mass, I its inertia about the origin and m
/// its mass, c is m w x (w x r) on the translations and w x I w on the rotations, which turn in the body's own axes.
#[inline(always)]
fn float<T: Real>(model: &Model, workspace: &Workspace<T>, body: usize, block: &[T; 21]) -> [T; 6] {
    let kinematics = &workspace.kinematics;
    let axes = kinematics.body_rotation[body];
    let spin = workspace.velocities.body[body][0];
    let arm = kinematics.subtree_com[body] - kinematics.body_position[body];
    let mass = kinematics.subtree_mass[body];
    let central = &workspace.inertia.composite[body];
    let inertia = |v: &Vector3<T>| {
        let [xx, yy, zz, xy, xz, yz] = central.rotational;
        let own = Vector3::new(xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z);
        own + scale(&(scale(v, dot(&arm, &arm)) - scale(&arm, dot(&arm, v))), mass)
    };
    let mut matrix = [[T::splat(0.0); 7]; 6];
    let places = (0..6).flat_map(|row| (0..=row).map(move |column| (row, column)));
    for ((row, column), &entry) in places.zip(block) {
        matrix[row][column] = entry;
        matrix[column][row] = entry;
    }
    let step = T::splat(model.options.timestep);
    let momentum = inertia(&spin);
    for axis in 0..3 {
        let e = axes.column(axis).into_owned();
        let push = scale(&e, dot(&spin, &arm)) + scale(&spin, dot(&arm, &e)) - scale(&arm, dot(&spin, &e) + dot(&spin, &e));
        let turn = rotate_back(&axes, &(cross(&e, &momentum) + cross(&spin, &inertia(&e))));
        for row in 0..3 {
            matrix[row][3 + axis] += step * mass * push[row];
            matrix[3 + row][3 + axis] += step * turn[row];
        }
    }
    let first = model.bodies.dofs[body].start;
    for (row, force) in matrix.iter_mut().zip(&workspace.damped_acceleration[first..]) {
        row[6] = *force;
    }
    solve(matrix)
}

/// Gaussian elimination of six equations; the block is positive definite but for a small part, so the pivots stay in place.
#[inline(always)]
fn solve<T: Real>(mut matrix: [[T; 7]; 6]) -> [T; 6] {
    for pivot in 0..6 {
        let above = matrix[pivot];
        let inverse = T::splat(1.0) / above[pivot];
        for row in &mut matrix[pivot + 1..] {
            let weight = row[pivot] * inverse;
            for (value, &entry) in row.iter_mut().zip(&above) {
                *value -= weight * entry;
            }
        }
    }
    let mut solution = [T::splat(0.0); 6];
    for row in (0..6).rev() {
        let mut value = matrix[row][6];
        for column in row + 1..6 {
            value -= matrix[row][column] * solution[column];
        }
        solution[row] = value / matrix[row][row];
    }
    solution
}

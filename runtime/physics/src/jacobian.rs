//! Jacobians of points, on request: sensors and controllers use them, the step does not.

use super::{
    inertia::Inertia,
    kinematics::Kinematics,
    spatial::{cross, scale, zero},
};
use crate::{model::Model, scalar::Real};
use nalgebra::Vector3;

/// How the point of `body` that is now at `point` (world, m) moves with every dof: one world vector per dof, m per unit of
/// the dof in `translation`, and the body's rotation, rad per unit, in `rotation`.
pub fn point_jacobian<T: Real>(
    model: &Model,
    kinematics: &Kinematics<T>,
    body: usize,
    point: &Vector3<T>,
    translation: &mut [Vector3<T>],
    rotation: &mut [Vector3<T>],
) {
    translation.fill(zero());
    rotation.fill(zero());
    let arm = point - kinematics.reference(model, body);
    let mut dof = last_dof(model, body);
    while let Some(index) = dof {
        let [angular, linear] = kinematics.dof_axis[index];
        translation[index] = linear + cross(&angular, &arm);
        rotation[index] = angular;
        dof = model.dofs.parent[index];
    }
}

/// How the common centre of mass of `body` and all its descendants moves with every dof, m per unit of the dof.
pub fn center_of_mass_jacobian<T: Real>(
    model: &Model,
    kinematics: &Kinematics<T>,
    inertia: &Inertia<T>,
    body: usize,
    translation: &mut [Vector3<T>],
) {
    let (mut above, mut rotation) = (vec![zero(); model.nv], vec![zero(); model.nv]);
    // Dofs above the body carry its centre of mass like a point of the body; those below move only a part of its mass.
    point_jacobian(model, kinematics, body, &kinematics.subtree_com[body], &mut above, &mut rotation);
    let total = kinematics.subtree_mass[body].at_least(T::splat(super::rotation::MINIMUM));
    for dof in 0..model.nv {
        let moved = model.dofs.body[dof];
        translation[dof] = if moved != body && is_below(model, moved, body) {
            scale(&inertia.composite[moved].momentum(&kinematics.dof_axis[dof])[1], T::splat(1.0) / total)
        } else {
            above[dof]
        };
    }
}

/// The last of the dofs that move `body`: the deepest on its way to the root.
pub(super) fn last_dof(model: &Model, mut body: usize) -> Option<usize> {
    while body > 0 {
        if let Some(dof) = model.bodies.dofs[body].clone().next_back() {
            return Some(dof);
        }
        body = model.bodies.parent[body];
    }
    None
}

/// The dofs that move a body, from the root on.
pub fn moving_dofs(model: &Model, body: usize) -> &[usize] {
    last_dof(model, body).map_or(&[], |dof| &model.dofs.column[model.dofs.row[dof].clone()])
}

fn is_below(model: &Model, mut body: usize, ancestor: usize) -> bool {
    while body > ancestor {
        body = model.bodies.parent[body];
    }
    body == ancestor
}

//! Body velocities and the rates of the motion axes.

use super::{
    kinematics::Kinematics,
    spatial::{Spatial, add_scaled, cross, cross_motion, spatial_zero},
    state::State,
};
use crate::{
    batch::one_lane,
    model::{JointKind, Model},
    scalar::Real,
};

/// Velocities in world axes about the centre of mass of each kinematic tree: rad/s and m/s.
#[derive(Debug, Clone)]
pub struct Velocities<T: Real> {
    /// Velocity of every body (`cvel`).
    pub body: Vec<Spatial<T>>,
    /// Rate of change of every dof's motion axis (`cdof_dot`).
    pub dof_axis_rate: Vec<Spatial<T>>,
}

one_lane!(Velocities { body, dof_axis_rate });

impl<T: Real> Velocities<T> {
    /// Memory for `model`.
    pub fn new(model: &Model) -> Self {
        Self { body: vec![spatial_zero(); model.bodies.parent.len()], dof_axis_rate: vec![spatial_zero(); model.nv] }
    }
}

/// Sweeps velocities from the root to the leaves.
#[inline(always)]
pub fn update<T: Real>(model: &Model, state: &State<T>, kinematics: &Kinematics<T>, out: &mut Velocities<T>) {
    for body in 1..model.bodies.parent.len() {
        let mut velocity = match kinematics.placed(body) {
            // Velocities are those of the point at the tree's centre of mass.
            Some(index) => {
                let [spin, linear] = state.mocap_velocity[index];
                let arm = kinematics.reference(model, body) - kinematics.body_position[body];
                [spin, linear + cross(&spin, &arm)]
            }
            None => out.body[model.bodies.parent[body]],
        };
        for joint in model.bodies.joints[body].clone() {
            let first = model.joints.dof_address[joint];
            match model.joints.kind[joint] {
                JointKind::Hinge | JointKind::Slide => {
                    carry(first..first + 1, state, kinematics, &mut velocity, &mut out.dof_axis_rate)
                }
                JointKind::Ball => carry(first..first + 3, state, kinematics, &mut velocity, &mut out.dof_axis_rate),
                JointKind::Free => {
                    for dof in first..first + 3 {
                        // Translation along fixed world axes.
                        add_scaled(&mut velocity, &kinematics.dof_axis[dof], state.velocity[dof]);
                    }
                    carry(first + 3..first + 6, state, kinematics, &mut velocity, &mut out.dof_axis_rate);
                }
            }
        }
        out.body[body] = velocity;
    }
}

/// Turns with the dofs of a hinge, slide or ball: all axes of one ball turn together, so their rates see the velocity before the
/// joint moves.
#[inline(always)]
fn carry<T: Real>(
    dofs: core::ops::Range<usize>,
    state: &State<T>,
    kinematics: &Kinematics<T>,
    velocity: &mut Spatial<T>,
    rates: &mut [Spatial<T>],
) {
    let before = *velocity;
    for dof in dofs {
        let axis = &kinematics.dof_axis[dof];
        rates[dof] = cross_motion(&before, axis);
        add_scaled(velocity, axis, state.velocity[dof]);
    }
}

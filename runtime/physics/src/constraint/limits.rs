//! Friction losses and limits of joints and tendons.

use super::{
    Constraints, CrossCoupling, Extent, RowKind,
    impedance::Spring,
    plan::Soft,
    rows::{ONE_WAY, Place},
};
use crate::{
    Workspace,
    model::{JointKind, Model},
    scalar::Real,
};
use nalgebra::Vector3;

impl Constraints {
    /// Dry friction of dofs: a force against the motion of up to the loss. It has no position, so it only damps.
    pub(super) fn add_dof_friction(&mut self, model: &Model) {
        for &Soft { element: dof, spring } in &self.fixed.friction_loss_dofs {
            self.jacobian.push_row(&mut [(dof, 1.0)]);
            let place = friction(spring, model.dofs.friction_loss[dof]);
            self.rows.push(RowKind::DofFriction(dof), place, model.dofs.inverse_weight[dof]);
        }
    }

    /// Dry friction of tendons.
    pub(super) fn add_tendon_friction<T: Real>(&mut self, model: &Model, workspace: &Workspace<T>, lane: usize) {
        for index in 0..self.fixed.rubbing_tendons.len() {
            let Soft { element: tendon, spring } = self.fixed.rubbing_tendons[index];
            if !self.push_tendon_row(model, workspace, lane, tendon, 1.0) {
                continue;
            }
            let place = friction(spring, model.tendons.friction_loss[tendon]);
            self.rows.push(RowKind::TendonFriction(tendon), place, model.tendons.inverse_weight[tendon]);
        }
    }

    /// Joint limits, the lower one first; a ball joint is limited in its rotation angle.
    pub(super) fn add_joint_limits(&mut self, model: &Model, extent: Extent, position: impl Fn(usize) -> f64) {
        let joints = &model.joints;
        for index in 0..self.fixed.limited_joints.len() {
            let Soft { element: joint, spring } = self.fixed.limited_joints[index];
            let Some([low, high]) = joints.range[joint] else { continue };
            let (address, dof) = (joints.position_address[joint], joints.dof_address[joint]);
            if joints.kind[joint] == JointKind::Ball {
                let (angle, axis) = turn(core::array::from_fn(|k| position(address + k)));
                let mut entries = [(dof, -axis.x), (dof + 1, -axis.y), (dof + 2, -axis.z)];
                self.add_joint_limit(model, joint, spring, low.at_least(high) - angle, &mut entries);
            } else if extent == Extent::All {
                let value = position(address);
                self.add_joint_limit(model, joint, spring, value - low, &mut [(dof, 1.0)]);
                if self.add_joint_limit(model, joint, spring, high - value, &mut [(dof, -1.0)]) {
                    self.jacobian.mark_upper();
                }
            }
        }
    }

    /// Whether the limit is near enough to have a row.
    fn add_joint_limit(
        &mut self,
        model: &Model,
        joint: usize,
        spring: Spring,
        distance: f64,
        entries: &mut [(usize, f64)],
    ) -> bool {
        let margin = model.joints.margin[joint];
        let near = distance < margin;
        if near {
            self.jacobian.push_row(entries);
            let weight = model.dofs.inverse_weight[model.joints.dof_address[joint]];
            self.rows.push(RowKind::JointLimit(joint), limit(spring, distance, margin), weight);
        }
        near
    }

    /// Tendon limits, the lower one first.
    pub(super) fn add_tendon_limits<T: Real>(&mut self, model: &Model, workspace: &Workspace<T>, lane: usize) {
        for index in 0..self.fixed.limited_tendons.len() {
            let Soft { element: tendon, spring } = self.fixed.limited_tendons[index];
            let Some([low, high]) = model.tendons.range[tendon] else { continue };
            let (length, margin) = (workspace.tendons.length[tendon].lane(lane), model.tendons.margin[tendon]);
            for (distance, sign) in [(length - low, 1.0), (high - length, -1.0)] {
                if distance < margin && self.push_tendon_row(model, workspace, lane, tendon, sign) {
                    if sign < 0.0 {
                        self.jacobian.mark_upper();
                    }
                    let place = limit(spring, distance, margin);
                    self.rows.push(RowKind::TendonLimit(tendon), place, model.tendons.inverse_weight[tendon]);
                }
            }
        }
    }

    /// Appends `sign` times a tendon's row to the Jacobian, and returns whether there is one: a tendon that nothing moves, with
    /// its ends on one body, is not constrained (nor is it in MuJoCo).
    fn push_tendon_row<T: Real>(
        &mut self,
        model: &Model,
        workspace: &Workspace<T>,
        lane: usize,
        tendon: usize,
        sign: f64,
    ) -> bool {
        self.gather_arms(model, workspace, lane, (tendon, sign), None);
        let columns = &self.fixed.tendons[tendon];
        // A path that may wrap around another body, but runs straight, cancels up to rounding.
        if self.fixed.columns_of(columns).iter().all(|&dof| self.arms[dof].abs() < 1e-14) {
            return false;
        }
        let coupling = CrossCoupling::Tendon(tendon);
        if columns.cross_couplings && !self.cross_couplings.contains(&coupling) {
            self.cross_couplings.push(coupling);
        }
        self.jacobian.push_over(self.fixed.columns_of(columns), |dof| self.arms[dof]);
        true
    }
}

fn friction(spring: Spring, loss: f64) -> Place {
    Place { position: 0.0, margin: 0.0, spring: spring.slack().at(0.0), bounds: [-loss, loss] }
}

fn limit(spring: Spring, distance: f64, margin: f64) -> Place {
    Place { position: distance, margin, spring: spring.at(distance - margin), bounds: ONE_WAY }
}

/// Angle in [0, π] and unit axis of a rotation.
fn turn([w, x, y, z]: [f64; 4]) -> (f64, Vector3<f64>) {
    let vector = Vector3::new(x, y, z) * if w < 0.0 { -1.0 } else { 1.0 };
    (2.0 * libm::atan2(vector.norm(), w.abs()), vector.try_normalize(1e-15).unwrap_or_else(Vector3::x))
}

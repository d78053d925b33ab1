//! Equalities: polynomial couplings of joints and of tendons, connections of points, welds of frames.
//!
//! A coupling has the residual y - y₀ - p(x - x₀). A connection has p₁ - p₂, the difference of two points in the world. A weld
//! adds the vector part of conj(Q₂) Q₁, where Q₁ and Q₂ are the world orientations of its two frames: the axis of the turn
//! between them times the sine of half its angle. Its rate is that of ½ conj(Q₂) (ω₁ - ω₂) Q₁, with the difference of the
//! bodies' angular velocities as a quaternion, which gives the rotational rows of the Jacobian. The residual's angular part is
//! weighted with a length, `torquescale`. The impedance of all rows of a connection or weld depends on the norm of its whole
//! residual. Without joint accelerations its residual still accelerates, because the Jacobian changes:
//!
//! ```text
//! points: a₁ - a₂,    turns: ½ conj(Q₂) (α₁ - α₂ + ½ (ω₁ - ω₂) ω₁ - ½ ω₂ (ω₁ - ω₂)) Q₁
//! ```
//!
//! with the bodies' accelerations a and α as they are then, and products of quaternions. (MuJoCo's manual, chapter Computation, "Constraint model, Equality".)

use super::{
    Constraints, CrossCoupling, Extent, RowKind,
    jacobian::{MOST_BASE_ROWS, Shape},
    rows::{BOTH_WAYS, Place},
};
use crate::{
    State, Workspace,
    model::{Attachment, Equality, Model, TendonCoupling},
    rotation::{conjugate, multiply},
    scalar::Real,
    spatial::{lane_of, matrix_of},
};
use nalgebra::Vector3;

/// Weight of a turn for a connection, which has none.
const NO_TURN: Option<f64> = None;

impl Constraints {
    /// All equalities that hold in the state.
    pub(super) fn add_equalities<T: Real>(
        &mut self,
        model: &Model,
        state: &State<T>,
        workspace: &Workspace<T>,
        lane: usize,
        extent: Extent,
    ) {
        for (equality, kind) in model.equalities.kind.iter().enumerate() {
            if state.active[equality].lane(lane) == 0.0 {
                continue;
            }
            match kind {
                Equality::Joint(_) if extent == Extent::Unshared => {}
                Equality::Joint(coupling) => {
                    self.add_joint_coupling(model, *coupling, |address| state.position[address].lane(lane));
                }
                Equality::Tendon(coupling) => self.add_tendon_coupling(model, workspace, lane, equality, coupling),
                Equality::Connect(attachment) => {
                    let attachment = held(attachment, state, equality, lane);
                    self.add_attachment(model, workspace, lane, equality, &attachment, NO_TURN);
                }
                Equality::Weld { attachment, torque_scale } => {
                    let attachment = held(attachment, state, equality, lane);
                    self.add_attachment(model, workspace, lane, equality, &attachment, Some(*torque_scale));
                }
            }
            let columns = &self.fixed.equalities[equality];
            if columns.cross_couplings {
                self.cross_couplings.push(CrossCoupling::Equality(equality));
            }
        }
    }

    fn add_joint_coupling(&mut self, model: &Model, coupling: usize, position: impl Fn(usize) -> f64) {
        let (joints, couplings) = (&model.joints, &model.couplings);
        let displacement = |joint: usize| {
            let address = joints.position_address[joint];
            position(address) - model.reference_position[address]
        };
        let dependent = couplings.joint[coupling];
        let dependent_dof = joints.dof_address[dependent];
        let mut approximate = model.dofs.inverse_weight[dependent_dof];
        let wanted = if let Some(leader) = couplings.leader[coupling] {
            let [wanted, slope] = polynomial(&couplings.polynomial[coupling], displacement(leader));
            let leader_dof = joints.dof_address[leader];
            self.jacobian.push_row(&mut [(dependent_dof, 1.0), (leader_dof, -slope)]);
            approximate += model.dofs.inverse_weight[leader_dof];
            wanted
        } else {
            self.jacobian.push_row(&mut [(dependent_dof, 1.0)]);
            couplings.polynomial[coupling][0]
        };
        let residual = displacement(dependent) - wanted;
        self.push_equality(couplings.equality[coupling], residual, residual, approximate);
    }

    fn add_tendon_coupling<T: Real>(
        &mut self,
        model: &Model,
        workspace: &Workspace<T>,
        lane: usize,
        equality: usize,
        coupling: &TendonCoupling,
    ) {
        let tendons = &model.tendons;
        let displacement = |tendon: usize| workspace.tendons.length[tendon].lane(lane) - tendons.reference_length[tendon];
        let mut approximate = tendons.inverse_weight[coupling.tendon];
        let (mut wanted, mut other) = (coupling.polynomial[0], None);
        if let Some(leader) = coupling.leader {
            let [value, slope] = polynomial(&coupling.polynomial, displacement(leader));
            (wanted, other) = (value, Some((leader, -slope)));
            approximate += tendons.inverse_weight[leader];
        }
        self.gather_arms(model, workspace, lane, (coupling.tendon, 1.0), other);
        let columns = self.fixed.columns_of(&self.fixed.equalities[equality]);
        self.jacobian.push_over(columns, |dof| self.arms[dof]);
        let residual = displacement(coupling.tendon) - wanted;
        self.push_equality(equality, residual, residual, approximate);
    }

    /// Three rows for the origins of two frames; with a weight for turns, three more for their axes.
    fn add_attachment<T: Real>(
        &mut self,
        model: &Model,
        workspace: &Workspace<T>,
        lane: usize,
        equality: usize,
        attachment: &Attachment,
        torque_scale: Option<f64>,
    ) {
        let kinematics = &workspace.kinematics;
        let bodies = attachment.bodies;
        let points: [Vector3<f64>; 2] = core::array::from_fn(|side| {
            let rotation = matrix_of(&kinematics.body_rotation[bodies[side]], lane);
            rotation * attachment.position[side] + lane_of(&kinematics.body_position[bodies[side]], lane)
        });
        let frames: [[f64; 4]; 2] = core::array::from_fn(|side| {
            let orientation = kinematics.body_orientation[bodies[side]].each_ref().map(|value| value.lane(lane));
            multiply(&orientation, &attachment.orientation[side])
        });
        let back = conjugate(&frames[1]);
        let scale = torque_scale.unwrap_or(0.0);
        let [_, x, y, z] = multiply(&back, &frames[0]);
        let gap = points[0] - points[1];
        let residual = [gap.x, gap.y, gap.z, scale * x, scale * y, scale * z];
        let dimension = if torque_scale.is_some() { 6 } else { 3 };

        let range = self.fixed.equalities[equality].range.clone();
        let (columns, moves) = (&self.fixed.columns[range.clone()], &self.fixed.moves[range]);
        let base = |column: usize| -> [f64; MOST_BASE_ROWS] {
            let dof = columns[column];
            let reference = lane_of(kinematics.reference(model, model.dofs.body[dof]), lane);
            let [angular, linear] = kinematics.dof_axis[dof].each_ref().map(|vector| lane_of(vector, lane));
            let [first, second] = moves[column];
            let at = |point: Vector3<f64>| linear + angular.cross(&(point - reference));
            let apart = at(points[0]) * first - at(points[1]) * second;
            let turn = angular * (0.5 * scale * (first - second));
            let [_, x, y, z] = multiply(&multiply(&back, &[0.0, turn.x, turn.y, turn.z]), &frames[0]);
            [apart.x, apart.y, apart.z, x, y, z]
        };
        self.jacobian.push_rows(columns, dimension, Shape::Plain, [0.0; 5], base);
        let violation = residual[..dimension].iter().map(|part| part * part).sum::<f64>().sqrt();
        for (row, part) in residual[..dimension].iter().enumerate() {
            let approximate = bodies.iter().map(|&body| model.bodies.inverse_weight[body][row / 3]).sum();
            self.push_equality(equality, *part, violation, approximate);
        }
    }

    /// Subtracts from the references of connections and welds the acceleration that their residual has anyway.
    pub(super) fn subtract_curvature<T: Real>(&mut self, model: &Model, state: &State<T>, workspace: &Workspace<T>, lane: usize) {
        // Equalities come first, and only blocks of several rows are attachments.
        for block in &self.jacobian.blocks {
            let RowKind::Equality(equality) = self.rows.kind[block.rows.start] else { break };
            let (Equality::Connect(attachment) | Equality::Weld { attachment, .. }) = &model.equalities.kind[equality] else {
                continue;
            };
            let attachment = &held(attachment, state, equality, lane);
            let [first, second] = [0, 1].map(|side| Motion::of(model, workspace, lane, attachment, side));
            let points = first.acceleration - second.acceleration;
            let reference = &mut self.rows.reference[block.rows.clone()];
            (0..3).for_each(|axis| reference[axis] -= points[axis]);
            if let Equality::Weld { torque_scale, .. } = &model.equalities.kind[equality] {
                let pure = |vector: Vector3<f64>| [0.0, vector.x, vector.y, vector.z];
                let [spin, other] = [pure(first.spin), pure(second.spin)];
                let between = pure(first.spin - second.spin);
                let (after, before) = (multiply(&between, &spin), multiply(&other, &between));
                let turning = pure(first.turning - second.turning);
                let sum = core::array::from_fn(|k| 0.5 * torque_scale * (turning[k] + 0.5 * (after[k] - before[k])));
                let rate = multiply(&multiply(&conjugate(&second.frame), &sum), &first.frame);
                (0..3).for_each(|axis| reference[3 + axis] -= rate[1 + axis]);
            }
        }
    }

    fn push_equality(&mut self, equality: usize, residual: f64, violation: f64, approximate: f64) {
        let spring = self.fixed.springs[equality].at(violation);
        let place = Place { position: residual, margin: 0.0, spring, bounds: BOTH_WAYS };
        self.rows.push(RowKind::Equality(equality), place, approximate);
    }
}

/// The attachment as the state has it.
fn held<T: Real>(attachment: &Attachment, state: &State<T>, equality: usize, lane: usize) -> Attachment {
    let (position, orientation) = &state.held[equality];
    Attachment {
        position: [attachment.position[0], position.map(|value| value.lane(lane))],
        orientation: [attachment.orientation[0], orientation.map(|value| value.lane(lane))],
        ..attachment.clone()
    }
}

/// How one side of an attachment moves if no joint accelerates; gravity, which counts as an acceleration of everything, is in
/// both sides.
struct Motion {
    /// Of the frame's origin, m/s².
    acceleration: Vector3<f64>,
    /// Angular velocity of the body, rad/s.
    spin: Vector3<f64>,
    /// Angular acceleration of the body, rad/s².
    turning: Vector3<f64>,
    /// Orientation of the frame.
    frame: [f64; 4],
}

impl Motion {
    fn of<T: Real>(model: &Model, workspace: &Workspace<T>, lane: usize, attachment: &Attachment, side: usize) -> Self {
        let (kinematics, body) = (&workspace.kinematics, attachment.bodies[side]);
        let of_lane = |vector: &Vector3<T>| lane_of(vector, lane);
        let rotation = matrix_of(&kinematics.body_rotation[body], lane);
        let point = rotation * attachment.position[side] + of_lane(&kinematics.body_position[body]);
        let arm = point - of_lane(kinematics.reference(model, body));
        let [spin, velocity] = [0, 1].map(|part| of_lane(&workspace.velocities.body[body][part]));
        let [turning, acceleration] = [0, 1].map(|part| of_lane(&workspace.forces.body_acceleration[body][part]));
        let orientation = kinematics.body_orientation[body].each_ref().map(|value| value.lane(lane));
        Self {
            acceleration: acceleration + turning.cross(&arm) + spin.cross(&(velocity + spin.cross(&arm))),
            spin,
            turning,
            frame: multiply(&orientation, &attachment.orientation[side]),
        }
    }
}

/// A polynomial of degree four and its slope.
#[inline(always)]
pub(crate) fn polynomial<T: Real>(&[a0, a1, a2, a3, a4]: &[f64; 5], x: T) -> [T; 2] {
    let (b2, b3, four) = (T::splat(2.0 * a2), T::splat(3.0 * a3), T::splat(4.0));
    let (a0, a1, a2, a3, a4) = (T::splat(a0), T::splat(a1), T::splat(a2), T::splat(a3), T::splat(a4));
    let slope = a1 + x * (b2 + x * (b3 + x * four * a4));
    [a0 + x * (a1 + x * (a2 + x * (a3 + x * a4))), slope]
}

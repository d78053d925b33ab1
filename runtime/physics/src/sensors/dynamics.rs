//! Accelerations of bodies and the forces between them: a recursive Newton-Euler pass with the accelerations found.
//!
//! From the root to the leaves a_b = a_parent + (rate of the axes) v + axes v', from the leaves to the root
//! f_b = I a_b + v_b x* I v_b - (forces from outside) + sum over children f. Forces from outside are contacts, what is applied to
//! bodies, tendons, connections and welds; gravity enters as an upward acceleration of the world.

use crate::{
    Workspace,
    constraint::{Constraints, RowKind, equalities::polynomial},
    model::{Attachment, Equality, Model},
    rotation::{conjugate, multiply},
    spatial::{Spatial, add, add_scaled, cross_force, spatial_zero},
    state::State,
};
use nalgebra::Vector3;

/// Accelerations of bodies and forces between them and their parents, about the centre of mass of each tree (`cacc`,
/// `cfrc_int`).
pub struct Dynamics {
    pub(super) acceleration: Vec<Spatial<f64>>,
    pub(super) force: Vec<Spatial<f64>>,
}

impl Dynamics {
    /// After a [`forward`](crate::forward) pass on `state`.
    pub fn new(model: &Model, state: &State<f64>, workspace: &Workspace<f64>) -> Self {
        let (bodies, kinematics) = (&model.bodies, &workspace.kinematics);
        let count = bodies.parent.len();
        let mut acceleration = vec![spatial_zero(); count];
        acceleration[0] = [Vector3::zeros(), -model.options.gravity];
        let mut force = outside(model, state, workspace);
        for body in 1..count {
            let mut sum = acceleration[bodies.parent[body]];
            for dof in bodies.dofs[body].clone() {
                add_scaled(&mut sum, &workspace.velocities.dof_axis_rate[dof], state.velocity[dof]);
                add_scaled(&mut sum, &kinematics.dof_axis[dof], workspace.acceleration[dof]);
            }
            acceleration[body] = sum;
            let inertia = &workspace.inertia.body[body];
            let velocity = &workspace.velocities.body[body];
            let mut total = inertia.momentum(&sum);
            add(&mut total, &cross_force(velocity, &inertia.momentum(velocity)));
            add_scaled(&mut total, &force[body], -1.0);
            force[body] = total;
        }
        for body in (1..count).rev().filter(|&body| bodies.parent[body] > 0) {
            let part = force[body];
            add(&mut force[bodies.parent[body]], &part);
        }
        Self { acceleration, force }
    }

    /// What the parent of the body of a joint does to the body: torque about the joint (N m) and force (N), in world axes. Muscles,
    /// tendons and connections are forces from outside, so what remains is what the joint itself bears.
    pub fn joint_reaction(&self, model: &Model, workspace: &Workspace<f64>, joint: usize) -> [Vector3<f64>; 2] {
        let (body, kinematics) = (model.joints.body[joint], &workspace.kinematics);
        about(self.force[body], kinematics.joint_anchor[joint] - kinematics.reference(model, body))
    }
}

/// Torque about a point and force, from those about another, from which `arm` leads to it.
pub(super) fn about([torque, force]: Spatial<f64>, arm: Vector3<f64>) -> Spatial<f64> {
    [torque - arm.cross(&force), force]
}

/// Forces on bodies from outside (`cfrc_ext`).
fn outside(model: &Model, state: &State<f64>, workspace: &Workspace<f64>) -> Vec<Spatial<f64>> {
    let kinematics = &workspace.kinematics;
    let mut force = vec![spatial_zero(); model.bodies.parent.len()];
    let mut apply = |body: usize, point: Vector3<f64>, push: Vector3<f64>, turn: Vector3<f64>, sign: f64| {
        let arm = point - kinematics.reference(model, body);
        add_scaled(&mut force[body], &[turn + arm.cross(&push), push], sign);
    };
    for (body, [push, turn]) in state.body_force.iter().enumerate() {
        apply(body, kinematics.inertial_position[body], *push, *turn, 1.0);
    }
    for contact in workspace.lanes.iter().take(1).flat_map(|lane| &lane.constraints.contacts) {
        let [f, g, h, t, u, v] = contact.force;
        let (push, turn) = (contact.frame.tr_mul(&Vector3::new(f, g, h)), contact.frame.tr_mul(&Vector3::new(t, u, v)));
        let [first, second] = contact.geoms.map(|geom| model.geoms.body[geom]);
        apply(first, contact.position, push, turn, -1.0);
        apply(second, contact.position, push, turn, 1.0);
    }
    for lane in workspace.lanes.iter().take(1) {
        hold(model, workspace, &lane.constraints, &mut force);
    }
    crate::forces::pull_tendons(model, workspace, &mut force);
    force
}

/// Adds the forces of equalities, and of the friction and limits of tendons.
fn hold(model: &Model, workspace: &Workspace<f64>, constraints: &Constraints, force: &mut [Spatial<f64>]) {
    let (rows, tendons) = (&constraints.rows, &workspace.tendons);
    let mut previous = None;
    for (row, &kind) in rows.kind.iter().enumerate() {
        let strength = rows.force[row];
        match kind {
            RowKind::TendonFriction(tendon) => tendons.pull(tendon, strength, force),
            RowKind::TendonLimit(tendon) => {
                let low = model.tendons.range[tendon].map_or(0.0, |[low, _]| low);
                let lower = rows.position[row] == tendons.length[tendon] - low;
                tendons.pull(tendon, if lower { strength } else { -strength }, force);
            }
            RowKind::Equality(equality) if previous != Some(equality) => {
                previous = Some(equality);
                let part = |index: usize| rows.force[row + index];
                let push = |first: usize| Vector3::new(part(first), part(first + 1), part(first + 2));
                match &model.equalities.kind[equality] {
                    Equality::Joint(_) => {}
                    Equality::Tendon(coupling) => {
                        tendons.pull(coupling.tendon, strength, force);
                        if let Some(leader) = coupling.leader {
                            let displacement = tendons.length[leader] - model.tendons.reference_length[leader];
                            let [_, slope] = polynomial(&coupling.polynomial, displacement);
                            tendons.pull(leader, -slope * strength, force);
                        }
                    }
                    Equality::Connect(attachment) => attach(model, workspace, attachment, push(0), None, force),
                    Equality::Weld { attachment, torque_scale } => {
                        attach(model, workspace, attachment, push(0), Some(push(3) * (0.5 * torque_scale)), force);
                    }
                }
            }
            _ => {}
        }
    }
}

/// Adds a push between the origins of two frames, and the torque whose power is `turn` times the rate of the vector part of
/// conj(Q₂) Q₁: the vector part of Q₂ turn conj(Q₁).
fn attach(
    model: &Model,
    workspace: &Workspace<f64>,
    attachment: &Attachment,
    push: Vector3<f64>,
    turn: Option<Vector3<f64>>,
    force: &mut [Spatial<f64>],
) {
    let kinematics = &workspace.kinematics;
    let frame = |side: usize| multiply(&kinematics.body_orientation[attachment.bodies[side]], &attachment.orientation[side]);
    let torque = turn.map_or(Vector3::zeros(), |turn| {
        let [_, x, y, z] = multiply(&multiply(&frame(1), &[0.0, turn.x, turn.y, turn.z]), &conjugate(&frame(0)));
        Vector3::new(x, y, z)
    });
    for (side, sign) in [(0, 1.0), (1, -1.0)] {
        let body = attachment.bodies[side];
        let arm = kinematics.point(body, &attachment.position[side]) - kinematics.reference(model, body);
        add_scaled(&mut force[body], &[torque + arm.cross(&push), push], sign);
    }
}

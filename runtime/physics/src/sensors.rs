//! Readings of a model's own sensors and forces between bodies, on request: a step has no use for them.
//!
//! Most are looked up. Accelerations and forces between bodies take a recursive Newton-Euler pass with the accelerations found:
//! from the root to the leaves a_b = a_parent + (rate of the axes) v + axes v', from the leaves to the root
//! f_b = I a_b + v_b x* I v_b - (forces from outside) + sum over children f. Forces from outside are contacts, what is applied to
//! bodies, tendons, connections and welds; gravity enters as an upward acceleration of the world.

use super::{
    Workspace,
    collision::{
        place::{Asset, Placed},
        ray,
    },
    constraint::{Constraints, RowKind, equalities::polynomial},
    rotation::{conjugate, multiply, normalize},
    spatial::{Spatial, add, add_scaled, cross_force, spatial_zero},
    state::State,
};
use crate::model::{Attachment, Equality, Framed, Measure, Model};
use crate::scalar::Real;
use nalgebra::{Matrix3, Vector3};

/// Readings of all sensors, one after another (`sensordata`), after a [`forward`](super::forward) pass on `state`.
pub fn readings(model: &Model, state: &State<f64>, workspace: &Workspace<f64>) -> Vec<f64> {
    let mut out = Vec::with_capacity(model.sensors.size());
    let dynamics = model.sensors.measure.iter().any(needs_dynamics).then(|| Dynamics::new(model, state, workspace));
    let view = View { model, state, workspace, dynamics };
    for (measure, &cutoff) in model.sensors.measure.iter().zip(&model.sensors.cutoff) {
        let start = out.len();
        view.read(measure, &mut out);
        if cutoff > 0.0 {
            out[start..].iter_mut().for_each(|value| *value = value.clip(-cutoff, cutoff));
        }
    }
    out
}

fn needs_dynamics(measure: &Measure) -> bool {
    matches!(
        measure,
        Measure::Accelerometer(_)
            | Measure::Force(_)
            | Measure::Torque(_)
            | Measure::FrameAcceleration(_)
            | Measure::FrameAngularAcceleration(_)
    )
}

/// Accelerations of bodies and forces between them and their parents, about the centre of mass of each tree (`cacc`,
/// `cfrc_int`).
pub struct Dynamics {
    acceleration: Vec<Spatial<f64>>,
    force: Vec<Spatial<f64>>,
}

impl Dynamics {
    /// After a [`forward`](super::forward) pass on `state`.
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
}

impl Dynamics {
    /// What the parent of the body of a joint does to the body: torque about the joint (N m) and force (N), in world axes. Muscles,
    /// tendons and connections are forces from outside, so what remains is what the joint itself bears.
    pub fn joint_reaction(&self, model: &Model, workspace: &Workspace<f64>, joint: usize) -> [Vector3<f64>; 2] {
        let (body, kinematics) = (model.joints.body[joint], &workspace.kinematics);
        about(self.force[body], kinematics.joint_anchor[joint] - kinematics.reference(model, body))
    }
}

/// Torque about a point and force, from those about another, from which `arm` leads to it.
fn about([torque, force]: Spatial<f64>, arm: Vector3<f64>) -> Spatial<f64> {
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
    super::forces::pull_tendons(model, workspace, &mut force);
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

/// What readings are taken from.
struct View<'a> {
    model: &'a Model,
    state: &'a State<f64>,
    workspace: &'a Workspace<f64>,
    dynamics: Option<Dynamics>,
}

impl View<'_> {
    fn read(&self, measure: &Measure, out: &mut Vec<f64>) {
        let (model, state, workspace) = (self.model, self.state, self.workspace);
        let (joints, actuation) = (&model.joints, &workspace.actuation);
        let dofs = |joint: usize| &state.velocity[joints.dof_address[joint]..];
        match *measure {
            Measure::Touch { site, .. } => out.push(self.touch(site, measure)),
            Measure::Accelerometer(site) => out.extend(&self.in_axes(site, self.acceleration(Framed::Site(site))[1])),
            Measure::Velocimeter(site) => out.extend(&self.in_axes(site, self.velocity(Framed::Site(site))[1])),
            Measure::Gyro(site) => out.extend(&self.in_axes(site, self.velocity(Framed::Site(site))[0])),
            Measure::Force(site) => out.extend(&self.in_axes(site, self.force(site)[1])),
            Measure::Torque(site) => out.extend(&self.in_axes(site, self.force(site)[0])),
            Measure::JointPosition(joint) => out.push(state.position[joints.position_address[joint]]),
            Measure::JointVelocity(joint) => out.push(dofs(joint)[0]),
            Measure::JointActuatorForce(joint) => out.push(workspace.forces.actuator[joints.dof_address[joint]]),
            Measure::BallOrientation(joint) => {
                let q = &state.position[joints.position_address[joint]..];
                out.extend(normalize(&[q[0], q[1], q[2], q[3]]));
            }
            Measure::BallVelocity(joint) => out.extend(&dofs(joint)[..3]),
            Measure::TendonPosition(tendon) => out.push(workspace.tendons.length[tendon]),
            Measure::TendonVelocity(tendon) => out.push(workspace.tendons.velocity[tendon]),
            Measure::ActuatorPosition(actuator) => out.push(actuation.length[actuator]),
            Measure::ActuatorVelocity(actuator) => out.push(actuation.velocity[actuator]),
            Measure::ActuatorForce(actuator) => out.push(actuation.force[actuator]),
            Measure::FramePosition(object, reference) => {
                let gap = self.place(object).0 - reference.map_or(Vector3::zeros(), |frame| self.place(frame).0);
                out.extend(&self.seen_from(reference, gap));
            }
            Measure::FrameOrientation(object, reference) => {
                let orientation = self.orientation(object);
                out.extend(reference.map_or(orientation, |frame| {
                    let [w, x, y, z] = self.orientation(frame);
                    multiply(&[w, -x, -y, -z], &orientation)
                }));
            }
            Measure::FrameAxis(object, reference, axis) => {
                out.extend(&self.seen_from(reference, self.place(object).1.column(axis).into_owned()));
            }
            Measure::FrameVelocity(object, reference) => {
                let mut velocity = self.velocity(object)[1];
                if let Some(frame) = reference {
                    let [spin, drift] = self.velocity(frame);
                    velocity -= drift + spin.cross(&(self.place(object).0 - self.place(frame).0));
                }
                out.extend(&self.seen_from(reference, velocity));
            }
            Measure::FrameAngularVelocity(object, reference) => {
                let spin = self.velocity(object)[0] - reference.map_or(Vector3::zeros(), |frame| self.velocity(frame)[0]);
                out.extend(&self.seen_from(reference, spin));
            }
            Measure::FrameAcceleration(object) => out.extend(&self.acceleration(object)[1]),
            Measure::FrameAngularAcceleration(object) => out.extend(&self.acceleration(object)[0]),
            Measure::SubtreeCenter(body) => out.extend(&workspace.kinematics.subtree_com[body]),
            Measure::SubtreeVelocity(body) => out.extend(&self.subtree_velocity(body)),
            Measure::SubtreeAngularMomentum(body) => out.extend(&self.subtree_momentum(body)),
            Measure::Clock => out.push(state.time),
        }
    }

    fn body_of(&self, object: Framed) -> usize {
        match object {
            Framed::InertialBody(body) | Framed::Body(body) => body,
            Framed::Geom(geom) => self.model.geoms.body[geom],
            Framed::Site(site) => self.model.sites.body[site],
        }
    }

    /// Position and axes.
    fn place(&self, object: Framed) -> (Vector3<f64>, Matrix3<f64>) {
        let kinematics = &self.workspace.kinematics;
        match object {
            Framed::InertialBody(body) => (kinematics.inertial_position[body], kinematics.inertial_rotation[body]),
            Framed::Body(body) => (kinematics.body_position[body], kinematics.body_rotation[body]),
            Framed::Geom(geom) => (kinematics.geom_position[geom], kinematics.geom_rotation[geom]),
            Framed::Site(site) => (kinematics.site_position(self.model, site), kinematics.site_rotation(self.model, site)),
        }
    }

    fn orientation(&self, object: Framed) -> [f64; 4] {
        let model = self.model;
        let local = match object {
            Framed::InertialBody(body) => model.bodies.inertial_orientation[body],
            Framed::Body(_) => [1.0, 0.0, 0.0, 0.0],
            Framed::Geom(geom) => model.geoms.orientation[geom],
            Framed::Site(site) => model.sites.orientation[site],
        };
        multiply(&self.workspace.kinematics.body_orientation[self.body_of(object)], &local)
    }

    /// A spatial vector about the tree's centre of mass, moved to an object's origin as velocities are.
    fn moved(&self, object: Framed, [angular, linear]: Spatial<f64>) -> Spatial<f64> {
        let arm = self.place(object).0 - self.workspace.kinematics.reference(self.model, self.body_of(object));
        [angular, linear + angular.cross(&arm)]
    }

    fn velocity(&self, object: Framed) -> Spatial<f64> {
        self.moved(object, self.workspace.velocities.body[self.body_of(object)])
    }

    /// Angular acceleration, and the acceleration of the material point against free fall: that of the spatial vector and
    /// what the point's turning adds.
    fn acceleration(&self, object: Framed) -> Spatial<f64> {
        let spatial = self.dynamics.as_ref().map_or(spatial_zero(), |dynamics| dynamics.acceleration[self.body_of(object)]);
        let [spin, velocity] = self.velocity(object);
        let [angular, linear] = self.moved(object, spatial);
        [angular, linear + spin.cross(&velocity)]
    }

    /// Torque about a site and force between its body and the parent.
    fn force(&self, site: usize) -> Spatial<f64> {
        let body = self.model.sites.body[site];
        let force = self.dynamics.as_ref().map_or(spatial_zero(), |dynamics| dynamics.force[body]);
        about(force, self.place(Framed::Site(site)).0 - self.workspace.kinematics.reference(self.model, body))
    }

    fn in_axes(&self, site: usize, vector: Vector3<f64>) -> Vector3<f64> {
        self.place(Framed::Site(site)).1.tr_mul(&vector)
    }

    fn seen_from(&self, reference: Option<Framed>, vector: Vector3<f64>) -> Vector3<f64> {
        reference.map_or(vector, |frame| self.place(frame).1.tr_mul(&vector))
    }

    fn touch(&self, site: usize, measure: &Measure) -> f64 {
        let Measure::Touch { shape, size, .. } = *measure else { return 0.0 };
        let (position, rotation) = self.place(Framed::Site(site));
        let zone = Placed { kind: shape, position, rotation, size, asset: Asset::None };
        let body = self.model.sites.body[site];
        let mut sum = 0.0;
        for contact in self.workspace.lanes.iter().take(1).flat_map(|lane| &lane.constraints.contacts) {
            let bodies = contact.geoms.map(|geom| self.model.geoms.body[geom]);
            let normal: Vector3<f64> = contact.frame.row(0).transpose();
            // From the contact into the other body: where the skin of the sensor's own body should be.
            let ray = if bodies[1] == body { -normal } else { normal };
            if contact.force[0] > 0.0 && bodies.contains(&body) && ray::meet(&zone, contact.position, ray).is_some() {
                sum += contact.force[0];
            }
        }
        sum
    }

    /// The bodies from `root` downwards.
    fn subtree(&self, root: usize) -> Vec<usize> {
        let mut members = vec![root];
        for body in root + 1..self.model.bodies.parent.len() {
            if members.contains(&self.model.bodies.parent[body]) {
                members.push(body);
            }
        }
        members
    }

    fn subtree_velocity(&self, root: usize) -> Vector3<f64> {
        let kinematics = &self.workspace.kinematics;
        let part = |body: usize| self.velocity(Framed::InertialBody(body))[1] * kinematics.mass[body];
        let momentum: Vector3<f64> = self.subtree(root).into_iter().map(part).sum();
        momentum / kinematics.subtree_mass[root].at_least(super::rotation::MINIMUM)
    }

    fn subtree_momentum(&self, root: usize) -> Vector3<f64> {
        let kinematics = &self.workspace.kinematics;
        let (centre, drift) = (kinematics.subtree_com[root], self.subtree_velocity(root));
        let part = |body: usize| {
            let [spin, velocity] = self.velocity(Framed::InertialBody(body));
            let axes = kinematics.inertial_rotation[body];
            let moments: Vector3<f64> = kinematics.overrides.moments(self.model, body);
            let own = axes * moments.component_mul(&axes.tr_mul(&spin)) * self.state.mass_scale[body];
            own + (kinematics.inertial_position[body] - centre).cross(&(velocity - drift)) * kinematics.mass[body]
        };
        self.subtree(root).into_iter().map(part).sum()
    }
}

//! Readings of a model's own sensors, on request: a step has no use for them.
//!
//! Most are looked up. Accelerations and forces between bodies take a pass of their own ([`Dynamics`]), rays and distances one
//! over shapes (`surfaces`).

mod dynamics;
mod surfaces;

use super::{
    Workspace,
    constraint::RowKind,
    rotation::{multiply, normalize},
    spatial::{Spatial, spatial_zero},
    state::State,
};
use crate::model::{Framed, LimitQuantity, Limited, Measure, Model, Transmission};
use crate::scalar::Real;
pub use dynamics::Dynamics;
use dynamics::about;
use nalgebra::{Matrix3, Vector3};

/// Readings of all sensors, one after another (`sensordata`), after a [`forward`](super::forward) pass on `state`.
pub fn readings(model: &Model, state: &State<f64>, workspace: &Workspace<f64>) -> Vec<f64> {
    let mut out = Vec::with_capacity(model.sensors.size());
    let dynamics = model.sensors.measure.iter().any(needs_dynamics).then(|| Dynamics::new(model, state, workspace));
    let view = View { model, state, workspace, dynamics };
    for (measure, &cutoff) in model.sensors.measure.iter().zip(&model.sensors.cutoff) {
        let start = out.len();
        view.read(measure, cutoff, &mut out);
        if cutoff > 0.0 && measure.is_cut_off() {
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

/// What readings are taken from.
struct View<'a> {
    model: &'a Model,
    state: &'a State<f64>,
    workspace: &'a Workspace<f64>,
    dynamics: Option<Dynamics>,
}

impl View<'_> {
    fn read(&self, measure: &Measure, cutoff: f64, out: &mut Vec<f64>) {
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
            Measure::TendonActuatorForce(tendon) => out.push(self.tendon_actuator_force(tendon)),
            Measure::Limit(limited, quantity) => out.push(self.limit(limited, quantity)),
            Measure::Range(site) => out.push(self.range(site)),
            Measure::Gap(surfaces, quantity) => self.gap(surfaces, quantity, cutoff, out),
            Measure::Clock => out.push(state.time),
        }
    }

    /// Sum of the forces of the actuators that pull a tendon.
    fn tendon_actuator_force(&self, tendon: usize) -> f64 {
        let transmissions = self.model.actuators.transmission.iter();
        let pulls = transmissions.zip(&self.workspace.actuation.force).filter(|(way, _)| **way == Transmission::Tendon(tendon));
        pulls.map(|(_, force)| force).sum()
    }

    /// A quantity of the first row of a limit, zero where the limit is not reached.
    fn limit(&self, limited: Limited, quantity: LimitQuantity) -> f64 {
        let kind = match limited {
            Limited::Joint(joint) => RowKind::JointLimit(joint),
            Limited::Tendon(tendon) => RowKind::TendonLimit(tendon),
        };
        let Some(rows) = self.workspace.lanes.first().map(|lane| &lane.constraints.rows) else { return 0.0 };
        rows.kind.iter().position(|known| *known == kind).map_or(0.0, |row| match quantity {
            LimitQuantity::Distance => rows.position[row] - rows.margin[row],
            LimitQuantity::Velocity => rows.velocity[row],
            LimitQuantity::Force => rows.force[row],
        })
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

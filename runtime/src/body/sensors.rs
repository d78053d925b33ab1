//! Sensors: the quantities that a compiled task reads, measured once per control step.
//!
//! Everything is measured in one configuration: the workspace must hold the forward pass of the state. Velocities are those
//! of the very point. A mean acceleration is the change of velocity over the control step; [`Memory`] keeps what it needs.

use super::Body;
use super::metabolism::Contraction;
use crate::scene::ground::{ABYSS, Ground};
use core::cell::OnceCell;
use msk_physics::model::Model;
use msk_physics::sensors::Dynamics;
use msk_physics::{self as physics, State, Workspace};
use msk_program::frame::{FrameLayout, Sensor};
use msk_program::scene::Part;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// What the control loop knows and the physics does not.
#[derive(Debug, Clone, Copy)]
pub struct Control<'a> {
    /// The action that reached each muscle.
    pub action: &'a [f64],
    /// The policy's action in the task's own action space; empty where that is one entry per muscle.
    pub entries: &'a [f64],
    /// Time since reset, s.
    pub time: f64,
    /// Length of the control step that has just passed, s; zero at the reset snapshot, where mean accelerations are zero.
    pub elapsed: f64,
}

/// Velocities of the previous control step, from which mean accelerations follow: part of an episode's snapshot.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    velocities: Vec<Vector3<f64>>,
}

/// One configuration of a body in its scene, with everything the physics knows about it.
#[derive(Debug, Clone, Copy)]
pub struct Snapshot<'a> {
    /// The body.
    pub body: &'a Body,
    /// The model it is bound to.
    pub model: &'a Model,
    /// The state.
    pub state: &'a State<f64>,
    /// The forward pass of that state.
    pub workspace: &'a Workspace<f64>,
}

/// Fills the record of `layout`: `frame` has `layout.size()` values.
pub fn fill(layout: &FrameLayout, snapshot: &Snapshot<'_>, control: &Control<'_>, memory: &mut Memory, frame: &mut [f64]) {
    let mut accelerations = 0;
    let mut mean_acceleration = |velocity: Vector3<f64>| {
        let slot = accelerations;
        accelerations += 1;
        if memory.velocities.len() <= slot {
            memory.velocities.resize(slot + 1, velocity);
        }
        let change = velocity - core::mem::replace(&mut memory.velocities[slot], velocity);
        if control.elapsed > 0.0 { change / control.elapsed } else { Vector3::zeros() }
    };
    // Computed by the first sensor that needs it.
    let dynamics = OnceCell::new();
    for run in layout.runs() {
        let (sensor, offset) = run[0];
        if let Sensor::Query(query, size) = sensor {
            snapshot.answer(&layout.queries()[query], &mut frame[offset..offset + size]);
            continue;
        }
        if let Some(values) = snapshot.listed(sensor, control) {
            frame[offset..offset + run.len()].copy_from_slice(&values[..run.len()]);
            continue;
        }
        // Any other stands alone.
        let value = match sensor {
            Sensor::LandmarkAcceleration(landmark) => Value::Vector(mean_acceleration(snapshot.landmark_velocity(landmark))),
            Sensor::ComAcceleration => Value::Vector(mean_acceleration(snapshot.com_velocity())),
            Sensor::JointReactionForce(joint) => Value::Vector(snapshot.joint_reaction(joint, &dynamics)[1]),
            Sensor::JointReactionTorque(joint) => Value::Vector(snapshot.joint_reaction(joint, &dynamics)[0]),
            sensor => snapshot.measure(sensor, control),
        };
        value.write(&mut frame[offset..offset + sensor.size()]);
    }
}

/// One block of the record.
enum Value {
    Scalar(f64),
    Vector(Vector3<f64>),
    Axes(Matrix3<f64>),
}

impl Value {
    fn write(self, block: &mut [f64]) {
        match self {
            Self::Scalar(value) => block.copy_from_slice(&[value]),
            Self::Vector(value) => block.copy_from_slice(value.as_slice()),
            Self::Axes(value) => block.copy_from_slice(value.as_slice()),
        }
    }
}

impl Snapshot<'_> {
    /// What the parent segment does to that of a joint: torque about the joint and force, in world axes.
    fn joint_reaction(&self, joint: usize, dynamics: &OnceCell<Dynamics>) -> [Vector3<f64>; 2] {
        let (model, workspace) = (self.model, self.workspace);
        let dynamics = dynamics.get_or_init(|| Dynamics::new(model, self.state, workspace));
        dynamics.joint_reaction(model, workspace, self.body.joints[joint].index)
    }

    /// What the sensor measures, and after it what it would measure of the entities that follow in the list; `None` where that is not
    /// at hand as a list.
    fn listed<'a>(&'a self, sensor: Sensor, control: &Control<'a>) -> Option<&'a [f64]> {
        let (state, muscles) = (self.state, &self.workspace.actuation);
        match sensor {
            Sensor::MuscleLength(muscle) => Some(&muscles.length[muscle..]),
            Sensor::MuscleVelocity(muscle) => Some(&muscles.velocity[muscle..]),
            Sensor::MuscleForce(muscle) => Some(&muscles.force[muscle..]),
            Sensor::MuscleActivation(muscle) => Some(&state.activation[muscle..]),
            Sensor::MuscleExcitation(muscle) => Some(&state.control[muscle..]),
            Sensor::MuscleStrength(muscle) => Some(&state.strength[muscle..]),
            Sensor::Action(muscle) => Some(&control.action[muscle..]),
            Sensor::ActionEntry(entry) => Some(&control.entries[entry..]),
            _ => None,
        }
    }

    /// Any sensor but the mean accelerations, which need a memory, and reactions of joints, which share their dynamics.
    fn measure(&self, sensor: Sensor, control: &Control<'_>) -> Value {
        use Value::{Axes, Scalar, Vector};
        let (body, state, workspace) = (self.body, self.state, self.workspace);
        let (kinematics, muscles) = (&workspace.kinematics, &workspace.actuation);
        match sensor {
            Sensor::LandmarkPosition(landmark) => Vector(body.landmark_position(kinematics, landmark)),
            Sensor::LandmarkVelocity(landmark) => Vector(self.landmark_velocity(landmark)),
            // Taken where a memory and the dynamics are at hand.
            Sensor::LandmarkAcceleration(_)
            | Sensor::ComAcceleration
            | Sensor::JointReactionForce(_)
            | Sensor::JointReactionTorque(_) => Vector(Vector3::zeros()),
            Sensor::LandmarkAxes(landmark) => {
                let landmark = &body.landmarks[landmark];
                Axes(kinematics.body_rotation[landmark.body] * landmark.axes)
            }
            Sensor::LandmarkAngularVelocity(landmark) => Vector(self.angular_velocity(body.landmarks[landmark].body)),
            Sensor::LandmarkClearance(landmark) => Scalar(self.clearance(landmark)),
            Sensor::JointPosition(joint) => Scalar(state.position[body.joints[joint].position]),
            Sensor::JointVelocity(joint) => Scalar(state.velocity[body.joints[joint].dof]),
            Sensor::JointAcceleration(joint) => Scalar(workspace.acceleration[body.joints[joint].dof]),
            Sensor::JointTorque(joint) => Scalar(workspace.forces.actuator[body.joints[joint].dof]),
            Sensor::MuscleFibreLength(muscle) => Scalar(muscles.fibre_length(muscle)),
            Sensor::MuscleFibreVelocity(muscle) => Scalar(muscles.fibre_velocity(muscle)),
            Sensor::MuscleTendonLength(muscle) => Scalar(muscles.tendon_length(muscle)),
            Sensor::MuscleMetabolicPower(muscle) => Scalar(self.metabolic_power(muscle)),
            Sensor::ComPosition => Vector(body.centre_of_mass(self.model, kinematics)),
            Sensor::ComVelocity => Vector(self.com_velocity()),
            Sensor::AngularMomentum => Vector(self.angular_momentum()),
            Sensor::CentreOfPressure => Vector(self.centre_of_pressure()),
            Sensor::SupportMargin => Scalar(self.support_margin()),
            Sensor::MomentArm(muscle, joint) => Scalar(self.moment_arm(muscle, joint)),
            Sensor::RootPosition => Vector(kinematics.body_position[body.root.body]),
            Sensor::RootAxes => Axes(kinematics.body_rotation[body.root.body] * body.root.axes),
            Sensor::RootVelocity => Vector(self.velocity_of(body.root.body, kinematics.body_position[body.root.body])),
            Sensor::RootAngularVelocity => Vector(self.angular_velocity(body.root.body)),
            Sensor::GroundForce(landmark) => Vector(self.contact_force(Part::Landmark(landmark), Part::Ground)),
            Sensor::GroundContact(landmark) => Scalar(self.touching(Part::Landmark(landmark), Part::Ground)),
            Sensor::Touching(first, second) => Scalar(self.touching(first, second)),
            Sensor::ContactForce(first, second) => Vector(self.contact_force(first, second)),
            Sensor::ContactCount(first, second) => Scalar(self.contact_count(first, second) as f64),
            Sensor::SurfaceDistance(first, second) => Scalar(self.surface_distance(first, second)),
            Sensor::Slip(first, second) => Scalar(self.slip(first, second)),
            // Answered where the layout's queries are at hand, or read as lists.
            Sensor::Query(..)
            | Sensor::MuscleLength(_)
            | Sensor::MuscleVelocity(_)
            | Sensor::MuscleForce(_)
            | Sensor::MuscleActivation(_)
            | Sensor::MuscleExcitation(_)
            | Sensor::MuscleStrength(_)
            | Sensor::Action(_)
            | Sensor::ActionEntry(_) => Scalar(0.0),
            Sensor::Time => Scalar(control.time),
        }
    }

    /// Moment arm of a muscle about a joint, m (a plain number along a slide).
    fn moment_arm(&self, muscle: usize, joint: usize) -> f64 {
        let Some(tendon) = self.model.actuators.muscle(muscle).map(|muscle| muscle.tendon) else { return 0.0 };
        let (kinematics, paths) = (&self.workspace.kinematics, &self.workspace.tendons);
        physics::moment_arm(self.model, kinematics, paths, tendon, self.body.joints[joint].dof)
    }

    /// Height of a landmark's segment above the ground, m; over an abyss, above its bottom.
    fn clearance(&self, landmark: usize) -> f64 {
        let segment = &self.body.landmarks[landmark].segment;
        let height = self.ground().clearance(segment);
        if height.is_finite() || segment.is_empty() {
            return height;
        }
        let level = Ground { shapes: &[], ..self.ground() };
        level.clearance(segment) - ABYSS
    }

    fn landmark_velocity(&self, landmark: usize) -> Vector3<f64> {
        let position = self.body.landmark_position(&self.workspace.kinematics, landmark);
        self.velocity_of(self.body.landmarks[landmark].body, position)
    }

    /// Velocity of the material point of `body` that is at `point`: v = v_c + ω × (p - c), where the body's spatial velocity
    /// refers to c, the centre of mass of its kinematic tree.
    pub(super) fn velocity_of(&self, body: usize, point: Vector3<f64>) -> Vector3<f64> {
        let [angular, linear] = self.workspace.velocities.body[body];
        let centre = self.workspace.kinematics.subtree_com[self.model.bodies.root[body]];
        linear + angular.cross(&(point - centre))
    }

    /// Metabolic power of a muscle, W: see the module `metabolism`.
    pub fn metabolic_power(&self, muscle: usize) -> f64 {
        let (state, actuation) = (self.state, &self.workspace.actuation);
        let (optimal_length, _) = actuation.lengths(muscle);
        // What is no muscle has neither length nor metabolism.
        if optimal_length <= 0.0 {
            return 0.0;
        }
        let activation = self.model.actuators.activation[muscle].map_or(0.0, |slot| state.activation[slot]);
        let contraction = Contraction {
            peak_force: actuation.peak_force(muscle),
            optimal_length,
            length: actuation.fibre_length(muscle) / optimal_length,
            velocity: actuation.fibre_velocity(muscle),
            excitation: state.control[muscle],
            activation,
            force: -actuation.gain[muscle] * activation,
            isometric_force: actuation.isometric_force(state, muscle) * activation,
        };
        contraction.metabolic_power()
    }

    fn angular_velocity(&self, body: usize) -> Vector3<f64> {
        self.workspace.velocities.body[body][0]
    }

    /// Velocity of the body's own centre of mass: momentum over mass.
    pub(super) fn com_velocity(&self) -> Vector3<f64> {
        self.momentum(self.body.own()) / self.body.own_mass(self.model, &self.workspace.kinematics)
    }

    /// Momentum of these bodies, kg m/s.
    pub(crate) fn momentum(&self, bodies: impl Iterator<Item = usize>) -> Vector3<f64> {
        let kinematics = &self.workspace.kinematics;
        bodies.map(|body| self.velocity_of(body, kinematics.inertial_position[body]) * kinematics.mass[body]).sum()
    }

    /// Angular momentum about the body's own centre of mass: Σ R I R'ω + m (x - c) × (v - v_c).
    pub(crate) fn angular_momentum(&self) -> Vector3<f64> {
        let (bodies, kinematics) = (&self.model.bodies, &self.workspace.kinematics);
        let centre = self.body.centre_of_mass(self.model, kinematics);
        let drift = self.com_velocity();
        let part = |body: usize| {
            let axes = kinematics.inertial_rotation[body];
            let spin = axes * bodies.inertia[body].component_mul(&(axes.transpose() * self.angular_velocity(body)));
            let spin = spin * self.state.mass_scale[body];
            let position = kinematics.inertial_position[body];
            let orbit = (position - centre).cross(&(self.velocity_of(body, position) - drift));
            spin + orbit * kinematics.mass[body]
        };
        self.body.own().map(part).sum()
    }
}

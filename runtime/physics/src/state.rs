//! What changes from step to step and must be kept to continue an episode bit for bit.

use super::{overrides::Overrides, rotation::constant_quaternion, spatial::constant};
use crate::{
    batch::one_lane,
    model::{Equality, Model},
    scalar::Real,
};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The dynamic state of one body (or scene), with everything that acts on it from outside. `Clone` is a snapshot; one that was written
/// and read by serde goes on with the same bits if the format keeps those of numbers. What was read may not [`fit`](Self::fits).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State<T: Real> {
    /// Simulated time, s.
    pub time: T,
    /// Generalised positions, `nq` entries: m, rad, and quaternions w x y z of free and ball joints.
    pub position: Vec<T>,
    /// Generalised velocities, `nv` entries: m/s and rad/s. A free joint moves in world axes and turns in its body's axes.
    pub velocity: Vec<T>,
    /// Activations of muscles and other actuators that have one, `na` entries.
    pub activation: Vec<T>,
    /// Fibre lengths, one per actuator where tendons are elastic, else none, m; zero for a fibre that is not laid yet.
    pub fibre_length: Vec<T>,
    /// Their rates, from which the next step starts its search, m/s.
    pub fibre_velocity: Vec<T>,
    /// Time between the positions that belong to these lengths and the present ones, s.
    pub fibre_step: T,
    /// Controls (of muscles: excitations), one per actuator.
    pub control: Vec<T>,
    /// Generalised forces applied from outside, `nv` entries: N and N m.
    pub applied_force: Vec<T>,
    /// Force (N) and torque (N m) applied from outside at each body's centre of mass, world axes.
    pub body_force: Vec<[Vector3<T>; 2]>,
    /// Positions of the bodies that are placed from outside (`mocap_pos`), m, world frame, in the order of the bodies.
    pub mocap_position: Vec<Vector3<T>>,
    /// Their orientations w x y z (`mocap_quat`).
    pub mocap_orientation: Vec<[T; 4]>,
    /// Their angular (rad/s) and linear (m/s) velocities in world axes; zero at first. A body with a velocity moves on by itself, and
    /// carries by friction what touches it. MuJoCo's mocap bodies have none.
    pub mocap_velocity: Vec<[Vector3<T>; 2]>,
    /// For each equality of the model whether it holds: 1 if it does, 0 if it is released.
    pub active: Vec<T>,
    /// For each equality of the model where the second frame of a connection or weld stands in its body, position (m) and
    /// orientation; of others without meaning. The model's at first: what is taken as it stands has another one.
    pub held: Vec<(Vector3<T>, [T; 4])>,
    /// Factor of the active force of each muscle, one per actuator; 1 at first. Actuators that are no muscles ignore theirs.
    pub strength: Vec<T>,
    /// Factor of mass and inertia of each body; 1 at first. Must be positive. As in MuJoCo, where a program changes `body_mass`, the
    /// inverse weights that scale the softness of constraints stay those of the model.
    pub mass_scale: Vec<T>,
    /// Sliding friction of each geom; that of the model at first. Contacts of explicit pairs have the pair's own.
    pub friction: Vec<T>,
    /// Damping of each dof, N m s/rad or N s/m; that of the model at first. In a model without any it acts explicitly.
    pub damping: Vec<T>,
    /// Stiffness of the spring of each joint, N m/rad or N/m; that of the model at first. A joint without a spring in the model has none.
    pub stiffness: Vec<T>,
    /// Shapes that the episode has of its own; those of the model at first.
    pub overrides: Overrides,
    /// Acceleration of the last step, from which the constraint solver starts, `nv` entries.
    pub warm_start: Vec<T>,
}

one_lane!(State {
    time,
    position,
    velocity,
    activation,
    fibre_length,
    fibre_velocity,
    fibre_step,
    control,
    applied_force,
    body_force,
    mocap_position,
    mocap_orientation,
    mocap_velocity,
    active,
    held,
    strength,
    mass_scale,
    friction,
    damping,
    stiffness,
    overrides,
    warm_start
});

impl<T: Real> State<T> {
    /// Takes over another state of the same model without asking for memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.time = other.time;
        self.position.copy_from_slice(&other.position);
        self.velocity.copy_from_slice(&other.velocity);
        self.activation.copy_from_slice(&other.activation);
        self.fibre_length.copy_from_slice(&other.fibre_length);
        self.fibre_velocity.copy_from_slice(&other.fibre_velocity);
        self.fibre_step = other.fibre_step;
        self.control.copy_from_slice(&other.control);
        self.active.copy_from_slice(&other.active);
        self.held.copy_from_slice(&other.held);
        self.applied_force.copy_from_slice(&other.applied_force);
        self.body_force.copy_from_slice(&other.body_force);
        self.mocap_position.copy_from_slice(&other.mocap_position);
        self.mocap_orientation.copy_from_slice(&other.mocap_orientation);
        self.mocap_velocity.copy_from_slice(&other.mocap_velocity);
        self.strength.copy_from_slice(&other.strength);
        self.mass_scale.copy_from_slice(&other.mass_scale);
        self.friction.copy_from_slice(&other.friction);
        self.damping.copy_from_slice(&other.damping);
        self.stiffness.copy_from_slice(&other.stiffness);
        self.overrides.copy_from(&other.overrides);
        self.warm_start.copy_from_slice(&other.warm_start);
    }

    /// Whether every part is as long as `model` asks for.
    pub fn fits(&self, model: &Model) -> bool {
        let actuators = model.actuators.name.len();
        let fibres = if model.elastic_tendons.is_some() { actuators } else { 0 };
        let (bodies, equalities) = (model.bodies.parent.len(), model.equalities.kind.len());
        let placed = model.bodies.mocap.iter().filter(|placed| **placed).count();
        self.position.len() == model.nq
            && [&self.velocity, &self.applied_force, &self.warm_start, &self.damping].iter().all(|part| part.len() == model.nv)
            && self.activation.len() == model.na
            && self.control.len() == actuators
            && [&self.fibre_length, &self.fibre_velocity].iter().all(|part| part.len() == fibres)
            && self.body_force.len() == bodies
            && [self.mocap_position.len(), self.mocap_orientation.len(), self.mocap_velocity.len()] == [placed; 3]
            && [self.active.len(), self.held.len()] == [equalities; 2]
            && [self.strength.len(), self.mass_scale.len()] == [actuators, bodies]
            && [self.friction.len(), self.stiffness.len()] == [model.geoms.kind.len(), model.joints.kind.len()]
            && self.overrides.fits(model, T::LANES)
    }

    /// The reference configuration at rest, with silent muscles and nothing applied.
    pub fn new(model: &Model) -> Self {
        let zero = T::splat(0.0);
        let placed = (0..model.bodies.mocap.len()).filter(|&body| model.bodies.mocap[body]);
        let fibres = if model.elastic_tendons.is_some() { model.actuators.name.len() } else { 0 };
        Self {
            time: zero,
            position: model.reference_position.iter().map(|&value| T::splat(value)).collect(),
            velocity: vec![zero; model.nv],
            activation: vec![zero; model.na],
            fibre_length: vec![zero; fibres],
            fibre_velocity: vec![zero; fibres],
            fibre_step: T::splat(model.options.timestep),
            control: vec![zero; model.actuators.name.len()],
            applied_force: vec![zero; model.nv],
            body_force: vec![[Vector3::from_element(zero); 2]; model.bodies.parent.len()],
            mocap_position: placed.clone().map(|body| constant(&model.bodies.position[body])).collect(),
            mocap_velocity: vec![[Vector3::from_element(zero); 2]; placed.clone().count()],
            mocap_orientation: placed.map(|body| constant_quaternion(&model.bodies.orientation[body])).collect(),
            active: model.equalities.active.iter().map(|&active| T::splat(f64::from(u8::from(active)))).collect(),
            held: model.equalities.kind.iter().map(second_frame).collect(),
            strength: vec![T::splat(1.0); model.actuators.name.len()],
            mass_scale: vec![T::splat(1.0); model.bodies.parent.len()],
            friction: model.geoms.friction.iter().map(|friction| T::splat(friction[0])).collect(),
            damping: model.dofs.damping.iter().map(|&damping| T::splat(damping)).collect(),
            stiffness: model.joints.stiffness.iter().map(|&stiffness| T::splat(stiffness)).collect(),
            overrides: Overrides::none(T::LANES),
            warm_start: vec![zero; model.nv],
        }
    }
}

/// Where the second frame of a connection or weld stands in its body.
fn second_frame<T: Real>(kind: &Equality) -> (Vector3<T>, [T; 4]) {
    match kind {
        Equality::Connect(attachment) | Equality::Weld { attachment, .. } => {
            (constant(&attachment.position[1]), constant_quaternion(&attachment.orientation[1]))
        }
        Equality::Joint(_) | Equality::Tendon(_) => (constant(&Vector3::zeros()), constant_quaternion(&[1.0, 0.0, 0.0, 0.0])),
    }
}

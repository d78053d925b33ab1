//! Generalised forces and the acceleration that they cause without constraints.

use super::{
    Workspace,
    fluid::Medium,
    inertia::{self, Inertia},
    kinematics::Kinematics,
    rotation::{constant_quaternion, difference, normalize},
    spatial::{Spatial, add, add_scaled, constant, cross, cross_force, dot, pair, scale, spatial_zero, zero},
    state::State,
    tendons::TendonPaths,
    velocities::Velocities,
};
use crate::{
    batch::one_lane,
    model::{JointKind, Model, Transmission},
    scalar::Real,
};
use std::sync::Arc;

/// Generalised forces, `nv` entries each: N and N m.
#[derive(Debug, Clone)]
pub struct Forces<T: Real> {
    /// Springs and dampers of joints and tendons, the weight that is compensated, drag (`qfrc_passive`).
    pub passive: Vec<T>,
    /// Coriolis, centrifugal and gravitational forces, on the left-hand side of M a + bias = force (`qfrc_bias`).
    pub bias: Vec<T>,
    /// Muscles (`qfrc_actuator`).
    pub actuator: Vec<T>,
    /// What balances the weight of bodies with gravity compensation (`qfrc_gravcomp`).
    pub compensation: Vec<T>,
    /// Passive - bias + actuator + applied (`qfrc_smooth`).
    pub smooth: Vec<T>,
    /// M^-1 smooth (`qacc_smooth`), m/s² and rad/s². A step with constraint rows leaves it out:
    /// [`unconstrained`](crate::smooth::unconstrained) fills it on request.
    pub smooth_acceleration: Vec<T>,
    /// Acceleration of every body without joint accelerations, that of gravity upwards included, about the centre of mass of
    /// its tree.
    pub(super) body_acceleration: Vec<Spatial<T>>,
    /// Scratch: forces on bodies.
    pub(super) body_force: Vec<Spatial<T>>,
    pub(super) medium: Arc<Medium>,
    /// Scratch: a generalised force before it is added to another.
    swept: Vec<T>,
}

one_lane!(Forces {
    passive, bias, actuator, compensation, smooth, smooth_acceleration, body_acceleration; but body_force, medium, swept
});

impl<T: Real> Forces<T> {
    /// Memory for `model`.
    pub fn new(model: &Model) -> Self {
        Self::of(model, &Arc::new(Medium::new(model)))
    }

    pub(crate) fn of(model: &Model, medium: &Arc<Medium>) -> Self {
        let zeros = vec![T::splat(0.0); model.nv];
        let bodies = vec![spatial_zero(); model.bodies.parent.len()];
        Self {
            passive: zeros.clone(),
            compensation: zeros.clone(),
            bias: zeros.clone(),
            actuator: zeros.clone(),
            smooth: zeros.clone(),
            smooth_acceleration: zeros.clone(),
            body_acceleration: bodies.clone(),
            body_force: bodies,
            medium: Arc::clone(medium),
            swept: zeros,
        }
    }
}

/// Sweeps forces on bodies up the tree into generalised forces: out = sum over bodies of (body's Jacobian)' force.
/// On return `body_force` holds the total on every subtree.
#[inline(always)]
pub fn gather<T: Real>(model: &Model, kinematics: &Kinematics<T>, body_force: &mut [Spatial<T>], out: &mut [T]) {
    for body in (1..model.bodies.parent.len()).rev() {
        let force = body_force[body];
        for dof in model.bodies.dofs[body].clone() {
            out[dof] = pair(&kinematics.dof_axis[dof], &force);
        }
        let parent = model.bodies.parent[body];
        if parent > 0 {
            add(&mut body_force[parent], &force);
        }
    }
}

/// Bias forces by recursive Newton-Euler without joint accelerations.
#[inline(always)]
pub fn bias<T: Real>(
    model: &Model,
    state: &State<T>,
    kinematics: &Kinematics<T>,
    body_inertia: &Inertia<T>,
    velocities: &Velocities<T>,
    out: &mut Forces<T>,
) {
    // Gravity enters as an upward acceleration of the world.
    out.body_acceleration[0] = [zero(), -constant(&model.options.gravity)];
    for body in 1..model.bodies.parent.len() {
        let mut acceleration = out.body_acceleration[model.bodies.parent[body]];
        for dof in model.bodies.dofs[body].clone() {
            add_scaled(&mut acceleration, &velocities.dof_axis_rate[dof], state.velocity[dof]);
        }
        out.body_acceleration[body] = acceleration;
        let inertia = &body_inertia.body[body];
        let velocity = &velocities.body[body];
        let mut force = inertia.momentum(&acceleration);
        add(&mut force, &cross_force(velocity, &inertia.momentum(velocity)));
        out.body_force[body] = force;
    }
    gather(model, kinematics, &mut out.body_force, &mut out.bias);
}

/// Springs and dampers of joints and tendons, compensated weight, drag.
#[inline(always)]
pub fn passive<T: Real>(
    model: &Model,
    state: &State<T>,
    kinematics: &Kinematics<T>,
    tendons: &TendonPaths<T>,
    velocities: &Velocities<T>,
    out: &mut Forces<T>,
) {
    for dof in 0..model.nv {
        out.passive[dof] = -state.damping[dof] * state.velocity[dof];
    }
    for joint in 0..model.joints.kind.len() {
        if model.joints.stiffness[joint] != 0.0 {
            joint_spring(model, state, joint, &mut out.passive);
        }
    }
    compensate(model, kinematics, out);
    if !out.medium.is_empty() {
        out.medium.drag(model, kinematics, velocities, &mut out.body_force);
        add_swept(model, kinematics, out);
    }
    let elastic = |tendon: &usize| model.tendons.stiffness[*tendon] != 0.0 || model.tendons.damping[*tendon] != 0.0;
    let tendon_count = model.tendons.path.len();
    if !(0..tendon_count).any(|tendon| elastic(&tendon)) {
        return;
    }
    out.body_force.fill(spatial_zero());
    for tendon in (0..tendon_count).filter(elastic) {
        tendons.pull(tendon, tendon_force(model, tendons, tendon), &mut out.body_force);
    }
    add_swept(model, kinematics, out);
    for tendon in (0..tendon_count).filter(|tendon| tendons.is_fixed(*tendon)).filter(elastic) {
        tendons.pull_joints(tendon, tendon_force(model, tendons, tendon), &mut out.passive);
    }
}

/// Adds the forces on bodies to the passive ones.
#[inline(always)]
fn add_swept<T: Real>(model: &Model, kinematics: &Kinematics<T>, out: &mut Forces<T>) {
    gather(model, kinematics, &mut out.body_force, &mut out.swept);
    for (total, part) in out.passive.iter_mut().zip(&out.swept) {
        *total += *part;
    }
}

/// Fills the forces that balance the weight of bodies and adds them where no actuator provides them.
#[inline(always)]
fn compensate<T: Real>(model: &Model, kinematics: &Kinematics<T>, out: &mut Forces<T>) {
    let shares = &model.bodies.gravity_compensation;
    if shares.iter().all(|share| *share == 0.0) {
        return;
    }
    for (body, share) in shares.iter().enumerate() {
        let force = scale(&constant(&-model.options.gravity), T::splat(*share) * kinematics.mass[body]);
        let arm = kinematics.inertial_position[body] - kinematics.reference(model, body);
        out.body_force[body] = [cross(&arm, &force), force];
    }
    gather(model, kinematics, &mut out.body_force, &mut out.compensation);
    for dof in (0..model.nv).filter(|&dof| !model.joints.actuator_compensates[model.dofs.joint[dof]]) {
        out.passive[dof] += out.compensation[dof];
    }
}

/// Adds the spring of one joint.
#[inline(always)]
fn joint_spring<T: Real>(model: &Model, state: &State<T>, joint: usize, passive: &mut [T]) {
    let joints = &model.joints;
    let stiffness = state.stiffness[joint];
    let address = joints.position_address[joint];
    let dof = joints.dof_address[joint];
    let q = &state.position[address..];
    let mut turn_back = |q: &[T], rest: &[f64], dof: usize| {
        let now = normalize(&[q[0], q[1], q[2], q[3]]);
        let displacement = difference(&now, &constant_quaternion(&[rest[0], rest[1], rest[2], rest[3]]));
        for axis in 0..3 {
            passive[dof + axis] -= stiffness * displacement[axis];
        }
    };
    // A free or ball joint's spring rests at the reference configuration.
    let rest = &model.reference_position[address..];
    match joints.kind[joint] {
        JointKind::Hinge | JointKind::Slide => passive[dof] -= stiffness * (q[0] - T::splat(joints.spring_reference[joint])),
        JointKind::Ball => turn_back(q, rest, dof),
        JointKind::Free => {
            turn_back(&q[3..], &rest[3..], dof + 3);
            for axis in 0..3 {
                passive[dof + axis] -= stiffness * (q[axis] - T::splat(rest[axis]));
            }
        }
    }
}

/// Adds the pulls of all tendons, by spring, damper and actuators, to the forces on bodies. On request.
pub(super) fn pull_tendons(model: &Model, workspace: &Workspace<f64>, body_force: &mut [Spatial<f64>]) {
    let tendons = &workspace.tendons;
    for tendon in 0..model.tendons.path.len() {
        tendons.pull(tendon, tendon_force(model, tendons, tendon), body_force);
    }
    for (actuator, transmission) in model.actuators.transmission.iter().enumerate() {
        if let Transmission::Tendon(tendon) = *transmission {
            let [gear, ..] = model.actuators.gear[actuator];
            tendons.pull(tendon, workspace.actuation.force[actuator] * gear, body_force);
        }
    }
}

/// Force of a tendon's spring, slack between two lengths, and damper, N; positive lengthens.
#[inline(always)]
fn tendon_force<T: Real>(model: &Model, tendons: &TendonPaths<T>, tendon: usize) -> T {
    let (length, velocity) = (tendons.length[tendon], tendons.velocity[tendon]);
    let rest = model.tendons.resting_length[tendon];
    let [low, high] = model.tendons.spring_length[tendon].unwrap_or([rest, rest]);
    let slack = (T::splat(low) - length).at_least(T::splat(0.0)) + (T::splat(high) - length).at_most(T::splat(0.0));
    T::splat(model.tendons.stiffness[tendon]) * slack - T::splat(model.tendons.damping[tendon]) * velocity
}

/// Sums everything but constraints.
#[inline(always)]
pub fn smooth<T: Real>(model: &Model, state: &State<T>, kinematics: &Kinematics<T>, out: &mut Forces<T>) {
    for dof in 0..model.nv {
        out.smooth[dof] = out.passive[dof] - out.bias[dof] + out.actuator[dof] + state.applied_force[dof];
    }
    let nothing = |applied: &[nalgebra::Vector3<T>; 2]| applied.iter().flatten().all(|part| *part == T::splat(0.0));
    if !state.body_force.iter().all(nothing) {
        for (body, [force, torque]) in state.body_force.iter().enumerate() {
            let arm = kinematics.inertial_position[body] - kinematics.reference(model, body);
            out.body_force[body] = [torque + cross(&arm, force), *force];
        }
        gather(model, kinematics, &mut out.body_force, &mut out.swept);
        // Adding nothing would still turn -0.0 into 0.0: an episode's bits must not depend on its neighbours.
        let pushed = T::mask(|lane| !(state.body_force.iter().flatten().flatten()).all(|part| part.lane(lane) == 0.0));
        for (total, part) in out.smooth.iter_mut().zip(&out.swept) {
            *total = T::select(pushed, *total + *part, *total);
        }
    }
}

/// Potential (of gravity and joint springs of hinges and slides) and kinetic energy, J.
pub fn energy<T: Real>(
    model: &Model,
    state: &State<T>,
    kinematics: &Kinematics<T>,
    inertia: &Inertia<T>,
    scratch: &mut [T],
) -> [T; 2] {
    let half = T::splat(0.5);
    let mut potential = T::splat(0.0);
    for body in 1..model.bodies.parent.len() {
        let height = dot(&constant(&model.options.gravity), &kinematics.inertial_position[body]);
        potential -= kinematics.mass[body] * height;
    }
    for joint in 0..model.joints.kind.len() {
        if matches!(model.joints.kind[joint], JointKind::Hinge | JointKind::Slide) {
            let q = state.position[model.joints.position_address[joint]] - T::splat(model.joints.spring_reference[joint]);
            potential += half * state.stiffness[joint] * q * q;
        }
    }
    inertia::multiply(model, &inertia.matrix, &state.velocity, scratch);
    let kinetic = state.velocity.iter().zip(scratch.iter()).fold(T::splat(0.0), |sum, (v, p)| sum + half * *v * *p);
    [potential, kinetic]
}

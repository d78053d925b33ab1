//! What actuators act on besides tendons: joints, sites and bodies in contact, and how far and how fast these are.
//!
//! The moment of an actuator is how its length changes with every dof. It is kept for the dofs that can have one, which
//! are known once per model: those of the joint, or those between a site and the root (and its reference and the root,
//! without the dofs that move both). Site wrenches follow MuJoCo's definition: with a reference, force and torque act in
//! its axes on the site and are answered at the reference's origin. An actuator on a body draws it to what it touches: its
//! moment is the mean over the body's contacts, those in the gap included, of what brings the two sides together along the
//! normal; it has no length.

use crate::{
    batch::one_lane,
    constrained::ConstraintState,
    jacobian::last_dof,
    kinematics::Kinematics,
    model::{JointKind, Model, Transmission},
    rotation::{MINIMUM, constant_quaternion, difference, matrix, multiply, normalize},
    scalar::Real,
    spatial::{Spatial, cross, dot, lane_of, pair, rotate, rotate_back, zero},
    state::State,
};
use core::ops::Range;
use nalgebra::Vector3;
use std::sync::Arc;

/// The dofs that an actuator's length may depend on, and their side: +1 moves the target, -1 what it is measured from. What a
/// body touches may be moved by any.
pub(super) fn entries(model: &Model, transmission: Transmission) -> Vec<(usize, f64)> {
    match transmission {
        Transmission::Tendon(_) => Vec::new(),
        Transmission::Joint(joint) | Transmission::JointInParent(joint) => {
            let first = model.joints.dof_address[joint];
            let count = match model.joints.kind[joint] {
                JointKind::Free => 6,
                JointKind::Ball => 3,
                JointKind::Hinge | JointKind::Slide => 1,
            };
            (first..first + count).map(|dof| (dof, 1.0)).collect()
        }
        Transmission::Body(_) => (0..model.nv).map(|dof| (dof, 1.0)).collect(),
        Transmission::Site { site, reference } => {
            let mut end = last_dof(model, model.sites.body[site]);
            let mut other = reference.and_then(|site| last_dof(model, model.sites.body[site]));
            let mut found = Vec::new();
            // Parents come before their children, so the later of the two is never an ancestor of the other.
            while end != other {
                let (dof, sign) = if end > other { (&mut end, 1.0) } else { (&mut other, -1.0) };
                let Some(index) = *dof else { break };
                found.push((index, sign));
                *dof = model.dofs.parent[index];
            }
            found.sort_unstable_by_key(|(dof, _)| *dof);
            found
        }
    }
}

/// The length around the circle (rad times gear) of an actuator that measures an angle in space, in which a servo takes the
/// short way.
pub(super) fn circle(model: &Model, actuator: usize) -> Option<f64> {
    let [x, y, z, u, v, w] = model.actuators.gear[actuator];
    let norm = |x: f64, y: f64, z: f64| (x * x + y * y + z * z).sqrt();
    let turn = match model.actuators.transmission[actuator] {
        Transmission::Joint(joint) | Transmission::JointInParent(joint) if model.joints.kind[joint] == JointKind::Ball => {
            norm(x, y, z)
        }
        Transmission::Site { reference: Some(_), .. } if norm(x, y, z) <= MINIMUM => norm(u, v, w),
        _ => return None,
    };
    (turn > MINIMUM).then_some(core::f64::consts::TAU * turn)
}

/// Fills the moment of an actuator on the dofs of `sides` and returns its length.
pub(super) fn measure<T: Real>(
    model: &Model,
    state: &State<T>,
    kinematics: &Kinematics<T>,
    lanes: &[ConstraintState],
    actuator: usize,
    sides: &[(usize, f64)],
    moment: &mut [T],
) -> T {
    let gear = model.actuators.gear[actuator].map(T::splat);
    match model.actuators.transmission[actuator] {
        Transmission::Tendon(_) => T::splat(0.0),
        Transmission::Body(body) => {
            adhesion_moment(model, kinematics, lanes, body, moment);
            T::splat(0.0)
        }
        Transmission::Joint(joint) => of_joint(model, state, joint, &gear, false, moment),
        Transmission::JointInParent(joint) => of_joint(model, state, joint, &gear, true, moment),
        Transmission::Site { site, reference } => of_site(model, kinematics, [Some(site), reference], &gear, sides, moment),
    }
}

fn of_joint<T: Real>(model: &Model, state: &State<T>, joint: usize, gear: &[T; 6], in_parent: bool, moment: &mut [T]) -> T {
    let address = model.joints.position_address[joint];
    let [x, y, z, u, v, w] = *gear;
    let q = &state.position[address..];
    let turned = |q: &[T], axis: Vector3<T>| {
        let q = normalize(&[q[0], q[1], q[2], q[3]]);
        let axis = if in_parent { rotate_back(&matrix(&q), &axis) } else { axis };
        (q, axis)
    };
    match model.joints.kind[joint] {
        JointKind::Hinge | JointKind::Slide => {
            moment[0] = x;
            x * q[0]
        }
        JointKind::Ball => {
            let (q, axis) = turned(q, Vector3::new(x, y, z));
            moment.copy_from_slice(axis.as_slice());
            dot(&axis, &difference(&q, &constant_quaternion(&[1.0, 0.0, 0.0, 0.0])))
        }
        JointKind::Free => {
            let (_, axis) = turned(&q[3..], Vector3::new(u, v, w));
            moment[..3].copy_from_slice(&[x, y, z]);
            moment[3..].copy_from_slice(axis.as_slice());
            T::splat(0.0)
        }
    }
}

fn of_site<T: Real>(
    model: &Model,
    kinematics: &Kinematics<T>,
    sites: [Option<usize>; 2],
    gear: &[T; 6],
    sides: &[(usize, f64)],
    moment: &mut [T],
) -> T {
    let [Some(site), reference] = sites else { return T::splat(0.0) };
    let [x, y, z, u, v, w] = *gear;
    let (push, turn) = (Vector3::new(x, y, z), Vector3::new(u, v, w));
    let axes = kinematics.site_rotation(model, reference.unwrap_or(site));
    let (force, torque) = (rotate(&axes, &push), rotate(&axes, &turn));
    let wrench = |site: usize| -> Spatial<T> {
        let body = model.sites.body[site];
        let arm = kinematics.site_position(model, site) - kinematics.reference(model, body);
        [torque + cross(&arm, &force), force]
    };
    let acting = wrench(site);
    let answering = reference.map_or([zero(), zero()], wrench);
    for (&(dof, side), entry) in sides.iter().zip(moment) {
        let axis = &kinematics.dof_axis[dof];
        *entry = if side > 0.0 { pair(axis, &acting) } else { -pair(axis, &answering) };
    }
    let Some(reference) = reference else { return T::splat(0.0) };
    let gap = kinematics.site_position(model, site) - kinematics.site_position(model, reference);
    let orientation = |site: usize| {
        let body = &kinematics.body_orientation[model.sites.body[site]];
        multiply(body, &constant_quaternion(&model.sites.orientation[site]))
    };
    dot(&push, &rotate_back(&axes, &gap)) + dot(&turn, &difference(&orientation(site), &orientation(reference)))
}

/// The moment of an actuator that draws a body to what it touches.
fn adhesion_moment<T: Real>(model: &Model, kinematics: &Kinematics<T>, lanes: &[ConstraintState], body: usize, moment: &mut [T]) {
    moment.fill(T::splat(0.0));
    for (lane, constrained) in lanes.iter().enumerate() {
        let own = |geom: usize| model.geoms.body[geom] == body;
        let touching = || constrained.constraints.contacts.iter().filter(|contact| contact.geoms.into_iter().any(own));
        let share = 1.0 / touching().count().max(1) as f64;
        for contact in touching() {
            let normal = contact.frame.row(0).transpose();
            for (geom, sign) in contact.geoms.into_iter().zip([share, -share]) {
                let body = model.geoms.body[geom];
                let arm = contact.position - lane_of(kinematics.reference(model, body), lane);
                for dof in core::iter::successors(last_dof(model, body), |&dof| model.dofs.parent[dof]) {
                    let [angular, linear] = kinematics.dof_axis[dof].each_ref().map(|part| lane_of(part, lane));
                    let part = sign * (linear + angular.cross(&arm)).dot(&normal);
                    moment[dof].set_lane(lane, moment[dof].lane(lane) + part);
                }
            }
        }
    }
}

/// The moments of all actuators that do not pull tendons.
#[derive(Debug, Clone)]
pub(super) struct Moments<T> {
    /// Dofs and sides of all entries.
    sides: Arc<[(usize, f64)]>,
    values: Vec<T>,
}

one_lane!(Moments { values; but sides });

impl<T: Real> Moments<T> {
    /// Memory for the entries of these dofs and sides.
    pub fn of(sides: &Arc<[(usize, f64)]>) -> Self {
        Self { sides: Arc::clone(sides), values: vec![T::splat(0.0); sides.len()] }
    }

    /// Fills an actuator's entries and returns its length and velocity.
    pub fn update(
        &mut self,
        model: &Model,
        state: &State<T>,
        kinematics: &Kinematics<T>,
        lanes: &[ConstraintState],
        actuator: usize,
        range: Range<usize>,
    ) -> [T; 2] {
        let (sides, values) = (&self.sides[range.clone()], &mut self.values[range.clone()]);
        let length = measure(model, state, kinematics, lanes, actuator, sides, values);
        let velocity = self.entries(range).fold(T::splat(0.0), |sum, (dof, entry)| sum + entry * state.velocity[dof]);
        [length, velocity]
    }

    /// The dofs and moments of an actuator.
    pub fn entries(&self, range: Range<usize>) -> impl Iterator<Item = (usize, T)> + '_ {
        self.sides[range.clone()].iter().zip(&self.values[range]).map(|(&(dof, _), &entry)| (dof, entry))
    }
}

//! Feedback: the accelerations that bring the body back to its reference.
//!
//! Every wish is a proportional-derivative law, taken implicitly over the hold T (Tan, Liu & Turk, Stable proportional-
//! derivative controllers, IEEE CG&A 31, 2011): the error is the one expected at its end and the damping acts on the velocity
//! then,
//!
//! > a = (k (x* - x - T v) - d v) / (1 + T d),
//!
//! which remains stable where the explicit law would oscillate. Where the reference x* moves, the damping acts on the difference to
//! its velocity at the end of the hold, and its acceleration is added to the numerator. The wishes contradict each other (the feet cannot rest while
//! every joint turns as it likes), so they meet in a [`compromise`](super::compromise).

use super::wishes::{CentreWish, Wishes};
use super::{Offsets, Priority, View, goal::Goal, support::Point};
use crate::body::{Body, Joint};
use msk_physics::scalar::Real;
use msk_physics::{State, kinematics::Kinematics, rotation::difference};
use nalgebra::Vector3;

/// Stiffness (1/s²) and damping (1/s) of a wish, and its weight in the compromise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Law {
    stiffness: f64,
    damping: f64,
    pub weight: f64,
}

impl Law {
    /// The acceleration wished for at `error` = x* - x and `velocity`, where the reference has a velocity and an acceleration.
    #[inline(always)]
    pub fn acceleration<T: Real>(&self, error: T, velocity: T, [moving, bending]: [T; 2], hold: f64) -> T {
        let [stiffness, damping, hold] = [self.stiffness, self.damping, hold].map(T::splat);
        let expected = error - hold * velocity;
        (stiffness * expected + damping * (moving - velocity) + bending) / (T::splat(1.0) + hold * damping)
    }
}

// Critically damped where stiff: d = 2 √k.
const JOINTS: Law = Law { stiffness: 500.0, damping: 44.7, weight: 0.3 };
const ROOT: Law = Law { stiffness: 500.0, damping: 44.7, weight: 1.0 };
/// Level position of the centre of mass: slow, since the centre of pressure cannot leave the feet. The body falls like an
/// inverted pendulum at √(g / 0.94 m) = 3.2 1/s, well within the 5.5 1/s of this law.
const BALANCE: Law = Law { stiffness: 30.0, damping: 11.0, weight: 3.0 };
/// Height of the centre of mass.
const HEIGHT: Law = Law { stiffness: 300.0, damping: 34.6, weight: 3.0 };
/// Of the centre of mass along each axis of the world.
pub(super) const CENTRE: [Law; 3] = [BALANCE, BALANCE, HEIGHT];
/// Points of the feet: they shall come to rest where they are.
pub(super) const FEET: Law = Law { stiffness: 0.0, damping: 30.0, weight: 2.0 };
/// With more points of contact than this each counts less, so that a finely divided foot weighs no more than a coarse one.
const FOOT_POINTS: f64 = 8.0;

/// The reference at the beginning of an episode.
#[derive(Debug, Clone)]
pub(super) struct Feedback {
    joints: Vec<JointReference>,
    root: Option<RootReference>,
}

/// Where a joint shall be.
#[derive(Debug, Clone, Copy)]
struct JointReference {
    /// Its place in the body's list.
    index: usize,
    /// Its place in the position vector.
    position: usize,
    dof: usize,
    /// Its coordinate where no goal moves, rad or m.
    value: f64,
}

/// Where a free root shall be.
#[derive(Debug, Clone)]
struct RootReference {
    /// First coordinate and first dof of the free joint.
    address: (usize, usize),
    body: usize,
    orientation: [f64; 4],
    com_height: f64,
}

impl Feedback {
    /// Takes the joints' reference from `pose` (in the order of the body's joints) and the root's from a forward pass of `state`.
    pub fn new(body: &Body, pose: &[f64], state: &State<f64>, kinematics: &Kinematics<f64>) -> Self {
        let independent = body.joints.iter().zip(pose).enumerate().filter(|(_, (joint, _))| joint.independent);
        let joint = |(index, (joint, &value)): (usize, (&Joint, &f64))| JointReference {
            index,
            position: joint.position,
            dof: joint.dof,
            value,
        };
        let root = body.root.free.map(|(position, dof)| RootReference {
            address: (position, dof),
            body: body.root.body,
            orientation: core::array::from_fn(|part| state.position[position + 3 + part]),
            com_height: kinematics.subtree_com[body.root.body].z,
        });
        Self { joints: independent.map(joint).collect(), root }
    }

    /// Wishes for the reference pose, an upright root, the centre of mass above `target` (level position, m) and points of the feet that
    /// bear weight at rest; `offsets` move these targets.
    pub fn hold(
        &self,
        view: &View<'_>,
        body: &Body,
        (feet, target): (impl Iterator<Item = Point>, Option<Vector3<f64>>),
        offsets: &Offsets,
        wishes: &mut Wishes,
    ) {
        wishes.clear(view.coordinates.len());
        wish_joints(&self.joints, view, body, None, offsets, wishes);
        if let Some(root) = &self.root {
            let shift = offsets.shift(body, view);
            let orientation = offsets.orientation(body, &root.orientation);
            wish_orientation(root, view, &orientation, [Vector3::zeros(); 2], wishes);
            if let Some(target) = target {
                let target = target + shift;
                wishes.centre = CentreWish {
                    error: Vector3::new(target.x, target.y, root.com_height + shift.z) - view.com(root.body),
                    factor: offsets.factor(Priority::Balance),
                    ..CentreWish::default()
                };
            }
        }
        wish_rest(feet.map(|point| (point, true)), offsets, wishes);
    }

    /// Wishes for joints, root and centre of mass where and as fast as the goal has them, and those points of the feet that bear weight at
    /// rest of which the goal has it, too; `offsets` move these targets.
    pub fn follow(
        &self,
        view: &View<'_>,
        body: &Body,
        (feet, goal): (impl Iterator<Item = (Point, bool)>, &Goal),
        offsets: &Offsets,
        wishes: &mut Wishes,
    ) {
        wishes.clear(view.coordinates.len());
        wish_joints(&self.joints, view, body, Some(goal), offsets, wishes);
        if let Some(root) = &self.root {
            let first = root.address.0 + 3;
            let orientation = offsets.orientation(body, &core::array::from_fn(|part| goal.position[first + part]));
            wish_orientation(root, view, &orientation, [goal.spin, goal.spin_rate], wishes);
            wishes.centre = CentreWish {
                error: goal.com + offsets.shift(body, view) - view.com(root.body),
                moving: goal.com_velocity,
                bending: goal.com_acceleration,
                factor: offsets.factor(Priority::Balance),
            };
        }
        wish_rest(feet, offsets, wishes);
    }
}

/// Wishes for points of the feet that bear weight, with whether they shall rest.
fn wish_rest(feet: impl Iterator<Item = (Point, bool)>, offsets: &Offsets, wishes: &mut Wishes) {
    wishes.feet.extend(feet.map(|(point, rests)| (point, if rests { 1.0 } else { 0.0 })));
    let resting = wishes.feet.iter().filter(|(_, weight)| *weight > 0.0).count();
    let share = (FOOT_POINTS / resting as f64).at_most(1.0);
    let weight = FEET.weight * offsets.factor(Priority::Feet);
    wishes.feet.iter_mut().for_each(|(_, rests)| *rests *= weight * weight * share);
}

fn wish_joints(
    joints: &[JointReference],
    view: &View<'_>,
    body: &Body,
    goal: Option<&Goal>,
    offsets: &Offsets,
    wishes: &mut Wishes,
) {
    let View { coordinates, state, hold, .. } = *view;
    for &JointReference { index, position, dof, value } in joints {
        let Some(coordinate) = coordinates.of(dof) else { continue };
        let (reference, moving) = match goal {
            Some(goal) => (goal.position[position], [goal.velocity[position], goal.acceleration[position]]),
            None => (value, [0.0; 2]),
        };
        let reference = offsets.joint(body, index, reference);
        let wish = JOINTS.acceleration(reference - state.position[position], state.velocity[dof], moving, hold);
        wishes.add(coordinate, JOINTS.weight, wish);
    }
}

/// `moving` are the reference's angular velocity and acceleration in its own axes.
fn wish_orientation(
    root: &RootReference,
    view: &View<'_>,
    orientation: &[f64; 4],
    moving: [Vector3<f64>; 2],
    wishes: &mut Wishes,
) {
    let View { coordinates, state, hold, .. } = *view;
    let (position, dof) = root.address;
    let now = core::array::from_fn(|part| state.position[position + 3 + part]);
    let error = difference(orientation, &now);
    for axis in 0..3 {
        let Some(coordinate) = coordinates.of(dof + 3 + axis) else { continue };
        let moving = moving.map(|part| part[axis]);
        let wish = ROOT.acceleration(error[axis], state.velocity[dof + 3 + axis], moving, hold);
        wishes.add(coordinate, ROOT.weight, wish);
    }
}

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
//! every joint turns as it likes), so they meet in weighted least squares over the accelerations of the independent
//! coordinates: a whole-body controller in one 77 by 77 system.

use super::{Offsets, Priority, View, dynamics::Motion, goal::Goal, symmetric::Symmetric};
use crate::body::{Body, Joint};
use msk_physics::scalar::Real;
use msk_physics::{State, kinematics::Kinematics, rotation::difference};
use nalgebra::Vector3;

/// Stiffness (1/s²) and damping (1/s) of a wish, and its weight in the compromise.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Law {
    stiffness: f64,
    damping: f64,
    weight: f64,
}

impl Law {
    /// The acceleration wished for at `error` = x* - x and `velocity`.
    fn acceleration(&self, error: f64, velocity: f64, hold: f64) -> f64 {
        self.towards(error, velocity, [0.0; 2], hold)
    }

    /// The same where the reference has a velocity and an acceleration.
    fn towards(&self, error: f64, velocity: f64, [moving, bending]: [f64; 2], hold: f64) -> f64 {
        let expected = error - hold * velocity;
        (self.stiffness * expected + self.damping * (moving - velocity) + bending) / (1.0 + hold * self.damping)
    }

    fn vector(&self, error: &Vector3<f64>, velocity: &Vector3<f64>, hold: f64) -> Vector3<f64> {
        error.zip_map(velocity, |error, velocity| self.acceleration(error, velocity, hold))
    }
}

// Critically damped where stiff: d = 2 √k.
const JOINTS: Law = Law { stiffness: 500.0, damping: 44.7, weight: 0.3 };
const ROOT: Law = Law { stiffness: 500.0, damping: 44.7, weight: 1.0 };
/// Height of the centre of mass.
const HEIGHT: Law = Law { stiffness: 300.0, damping: 34.6, weight: 3.0 };
/// Level position of the centre of mass: slow, since the centre of pressure cannot leave the feet. The body falls like an
/// inverted pendulum at √(g / 0.94 m) = 3.2 1/s, well within the 5.5 1/s of this law.
const BALANCE: Law = Law { stiffness: 30.0, damping: 11.0, weight: 3.0 };
/// Points of the feet: they shall come to rest where they are.
const FEET: Law = Law { stiffness: 0.0, damping: 30.0, weight: 2.0 };
/// With more points of contact than this each counts less, so that a finely divided foot weighs no more than a coarse one.
const FOOT_POINTS: f64 = 8.0;
/// Keeps what no wish asks for at rest.
const REST: f64 = 1e-6;

/// The reference at the beginning of an episode.
#[derive(Debug, Clone)]
pub(super) struct Feedback {
    joints: Vec<JointReference>,
    root: Option<RootReference>,
}

/// The least-squares compromise between the wishes of one control step.
#[derive(Debug, Clone)]
pub(super) struct Compromise {
    normal: Symmetric,
    /// Accelerations of the independent coordinates, after [`Feedback::accelerations`] or [`Feedback::towards`].
    pub wanted: Vec<f64>,
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

    /// Fills the compromise between the reference pose, an upright root, the centre of mass above `target` (level
    /// position, m) and resting `feet`; `offsets` move these targets.
    pub fn accelerations(
        &self,
        view: &View<'_>,
        body: &Body,
        (feet, target): (&[Motion], Option<Vector3<f64>>),
        offsets: &Offsets,
        compromise: &mut Compromise,
    ) {
        compromise.clear();
        compromise.joint_wishes(&self.joints, view, body, None, offsets);
        if let Some(mut root) = self.root.clone() {
            let shift = offsets.shift(body, view);
            root.orientation = offsets.orientation(body, &root.orientation);
            root.com_height += shift.z;
            compromise.root_wish(&root, view, [Vector3::zeros(); 2]);
            if let Some(target) = target {
                compromise.balance_wish(&root, view, target + shift, offsets);
            }
        }
        compromise.settle(view, feet, offsets);
    }

    /// Fills the compromise between joints, root and centre of mass where and as fast as the goal has them, and resting
    /// `feet`; `offsets` move these targets.
    pub fn towards(
        &self,
        view: &View<'_>,
        body: &Body,
        (feet, goal): (&[Motion], &Goal),
        offsets: &Offsets,
        compromise: &mut Compromise,
    ) {
        compromise.clear();
        compromise.joint_wishes(&self.joints, view, body, Some(goal), offsets);
        if let Some(mut root) = self.root.clone() {
            let first = root.address.0 + 3;
            root.orientation = offsets.orientation(body, &core::array::from_fn(|part| goal.position[first + part]));
            compromise.root_wish(&root, view, [goal.spin, goal.spin_rate]);
            compromise.centre_wish(&root, view, goal, offsets.shift(body, view), offsets);
        }
        compromise.settle(view, feet, offsets);
    }
}

impl Compromise {
    /// Memory for so many independent coordinates.
    pub fn new(size: usize) -> Self {
        Self { normal: Symmetric::new(size), wanted: vec![0.0; size] }
    }

    fn clear(&mut self) {
        self.normal.clear();
        self.wanted.fill(0.0);
        for coordinate in 0..self.wanted.len() {
            self.normal.add(coordinate, coordinate, REST);
        }
    }

    /// Adds the wish for resting feet and solves.
    fn settle(&mut self, view: &View<'_>, feet: &[Motion], offsets: &Offsets) {
        let share = (FOOT_POINTS / feet.len() as f64).at_most(1.0);
        let weight = FEET.weight * offsets.factor(Priority::Feet);
        for point in feet {
            let wish = FEET.vector(&Vector3::zeros(), &point.velocity(view.velocities), view.hold);
            self.point_wish(point, &wish, &Vector3::repeat(weight * weight * share));
        }
        self.normal.factor();
        self.normal.solve(&mut self.wanted);
    }

    fn joint_wishes(&mut self, joints: &[JointReference], view: &View<'_>, body: &Body, goal: Option<&Goal>, offsets: &Offsets) {
        let View { coordinates, state, hold, .. } = *view;
        for &JointReference { index, position, dof, value } in joints {
            let Some((column, _)) = coordinates.entry(dof) else { continue };
            let (reference, moving) = match goal {
                Some(goal) => (goal.position[position], [goal.velocity[position], goal.acceleration[position]]),
                None => (value, [0.0; 2]),
            };
            let reference = offsets.joint(body, index, reference);
            let wish = JOINTS.towards(reference - state.position[position], state.velocity[dof], moving, hold);
            self.normal.add(column, column, JOINTS.weight * JOINTS.weight);
            self.wanted[column] += JOINTS.weight * JOINTS.weight * wish;
        }
    }

    /// `moving` are the reference's angular velocity and acceleration in its own axes.
    fn root_wish(&mut self, root: &RootReference, view: &View<'_>, moving: [Vector3<f64>; 2]) {
        let View { coordinates, state, hold, .. } = *view;
        let (position, dof) = root.address;
        let now = core::array::from_fn(|part| state.position[position + 3 + part]);
        let error = difference(&root.orientation, &now);
        for axis in 0..3 {
            let Some((column, _)) = coordinates.entry(dof + 3 + axis) else { continue };
            let moving = moving.map(|part| part[axis]);
            let wish = ROOT.towards(error[axis], state.velocity[dof + 3 + axis], moving, hold);
            self.normal.add(column, column, ROOT.weight * ROOT.weight);
            self.wanted[column] += ROOT.weight * ROOT.weight * wish;
        }
    }

    fn balance_wish(&mut self, root: &RootReference, view: &View<'_>, target: Vector3<f64>, offsets: &Offsets) {
        let View { hold, velocities, .. } = *view;
        let com = Motion::of_com(view, root.body);
        let velocity = com.velocity(velocities);
        let error = Vector3::new(target.x, target.y, root.com_height) - view.workspace.kinematics.subtree_com[root.body];
        let mut wish = BALANCE.vector(&error, &velocity, hold);
        wish.z = HEIGHT.acceleration(error.z, velocity.z, hold);
        let factor = offsets.factor(Priority::Balance);
        let weight =
            Vector3::new(BALANCE.weight, BALANCE.weight, HEIGHT.weight).map(|weight| factor * weight * (factor * weight));
        self.point_wish(&com, &wish, &weight);
    }

    /// The centre of mass where the goal has it.
    fn centre_wish(&mut self, root: &RootReference, view: &View<'_>, goal: &Goal, shift: Vector3<f64>, offsets: &Offsets) {
        let com = Motion::of_com(view, root.body);
        let velocity = com.velocity(view.velocities);
        let error = goal.com + shift - view.workspace.kinematics.subtree_com[root.body];
        let law = |axis: usize| if axis == 2 { HEIGHT } else { BALANCE };
        let wish = core::array::from_fn::<f64, 3, _>(|axis| {
            law(axis).towards(error[axis], velocity[axis], [goal.com_velocity[axis], goal.com_acceleration[axis]], view.hold)
        });
        let factor = offsets.factor(Priority::Balance);
        let weight = Vector3::from_fn(|axis, _| factor * law(axis).weight * (factor * law(axis).weight));
        self.point_wish(&com, &Vector3::from(wish), &weight);
    }

    /// Adds the wish for an acceleration (m/s²) of a point; `weight` is squared already.
    fn point_wish(&mut self, point: &Motion, wish: &Vector3<f64>, weight: &Vector3<f64>) {
        for (count, (row, motion)) in point.columns.iter().enumerate() {
            let weighted = motion.component_mul(weight);
            self.wanted[*row] += weighted.dot(wish);
            for (column, other) in &point.columns[..=count] {
                self.normal.add(*row, *column, weighted.dot(other));
            }
        }
    }
}

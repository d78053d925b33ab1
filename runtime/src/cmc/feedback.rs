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

use super::wishes::{CentreWish, PointWish, Wishes};
use super::{Offsets, Priority, View, gait::Step, goal::Goal, support::Point, turning};
use crate::body::{Body, Joint};
use msk_physics::scalar::Real;
use msk_physics::{State, kinematics::Kinematics, rotation::difference};
use nalgebra::Vector3;

/// Stiffness (1/s²) and damping (1/s) of a wish, and its weight in the compromise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Law {
    pub stiffness: f64,
    pub damping: f64,
    pub weight: f64,
}

impl Law {
    /// The acceleration wished for at `error` = x* - x and `velocity`, where the reference has a velocity and an acceleration.
    fn acceleration(&self, error: f64, velocity: f64, reference: [f64; 2], hold: f64) -> f64 {
        acceleration([self.stiffness, self.damping], error, velocity, reference, hold)
    }

    /// Critically damped.
    pub const fn critical(stiffness: f64, root: f64, weight: f64) -> Self {
        Self { stiffness, damping: 2.0 * root, weight }
    }

    /// As many times as stiff, and damped as well as before.
    fn firm(self, times: f64) -> Self {
        Self { stiffness: self.stiffness * times, damping: self.damping * times.sqrt(), ..self }
    }
}

/// The acceleration that a stiffness (1/s²) and a damping (1/s) wish for at `error` = x* - x and `velocity`, where the reference has a velocity and
/// an acceleration.
#[inline(always)]
pub(super) fn acceleration<T: Real>(law: [T; 2], error: T, velocity: T, reference: [T; 2], hold: f64) -> T {
    let ([stiffness, damping], [moving, bending], hold) = (law, reference, T::splat(hold));
    let expected = error - hold * velocity;
    (stiffness * expected + damping * (moving - velocity) + bending) / (T::splat(1.0) + hold * damping)
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
/// The same of a body that hangs: it is its own pendulum, and muscles that are at their limit would swing it higher and higher if its height came
/// first, so that it does not sway comes first, and it is pulled up gently.
pub(super) const HANGING: [Law; 3] = [SWAY, SWAY, Law { stiffness: 250.0, damping: 60.0, weight: 2.0 }];
const SWAY: Law = Law { stiffness: 200.0, damping: 40.0, weight: 12.0 };
/// Points of the feet: they shall come to rest where they are.
pub(super) const FEET: Law = Law { stiffness: 0.0, damping: 30.0, weight: 2.0 };

// A gait has to give way: to a foot on its way, and to muscles that take tens of milliseconds to follow. The numbers were found by random searches
// for what walks furthest on level ground, waves and stairs.
const WALKING_JOINTS: Law = Law::critical(163.0, 12.8, 0.22);
/// Joints of the legs bend as the feet have it.
const WALKING_LEGS: Law = Law { weight: 0.023, ..WALKING_JOINTS };
const WALKING_ROOT: Law = Law::critical(80.0, 8.9, 1.5);
const WALKING_LEVEL: Law = Law { stiffness: 0.0, damping: 0.0, weight: 3.8 };
const WALKING_CENTRE: [Law; 3] = [WALKING_LEVEL, WALKING_LEVEL, Law::critical(197.0, 14.0, 1.4)];

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
    /// Of one that moves a foot: where it shall be in a gait.
    walking: Option<f64>,
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

/// Where a pose has been carried since it was taken.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Carried {
    /// To the left, rad.
    pub turned: f64,
    /// Up, m.
    pub risen: f64,
}

impl Feedback {
    /// Takes the joints' reference from `pose` (in the order of the body's joints) and the root's from a forward pass of `state`; `legs` are the dofs
    /// that move the feet.
    pub fn new(body: &Body, pose: &[f64], legs: &[usize], state: &State<f64>, kinematics: &Kinematics<f64>) -> Self {
        let neutral = body.neutral();
        let independent = body.joints.iter().zip(pose).enumerate().filter(|(_, (joint, _))| joint.independent);
        let joint = |(index, (joint, &value)): (usize, (&Joint, &f64))| JointReference {
            index,
            position: joint.position,
            dof: joint.dof,
            value,
            walking: if legs.contains(&joint.dof) { neutral.get(index).copied() } else { None },
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
        Carried { turned, risen }: Carried,
        offsets: &Offsets,
        wishes: &mut Wishes,
    ) {
        wishes.clear(view.coordinates.len());
        wish_joints(&self.joints, Toward::Pose, view, body, offsets, wishes);
        if let Some(root) = &self.root {
            let shift = offsets.shift(body, view);
            let orientation = offsets.orientation(body, &turning::orientation(&root.orientation, turned));
            wish_orientation(root, &ROOT, view, &orientation, [Vector3::zeros(); 2], wishes);
            if let Some(target) = target {
                let target = target + shift;
                wishes.centre = CentreWish {
                    error: Vector3::new(target.x, target.y, root.com_height + risen + shift.z) - view.com(root.body),
                    factor: offsets.factor(Priority::Balance),
                    ..CentreWish::default()
                };
            }
        }
        wish_rest(feet.map(|point| (point, true)), offsets, wishes);
    }

    /// Wishes for changes of coordinates (rad or m) from where they are now, within the ranges of their joints.
    pub fn wish_changes(
        &self,
        changes: impl Iterator<Item = (usize, f64)>,
        law: &Law,
        (view, body): (&View<'_>, &Body),
        wishes: &mut Wishes,
    ) {
        for (coordinate, change) in changes {
            let of_joint = |joint: &&JointReference| view.coordinates.of(joint.dof) == Some(coordinate);
            let Some(joint) = self.joints.iter().find(of_joint) else { continue };
            let now = view.state.position[joint.position];
            let target = body.joints[joint.index].within_range(now + change);
            let wish = law.acceleration(target - now, view.state.velocity[joint.dof], [0.0; 2], view.hold);
            wishes.add(coordinate, law.weight, wish);
        }
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
        wish_joints(&self.joints, Toward::Goal(goal), view, body, offsets, wishes);
        if let Some(root) = &self.root {
            let first = root.address.0 + 3;
            let orientation = offsets.orientation(body, &core::array::from_fn(|part| goal.position[first + part]));
            wish_orientation(root, &ROOT, view, &orientation, [goal.spin, goal.spin_rate], wishes);
            wishes.centre = CentreWish {
                error: goal.com + offsets.shift(body, view) - view.com(root.body),
                moving: goal.com_velocity,
                bending: goal.com_acceleration,
                factor: offsets.factor(Priority::Balance),
                ..CentreWish::default()
            };
        }
        wish_rest(feet, offsets, wishes);
    }

    /// Wishes for a step of a gait: the centre of mass is accelerated as the pressure under the feet has it, one foot goes its way, the other
    /// rests; joints are as in the reference pose, those of the legs nearly as in the
    /// neutral one. `offsets` move the targets of joints and root, and the height.
    pub fn walk(&self, view: &View<'_>, body: &Body, (points, step): (&[Point], &Step), offsets: &Offsets, wishes: &mut Wishes) {
        wishes.clear(view.coordinates.len());
        let [root_times, joint_times] = step.firmness();
        wish_joints(&self.joints, Toward::Walking { firm: joint_times }, view, body, offsets, wishes);
        if let Some(root) = &self.root {
            let orientation = offsets.orientation(body, &step.orientation);
            wish_orientation(root, &WALKING_ROOT.firm(root_times), view, &orientation, [step.spin, Vector3::zeros()], wishes);
            wishes.centre = CentreWish {
                error: Vector3::z() * (step.height + offsets.center_of_mass.z - view.com(root.body).z),
                moving: Vector3::z() * step.rise,
                bending: Vector3::new(step.acceleration.x, step.acceleration.y, 0.0),
                laws: WALKING_CENTRE,
                factor: offsets.factor(Priority::Balance),
            };
        }
        wishes.points.extend(points.iter().filter_map(|point| step.wish(point)));
        let factor = offsets.factor(Priority::Feet);
        share_weight(factor * factor, wishes);
    }
}

/// Wishes for points of the feet that bear weight, with whether they shall rest.
fn wish_rest(feet: impl Iterator<Item = (Point, bool)>, offsets: &Offsets, wishes: &mut Wishes) {
    wishes.points.extend(feet.map(|(point, rests)| PointWish::at_rest(point, if rests { 1.0 } else { 0.0 })));
    let weight = FEET.weight * offsets.factor(Priority::Feet);
    share_weight(weight * weight, wishes);
}

/// Multiplies the weights of points of the feet: all together weigh no more than [`FOOT_POINTS`].
fn share_weight(weight: f64, wishes: &mut Wishes) {
    let counting = wishes.points.iter().filter(|wish| wish.law.weight > 0.0).count();
    let share = (FOOT_POINTS / counting as f64).at_most(1.0);
    wishes.points.iter_mut().for_each(|wish| wish.law.weight *= weight * share);
}

/// Where joints shall be.
#[derive(Clone, Copy)]
enum Toward<'a> {
    /// In the reference pose.
    Pose,
    /// Where a goal has them.
    Goal(&'a Goal),
    /// In the reference pose, but for those of the legs, and so many times as stiff as usual.
    Walking { firm: f64 },
}

fn wish_joints(
    joints: &[JointReference],
    toward: Toward<'_>,
    view: &View<'_>,
    body: &Body,
    offsets: &Offsets,
    wishes: &mut Wishes,
) {
    let View { coordinates, state, hold, .. } = *view;
    for &JointReference { index, position, dof, value, walking } in joints {
        let Some(coordinate) = coordinates.of(dof) else { continue };
        let (reference, moving, law) = match (toward, walking) {
            (Toward::Pose, _) => (value, [0.0; 2], JOINTS),
            (Toward::Goal(goal), _) => (goal.position[position], [goal.velocity[position], goal.acceleration[position]], JOINTS),
            (Toward::Walking { firm }, None) => (value, [0.0; 2], WALKING_JOINTS.firm(firm)),
            (Toward::Walking { .. }, Some(neutral)) => (neutral, [0.0; 2], WALKING_LEGS),
        };
        let reference = offsets.joint(body, index, reference);
        let wish = law.acceleration(reference - state.position[position], state.velocity[dof], moving, hold);
        wishes.add(coordinate, law.weight, wish);
    }
}

/// `moving` are the reference's angular velocity and acceleration in its own axes.
fn wish_orientation(
    root: &RootReference,
    law: &Law,
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
        let wish = law.acceleration(error[axis], state.velocity[dof + 3 + axis], moving, hold);
        wishes.add(coordinate, law.weight, wish);
    }
}

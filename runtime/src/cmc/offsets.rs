//! Offsets of the targets that the controller tracks.

use super::{View, gait::Walk};
use crate::body::Body;
use msk_physics::rotation;
use nalgebra::Vector3;

/// By how much targets are moved; nothing by default.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Offsets {
    /// Of joints, by their place in the body's list, rad; others are not moved.
    pub joints: Vec<(usize, f64)>,
    /// Of the centre of mass: forward, left, up in the root's heading, m.
    pub center_of_mass: Vector3<f64>,
    /// Of the root's orientation: a rotation vector along its axes forward, left, up, rad.
    pub root: Vector3<f64>,
    /// Of hands, which are landmarks, from where they are when an episode begins: along the root's heading forward, left, up, m.
    pub hands: Vec<(usize, Vector3<f64>)>,
    /// How much more (or less) balance and resting feet count than usual: natural logarithms of factors of their weights.
    pub priorities: [f64; 2],
    /// How the body shall walk, where it walks.
    pub walk: Walk,
    /// Whether a body that walks shall go on with the demonstration instead, from now on.
    pub changes_over: bool,
}

/// What counts against the joints in the compromise of wishes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Priority {
    /// The centre of mass.
    Balance,
    /// Points of the feet on the ground.
    Feet,
}

impl Offsets {
    /// The factor of a weight; exactly 1 where nothing is asked for.
    pub(super) fn factor(&self, priority: Priority) -> f64 {
        libm::exp(self.priorities[priority as usize])
    }

    /// The target of a joint with its offset, kept within the joint's range.
    pub(super) fn joint(&self, body: &Body, index: usize, target: f64) -> f64 {
        let Some((_, offset)) = self.joints.iter().find(|(joint, _)| *joint == index) else { return target };
        body.joints[index].within_range(target + offset)
    }

    /// The target orientation of the root with its offset.
    pub(super) fn orientation(&self, body: &Body, target: &[f64; 4]) -> [f64; 4] {
        if self.root == Vector3::zeros() {
            return *target;
        }
        rotation::integrate(target, &(body.root.axes * self.root), 1.0)
    }

    /// The shift of the centre of mass in world axes, m.
    pub(super) fn shift(&self, body: &Body, view: &View<'_>) -> Vector3<f64> {
        if self.center_of_mass == Vector3::zeros() {
            return Vector3::zeros();
        }
        body.root_heading(&view.workspace.kinematics) * self.center_of_mass
    }
}

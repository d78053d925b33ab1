//! A body file bound to its model: names become indices, poses become coordinates, landmarks get their frames.
//!
//! 1. [`bind`](Body::bind) resolves every name of a body file in a [`Model`] and reports all problems at once;
//! 2. [`Body::vocabulary`] tells the compiler what exists;
//! 3. [`Body::place`] puts the body into a pose with its lowest point on the ground, facing where it should;
//! 4. [`sensors`] measures the quantities that a compiled task reads.
//!
//! The model may hold more than the body (a ground, scenery): whole-body quantities are those of the root's own subtree.

mod alignment;
mod bind;
mod changes;
pub mod contacts;
pub(crate) mod coupling;
mod metabolism;
mod motion;
mod parts;
mod placement;
mod queries;
pub mod sensors;
pub mod shape;
mod support;
mod vocabulary;

pub use alignment::{InitialGuess, OutOfReach};
pub use bind::{BindError, Problem, subtree};
pub use changes::ChangeError;

use core::ops::Range;
use msk_physics::kinematics::Kinematics;
use msk_physics::model::{JointKind, Model};
use msk_physics::scalar::Real;
use msk_program::body::{Axis, ExcitationMap};
use msk_program::vocabulary::GroupKind;
use nalgebra::{Matrix3, Vector3};

/// A body file bound to a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name in tasks.
    pub name: String,
    /// How a policy's action becomes excitation.
    pub excitation: ExcitationMap,
    /// The body of the model that everything hangs on.
    pub root: Root,
    /// The root and all bodies of the model that hang on it.
    pub members: Range<usize>,
    /// Those of them that a scene has put there: carried, but no part of the body.
    pub carried: Vec<usize>,
    /// The body's own mass, kg.
    pub mass: f64,
    /// Landmarks, in the order of the body file.
    pub landmarks: Vec<Landmark>,
    /// Hinges and slides, in the order of the model.
    pub joints: Vec<Joint>,
    /// Muscles, in the order of the model.
    pub muscles: Vec<Muscle>,
    /// Named sets, in the order of the body file.
    pub groups: Vec<msk_program::vocabulary::Group>,
    /// Named poses with couplings solved, coordinates in the order of `joints`; one of them is `neutral`.
    pub poses: Vec<msk_program::vocabulary::Pose>,
    /// The model's couplings, leaders before followers.
    pub couplings: Vec<usize>,
    /// Shapes of the body that can touch the ground.
    pub shapes: Vec<usize>,
    /// Shapes to stand and walk on; none means the level z = 0.
    pub ground: Vec<usize>,
    /// Those of them that are the level ground.
    pub level: Vec<usize>,
    /// Objects of the scene, in its order; their landmarks are the last of `landmarks`.
    pub objects: Vec<Object>,
    /// What the scene holds together, in its order.
    pub connections: Vec<Connection>,
}

/// Two things that a scene holds together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Connection {
    /// The equality of the model.
    pub equality: usize,
    /// Whether they are held as they stand when an episode begins.
    pub here: bool,
}

/// An object of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Its body.
    pub body: usize,
    /// First coordinate and first dof of its free joint.
    pub free: Option<(usize, usize)>,
    /// Its place among the bodies that are placed from outside, if it is one: every episode may have it elsewhere.
    pub placed: Option<usize>,
    /// Its own shapes.
    pub shapes: Vec<usize>,
}

/// The body of the model that carries the whole body.
#[derive(Debug, Clone, PartialEq)]
pub struct Root {
    /// Its index.
    pub body: usize,
    /// Anatomical axes forward, left, up as columns in the root's frame.
    pub axes: Matrix3<f64>,
    /// First coordinate and first dof of its free joint; `None` for a body fixed to the world.
    pub free: Option<(usize, usize)>,
}

/// A named place with anatomical axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Landmark {
    /// Name in tasks.
    pub name: String,
    /// One sentence for hovers.
    pub description: String,
    /// Body of the model that carries it.
    pub body: usize,
    /// Position in that body's frame, m.
    pub point: Vector3<f64>,
    /// Anatomical axes forward, left, up as columns in that body's frame.
    pub axes: Matrix3<f64>,
    /// Shapes of its segment.
    pub segment: Vec<usize>,
    /// Whether it is an object of the scene and no part of the body.
    pub of_scene: bool,
}

/// A hinge or slide.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name in tasks.
    pub name: String,
    /// Index in the model.
    pub index: usize,
    /// Turns or slides.
    pub kind: JointKind,
    /// Its coordinate in the position vector.
    pub position: usize,
    /// Its degree of freedom.
    pub dof: usize,
    /// Range if limited, rad or m.
    pub range: Option<[f64; 2]>,
    /// Whether no coupling determines it to another joint.
    pub independent: bool,
    /// Whether it belongs to an object of the scene.
    pub of_scene: bool,
}

impl Joint {
    /// The coordinate within its range that is nearest to another, rad or m.
    pub(crate) fn within_range(&self, coordinate: f64) -> f64 {
        self.range.map_or(coordinate, |[low, high]| coordinate.clip(low, high))
    }
}

/// A muscle.
#[derive(Debug, Clone, PartialEq)]
pub struct Muscle {
    /// Name in tasks.
    pub name: String,
    /// Peak isometric force, N.
    pub peak_force: f64,
    /// Recruitment family; empty if the body file has none.
    pub family: String,
}

impl Body {
    /// The body's own parts: members that are not carried.
    pub fn own(&self) -> impl Iterator<Item = usize> + '_ {
        self.members.clone().filter(|member| !self.carried.contains(member))
    }

    /// Whether a body of the model is a part of this body.
    pub fn owns(&self, body: usize) -> bool {
        self.members.contains(&body) && !self.carried.contains(&body)
    }

    /// The body's own centre of mass, without what it carries, m.
    pub fn centre_of_mass(&self, model: &Model, kinematics: &Kinematics<f64>) -> Vector3<f64> {
        let all = kinematics.subtree_com[self.root.body];
        if self.carried.is_empty() {
            return all;
        }
        let (total, mass) = (kinematics.subtree_mass[self.root.body], &kinematics.mass);
        let load: Vector3<f64> = self.carried.iter().map(|&body| kinematics.inertial_position[body] * mass[body]).sum();
        (all * total - load) / self.own_mass(model, kinematics)
    }

    /// Mass of the body without what it carries, kg.
    pub fn own_mass(&self, model: &Model, kinematics: &Kinematics<f64>) -> f64 {
        self.mass + self.own().map(|body| kinematics.mass[body] - model.bodies.mass[body]).sum::<f64>()
    }

    /// The pose of that name: coordinates in the order of `joints`, rad or m.
    pub fn pose(&self, name: &str) -> Option<&[f64]> {
        self.poses.iter().find(|pose| pose.name == name).map(|pose| pose.coordinates.as_slice())
    }

    /// Sets the coordinates of all coupled joints in `position` (length `nq`) from those that lead them.
    pub fn solve_couplings(&self, model: &Model, position: &mut [f64]) {
        coupling::solve(model, &self.couplings, position);
    }

    /// Sets the velocities of all coupled joints in `velocity` (length `nv`) from those that lead them, at `position`.
    pub fn solve_coupled_velocities(&self, model: &Model, position: &[f64], velocity: &mut [f64]) {
        coupling::solve_velocities(model, &self.couplings, position, velocity);
    }

    /// The landmarks of the group `hands`; none where the body has no such group.
    pub fn hands(&self) -> &[usize] {
        self.landmark_group("hands").unwrap_or_default()
    }

    /// The members of a group of landmarks.
    pub(crate) fn landmark_group(&self, name: &str) -> Option<&[usize]> {
        let group = self.groups.iter().find(|group| group.kind == GroupKind::Landmarks && group.name == name);
        group.map(|group| group.members.as_slice())
    }

    /// The coordinates of the standing pose, in the order of `joints`, rad or m.
    pub fn neutral(&self) -> &[f64] {
        // Binding fails without this pose.
        self.pose(NEUTRAL).unwrap_or_default()
    }
}

/// The pose that `neutral(...)` in tasks refers to.
pub const NEUTRAL: &str = "neutral";

/// The unit vector of a signed axis.
fn unit(axis: Axis) -> Vector3<f64> {
    match axis {
        Axis::PlusX => Vector3::x(),
        Axis::MinusX => -Vector3::x(),
        Axis::PlusY => Vector3::y(),
        Axis::MinusY => -Vector3::y(),
        Axis::PlusZ => Vector3::z(),
        Axis::MinusZ => -Vector3::z(),
    }
}

/// The axes forward, left, up as columns, or `None` where forward and up lie on one line.
fn anatomical_axes(forward: Axis, up: Axis) -> Option<Matrix3<f64>> {
    let (forward, up) = (unit(forward), unit(up));
    let left = up.cross(&forward);
    (left != Vector3::zeros()).then(|| Matrix3::from_columns(&[forward, left, up]))
}

#[cfg(test)]
mod tests;

//! What exists on a body and in a scene, as the compiler needs to know it.
//!
//! The runtime makes a [`Vocabulary`] from a model and a body file; the checker resolves names against it. It is plain data:
//! it can be printed for people, written as JSON for agents, and kept as a fixture for tests that need no physics.

use crate::scene::{Motion, ObjectJointKind, Parent, SceneDescription};
use serde::{Deserialize, Serialize};

/// A closed interval.
pub type Interval = [f64; 2];

/// Everything that a task on this body may name.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Vocabulary {
    /// Name of the body file's body.
    pub body: String,
    /// Physics step, s.
    pub physics_step: f64,
    /// Total mass of the body, kg.
    pub mass: f64,
    /// Magnitude of gravity, m/s².
    pub gravity: f64,
    /// Place of the centre of mass in the standing pose, m.
    pub neutral_com: [f64; 3],
    /// Named places with anatomical axes.
    pub landmarks: Vec<Landmark>,
    /// Hinges and slides (the root is not among them).
    pub joints: Vec<Joint>,
    /// Muscles.
    pub muscles: Vec<Muscle>,
    /// Named sets of joints, muscles or landmarks.
    pub groups: Vec<Group>,
    /// Named poses.
    pub poses: Vec<Pose>,
}

/// A named place on a body segment with anatomical axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Landmark {
    /// Name in tasks.
    pub name: String,
    /// One sentence for hovers.
    pub description: String,
    /// Mass of the body that carries it, kg.
    pub mass: f64,
    /// Place in the standing pose, feet on the ground, root above the origin, facing x, m.
    pub neutral_position: [f64; 3],
    /// Axes forward, left, up in the standing pose, one after the other, in world axes.
    pub neutral_axes: [f64; 9],
    /// Whether it has a segment of geoms, which `touching` and `clearance` need.
    pub has_segment: bool,
    /// Whether it is an object of the scene and no part of the body.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub of_scene: bool,
}

/// Whether a joint turns or slides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// Coordinates in rad.
    Hinge,
    /// Coordinates in m.
    Slide,
}

/// A hinge or slide.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Name in tasks.
    pub name: String,
    /// Turns or slides.
    pub kind: JointKind,
    /// Range, rad or m; the whole line if unlimited.
    pub range: Option<Interval>,
    /// Coordinate in the standing pose, rad or m.
    pub neutral: f64,
    /// Whether no coupling slaves it to another joint.
    pub independent: bool,
    /// Whether it belongs to an object of the scene: no set of the body's joints holds it.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub of_scene: bool,
}

/// A muscle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Muscle {
    /// Name in tasks.
    pub name: String,
    /// Peak isometric force, N.
    pub peak_force: f64,
    /// Recruitment family.
    pub family: String,
}

/// What a group holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GroupKind {
    /// Indices into `joints`.
    Joints,
    /// Indices into `muscles`.
    Muscles,
    /// Indices into `landmarks`.
    Landmarks,
}

/// A named set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// Name in tasks.
    pub name: String,
    /// What it holds.
    pub kind: GroupKind,
    /// Indices of the members, in the order of the body file.
    pub members: Vec<usize>,
}

/// A named pose: every joint's coordinate with couplings solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Name in tasks.
    pub name: String,
    /// Coordinates in the order of `joints`, rad or m.
    pub coordinates: Vec<f64>,
}

impl Vocabulary {
    /// The vocabulary of this body in `scene`: objects become landmarks, their hinges and slides joints, both appended in the
    /// order of the scene; groups of objects become groups of landmarks.
    #[must_use]
    pub fn with_scene(&self, scene: &SceneDescription) -> Self {
        let mut whole = self.clone();
        let first = whole.landmarks.len();
        for (object, mass) in scene.objects.iter().zip(scene.masses()) {
            let (origin, axes) = match &object.parent {
                Parent::World => ([0.0; 3], IDENTITY),
                Parent::Object(parent) => place_of(&whole.landmarks[first + parent]),
                Parent::Landmark(name) => {
                    whole.landmarks.iter().find(|landmark| landmark.name == *name).map_or(([0.0; 3], IDENTITY), place_of)
                }
            };
            let offset = turned(&axes, object.position);
            whole.landmarks.push(Landmark {
                name: object.name.clone(),
                description: object.description.clone(),
                mass,
                neutral_position: core::array::from_fn(|k| origin[k] + offset[k]),
                neutral_axes: composed(&axes, object.orientation),
                has_segment: object.shape.is_some() && object.surface.solid,
                of_scene: true,
            });
            let Motion::Joints(joints) = &object.motion else { continue };
            for joint in joints {
                let kind = match joint.kind {
                    ObjectJointKind::Hinge => JointKind::Hinge,
                    ObjectJointKind::Slide => JointKind::Slide,
                    ObjectJointKind::Ball => continue,
                };
                let name = joint.name.clone();
                whole.joints.push(Joint { name, kind, range: joint.range, neutral: 0.0, independent: true, of_scene: true });
            }
        }
        // An object is touched where anything that it carries is: parents stand before what they carry.
        for (index, object) in scene.objects.iter().enumerate().rev() {
            if let (Parent::Object(parent), true) = (&object.parent, whole.landmarks[first + index].has_segment) {
                whole.landmarks[first + parent].has_segment = true;
            }
        }
        whole.groups.extend(scene.groups.iter().map(|(name, members)| Group {
            name: name.clone(),
            kind: GroupKind::Landmarks,
            members: members.iter().map(|member| first + member).collect(),
        }));
        whole
    }
}

/// Axes of the world, one after the other.
const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

fn place_of(landmark: &Landmark) -> ([f64; 3], [f64; 9]) {
    (landmark.neutral_position, landmark.neutral_axes)
}

/// A vector given along `axes` (one after the other), in world axes.
fn turned(axes: &[f64; 9], [x, y, z]: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|k| axes[k] * x + axes[3 + k] * y + axes[6 + k] * z)
}

/// Axes, one after the other, of what is turned by `quaternion` (w x y z) against `axes`.
fn composed(axes: &[f64; 9], [w, x, y, z]: [f64; 4]) -> [f64; 9] {
    let columns = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
        [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
        [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let mut whole = [0.0; 9];
    for (axis, column) in whole.chunks_exact_mut(3).zip(columns) {
        axis.copy_from_slice(&turned(axes, column));
    }
    whole
}

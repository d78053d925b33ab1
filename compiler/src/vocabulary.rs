//! What exists on a body and in a scene, as the compiler needs to know it.
//!
//! The runtime makes a [`Vocabulary`] from a model and a body file; the checker resolves names against it. It is plain data:
//! it can be printed for people, written as JSON for agents, and kept as a fixture for tests that need no physics.

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

//! A body file, resolved: how a model file is bound to the vocabulary.
//!
//! The compiler reads `bodies/NAME.msk` into this plain description; the runtime binds it to a model.

use serde::{Deserialize, Serialize};

/// How a model file is bound to the vocabulary. Element names are those of the model file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyDescription {
    /// Name in tasks (`body human`).
    pub name: String,
    /// Path of the model file: in the body file relative to it, here joined to the body file's folder.
    pub model: String,
    /// Body that carries the free joint.
    pub root: String,
    /// Which axis of the root's frame points forward.
    pub root_forward: Axis,
    /// Which axis of the root's frame points up.
    pub root_up: Axis,
    /// How actions become excitations.
    pub excitation: ExcitationMap,
    /// Whether tendons stretch.
    #[serde(default)]
    pub tendons: TendonKind,
    /// Landmarks.
    pub landmarks: Vec<LandmarkDescription>,
    /// Names in tasks for joints of the model: (alias, joint).
    pub joint_aliases: Vec<(String, String)>,
    /// Groups of joints: (name, joints).
    pub joint_groups: Vec<(String, Vec<String>)>,
    /// Groups of muscles: (name, muscles).
    pub muscle_groups: Vec<(String, Vec<String>)>,
    /// Groups of landmarks: (name, landmarks).
    pub landmark_groups: Vec<(String, Vec<String>)>,
    /// Recruitment families: (printed name, muscles); every muscle is in exactly one.
    pub families: Vec<(String, Vec<String>)>,
    /// Named poses: (name, [(joint, coordinate in rad or m)]); joints not named stay at zero, coupled joints are solved.
    pub poses: Vec<(String, Vec<(String, f64)>)>,
    /// What a task changes on the body: `body human with core.peak_force *= 3`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<Change>,
}

/// A parameter of a body part that a task changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Name of the muscle or joint, as tasks name it.
    pub part: String,
    /// What is changed on it.
    pub property: Property,
    /// The new value, N, N m s/rad (N s/m), N m/rad (N/m); or a factor.
    pub value: f64,
    /// Whether the value is a factor.
    pub scales: bool,
}

/// Parameters of body parts that a task may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Property {
    /// Peak isometric force of a muscle.
    PeakForce,
    /// Damping of a joint.
    Damping,
    /// Stiffness of a joint.
    Stiffness,
}

/// A signed axis of a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Axis {
    #[default]
    PlusX,
    MinusX,
    PlusY,
    MinusY,
    PlusZ,
    MinusZ,
}

/// How a policy's action becomes muscle excitation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ExcitationMap {
    /// u = (a + 1) / 2 for an action in [-1, 1]: the paper's.
    #[default]
    Linear,
    /// u = 1 / (1 + exp(-5 (a - 0.5))): the published code's.
    Sigmoid,
}

/// Whether the tendons of a body's muscles stretch.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TendonKind {
    /// They do not: the fibre is the path less a constant, as in MuJoCo.
    #[default]
    Rigid,
    /// They do: every muscle is a fibre in series with a spring, as in OpenSim.
    Elastic,
}

/// A landmark of a body file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LandmarkDescription {
    /// Name in tasks.
    pub name: String,
    /// Documentation comment.
    pub description: String,
    /// Body of the model that carries it.
    pub body: String,
    /// Point in that body's frame, m.
    pub point: [f64; 3],
    /// Axis of that body's frame that is anatomically forward.
    pub forward: Axis,
    /// Axis of that body's frame that is anatomically up.
    pub up: Axis,
    /// Geoms of the landmark's segment.
    pub segment: Vec<String>,
}

//! What a builder can add: bodies, joints, shapes, sites.

use msk_physics::model::rotation::IDENTITY;
use msk_physics::model::{GeomKind, HeightField, JointKind, Quaternion, SolverParameters};
use nalgebra::Vector3;

/// A body to be added.
#[derive(Debug, Clone, PartialEq)]
pub struct NewBody {
    /// Name, unique among the bodies.
    pub name: String,
    /// What carries it: a body of the model or one added before.
    pub parent: usize,
    /// Position in the parent's frame, m.
    pub position: Vector3<f64>,
    /// Orientation in the parent's frame.
    pub orientation: Quaternion,
    /// Whether every episode may have it elsewhere: only what stands in the world without joints (MuJoCo's `mocap`).
    pub placed: bool,
}

impl Default for NewBody {
    fn default() -> Self {
        Self { name: String::new(), parent: 0, position: Vector3::zeros(), orientation: IDENTITY, placed: false }
    }
}

/// A joint to be added.
#[derive(Debug, Clone, PartialEq)]
pub struct NewJoint {
    /// Name, unique among the joints.
    pub name: String,
    /// Kind.
    pub kind: JointKind,
    /// Axis in the body's frame, of any length; without meaning for ball and free joints.
    pub axis: Vector3<f64>,
    /// Anchor in the body's frame, m; free joints have none.
    pub anchor: Vector3<f64>,
    /// Range, rad or m.
    pub range: Option<[f64; 2]>,
    /// Damping, N m s/rad or N s/m.
    pub damping: f64,
    /// Stiffness, N m/rad or N/m.
    pub stiffness: f64,
    /// Friction loss, N m or N.
    pub friction_loss: f64,
}

impl Default for NewJoint {
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: JointKind::Hinge,
            axis: Vector3::z(),
            anchor: Vector3::zeros(),
            range: None,
            damping: 0.0,
            stiffness: 0.0,
            friction_loss: 0.0,
        }
    }
}

/// A shape to be added.
#[derive(Debug, Clone, PartialEq)]
pub struct NewGeom {
    /// Name, unique among the shapes.
    pub name: String,
    /// Kind; not a mesh.
    pub kind: GeomKind,
    /// Size as defined by the kind, m; without meaning for height fields.
    pub size: Vector3<f64>,
    /// The heights of a height field.
    pub heights: Option<HeightField>,
    /// Position in the body's frame, m.
    pub position: Vector3<f64>,
    /// Orientation in the body's frame.
    pub orientation: Quaternion,
    /// Mass, kg: spread evenly over the shape.
    pub mass: f64,
    /// Contact type bits.
    pub contact_type: u32,
    /// Contact affinity bits.
    pub contact_affinity: u32,
    /// Contact dimension: 1, 3, 4 or 6.
    pub contact_dimension: u8,
    /// Sliding, torsional (m) and rolling (m) friction.
    pub friction: [f64; 3],
    /// Of two shapes that of higher priority decides friction and softness of their contacts.
    pub priority: i32,
    /// SolverParameters of contacts.
    pub softness: SolverParameters,
}

impl Default for NewGeom {
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: GeomKind::Sphere,
            size: Vector3::zeros(),
            heights: None,
            position: Vector3::zeros(),
            orientation: IDENTITY,
            mass: 0.0,
            contact_type: 1,
            contact_affinity: 1,
            contact_dimension: 3,
            friction: [1.0, 0.005, 0.0001],
            priority: 0,
            softness: SolverParameters::default(),
        }
    }
}

/// A marked point to be added.
#[derive(Debug, Clone, PartialEq)]
pub struct NewSite {
    /// Name, unique among the sites.
    pub name: String,
    /// Position in the body's frame, m.
    pub position: Vector3<f64>,
    /// Orientation in the body's frame.
    pub orientation: Quaternion,
}

/// Two sites to be held together.
#[derive(Debug, Clone, PartialEq)]
pub struct NewAttachment {
    /// Name, unique among the equalities.
    pub name: String,
    /// The two sites, on different bodies.
    pub sites: [usize; 2],
    /// Whether their axes are held together, too, not only their places.
    pub weld: bool,
    /// SolverParameters.
    pub softness: SolverParameters,
}

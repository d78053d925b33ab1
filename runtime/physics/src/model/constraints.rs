//! Soft constraints: their parameters, what equalities hold together, and explicit contact pairs.

use super::Quaternion;
use nalgebra::Vector3;

/// Parameters of a soft constraint: MuJoCo's `solref` and `solimp`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverParameters {
    /// Time constant and damping ratio, or negative stiffness and damping.
    pub reference: [f64; 2],
    /// Impedance: d0, dmax, width, midpoint, power.
    pub impedance: [f64; 5],
}

impl Default for SolverParameters {
    fn default() -> Self {
        Self { reference: [0.02, 1.0], impedance: [0.9, 0.95, 0.001, 0.5, 2.0] }
    }
}

/// Equality constraints of all kinds in the order of the file, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Equalities {
    /// Names; empty where the file gives none.
    pub name: Vec<String>,
    /// What is held together.
    pub kind: Vec<Equality>,
    /// Whether it holds when an episode begins; each state may change that.
    pub active: Vec<bool>,
    /// SolverParameters.
    pub softness: Vec<SolverParameters>,
}

/// What an equality holds together.
#[derive(Debug, Clone, PartialEq)]
pub enum Equality {
    /// A joint by a polynomial of another one: an index into [`Couplings`].
    Joint(usize),
    /// The length of a tendon.
    Tendon(TendonCoupling),
    /// Two points: three rows.
    Connect(Attachment),
    /// Two frames: six rows.
    Weld {
        /// The frames.
        attachment: Attachment,
        /// Weight of a turn against a displacement, m.
        torque_scale: f64,
    },
}

/// Tendon lengths l1 - l1₀ = p(l2 - l2₀), with the lengths at the reference configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct TendonCoupling {
    /// The coupled tendon.
    pub tendon: usize,
    /// The tendon that leads; `None` fixes the coupled tendon at the constant coefficient.
    pub leader: Option<usize>,
    /// Coefficients of degree 0 to 4.
    pub polynomial: [f64; 5],
}

/// A frame on each of two bodies; a connection makes their origins coincide, a weld their axes too.
#[derive(Debug, Clone, PartialEq)]
pub struct Attachment {
    /// The two bodies.
    pub bodies: [usize; 2],
    /// Origin of the frame in each body's frame, m.
    pub position: [Vector3<f64>; 2],
    /// Axes of the frame in each body's frame.
    pub orientation: [Quaternion; 2],
    /// What of this the file gives, and what follows from the rest.
    pub origin: AttachmentOrigin,
}

/// How an attachment is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttachmentOrigin {
    /// Two sites are the frames.
    Sites([usize; 2]),
    /// It holds at the reference configuration: one frame is given, the other derived.
    Reference,
    /// Both frames are given.
    Given,
}

/// Polynomial couplings of joints q1 - q1₀ = p(q2 - q2₀), one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Couplings {
    /// The coupled joint.
    pub joint: Vec<usize>,
    /// The joint that leads; `None` fixes the coupled joint at the constant coefficient.
    pub leader: Vec<Option<usize>>,
    /// Coefficients of degree 0 to 4.
    pub polynomial: Vec<[f64; 5]>,
    /// Its place among the [`Equalities`].
    pub equality: Vec<usize>,
}

/// Explicit contact pairs, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactPairs {
    /// The two geoms.
    pub geoms: Vec<[usize; 2]>,
    /// Contact dimension.
    pub dimension: Vec<u8>,
    /// SolverParameters.
    pub softness: Vec<SolverParameters>,
    /// SolverParameters reference of the friction directions; both zero takes `softness`.
    pub friction_reference: Vec<[f64; 2]>,
    /// Friction: two sliding, torsional, two rolling.
    pub friction: Vec<[f64; 5]>,
    /// Detection distance, m.
    pub margin: Vec<f64>,
    /// Inactive part of the margin, m.
    pub gap: Vec<f64>,
}

//! What a body is: the compiled, immutable [`Model`], and how it comes from and goes back to MJCF.
//!
//! 1. [`mjcf`] reads a file (defaults, classes, includes) into a tree of elements with resolved attributes;
//! 2. the compiler turns it into a [`Model`]: structure of arrays, indices instead of names, inertial frames made explicit,
//!    derived constants (inverse weights, reference lengths, muscle peak forces) computed once;
//! 3. the writer prints a `Model` as flat canonical MJCF.
//!
//! Orders and meanings of all arrays are MuJoCo's (body 0 is the world, bodies in depth-first order), so that any number
//! can be compared with the oracle index by index. Quaternions are w x y z, positions in metres, angles in radians.

mod actuators;
mod bodies;
mod constraints;
#[cfg(feature = "disk")]
mod disk;
mod elastic;
mod files;
mod geometry;
mod height_field;
mod hull;
pub mod import;
pub mod inertia;
mod keyframes;
mod mesh;
pub mod mjcf;
mod options;
pub mod rotation;
mod sensors;
mod tendons;
pub mod topology;

pub use actuators::{Actuators, Bias, Dynamics, Gain, Muscle, Transmission};
pub use bodies::{Bodies, Dofs, JointKind, Joints};
pub use constraints::{
    Attachment, AttachmentOrigin, ContactPairs, Couplings, Equalities, Equality, SolverParameters, TendonCoupling,
};
#[cfg(feature = "disk")]
pub use disk::DiskFiles;
pub use elastic::{ElasticError, ElasticTendons, FibreCurves};
pub use files::ModelFiles;
pub use geometry::{GeomKind, Geoms, Sites};
pub use height_field::HeightField;
pub use keyframes::Keyframe;
pub use mesh::{Face, Hull, Mesh};
pub use mjcf::ModelError;
pub use options::{Cone, Fluid, Integrator, Options, Switches};
pub use sensors::{Framed, GapQuantity, LimitQuantity, Limited, Measure, Sensors, Surface};
pub use tendons::{PathPoint, Tendons};

/// Quaternion in the order w, x, y, z.
pub type Quaternion = [f64; 4];

/// An immutable compiled body (or body in a scene), shared by all episodes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// Name of the model file's root element.
    pub name: String,
    /// Simulation options.
    pub options: Options,
    /// Rigid bodies; index 0 is the world.
    pub bodies: Bodies,
    /// Joints, in depth-first order of their bodies.
    pub joints: Joints,
    /// Degrees of freedom, in the order of their joints.
    pub dofs: Dofs,
    /// Collision and wrapping shapes.
    pub geoms: Geoms,
    /// Meshes that geoms may show.
    pub meshes: Vec<Mesh>,
    /// Height fields that geoms may show.
    pub height_fields: Vec<HeightField>,
    /// Marked points.
    pub sites: Sites,
    /// Spatial and fixed tendons.
    pub tendons: Tendons,
    /// Muscles and other actuators.
    pub actuators: Actuators,
    /// Elastic tendons of all muscles; `None` where tendons are rigid, as in MJCF.
    pub elastic_tendons: Option<ElasticTendons>,
    /// Equality constraints of all kinds.
    pub equalities: Equalities,
    /// Polynomial joint couplings, which are some of the equalities.
    pub couplings: Couplings,
    /// Explicit contact pairs.
    pub pairs: ContactPairs,
    /// Pairs of bodies that never collide, as (smaller, larger) body index, sorted.
    pub exclusions: Vec<(usize, usize)>,
    /// Length of the position vector.
    pub nq: usize,
    /// Number of degrees of freedom.
    pub nv: usize,
    /// Length of the activation vector.
    pub na: usize,
    /// The model's own sensors.
    pub sensors: Sensors,
    /// States with names.
    pub keyframes: Vec<Keyframe>,
    /// Mean of the mass matrix's diagonal at the reference configuration (`stat.meaninertia`): kg for slides, kg m² for hinges. The
    /// second pass over friction measures its improvement by it.
    pub mean_inertia: f64,
    /// Configuration at which joint angles and couplings are zero, length `nq`.
    pub reference_position: Vec<f64>,
}

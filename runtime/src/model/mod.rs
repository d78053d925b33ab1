//! What a body is: the compiled, immutable [`Model`], and how it comes from and goes back to MJCF.
//!
//! 1. [`mjcf`] reads a file (defaults, classes, includes) into a tree of elements with resolved attributes;
//! 2. the compiler turns it into a [`Model`]: structure of arrays, indices instead of names, inertial frames made explicit,
//!    derived constants (inverse weights, reference lengths, muscle peak forces) computed once;
//! 3. the writer prints a `Model` as flat canonical MJCF.
//!
//! Orders and meanings of all arrays are MuJoCo's (body 0 is the world, bodies in depth-first order), so that any number
//! can be compared with the oracle index by index. Quaternions are w x y z, positions in metres, angles in radians.

pub mod mjcf;

use nalgebra::Vector3;

/// Quaternion in the order w, x, y, z.
pub type Quaternion = [f64; 4];

/// An immutable compiled body (or body in a scene), shared by all episodes.
#[derive(Debug, Clone, Default)]
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
    /// Marked points.
    pub sites: Sites,
    /// Spatial tendons.
    pub tendons: Tendons,
    /// Muscles.
    pub actuators: Actuators,
    /// Polynomial joint couplings.
    pub couplings: Couplings,
    /// Explicit contact pairs.
    pub pairs: ContactPairs,
    /// Pairs of bodies that never collide, as (smaller, larger) body index.
    pub exclusions: Vec<(usize, usize)>,
    /// Length of the position vector.
    pub nq: usize,
    /// Number of degrees of freedom.
    pub nv: usize,
    /// Configuration at which joint angles and couplings are zero, length `nq`.
    pub reference_position: Vec<f64>,
}

/// Simulation options, MuJoCo's `option` element.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Physics step in seconds.
    pub timestep: f64,
    /// Gravity in m/s².
    pub gravity: Vector3<f64>,
    /// Solver iterations at most.
    pub iterations: usize,
    /// Line-search iterations at most.
    pub line_search_iterations: usize,
    /// Solver stops when the scaled improvement or gradient falls below this.
    pub tolerance: f64,
    /// Line search stops at this fraction of the solver's tolerance.
    pub line_search_tolerance: f64,
    /// Ratio of frictional to normal constraint impedance.
    pub impedance_ratio: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            timestep: 0.002,
            gravity: Vector3::new(0.0, 0.0, -9.81),
            iterations: 100,
            line_search_iterations: 50,
            tolerance: 1e-8,
            line_search_tolerance: 0.01,
            impedance_ratio: 1.0,
        }
    }
}

/// Rigid bodies, one entry each per array.
#[derive(Debug, Clone, Default)]
pub struct Bodies {
    /// Names; empty where the file gives none.
    pub name: Vec<String>,
    /// Parent body; the world's is itself.
    pub parent: Vec<usize>,
    /// Root of the kinematic tree, the child of the world that the body hangs on.
    pub root: Vec<usize>,
    /// Nearest ancestor (or itself) with joints, else the world: bodies welded together share it.
    pub weld: Vec<usize>,
    /// Position in the parent's frame, m.
    pub position: Vec<Vector3<f64>>,
    /// Orientation in the parent's frame.
    pub orientation: Vec<Quaternion>,
    /// Centre of mass in the body's frame, m.
    pub inertial_position: Vec<Vector3<f64>>,
    /// Principal axes in the body's frame.
    pub inertial_orientation: Vec<Quaternion>,
    /// Mass, kg.
    pub mass: Vec<f64>,
    /// Principal moments of inertia, kg m².
    pub inertia: Vec<Vector3<f64>>,
    /// Mass of the body and all its descendants, kg.
    pub subtree_mass: Vec<f64>,
    /// First joint and number of joints.
    pub joints: Vec<core::ops::Range<usize>>,
    /// First dof and number of dofs.
    pub dofs: Vec<core::ops::Range<usize>>,
    /// Geoms of the body.
    pub geoms: Vec<core::ops::Range<usize>>,
    /// Inverse weight at the reference configuration: translation (1/kg), rotation (1/(kg m²)).
    pub inverse_weight: Vec<[f64; 2]>,
}

/// Kind of joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Six degrees of freedom, seven coordinates.
    Free,
    /// Three degrees of freedom, a quaternion.
    Ball,
    /// One translation.
    Slide,
    /// One rotation.
    Hinge,
}

/// Parameters of a soft constraint: MuJoCo's `solref` and `solimp`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Softness {
    /// Time constant and damping ratio, or negative stiffness and damping.
    pub reference: [f64; 2],
    /// Impedance: d0, dmax, width, midpoint, power.
    pub impedance: [f64; 5],
}

impl Default for Softness {
    fn default() -> Self {
        Self { reference: [0.02, 1.0], impedance: [0.9, 0.95, 0.001, 0.5, 2.0] }
    }
}

/// Joints, one entry each per array.
#[derive(Debug, Clone, Default)]
pub struct Joints {
    /// Names.
    pub name: Vec<String>,
    /// Kind.
    pub kind: Vec<JointKind>,
    /// Body that the joint moves.
    pub body: Vec<usize>,
    /// First coordinate in the position vector.
    pub position_address: Vec<usize>,
    /// First degree of freedom.
    pub dof_address: Vec<usize>,
    /// Anchor in the body's frame, m.
    pub anchor: Vec<Vector3<f64>>,
    /// Unit axis in the body's frame.
    pub axis: Vec<Vector3<f64>>,
    /// Range, if limited (rad or m).
    pub range: Vec<Option<[f64; 2]>>,
    /// Distance to a limit at which its constraint appears.
    pub margin: Vec<f64>,
    /// Softness of the limit.
    pub limit_softness: Vec<Softness>,
    /// Spring stiffness, N m/rad or N/m.
    pub stiffness: Vec<f64>,
    /// Spring reference coordinate.
    pub spring_reference: Vec<f64>,
}

/// Degrees of freedom, one entry each per array.
#[derive(Debug, Clone, Default)]
pub struct Dofs {
    /// Body that the dof moves.
    pub body: Vec<usize>,
    /// Joint that the dof belongs to.
    pub joint: Vec<usize>,
    /// Previous dof on the path to the root, if any.
    pub parent: Vec<Option<usize>>,
    /// Rotor inertia, kg m² or kg.
    pub armature: Vec<f64>,
    /// Damping, N m s/rad or N s/m.
    pub damping: Vec<f64>,
    /// Friction loss, N m or N.
    pub friction_loss: Vec<f64>,
    /// Inverse weight at the reference configuration: diagonal of the inverse mass matrix (averaged over a free joint's triples).
    pub inverse_weight: Vec<f64>,
    /// Row of the mass matrix of each dof: the half-open range of its entries in the sparse lower triangle, columns
    /// ascending along the root path, the diagonal last.
    pub row: Vec<core::ops::Range<usize>>,
    /// Column of each entry of the sparse lower triangle.
    pub column: Vec<usize>,
}

/// Kind of shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GeomKind {
    /// Infinite half space below z = 0 of its frame.
    Plane,
    /// Radius.
    Sphere,
    /// Radius, half length along z.
    Capsule,
    /// Half axes.
    Ellipsoid,
    /// Radius, half length along z.
    Cylinder,
    /// Half extents.
    Box,
}

/// Shapes, one entry each per array.
#[derive(Debug, Clone, Default)]
pub struct Geoms {
    /// Names; empty where the file gives none.
    pub name: Vec<String>,
    /// Kind.
    pub kind: Vec<GeomKind>,
    /// Body that carries it.
    pub body: Vec<usize>,
    /// Size as the kind says, m.
    pub size: Vec<Vector3<f64>>,
    /// Position in the body's frame, m.
    pub position: Vec<Vector3<f64>>,
    /// Orientation in the body's frame.
    pub orientation: Vec<Quaternion>,
    /// Contact type bits.
    pub contact_type: Vec<u32>,
    /// Contact affinity bits.
    pub contact_affinity: Vec<u32>,
    /// Contact dimension: 1, 3, 4 or 6.
    pub contact_dimension: Vec<u8>,
    /// Contact priority.
    pub priority: Vec<i32>,
    /// Weight in the mixing of softness.
    pub softness_mix: Vec<f64>,
    /// Softness of contacts.
    pub softness: Vec<Softness>,
    /// Sliding, torsional, rolling friction.
    pub friction: Vec<[f64; 3]>,
    /// Distance at which contacts are detected, m.
    pub margin: Vec<f64>,
    /// Part of the margin in which a contact is detected but inactive, m.
    pub gap: Vec<f64>,
    /// Radius of the bounding sphere; 0 for planes.
    pub bounding_radius: Vec<f64>,
    /// Rendering group of the file; kept for the writer and the drawing tool.
    pub group: Vec<i32>,
}

/// Marked points, one entry each per array.
#[derive(Debug, Clone, Default)]
pub struct Sites {
    /// Names.
    pub name: Vec<String>,
    /// Body that carries it.
    pub body: Vec<usize>,
    /// Position in the body's frame, m.
    pub position: Vec<Vector3<f64>>,
    /// Orientation in the body's frame.
    pub orientation: Vec<Quaternion>,
}

/// One entry of a spatial tendon's path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathPoint {
    /// The tendon passes through a site.
    Site(usize),
    /// The tendon may wrap around a sphere or cylinder geom, on the side of a site if one is given.
    Wrap {
        /// The sphere or cylinder.
        geom: usize,
        /// The side site.
        side: Option<usize>,
    },
    /// Divides the force of what follows.
    Pulley(f64),
}

/// Spatial tendons, one entry each per array.
#[derive(Debug, Clone, Default)]
pub struct Tendons {
    /// Names.
    pub name: Vec<String>,
    /// Entries of the path in `path_points`.
    pub path: Vec<core::ops::Range<usize>>,
    /// All path entries.
    pub path_points: Vec<PathPoint>,
    /// Range, if limited, m.
    pub range: Vec<Option<[f64; 2]>>,
    /// Stiffness, N/m.
    pub stiffness: Vec<f64>,
    /// Damping, N s/m.
    pub damping: Vec<f64>,
    /// Lengths between which the spring is slack, m; `None` takes the reference length.
    pub spring_length: Vec<Option<[f64; 2]>>,
    /// Length at the reference configuration, m.
    pub reference_length: Vec<f64>,
}

/// Muscles (MuJoCo's muscle actuator), one entry each per array.
#[derive(Debug, Clone, Default)]
pub struct Actuators {
    /// Names.
    pub name: Vec<String>,
    /// Tendon that it pulls.
    pub tendon: Vec<usize>,
    /// Gear ratio.
    pub gear: Vec<f64>,
    /// Control range, if limited.
    pub control_range: Vec<Option<[f64; 2]>>,
    /// Operating range of the tendon length, m.
    pub length_range: Vec<[f64; 2]>,
    /// Norm of the actuator's joint-space acceleration per unit force at the reference configuration.
    pub acceleration_scale: Vec<f64>,
    /// Activation dynamics: activation time, deactivation time (s), smoothing width.
    pub time_constants: Vec<[f64; 3]>,
    /// Active force: range0, range1, force, scale, lmin, lmax, vmax, fpmax, fvmax (MuJoCo `gainprm`).
    pub gain: Vec<[f64; 9]>,
    /// Passive force, the same layout (MuJoCo `biasprm`).
    pub bias: Vec<[f64; 9]>,
}

/// Polynomial couplings q1 - q1₀ = p(q2 - q2₀), one entry each per array.
#[derive(Debug, Clone, Default)]
pub struct Couplings {
    /// Names; empty where the file gives none.
    pub name: Vec<String>,
    /// The slaved joint.
    pub joint: Vec<usize>,
    /// The joint that leads; `None` fixes the slaved joint at the constant coefficient.
    pub leader: Vec<Option<usize>>,
    /// Coefficients of degree 0 to 4.
    pub polynomial: Vec<[f64; 5]>,
    /// Softness.
    pub softness: Vec<Softness>,
}

/// Explicit contact pairs, one entry each per array.
#[derive(Debug, Clone, Default)]
pub struct ContactPairs {
    /// The two geoms.
    pub geoms: Vec<[usize; 2]>,
    /// Contact dimension.
    pub dimension: Vec<u8>,
    /// Softness.
    pub softness: Vec<Softness>,
    /// Softness reference of the friction directions; both zero takes `softness`.
    pub friction_reference: Vec<[f64; 2]>,
    /// Friction: two sliding, torsional, two rolling.
    pub friction: Vec<[f64; 5]>,
    /// Detection distance, m.
    pub margin: Vec<f64>,
    /// Inactive part of the margin, m.
    pub gap: Vec<f64>,
}

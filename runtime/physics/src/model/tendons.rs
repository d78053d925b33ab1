//! Tendons.

use super::SolverParameters;
use core::ops::Range;

/// One entry of a tendon's path. A fixed tendon's path consists of joints, a spatial one's of everything else.
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
    /// Adds a multiple of a hinge's or slide's coordinate to the length of a fixed tendon.
    Joint {
        /// The joint.
        joint: usize,
        /// The factor, m/rad or 1.
        coefficient: f64,
    },
}

/// Spatial tendons, and fixed ones, whose length is a linear combination of joint coordinates; one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tendons {
    /// Names.
    pub name: Vec<String>,
    /// Entries of the path in `path_points`.
    pub path: Vec<Range<usize>>,
    /// All path entries.
    pub path_points: Vec<PathPoint>,
    /// Range, if limited, m.
    pub range: Vec<Option<[f64; 2]>>,
    /// Distance to a limit at which its constraint appears, m.
    pub margin: Vec<f64>,
    /// SolverParameters of the limit.
    pub limit_softness: Vec<SolverParameters>,
    /// Inertia of a change of length, kg: of fixed tendons whose joints lie on one path to the root.
    pub armature: Vec<f64>,
    /// Dry friction, N.
    pub friction_loss: Vec<f64>,
    /// SolverParameters of the dry friction.
    pub friction_softness: Vec<SolverParameters>,
    /// Stiffness, N/m.
    pub stiffness: Vec<f64>,
    /// Damping, N s/m.
    pub damping: Vec<f64>,
    /// Lengths between which the spring is slack, m; `None` takes the resting length.
    pub spring_length: Vec<Option<[f64; 2]>>,
    /// Length at the reference configuration, m.
    pub reference_length: Vec<f64>,
    /// Length where all joints stand at the rest of their springs, m.
    pub resting_length: Vec<f64>,
    /// Inverse weight at the reference configuration: J M^-1 J' of the tendon's row of the Jacobian.
    pub inverse_weight: Vec<f64>,
}

//! Spatial tendons.

use super::Softness;
use core::ops::Range;

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
    /// Softness of the limit.
    pub limit_softness: Vec<Softness>,
    /// Stiffness, N/m.
    pub stiffness: Vec<f64>,
    /// Damping, N s/m.
    pub damping: Vec<f64>,
    /// Lengths between which the spring is slack, m; `None` takes the reference length.
    pub spring_length: Vec<Option<[f64; 2]>>,
    /// Length at the reference configuration, m.
    pub reference_length: Vec<f64>,
}

//! Shapes and marked points that bodies carry.

use super::{Quaternion, SolverParameters};
use crate::scalar::Real;
use nalgebra::Vector3;

/// Kind of shape, in MuJoCo's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GeomKind {
    /// Infinite half space below z = 0 of its frame.
    Plane,
    /// Heights over a rectangle, an asset of the model.
    HeightField,
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
    /// The convex hull of a mesh, an asset of the model.
    Mesh,
}

impl GeomKind {
    /// Radius of the smallest sphere about the centre that holds a shape of this kind; 0 for planes, which no sphere holds, and
    /// for shapes that an asset bounds.
    pub fn bounding_radius(self, size: Vector3<f64>) -> f64 {
        match self {
            Self::Plane | Self::HeightField | Self::Mesh => 0.0,
            Self::Sphere => size.x,
            Self::Capsule => size.x + size.y,
            Self::Ellipsoid => size.x.at_least(size.y).at_least(size.z),
            Self::Cylinder => libm::hypot(size.x, size.y),
            Self::Box => size.norm(),
        }
    }
}

impl GeomKind {
    /// How many numbers of a shape's size it needs; what has an asset or no end needs none.
    pub fn size_count(self) -> usize {
        match self {
            Self::Plane | Self::HeightField | Self::Mesh => 0,
            Self::Sphere => 1,
            Self::Capsule | Self::Cylinder => 2,
            Self::Ellipsoid | Self::Box => 3,
        }
    }
}

/// Shapes, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Geoms {
    /// Names; empty where the file gives none.
    pub name: Vec<String>,
    /// Kind.
    pub kind: Vec<GeomKind>,
    /// Body that carries it.
    pub body: Vec<usize>,
    /// Size as defined by the kind, m; half extents of the bounding box for height fields and meshes.
    pub size: Vec<Vector3<f64>>,
    /// What gives a height field or mesh its shape: index into the model's assets of that kind.
    pub asset: Vec<Option<usize>>,
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
    /// SolverParameters of contacts.
    pub softness: Vec<SolverParameters>,
    /// Sliding, torsional, rolling friction.
    pub friction: Vec<[f64; 3]>,
    /// Distance at which contacts are detected, m.
    pub margin: Vec<f64>,
    /// Part of the margin in which a contact is detected but inactive, m.
    pub gap: Vec<f64>,
    /// Radius of the bounding sphere; 0 for planes.
    pub bounding_radius: Vec<f64>,
    /// Whether it is drawn at all: neither it nor its material is wholly transparent. A range finder sees what is visible.
    pub visible: Vec<bool>,
    /// Rendering group of the file; kept for the writer and the drawing tool.
    pub group: Vec<i32>,
}

/// Marked points, one entry each per array.
#[derive(Debug, Clone, Default, PartialEq)]
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

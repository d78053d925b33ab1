//! Triangle meshes and their convex hulls.

use super::Quaternion;
use crate::scalar::Real;
use core::ops::Range;
use nalgebra::Vector3;

/// A mesh, in the frame of the geoms that show it: the origin is its centre of mass, the axes are its principal axes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Name.
    pub name: String,
    /// Corners, m.
    pub vertices: Vec<Vector3<f64>>,
    /// Surface, counter-clockwise from outside.
    pub triangles: Vec<[usize; 3]>,
    /// What collides.
    pub hull: Hull,
    /// Origin of this frame in the frame of the source, m.
    pub position: Vector3<f64>,
    /// Orientation of this frame in the frame of the source.
    pub orientation: Quaternion,
}

/// A convex polyhedron.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Hull {
    /// Corners, m.
    pub vertices: Vec<Vector3<f64>>,
    /// Flat faces.
    pub faces: Vec<Face>,
    /// Corners of all faces: indices into `vertices`, counter-clockwise from outside.
    pub corners: Vec<usize>,
    /// Faces around all corners, in ascending order; `around` maps corners to faces.
    pub incident: Vec<usize>,
    /// The part of `incident` that belongs to each corner.
    pub around: Vec<Range<usize>>,
}

/// A flat face of a [`Hull`].
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Outward unit normal.
    pub normal: Vector3<f64>,
    /// The face's part of [`Hull::corners`].
    pub corners: Range<usize>,
}

impl Hull {
    /// Corners of a face, counter-clockwise from outside.
    pub fn corners_of(&self, face: usize) -> &[usize] {
        &self.corners[self.faces[face].corners.clone()]
    }

    /// Faces around a corner.
    pub fn faces_around(&self, vertex: usize) -> &[usize] {
        &self.incident[self.around[vertex].clone()]
    }

    /// Index of the corner that lies farthest along `direction`, the first of several.
    pub fn support_point(&self, direction: Vector3<f64>) -> usize {
        let mut best = (0, f64::NEG_INFINITY);
        for (index, vertex) in self.vertices.iter().enumerate() {
            let along = vertex.dot(&direction);
            if along > best.1 {
                best = (index, along);
            }
        }
        best.0
    }

    /// Of the faces around a corner the one that looks most along `direction`.
    pub fn facing(&self, vertex: usize, direction: Vector3<f64>) -> Option<usize> {
        let along = |face: usize| self.faces[face].normal.dot(&direction);
        self.faces_around(vertex).iter().copied().reduce(|best, face| if along(face) > along(best) { face } else { best })
    }

    /// Largest distance of a corner from the origin, m.
    pub fn radius(&self) -> f64 {
        self.vertices.iter().map(|vertex| vertex.norm()).fold(0.0, Real::at_least)
    }
}

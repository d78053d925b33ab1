//! Triangle meshes of files and of MJCF text.
//!
//! 1. [`files`] reads STL, OBJ and MSH files;
//! 2. [`solid`] gives volume, centre and moments of inertia by any of MJCF's four methods;
//! 3. the compiler moves a mesh that collides into its own principal frame and builds its hull.

mod files;
mod solid;

pub(super) use files::read;
pub(super) use solid::{Method, SupportShape, measure};

use crate::model::Quaternion;
use crate::model::mjcf::error::ModelError;
use crate::model::rotation;
use nalgebra::Vector3;

/// Corners and triangles as a source gives them.
#[derive(Debug, Clone, Default)]
pub(super) struct Source {
    /// m.
    pub vertices: Vec<Vector3<f64>>,
    /// Indices into `vertices`, counter-clockwise from outside; none for a cloud of points.
    pub triangles: Vec<[usize; 3]>,
}

impl Source {
    /// Moves the origin to `position`, turns by the inverse of `orientation`, then scales each axis. A mirrored mesh keeps its
    /// outside.
    pub fn transform(&mut self, position: Vector3<f64>, orientation: Quaternion, scale: Vector3<f64>) {
        let turn = rotation::matrix(orientation);
        for vertex in &mut self.vertices {
            *vertex = turn.tr_mul(&(*vertex - position)).component_mul(&scale);
        }
        if scale.x * scale.y * scale.z < 0.0 {
            self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
    }

    /// The corners of each triangle.
    pub fn corners(&self) -> impl Iterator<Item = [Vector3<f64>; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|corner| self.vertices[corner]))
    }

    /// Whether every index names a corner.
    pub fn is_valid(&self) -> bool {
        self.triangles.iter().flatten().all(|&corner| corner < self.vertices.len())
    }
}

/// A mistake in a mesh file.
fn wrong(path: &std::path::Path, reason: &str) -> ModelError {
    ModelError::File { path: path.to_path_buf(), reason: reason.to_owned() }
}

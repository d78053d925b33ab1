//! The path of one tendon point by point, for drawing and inspection; the step does not need it.

use super::wrap::{WrapShape, WrappingSurface, bend};
use crate::{
    kinematics::Kinematics,
    model::{GeomKind, Model, PathPoint},
    scalar::Real,
    spatial::{norm, rotate_back},
};
use nalgebra::Vector3;

/// A point where a path is fixed, meets an obstacle, or leaves it.
#[derive(Debug, Clone, PartialEq)]
pub struct PathVertex<T: Real> {
    /// World position, m.
    pub position: Vector3<T>,
    /// What the path does there.
    pub kind: VertexKind,
    /// Length from the previous vertex along the path, before division by pulleys, m; 0 at the beginning of a branch.
    pub length: T,
    /// One over the divisor of the branch.
    pub weight: f64,
}

/// What a path does at a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VertexKind {
    /// Begins a branch at this site.
    Start(usize),
    /// Passes through this site.
    Site(usize),
    /// Begins to touch this geom.
    Touch(usize),
    /// Leaves this geom, after an arc on it.
    Leave(usize),
}

/// All vertices of `tendon` at the configuration of `kinematics`, first to last. For more than one lane, the first decides
/// which obstacles are touched.
pub fn path<T: Real>(model: &Model, kinematics: &Kinematics<T>, tendon: usize) -> Vec<PathVertex<T>> {
    let mut vertices: Vec<PathVertex<T>> = Vec::new();
    let (mut weight, mut begins, mut around) = (1.0, true, None);
    for point in &model.tendons.path_points[model.tendons.path[tendon].clone()] {
        match *point {
            PathPoint::Pulley(divisor) => (weight, begins) = (1.0 / divisor, true),
            // A fixed tendon has no path in space.
            PathPoint::Joint { .. } => {}
            PathPoint::Wrap { geom, side } => around = Some((geom, side)),
            PathPoint::Site(site) => {
                let position = kinematics.site_position(model, site);
                let previous = vertices.last().filter(|_| !begins).map(|vertex| vertex.position);
                let kind = if begins { VertexKind::Start(site) } else { VertexKind::Site(site) };
                let touched = previous.zip(around.take()).and_then(|(start, (geom, side))| {
                    bend(&start, &position, &obstacle(model, kinematics, geom, side)).map(|bend| (geom, bend))
                });
                if let (Some(start), Some((geom, bend))) = (previous, &touched) {
                    let mut push = |position, kind, length| vertices.push(PathVertex { position, kind, length, weight });
                    push(bend.first, VertexKind::Touch(*geom), norm(&(bend.first - start)));
                    push(bend.second, VertexKind::Leave(*geom), bend.arc);
                }
                let from = vertices.last().map_or(position, |vertex| vertex.position);
                let length = if begins { T::splat(0.0) } else { norm(&(position - from)) };
                vertices.push(PathVertex { position, kind, length, weight });
                begins = false;
            }
        }
    }
    vertices
}

/// The obstacle that `geom` is at the configuration of `kinematics`, with the site `side`.
fn obstacle<T: Real>(model: &Model, kinematics: &Kinematics<T>, geom: usize, side: Option<usize>) -> WrappingSurface<T> {
    let (position, rotation) = (kinematics.geom_position[geom], kinematics.geom_rotation[geom]);
    let local = |site| rotate_back(&rotation, &(kinematics.site_position(model, site) - position));
    WrappingSurface {
        shape: if model.geoms.kind[geom] == GeomKind::Sphere { WrapShape::Sphere } else { WrapShape::Cylinder },
        position,
        rotation,
        radius: T::splat(model.geoms.size[geom].x),
        side: side.map(local),
    }
}

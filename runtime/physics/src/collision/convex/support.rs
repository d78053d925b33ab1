//! Convex shapes by their support points.

use super::super::place::{Asset, Placed};
use crate::model::{GeomKind, Hull};
use crate::scalar::Real;
use nalgebra::{Matrix3, Vector3};

/// What a shape is once its roundness is taken off.
#[derive(Debug, Clone, Copy)]
pub enum Core<'a> {
    /// A point.
    Point,
    /// Half length along z.
    Segment(f64),
    /// Half axes.
    Ellipsoid(Vector3<f64>),
    /// Radius, half length along z.
    Cylinder(f64, f64),
    /// Half extents.
    Box(Vector3<f64>),
    /// A polyhedron.
    Hull(&'a Hull),
    /// A prism between two triangles; the first three corners are its foot.
    Prism(&'a [Vector3<f64>; 6]),
}

/// A convex shape: everything within `radius` of its core.
#[derive(Debug, Clone, Copy)]
pub struct SupportShape<'a> {
    /// Its core.
    pub core: Core<'a>,
    /// Origin of the core, m.
    pub position: Vector3<f64>,
    /// Rotation from the core's axes to the world's.
    pub rotation: Matrix3<f64>,
    /// Roundness, m.
    pub radius: f64,
}

impl<'a> SupportShape<'a> {
    /// The shape at a place relative to `origin`; `None` for planes and height fields, which have no support points.
    pub fn new(placed: &Placed<'a>, origin: Vector3<f64>) -> Option<Self> {
        let size = placed.size;
        let (core, radius) = match (placed.kind, placed.asset) {
            (GeomKind::Sphere, _) => (Core::Point, size.x),
            (GeomKind::Capsule, _) => (Core::Segment(size.y), size.x),
            (GeomKind::Ellipsoid, _) => (Core::Ellipsoid(size), 0.0),
            (GeomKind::Cylinder, _) => (Core::Cylinder(size.x, size.y), 0.0),
            (GeomKind::Box, _) => (Core::Box(size), 0.0),
            (GeomKind::Mesh, Asset::Mesh(mesh)) => (Core::Hull(&mesh.hull), 0.0),
            _ => return None,
        };
        Some(Self { core, position: placed.position - origin, rotation: placed.rotation, radius })
    }

    /// The core's farthest point along `direction`.
    pub fn support_point(&self, direction: Vector3<f64>) -> Vector3<f64> {
        let d = self.rotation.tr_mul(&direction);
        let local = match self.core {
            Core::Point => return self.position,
            Core::Segment(half) => Vector3::new(0.0, 0.0, half.copysign(d.z)),
            Core::Ellipsoid(axes) => {
                let stretched = axes.component_mul(&d);
                let length = stretched.norm();
                if length > 0.0 { axes.component_mul(&stretched) / length } else { Vector3::new(axes.x, 0.0, 0.0) }
            }
            Core::Cylinder(radius, half) => {
                let across = libm::hypot(d.x, d.y);
                let scale = if across > 0.0 { radius / across } else { 0.0 };
                Vector3::new(d.x * scale, d.y * scale, half.copysign(d.z))
            }
            Core::Box(half) => half.zip_map(&d, f64::copysign),
            Core::Hull(hull) => hull.vertices[hull.support_point(d)],
            Core::Prism(corners) => {
                let mut best = 0;
                for index in 1..6 {
                    if (corners[index] - corners[best]).dot(&d) > 0.0 {
                        best = index;
                    }
                }
                corners[best]
            }
        };
        self.position + self.rotation * local
    }

    /// Whether a single point of the core lies farthest along `direction`, with some room for the direction's own error.
    pub fn has_one_support_point(&self, direction: Vector3<f64>) -> bool {
        /// Sine of the angle with a flat part; directions found on round surfaces are known to some 1e-7.
        const ASIDE: f64 = 1e-5;
        let d = self.rotation.tr_mul(&direction);
        match self.core {
            Core::Point | Core::Ellipsoid(_) => true,
            Core::Segment(_) => d.z.abs() > ASIDE,
            Core::Cylinder(..) => d.z.abs() > ASIDE && libm::hypot(d.x, d.y) > ASIDE,
            Core::Box(_) => d.amin() > ASIDE,
            Core::Hull(_) | Core::Prism(_) => false,
        }
    }

    /// A length to compare rounding errors with, m.
    pub fn scale(&self) -> f64 {
        let size = match self.core {
            Core::Point => 0.0,
            Core::Segment(half) => half,
            Core::Ellipsoid(size) | Core::Box(size) => size.amax(),
            Core::Cylinder(radius, half) => radius.at_least(half),
            Core::Hull(hull) => hull.vertices.first().map_or(0.0, |vertex| vertex.amax()),
            Core::Prism(corners) => corners[3].amax(),
        };
        size.at_least(self.radius)
    }
}

/// A point of the difference of two cores, and the points of both whose difference it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub point: Vector3<f64>,
    pub on: [Vector3<f64>; 2],
}

/// The farthest point of first - second along `direction`.
pub(super) fn support_point(first: &SupportShape<'_>, second: &SupportShape<'_>, direction: Vector3<f64>) -> Vertex {
    let on = [first.support_point(direction), second.support_point(-direction)];
    Vertex { point: on[0] - on[1], on }
}

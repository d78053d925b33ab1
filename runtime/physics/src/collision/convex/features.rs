//! Flat faces and straight edges of convex cores.

use super::support::{Core, SupportShape};
use nalgebra::Vector3;

/// Corners that stand for the rim of a cylinder's cap, as many as MuJoCo 4.0.0 takes.
const RIM_CORNERS: usize = 16;
/// A direction this close to right angles with an edge or along a face's normal (as a sine) meets all of it.
const EXACTLY: f64 = 1e-7;

/// A cylinder is touched from the side if the direction is this close to right angles with its axis (as a sine): directions
/// found on round surfaces are no more exact.
const SIDEWAYS: f64 = 1e-5;

/// A flat face: which one of its core's, and its outward unit normal.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Facing {
    face: usize,
    pub normal: Vector3<f64>,
}

impl Facing {
    /// Whether `direction` is the face's normal.
    pub fn shows(&self, direction: Vector3<f64>) -> bool {
        self.normal.cross(&direction).norm_squared() < EXACTLY * EXACTLY && self.normal.dot(&direction) > 0.0
    }
}

impl SupportShape<'_> {
    /// Whether several contacts with this core make sense: it has straight edges.
    pub fn has_edges(&self) -> bool {
        matches!(self.core, Core::Segment(_) | Core::Cylinder(..) | Core::Box(_) | Core::Hull(_))
    }

    /// The flat faces around the core's farthest points along `direction`, in the order of their axes: of a box those that
    /// meet there, of others the one that looks most that way.
    pub(in super::super) fn facings(&self, direction: Vector3<f64>) -> [Option<Facing>; 3] {
        let d = self.rotation.tr_mul(&direction);
        let world = |face: usize, normal: Vector3<f64>| Some(Facing { face, normal: self.rotation * normal });
        match self.core {
            Core::Box(_) => core::array::from_fn(|axis| {
                let face = 2 * axis + usize::from(d[axis] < 0.0);
                if d[axis].abs() > EXACTLY { world(face, Vector3::ith(axis, d[axis].signum())) } else { None }
            }),
            // Touched from the side, no cap is near.
            Core::Cylinder(..) if d.z.abs() < SIDEWAYS => [None; 3],
            Core::Cylinder(..) => [world(usize::from(d.z < 0.0), Vector3::z() * d.z.signum()), None, None],
            Core::Hull(hull) => {
                let face = hull.facing(hull.support_point(d), d);
                [face.and_then(|face| world(face, hull.faces[face].normal)), None, None]
            }
            Core::Point | Core::Segment(_) | Core::Ellipsoid(_) | Core::Prism(_) => [None; 3],
        }
    }

    /// Writes the corners of a face, counter-clockwise from outside.
    pub(in super::super) fn outline(&self, facing: &Facing, corners: &mut Vec<Vector3<f64>>) {
        corners.clear();
        let mut add = |local: Vector3<f64>| corners.push(self.position + self.rotation * local);
        match self.core {
            Core::Box(half) => {
                let (axis, sign) = (facing.face / 2, if facing.face.is_multiple_of(2) { 1.0 } else { -1.0 });
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                for [x, y] in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
                    let mut corner = Vector3::zeros();
                    // Seen from the other end of the axis, the other sense is counter-clockwise.
                    (corner[axis], corner[u], corner[v]) = (sign * half[axis], x * half[u], sign * y * half[v]);
                    add(corner);
                }
            }
            Core::Cylinder(radius, half) => {
                let sign = if facing.face == 0 { 1.0 } else { -1.0 };
                for index in 0..RIM_CORNERS {
                    let angle = index as f64 * core::f64::consts::TAU / RIM_CORNERS as f64;
                    let (sin, cos) = libm::sincos(angle);
                    add(Vector3::new(radius * cos, sign * radius * sin, sign * half));
                }
            }
            Core::Hull(hull) => hull.corners_of(facing.face).iter().for_each(|&corner| add(hull.vertices[corner])),
            Core::Point | Core::Segment(_) | Core::Ellipsoid(_) | Core::Prism(_) => {}
        }
    }

    /// Of the edges at the core's farthest point along `direction`, the one most nearly parallel to the plane across
    /// `normal`, and the sine of its angle with that plane. Where a whole edge is farthest, only that one counts.
    pub fn edge_across(&self, direction: Vector3<f64>, normal: Vector3<f64>) -> Option<([Vector3<f64>; 2], f64)> {
        let (d, n) = (self.rotation.tr_mul(&direction), self.rotation.tr_mul(&normal));
        let mut best: Option<([Vector3<f64>; 2], f64)> = None;
        let mut consider = |ends: [Vector3<f64>; 2]| {
            let along = ends[1] - ends[0];
            let sine = (along.dot(&n) / along.norm()).abs();
            if best.is_none_or(|(_, least)| sine < least) {
                best = Some((ends, sine));
            }
        };
        match self.core {
            Core::Segment(half) => consider([Vector3::new(0.0, 0.0, half), Vector3::new(0.0, 0.0, -half)]),
            Core::Cylinder(radius, half) => {
                let across = libm::hypot(d.x, d.y);
                if across > 0.0 {
                    let [x, y] = [d.x, d.y].map(|side| side * radius / across);
                    consider([Vector3::new(x, y, half), Vector3::new(x, y, -half)]);
                }
            }
            Core::Box(half) => {
                let corner = half.zip_map(&d, f64::copysign);
                let whole = (0..3).find(|&axis| d[axis].abs() < EXACTLY);
                for axis in (0..3).filter(|&axis| whole.is_none_or(|whole| axis == whole)) {
                    let mut other = corner;
                    other[axis] = -other[axis];
                    consider([corner, other]);
                }
            }
            Core::Hull(hull) => {
                let vertex = hull.support_point(d);
                let corner = hull.vertices[vertex];
                let neighbours = |&face: &usize| {
                    let corners = hull.corners_of(face);
                    let place = corners.iter().position(|&corner| corner == vertex)?;
                    Some(hull.vertices[corners[(place + 1) % corners.len()]])
                };
                let around = || hull.faces_around(vertex).iter().filter_map(neighbours);
                let whole = around().find(|other| {
                    let along = other - corner;
                    along.dot(&d).abs() < EXACTLY * along.norm()
                });
                match whole {
                    Some(other) => consider([corner, other]),
                    None => around().for_each(|other| consider([corner, other])),
                }
            }
            Core::Point | Core::Ellipsoid(_) | Core::Prism(_) => {}
        }
        // Of a capsule the line of its surface that lies this way, as long as its segment.
        best.map(|(ends, sine)| {
            let along = self.rotation * (ends[1] - ends[0]);
            let aside = direction - along * (direction.dot(&along) / along.norm_squared());
            (ends.map(|end| self.position + self.rotation * end + aside * self.radius), sine)
        })
    }
}

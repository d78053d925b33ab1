//! Contacts of convex shapes without a closed form.
//!
//! 1. [`support`]: every shape as a core, known by its farthest points, and a radius around it;
//! 2. [`gjk`]: the distance of two cores that are apart (Gilbert, Johnson, Keerthi 1988);
//! 3. [`epa`]: the least translation that separates two cores that overlap (van den Bergen 2001);
//! 4. [`manifold`]: several contacts where flat parts meet, found among the [`features`] of both cores.
//!
//! Spheres and capsules are points and segments with a radius, so their roundness costs no accuracy.

mod epa;
mod features;
mod gjk;
pub(super) mod manifold;
pub(super) mod support;

use super::polygon::Polygon;
use nalgebra::Vector3;
use support::SupportShape;

/// Memory of the searches, kept between calls.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    polytope: epa::Polytope,
    pub(super) polygon: Polygon,
    outline: Vec<Vector3<f64>>,
}

/// How two convex shapes stand to each other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Separation {
    /// Signed distance of the surfaces, m.
    pub distance: f64,
    /// Unit vector from the first to the second.
    pub normal: Vector3<f64>,
    /// Nearest points of both surfaces; deepest ones where they overlap.
    pub points: [Vector3<f64>; 2],
}

/// The signed distance of two shapes; `None` if it is larger than `reach`.
pub(super) fn separate(
    first: &SupportShape<'_>,
    second: &SupportShape<'_>,
    reach: f64,
    scratch: &mut Scratch,
) -> Option<Separation> {
    let radii = [first.radius, second.radius];
    let (distance, normal, cores) = match gjk::distance(first, second, reach + radii[0] + radii[1]) {
        gjk::Outcome::Farther => return None,
        gjk::Outcome::Apart { distance, normal, points } => (distance, normal, points),
        gjk::Outcome::Overlapping => {
            let depth = epa::depth(first, second, &mut scratch.polytope);
            (-depth.depth, depth.normal, depth.points)
        }
    };
    let distance = distance - radii[0] - radii[1];
    let points = [cores[0] + normal * radii[0], cores[1] - normal * radii[1]];
    (distance <= reach).then_some(Separation { distance, normal, points })
}

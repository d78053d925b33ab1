//! The vertical gap between two convex shapes.

use msk_physics::collision::SupportShape;
use msk_physics::scalar::Real;
use nalgebra::{Vector2, Vector3};

/// A point of the shape that lies farthest along `direction` (any length but zero).
pub(super) fn support_point(solid: &SupportShape<'_>, direction: &Vector3<f64>) -> Vector3<f64> {
    let core = solid.support_point(*direction);
    if solid.radius > 0.0 { core + direction * (solid.radius / direction.norm()) } else { core }
}

/// Refinements of a portal at most; smooth shapes need about ten.
const MOST_REFINEMENTS: usize = 100;

/// Gaps are this exact, m.
const EXACT: f64 = 1e-13;

/// How far `upper` can fall straight down until it touches `lower` (m; negative where it would have to rise to clear it);
/// `None` where one is not above the other.
///
/// The gap is where the vertical through the origin enters the difference of the two shapes {p - g}, which is convex. Three of
/// its points whose triangle the vertical pierces are a portal; the farthest point below the portal replaces one of them
/// until there is none (portal refinement, Snethen 2008).
pub(super) fn gap(upper: &SupportShape<'_>, lower: &SupportShape<'_>) -> Option<f64> {
    let difference = |d: &Vector3<f64>| support_point(upper, d) - support_point(lower, &-d);
    let mut portal = around_vertical(&difference, (upper.position - lower.position).xy())?;
    let mut level = f64::NEG_INFINITY;
    for _ in 0..MOST_REFINEMENTS {
        let Some(normal) = underside(&portal) else { break };
        let lowest = difference(&normal);
        // All of the difference lies above this plane, and the portal above the gap.
        level = level.at_least(normal.dot(&lowest) / normal.z);
        if height(&portal) - level < EXACT {
            break;
        }
        let [a, b, c] = portal;
        let parts = [[a, b, lowest], [b, c, lowest], [c, a, lowest]];
        // Where the vertical meets an edge, two of the parts are pierced: the lower one leads on.
        let pierced = parts.iter().filter(|part| insideness(part) > -1e-10);
        let lower = pierced.min_by(|first, second| height(first).total_cmp(&height(second)));
        let surest = || parts.iter().max_by(|first, second| insideness(first).total_cmp(&insideness(second)));
        portal = *lower.or_else(surest)?;
    }
    level.is_finite().then_some(level)
}

/// The unit normal of a triangle that looks down; `None` if the triangle is upright.
fn underside([a, b, c]: &[Vector3<f64>; 3]) -> Option<Vector3<f64>> {
    let normal = (b - a).cross(&(c - a));
    let normal = if normal.z > 0.0 { -normal } else { normal };
    normal.try_normalize(0.0).filter(|normal| normal.z < -1e-12)
}

/// Where the vertical through the origin meets the plane of a triangle.
fn height(triangle: &[Vector3<f64>; 3]) -> f64 {
    underside(triangle).map_or(f64::INFINITY, |normal| normal.dot(&triangle[0]) / normal.z)
}

fn cross(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Smallest share of the origin in the triangle's corners, seen from above; negative outside.
fn insideness([a, b, c]: &[Vector3<f64>; 3]) -> f64 {
    let area = cross(&(b - a), &(c - a));
    if area == 0.0 {
        return f64::NEG_INFINITY;
    }
    [cross(b, c), cross(c, a), cross(a, b)].iter().map(|part| part / area).fold(f64::INFINITY, Real::at_most)
}

/// Three points of a convex set whose triangle the vertical through the origin pierces; `None` if it misses the set.
/// `offset` is a first guess of where the set is (Gilbert, Johnson and Keerthi 1988, in the plane).
fn around_vertical(support: &impl Fn(&Vector3<f64>) -> Vector3<f64>, offset: Vector2<f64>) -> Option<[Vector3<f64>; 3]> {
    const MOST: usize = 64;
    let flat = |d: Vector2<f64>| Vector3::new(d.x, d.y, 0.0);
    // Left of the line from `from` to `to`, turned to the side where the origin is.
    let towards_origin = |from: &Vector3<f64>, to: &Vector3<f64>| {
        let left = Vector2::new(from.y - to.y, to.x - from.x);
        if left.dot(&from.xy()) > 0.0 { -left } else { left }
    };
    let start = if offset == Vector2::zeros() { Vector2::x() } else { -offset };
    let first = support(&flat(start));
    let back = if first.xy() == Vector2::zeros() { -start } else { -first.xy() };
    let second = support(&flat(back));
    if second.xy().dot(&back) < 0.0 {
        return None;
    }
    let (mut older, mut newer) = (first, second);
    for _ in 0..MOST {
        let direction = towards_origin(&older, &newer);
        if direction == Vector2::zeros() {
            return None;
        }
        let point = support(&flat(direction));
        if point.xy().dot(&direction) < 0.0 {
            return None;
        }
        if insideness(&[older, newer, point]) >= 0.0 {
            return Some([older, newer, point]);
        }
        // The origin lies beyond the edge to one of the two.
        let beyond = |corner: &Vector3<f64>, other: &Vector3<f64>| {
            let edge = towards_origin(corner, &point);
            edge.dot(&(other - corner).xy()) <= 0.0
        };
        if beyond(&newer, &older) {
            (older, newer) = (newer, point);
        } else {
            newer = point;
        }
    }
    None
}

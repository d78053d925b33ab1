//! Convex shapes as seen from straight above: how far the nearest point is, and where a level ray meets one.

use super::convex::support_point;
use msk_physics::collision::SupportShape;
use msk_physics::scalar::Real;
use nalgebra::{Vector2, Vector3};

/// Steps at most; smooth shapes need about ten.
const MOST_STEPS: usize = 64;

/// Distances are this exact, m.
const EXACT: f64 = 1e-12;

/// The farthest point of the footprint, seen from `eye`.
fn support(shape: &SupportShape<'_>, eye: Vector2<f64>, direction: Vector2<f64>) -> Vector2<f64> {
    support_point(shape, &Vector3::new(direction.x, direction.y, 0.0)).xy() - eye
}

/// The vector from `eye` to the nearest point of a shape's footprint, zero above or below it
/// (Gilbert, Johnson and Keerthi 1988, in the plane).
pub(super) fn nearest(shape: &SupportShape<'_>, eye: Vector2<f64>) -> Vector2<f64> {
    let towards = shape.position.xy() - eye;
    let mut ends = [support(shape, eye, if towards == Vector2::zeros() { Vector2::x() } else { -towards }); 2];
    let mut best = ends[0];
    for _ in 0..MOST_STEPS {
        let length = best.norm();
        if length <= EXACT {
            return Vector2::zeros();
        }
        let next = support(shape, eye, -best);
        // No point of the footprint is nearer than this along the line of sight.
        if length - next.dot(&best) / length <= EXACT {
            return best;
        }
        let triangle = [ends[0], ends[1], next];
        if around_origin(&triangle) {
            return Vector2::zeros();
        }
        // The nearest of the edges that the new point makes with the old ends.
        let candidates = [[ends[0], next], [ends[1], next]];
        let [first, second] = candidates.map(|edge| on_edge(&edge));
        let (edge, point) = if first.norm_squared() <= second.norm_squared() { (0, first) } else { (1, second) };
        if point.norm() >= length {
            return best;
        }
        (ends, best) = (candidates[edge], point);
    }
    best
}

/// How far from `eye` the level ray along the unit vector `direction` enters a shape's footprint, m; `None` if it misses it,
/// zero inside.
///
/// Two points of the footprint on either side of the line are a portal; the farthest point in front of it replaces one of them
/// until there is none.
pub(super) fn ray(shape: &SupportShape<'_>, eye: Vector2<f64>, direction: Vector2<f64>) -> Option<f64> {
    let left = Vector2::new(-direction.y, direction.x);
    let aside = |point: &Vector2<f64>| left.dot(point);
    let [mut high, mut low] = [support(shape, eye, left), support(shape, eye, -left)];
    if aside(&high) < 0.0 || aside(&low) > 0.0 {
        return None;
    }
    let mut entry = f64::NEG_INFINITY;
    for _ in 0..MOST_STEPS {
        let width = aside(&high) - aside(&low);
        if width <= 0.0 {
            break;
        }
        let share = -aside(&low) / width;
        let between = low + (high - low) * share;
        entry = between.dot(&direction);
        let edge = high - low;
        // Square to the portal, towards the eye.
        let normal = Vector2::new(-edge.y, edge.x);
        let normal = if normal.dot(&direction) > 0.0 { -normal } else { normal };
        let next = support(shape, eye, normal);
        let reach = (next - between).dot(&normal) / normal.norm();
        if reach.is_nan() || reach <= EXACT {
            break;
        }
        if aside(&next) >= 0.0 { high = next } else { low = next }
    }
    if entry >= 0.0 {
        return Some(entry);
    }
    // The line enters behind the eye: it is inside, or past the shape.
    (nearest(shape, eye) == Vector2::zeros()).then_some(0.0)
}

fn on_edge([a, b]: &[Vector2<f64>; 2]) -> Vector2<f64> {
    let along = b - a;
    let square = along.norm_squared();
    if square == 0.0 {
        return *a;
    }
    a + along * (-a.dot(&along) / square).clip(0.0, 1.0)
}

fn around_origin([a, b, c]: &[Vector2<f64>; 3]) -> bool {
    let sides = [a.perp(b), b.perp(c), c.perp(a)];
    (a - b).perp(&(c - b)) != 0.0 && (sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0))
}

//! The distance of two convex cores.
//!
//! The difference of two convex sets is convex, and its point nearest to the origin is the difference of the sets' nearest
//! points. Each round takes the point nearest to the origin of a simplex of known points, asks for the farthest point the
//! other way, and goes on with the smallest simplex that holds the new nearest point.

use super::support::{SupportShape, Vertex, support_point};
use crate::scalar::Real;
use nalgebra::Vector3;

/// Rounds at most: polyhedra need few, smooth shapes that nearly touch some tens.
const MOST_ROUNDS: usize = 200;
/// A distance is final when it is known to this share.
const PRECISION: f64 = 1e-15;
/// Closer cores than this share of their size count as overlapping.
const TOUCHING: f64 = 1e-13;

/// What is known of two cores.
#[derive(Debug)]
pub(super) enum Outcome {
    /// Farther from each other than asked for.
    Farther,
    /// Their distance (m), the unit vector from the first to the second, and their nearest points.
    Apart { distance: f64, normal: Vector3<f64>, points: [Vector3<f64>; 2] },
    /// They touch or overlap.
    Overlapping,
}

/// Up to four points of the difference, with the weights of their nearest point to the origin.
#[derive(Debug, Clone, Copy)]
struct Simplex {
    vertices: [Vertex; 4],
    weights: [f64; 4],
    size: usize,
}

/// The distance of two cores that are not farther apart than `limit`.
pub(super) fn distance(first: &SupportShape<'_>, second: &SupportShape<'_>, limit: f64) -> Outcome {
    let between = first.position - second.position;
    let start = if between.norm_squared() > 0.0 { between } else { Vector3::x() };
    let touching = TOUCHING * (first.scale() + second.scale());
    let vertex = support_point(first, second, -start);
    let mut simplex = Simplex { vertices: [vertex; 4], weights: [1.0, 0.0, 0.0, 0.0], size: 1 };
    let mut nearest = vertex.point;
    for _ in 0..MOST_ROUNDS {
        let square = nearest.norm_squared();
        let length = square.sqrt();
        if length <= touching {
            return Outcome::Overlapping;
        }
        let vertex = support_point(first, second, -nearest);
        let along = nearest.dot(&vertex.point);
        if along > limit * length {
            return Outcome::Farther;
        }
        let known = simplex.vertices[..simplex.size].iter().any(|known| known.point == vertex.point);
        if known || square - along <= PRECISION * square {
            break;
        }
        let mut next = simplex;
        next.vertices[next.size] = vertex;
        next.size += 1;
        // A plane through the last farthest point keeps the difference from the origin: no simplex holds it, whatever rounding
        // says of a flat one.
        let apart = along > 0.0;
        let Some(point) = next.reduce(apart) else { return Outcome::Overlapping };
        if point.norm_squared() >= square {
            break;
        }
        (simplex, nearest) = (next, point);
    }
    let distance = nearest.norm();
    let on = |side: usize| simplex.vertices[..simplex.size].iter().zip(simplex.weights).map(|(v, w)| v.on[side] * w).sum();
    Outcome::Apart { distance, normal: -nearest / distance, points: [on(0), on(1)] }
}

impl Simplex {
    /// Keeps the smallest face that holds the point nearest to the origin and returns that point; `None` if the origin is
    /// inside, which it is not where it is known to be `apart`.
    fn reduce(&mut self, apart: bool) -> Option<Vector3<f64>> {
        match self.size {
            2 => self.keep(&self.segment([0, 1])),
            3 => self.keep(&self.triangle([0, 1, 2])),
            4 => {
                let mut best: Option<Nearest> = None;
                for [a, b, c, d] in [[0, 1, 2, 3], [0, 3, 1, 2], [0, 2, 3, 1], [1, 3, 2, 0]] {
                    if !apart && self.hides(a, b, c, d) {
                        continue;
                    }
                    let candidate = self.triangle([a, b, c]);
                    if best.as_ref().is_none_or(|best| candidate.square < best.square) {
                        best = Some(candidate);
                    }
                }
                self.keep(&best?)
            }
            _ => Some(self.vertices[0].point),
        }
    }

    /// Whether the origin lies on the same side of the plane through a, b, c as d.
    fn hides(&self, a: usize, b: usize, c: usize, d: usize) -> bool {
        let [a, b, c, d] = [a, b, c, d].map(|index| self.vertices[index].point);
        let normal = (b - a).cross(&(c - a));
        let (origin, apex) = (-a.dot(&normal), (d - a).dot(&normal));
        // A flat tetrahedron hides nothing.
        apex != 0.0 && origin * apex > 0.0
    }

    fn segment(&self, [i, j]: [usize; 2]) -> Nearest {
        let [a, b] = [i, j].map(|index| self.vertices[index].point);
        let along = b - a;
        let share = (-a.dot(&along) / along.norm_squared()).clip(0.0, 1.0);
        if share.is_nan() || share == 0.0 {
            return self.corner(i);
        }
        if share == 1.0 {
            return self.corner(j);
        }
        let point = a + along * share;
        Nearest { members: [i, j, 0], weights: [1.0 - share, share, 0.0], size: 2, square: point.norm_squared() }
    }

    fn corner(&self, i: usize) -> Nearest {
        Nearest { members: [i, 0, 0], weights: [1.0, 0.0, 0.0], size: 1, square: self.vertices[i].point.norm_squared() }
    }

    /// The triangle's point nearest to the origin: inside where all three areas have the normal's sense, else on an edge.
    fn triangle(&self, members: [usize; 3]) -> Nearest {
        let [a, b, c] = members.map(|index| self.vertices[index].point);
        let normal = (b - a).cross(&(c - a));
        let areas = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|area| area.dot(&normal));
        let square = normal.norm_squared();
        if square > 0.0 && areas.iter().all(|area| *area > 0.0) {
            let total: f64 = areas.iter().sum();
            let height = a.dot(&normal);
            return Nearest { members, weights: areas.map(|area| area / total), size: 3, square: height * height / square };
        }
        let [i, j, k] = members;
        let edges = [self.segment([i, j]), self.segment([j, k]), self.segment([k, i])];
        edges
            .into_iter()
            .reduce(|best, edge| if edge.square < best.square { edge } else { best })
            .unwrap_or_else(|| self.corner(i))
    }

    fn keep(&mut self, nearest: &Nearest) -> Option<Vector3<f64>> {
        let old = self.vertices;
        self.size = nearest.size;
        let mut point = Vector3::zeros();
        for (slot, (&member, &weight)) in nearest.members.iter().zip(&nearest.weights).take(nearest.size).enumerate() {
            self.vertices[slot] = old[member];
            self.weights[slot] = weight;
            point += old[member].point * weight;
        }
        Some(point)
    }
}

/// The nearest point of a simplex to the origin: the corners it lies between, and their weights.
struct Nearest {
    members: [usize; 3],
    weights: [f64; 3],
    size: usize,
    square: f64,
}

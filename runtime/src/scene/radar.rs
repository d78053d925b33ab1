//! Looking around on the level: how near things are, sector by sector.

use super::footprint::{nearest, ray};
use core::f64::consts::TAU;
use msk_physics::collision::SupportShape;
use msk_physics::scalar::Real;
use nalgebra::Vector2;

/// Sectors side by side, symmetric about a heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radar {
    /// Where it stands, m.
    pub eye: Vector2<f64>,
    /// The middle of all sectors, unit vector.
    pub heading: Vector2<f64>,
    /// Angle that all sectors span, rad.
    pub over: f64,
    /// What is farther is not seen, m.
    pub range: f64,
}

impl Radar {
    /// Raises the nearness of `sectors`, from left to right, to that of a shape: `1 - distance / range` of the nearest point of its
    /// footprint in the sector.
    pub(crate) fn see(&self, shape: &SupportShape<'_>, sectors: &mut [f64]) {
        let to_nearest = nearest(shape, self.eye);
        let distance = to_nearest.norm();
        if distance >= self.range {
            return;
        }
        let count = sectors.len() as f64;
        let bearing = self.bearing(&to_nearest);
        for (index, nearness) in sectors.iter_mut().enumerate() {
            let left = self.over * (0.5 - index as f64 / count);
            let right = self.over * (0.5 - (index + 1) as f64 / count);
            // The distance is convex: unless its least is in the sector, the sector's is on one of its edges.
            let inside = distance == 0.0 || turned_into(bearing, right) <= left;
            let seen = if inside {
                Some(distance)
            } else {
                let edges = [left, right].map(|angle| ray(shape, self.eye, self.direction(angle)));
                edges.into_iter().flatten().reduce(Real::at_most)
            };
            if let Some(seen) = seen {
                *nearness = nearness.at_least(1.0 - seen / self.range);
            }
        }
    }

    /// Angle of a vector to the left of the heading, rad.
    fn bearing(&self, vector: &Vector2<f64>) -> f64 {
        libm::atan2(self.heading.perp(vector), self.heading.dot(vector))
    }

    fn direction(&self, angle: f64) -> Vector2<f64> {
        let (sin, cos) = libm::sincos(angle);
        self.heading * cos + Vector2::new(-self.heading.y, self.heading.x) * sin
    }
}

/// The angle, by whole turns, that is not less than `least`.
fn turned_into(angle: f64, least: f64) -> f64 {
    if angle < least { angle + TAU } else { angle }
}

//! The distance of two surfaces.

use super::{
    convex::{self, Scratch, support::SupportShape},
    ellipsoid, height_field,
    place::Placed,
};
use crate::model::GeomKind;
use nalgebra::Vector3;

/// How far two surfaces are from each other, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Distance, m; where the shapes overlap, minus the least translation that separates them.
    pub distance: f64,
    /// The nearest points on the first and the second surface, world frame, m.
    pub points: [Vector3<f64>; 2],
}

/// The distance of two shapes, whatever their kinds; `None` if it is larger than `range`, or if both are planes or height
/// fields. `scratch` is memory kept between calls.
pub fn between(first: &Placed<'_>, second: &Placed<'_>, range: f64, scratch: &mut Scratch) -> Option<Gap> {
    if first.kind as u8 > second.kind as u8 {
        let Gap { distance, points: [b, a] } = between(second, first, range, scratch)?;
        return Some(Gap { distance, points: [a, b] });
    }
    match (first.kind, second.kind) {
        (GeomKind::Plane | GeomKind::HeightField, GeomKind::Plane | GeomKind::HeightField) => None,
        (GeomKind::Plane, _) => above(first, second, range),
        (GeomKind::HeightField, _) => height_field::distance(first, second, range, scratch),
        (GeomKind::Sphere | GeomKind::Capsule | GeomKind::Ellipsoid, GeomKind::Ellipsoid) => {
            let separation = ellipsoid::separate(first, second, scratch)?;
            let points = separation.points();
            (separation.distance <= range).then_some(Gap { distance: separation.distance, points })
        }
        _ => {
            let origin = first.position;
            let (first, second) = (SupportShape::new(first, origin)?, SupportShape::new(second, origin)?);
            let separation = convex::separate(&first, &second, range, scratch)?;
            Some(Gap { distance: separation.distance, points: separation.points.map(|point| point + origin) })
        }
    }
}

/// Height of a shape over a plane.
fn above(plane: &Placed<'_>, shape: &Placed<'_>, range: f64) -> Option<Gap> {
    let normal = plane.axis();
    let solid = SupportShape::new(shape, plane.position)?;
    let lowest = solid.support_point(-normal) - normal * solid.radius;
    let distance = lowest.dot(&normal);
    let lowest = lowest + plane.position;
    (distance <= range).then_some(Gap { distance, points: [lowest - normal * distance, lowest] })
}

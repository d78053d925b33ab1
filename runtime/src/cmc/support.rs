//! Support: the points of the feet that can bear weight, and where the ground is under them.

use crate::body::Body;
use crate::scene::ground::{Footing, Ground};
use core::ops::Range;
use msk_physics::kinematics::Kinematics;
use msk_physics::model::{GeomKind, Model};
use msk_physics::scalar::Real;
use nalgebra::{Matrix3, Vector3};

/// A point of a foot that faces the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    /// Which of all points of all feet it is: they come in this order.
    pub key: usize,
    /// Body that carries it.
    pub body: usize,
    /// World position, m.
    pub position: Vector3<f64>,
    /// Upward normal of the ground.
    pub normal: Vector3<f64>,
    /// Height above the ground, m.
    pub height: f64,
    /// Coefficient of sliding friction.
    pub friction: f64,
}

/// The feet of a body.
#[derive(Debug, Clone)]
pub(super) struct Support {
    /// Shapes of each foot, with the key of the first point of each.
    feet: Vec<Vec<(usize, usize)>>,
    ground: Vec<usize>,
    /// Whether all of it is level.
    is_level: bool,
    /// Points of all feet that the body stands on, refilled by [`update`](Self::update).
    pub points: Vec<Point>,
}

/// A foot that is nearer to the ground than this when an episode begins is stood on, m.
const STANCE: f64 = 0.01;
/// What is further below the top of something stands beside it, m.
const SUNK: f64 = 0.04;

/// The plane on which a point would rest.
#[derive(Debug, Clone, Copy)]
struct Bed {
    origin: Vector3<f64>,
    normal: Vector3<f64>,
    friction: f64,
}

impl Bed {
    /// That under a point; the level z = 0 where there is nothing.
    fn under(ground: &Ground<'_>, point: &Vector3<f64>) -> Self {
        let none = Self { origin: Vector3::zeros(), normal: Vector3::z(), friction: 0.0 };
        ground.under(point, SUNK).map_or(none, |(shape, Footing { height, normal })| {
            let origin = Vector3::new(point.x, point.y, height);
            Self { origin, normal, friction: ground.model.geoms.friction[shape][0] }
        })
    }
}

impl Support {
    /// The landmarks of the body's group `feet`, or all whose names begin with `sole`, as far as they have shapes.
    pub fn new(body: &Body) -> Self {
        let feet = Self::landmarks(body).map(|landmark| &body.landmarks[landmark].segment);
        let mut shapes = 0;
        let mut keyed = |&shape: &usize| {
            shapes += 1;
            (shape, MOST_POINTS * (shapes - 1))
        };
        Self {
            feet: feet.map(|shapes| shapes.iter().map(&mut keyed).collect()).collect(),
            is_level: body.ground == body.level,
            ground: body.ground.clone(),
            points: Vec::new(),
        }
    }

    /// The bodies that carry the shapes of all feet, ascending.
    pub fn carriers(&self, model: &Model) -> Vec<usize> {
        let mut bodies: Vec<usize> = self.feet.iter().flatten().map(|&(shape, _)| model.geoms.body[shape]).collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    }

    /// Keeps the feet that the body stands on.
    pub fn choose_stance(&mut self, model: &Model, kinematics: &Kinematics<f64>) {
        let feet = core::mem::take(&mut self.feet);
        let stands = |shapes: &Vec<(usize, usize)>| {
            let mut points = Vec::new();
            self.fill(model, kinematics, shapes, &mut points);
            points.iter().any(|point| point.height < STANCE)
        };
        self.feet = feet.into_iter().filter(stands).collect();
    }

    /// Refills the points of all feet stood on.
    pub fn update(&mut self, model: &Model, kinematics: &Kinematics<f64>) {
        let mut points = core::mem::take(&mut self.points);
        points.clear();
        for shapes in &self.feet {
            self.fill(model, kinematics, shapes, &mut points);
        }
        self.points = points;
    }

    /// The landmarks of the feet that have points, in the order of the feet.
    pub fn landmarks(body: &Body) -> impl Iterator<Item = usize> + '_ {
        members(body).into_iter().filter(|&landmark| !body.landmarks[landmark].segment.is_empty())
    }

    /// Keys of the points of each foot.
    pub fn keys(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        self.feet.iter().filter_map(|shapes| Some(shapes.first()?.1..shapes.last()?.1 + MOST_POINTS))
    }

    /// The middle of all points, m; `None` without any.
    pub fn centre(&self) -> Option<Vector3<f64>> {
        let sum: Vector3<f64> = self.points.iter().map(|point| point.position).sum();
        (!self.points.is_empty()).then(|| sum / self.points.len() as f64)
    }

    fn fill(&self, model: &Model, kinematics: &Kinematics<f64>, shapes: &[(usize, usize)], points: &mut Vec<Point>) {
        let ground = Ground { model, kinematics, shapes: &self.ground };
        for &(shape, first) in shapes {
            let (centre, rotation) = (kinematics.geom_position[shape], kinematics.geom_rotation[shape]);
            let bed = Bed::under(&ground, &centre);
            let own = model.geoms.friction[shape][0];
            let body = model.geoms.body[shape];
            let mut key = first;
            let mut push = |arm: Vector3<f64>| {
                let position = centre + arm;
                // Where the ground is not level each point has a place of its own.
                let Bed { origin, normal, friction } = if self.is_level { bed } else { Bed::under(&ground, &position) };
                let (height, friction) = ((position - origin).dot(&normal), friction.at_least(own));
                points.push(Point { key, body, position, normal, height, friction });
                key += 1;
            };
            underside(model.geoms.kind[shape], &model.geoms.size[shape], &rotation, &bed.normal, &mut push);
        }
    }
}

/// The landmarks of the body's group `feet`, or all whose names begin with `sole`.
fn members(body: &Body) -> Vec<usize> {
    let named = || (0..body.landmarks.len()).filter(|&index| body.landmarks[index].name.starts_with("sole"));
    body.landmark_group("feet").map_or_else(|| named().collect(), <[usize]>::to_vec)
}

/// Points of one shape at most: the corners of a box.
const MOST_POINTS: usize = 8;

/// Hands out the points, relative to its centre in world axes, on which a shape can rest on ground with that normal.
fn underside(
    kind: GeomKind,
    size: &Vector3<f64>,
    rotation: &Matrix3<f64>,
    normal: &Vector3<f64>,
    push: &mut impl FnMut(Vector3<f64>),
) {
    let down = -rotation.transpose() * normal;
    match kind {
        GeomKind::Sphere => push(-normal * size.x),
        GeomKind::Capsule => {
            for end in [-1.0, 1.0] {
                push(rotation.column(2) * (end * size.y) - normal * size.x);
            }
        }
        GeomKind::Ellipsoid => {
            // The support point of x'D⁻²x = 1 in a direction d is D² d / |D d|.
            let stretched = size.component_mul(&down);
            push(rotation * size.component_mul(&stretched) / stretched.norm());
        }
        GeomKind::Cylinder => {
            let across = Vector3::new(down.x, down.y, 0.0);
            let rim = if across.norm() > 0.0 { across.normalize() * size.x } else { Vector3::zeros() };
            for end in [-1.0, 1.0] {
                push(rotation * (rim + Vector3::z() * (end * size.y)));
            }
        }
        GeomKind::Box | GeomKind::Mesh => {
            for corner in 0..8 {
                let side = |bit: usize| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
                push(rotation * size.component_mul(&Vector3::new(side(0), side(1), side(2))));
            }
        }
        GeomKind::Plane | GeomKind::HeightField => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::shape::support;

    #[test]
    fn the_lowest_point_is_as_low_as_the_shape_reaches() {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.5, 0.9).into_inner();
        let normal = Vector3::z();
        let size = Vector3::new(0.1, 0.3, 0.2);
        for kind in [GeomKind::Sphere, GeomKind::Capsule, GeomKind::Ellipsoid, GeomKind::Cylinder, GeomKind::Box] {
            let mut lowest = f64::INFINITY;
            underside(kind, &size, &turn, &normal, &mut |arm| lowest = lowest.at_most(arm.dot(&normal)));
            let reach = support(kind, size, -turn.transpose() * normal);
            assert!((lowest + reach).abs() < 1e-12, "{kind:?}: {lowest} is not {reach}");
        }
    }
}

//! How high the ground is, and how far things are above it.
//!
//! The ground is everything walkable: the level ground, stairs, slopes, stones. Seen from above it is one surface of heights;
//! under bridges there is none.

use super::convex::{gap, support_point};
use crate::body::shape::support;
use msk_physics::collision::{Asset, Core, Placed, SupportShape, ray};
use msk_physics::kinematics::Kinematics;
use msk_physics::model::{GeomKind, HeightField, Model};
use msk_physics::scalar::Real;
use nalgebra::{Matrix3, Vector2, Vector3};

/// Where a scene with walkable things has none under a place, the ground counts as this high, m: deeper than any fall.
pub const ABYSS: f64 = -10.0;

/// A place on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footing {
    /// Height, m.
    pub height: f64,
    /// Upward unit normal.
    pub normal: Vector3<f64>,
}

/// Walkable shapes where they are now.
#[derive(Debug, Clone, Copy)]
pub struct Ground<'a> {
    /// The model.
    pub model: &'a Model,
    /// Where its shapes are.
    pub kinematics: &'a Kinematics<f64>,
    /// Which of them are walkable; none means the level z = 0.
    pub shapes: &'a [usize],
}

impl Ground<'_> {
    /// The highest place of the ground over or under a horizontal place; `None` over an abyss.
    pub fn footing(&self, place: Vector2<f64>) -> Option<Footing> {
        if self.shapes.is_empty() {
            return Some(Footing { height: 0.0, normal: Vector3::z() });
        }
        let footings = self.shapes.iter().filter_map(|&shape| self.top(shape, place));
        footings.max_by(|a, b| a.height.total_cmp(&b.height))
    }

    /// What a point rests on or falls onto: the highest place under it that is no more than `sunk` (m) above it, and the shape there. `None` over an
    /// abyss, and without shapes.
    pub fn under(&self, point: &Vector3<f64>, sunk: f64) -> Option<(usize, Footing)> {
        let tops = self.shapes.iter().filter_map(|&shape| Some((shape, self.top(shape, point.xy())?)));
        let under = tops.filter(|(_, footing)| footing.height <= point.z + sunk);
        under.max_by(|(_, a), (_, b)| a.height.total_cmp(&b.height))
    }

    /// Height of the ground at a horizontal place, m; [`ABYSS`] where there is none.
    pub fn height(&self, place: Vector2<f64>) -> f64 {
        self.footing(place).map_or(ABYSS, |footing| footing.height)
    }

    /// Upward unit normal of the ground at a horizontal place; straight up where there is none.
    pub fn normal(&self, place: Vector2<f64>) -> Vector3<f64> {
        self.footing(place).map_or_else(Vector3::z, |footing| footing.normal)
    }

    /// The highest point of one shape over a horizontal place.
    fn top(&self, shape: usize, place: Vector2<f64>) -> Option<Footing> {
        let placed = Placed::of(self.model, self.kinematics, 0, shape);
        if placed.kind == GeomKind::Plane {
            let normal = placed.rotation.column(2).into_owned();
            let rise = normal.xy().dot(&(place - placed.position.xy()));
            return (normal.z > 0.0).then(|| Footing { height: placed.position.z - rise / normal.z, normal });
        }
        // From outside, but no farther away than needed: the height has the rounding of the distance.
        let top = placed.position.z + 1.001 * self.radius(shape);
        let (fall, normal) = ray::meet(&placed, Vector3::new(place.x, place.y, top), -Vector3::z())?;
        Some(Footing { height: top - fall, normal })
    }

    /// How far `shapes` are above the ground, m: how far they can fall together until one touches it; negative where they would
    /// have to rise to clear it, infinite where no ground is under any of them.
    pub fn clearance(&self, shapes: &[usize]) -> f64 {
        let each = shapes.iter().map(|&shape| self.clearance_of(shape));
        each.fold(f64::INFINITY, Real::at_most)
    }

    fn clearance_of(&self, shape: usize) -> f64 {
        if self.shapes.is_empty() {
            return self.above_plane(shape, Vector3::zeros(), Vector3::z());
        }
        let placed = Placed::of(self.model, self.kinematics, 0, shape);
        let Some(solid) = SupportShape::new(&placed, Vector3::zeros()) else { return f64::INFINITY };
        let mut least = f64::INFINITY;
        for &ground in self.shapes {
            let (centre, rotation) = (self.kinematics.geom_position[ground], self.kinematics.geom_rotation[ground]);
            if self.model.geoms.kind[ground] == GeomKind::Plane {
                least = least.at_most(self.above_plane(shape, centre, rotation.column(2).into_owned()));
            } else if self.may_be_above(shape, ground, least) {
                least = least.at_most(self.above(&solid, ground, least));
            }
        }
        least
    }

    /// Height over a plane with unit normal n through p: ((c - p) · n - h(-n)) / n_z for a shape centred at c with the support
    /// function h. Planes that do not look up are no ground.
    fn above_plane(&self, shape: usize, origin: Vector3<f64>, normal: Vector3<f64>) -> f64 {
        let kinematics = self.kinematics;
        if normal.z <= 0.0 {
            return f64::INFINITY;
        }
        let down = kinematics.geom_rotation[shape].transpose() * -normal;
        let placed = Placed::of(self.model, kinematics, 0, shape);
        let reach = match placed.asset {
            Asset::Mesh(mesh) => mesh.hull.vertices[mesh.hull.support_point(down)].dot(&down),
            _ => support(placed.kind, placed.size, down),
        };
        ((kinematics.geom_position[shape] - origin).dot(&normal) - reach) / normal.z
    }

    /// Radius of a sphere about the centre of a shape that holds it, m.
    fn radius(&self, shape: usize) -> f64 {
        self.kinematics.overrides.bounding_radius(self.model, 0, shape)
    }

    /// Whether the bounding spheres allow a gap smaller than `least`.
    fn may_be_above(&self, shape: usize, ground: usize, least: f64) -> bool {
        let radii = self.radius(shape) + self.radius(ground);
        let between = self.kinematics.geom_position[shape] - self.kinematics.geom_position[ground];
        between.xy().norm_squared() <= radii * radii && between.z - radii < least
    }

    /// Height of a shape over one that is not a plane; what is not below `least` may be left out.
    fn above(&self, shape: &SupportShape<'_>, ground: usize, least: f64) -> f64 {
        let placed = Placed::of(self.model, self.kinematics, 0, ground);
        if let Asset::HeightField(field) = placed.asset {
            return over_field(shape, &placed, field, least);
        }
        let lowest = support_point(shape, &-Vector3::z());
        match self.top(ground, lowest.xy()) {
            // Over a level place of a convex shape: nothing else of it is higher, and nothing of the other is lower.
            Some(footing) if footing.normal.z >= 1.0 - 1e-15 => lowest.z - footing.height,
            _ => SupportShape::new(&placed, Vector3::zeros()).and_then(|ground| gap(shape, &ground)).unwrap_or(f64::INFINITY),
        }
    }
}

/// Height of a shape over a height field: over the nearest of its triangles.
fn over_field(shape: &SupportShape<'_>, placed: &Placed<'_>, field: &HeightField, least: f64) -> f64 {
    let directions = [Vector3::x(), Vector3::y()].map(|axis| placed.rotation * axis);
    let cells = |axis: usize, count: usize| {
        // The field's own axes are level, or nearly so: the shape's extent along them bounds the cells under it.
        let reach = |direction: Vector3<f64>| support_point(shape, &direction) - placed.position;
        let [low, high] = [-directions[axis], directions[axis]].map(|direction| reach(direction).dot(&directions[axis]));
        let index = |along: f64| (along / field.radius[axis] + 1.0) * 0.5 * (count - 1) as f64;
        // One cell more on both sides covers the rounding.
        let first = (index(low) - 1.0).at_least(0.0) as usize;
        first..((index(high) + 2.0).at_least(0.0) as usize).min(count - 1)
    };
    let lowest = support_point(shape, &-Vector3::z()).z;
    let mut least = least;
    let mut over = |corners: [Vector3<f64>; 3]| {
        let top = corners[0].z.at_least(corners[1].z).at_least(corners[2].z);
        if lowest - top >= least {
            return;
        }
        let [a, b, c] = corners.map(|corner| corner - corners[0]);
        let prism = [a, b, c, a, b, c];
        let core = Core::Prism(&prism);
        let triangle = SupportShape { core, position: corners[0], rotation: Matrix3::identity(), radius: 0.0 };
        least = least.at_most(gap(shape, &triangle).unwrap_or(f64::INFINITY));
    };
    let columns = cells(0, field.columns);
    for row in cells(1, field.rows) {
        for column in columns.clone() {
            let place = |row, column| placed.position + placed.rotation * field.point(row, column);
            let [a, b, c, d] = [place(row, column), place(row, column + 1), place(row + 1, column), place(row + 1, column + 1)];
            over([a, d, c]);
            over([a, b, d]);
        }
    }
    least
}

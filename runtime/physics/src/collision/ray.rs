//! Where a ray first meets a surface.
//!
//! Every shape is hit from outside and from inside (a ray that starts inside a ball ends at its far side), planes and the
//! triangles of meshes on the terms of MuJoCo: a plane only from above and, where it has a size, only on its rectangle; a
//! mesh on its triangles, not on its hull; a height field on its surface, its four sides and its floor.

use super::place::{Asset, Placed};
use crate::{
    kinematics::Kinematics,
    model::{GeomKind, HeightField, Mesh, Model},
    scalar::Real,
    spatial::lane_of,
};
use nalgebra::Vector3;

/// The first surface on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The geom.
    pub geom: usize,
    /// How far from the ray's origin, in lengths of its direction.
    pub distance: f64,
    /// Unit normal of the surface, outwards, world frame.
    pub normal: Vector3<f64>,
}

/// The first geom that `admits` allows on the ray from `origin` along `direction` (world frame), not farther than `range`
/// lengths of the direction; `None` where there is none. Geoms are given to `admits` by their index, so that a caller leaves
/// out the bodies it looks from. The kinematics are those of the episode in `lane`.
pub fn cast<T: Real>(
    model: &Model,
    kinematics: &Kinematics<T>,
    lane: usize,
    [origin, direction]: [Vector3<f64>; 2],
    range: f64,
    admits: impl Fn(usize) -> bool,
) -> Option<Hit> {
    let square = direction.norm_squared();
    let mut best: Option<Hit> = None;
    for geom in (0..model.geoms.kind.len()).filter(|&geom| admits(geom)) {
        let limit = best.map_or(range, |hit| hit.distance);
        let radius = kinematics.overrides.bounding_radius(model, lane, geom);
        if radius > 0.0 {
            // Rays that pass the bounding sphere by need not know the shape.
            let centre = lane_of(&kinematics.geom_position[geom], lane) - origin;
            let along = (centre.dot(&direction) / square).clip(0.0, limit);
            if (centre - direction * along).norm_squared() > radius * radius * (1.0 + 1e-9) {
                continue;
            }
        }
        let placed = Placed::of(model, kinematics, lane, geom);
        if let Some((distance, normal)) = meet(&placed, origin, direction).filter(|(distance, _)| *distance <= limit)
            && best.is_none_or(|hit| distance < hit.distance)
        {
            best = Some(Hit { geom, distance, normal });
        }
    }
    best
}

/// Where the ray from `origin` along `direction` first meets one shape: in lengths of the direction, and the outward unit
/// normal there.
pub fn meet(placed: &Placed<'_>, origin: Vector3<f64>, direction: Vector3<f64>) -> Option<(f64, Vector3<f64>)> {
    let ray = Ray { origin: placed.local(origin), direction: placed.rotation.tr_mul(&direction) };
    let size = placed.size;
    let (distance, normal) = match (placed.kind, placed.asset) {
        (GeomKind::Plane, _) => ray.plane(size),
        (GeomKind::Sphere, _) => ray.ellipsoid(Vector3::repeat(size.x)),
        (GeomKind::Ellipsoid, _) => ray.ellipsoid(size),
        (GeomKind::Capsule, _) => ray.capsule(size.x, size.y),
        (GeomKind::Cylinder, _) => ray.cylinder(size.x, size.y),
        (GeomKind::Box, _) => ray.cuboid(Vector3::zeros(), size),
        (GeomKind::Mesh, Asset::Mesh(mesh)) => ray.mesh(mesh),
        (GeomKind::HeightField, Asset::HeightField(field)) => ray.height_field(field),
        (GeomKind::Mesh | GeomKind::HeightField, _) => None,
    }?;
    Some((distance, placed.rotation * normal))
}

/// A ray in a shape's own axes.
#[derive(Debug, Clone, Copy)]
struct Ray {
    origin: Vector3<f64>,
    direction: Vector3<f64>,
}

/// How far along the ray, and the outward unit normal.
type Meeting = Option<(f64, Vector3<f64>)>;

/// The earlier of two meetings.
fn first(a: Meeting, b: Meeting) -> Meeting {
    match (a, b) {
        (Some(x), Some(y)) => Some(if y.0 < x.0 { y } else { x }),
        (found, None) | (None, found) => found,
    }
}

/// The roots of a x² + 2 b x + c, smaller first, none where they are not real.
fn roots(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let discriminant = b * b - a * c;
    if a <= 0.0 || discriminant < 0.0 {
        return None;
    }
    // The root where nothing cancels first, the other from their product c / a.
    let q = -(b + discriminant.sqrt().copysign(b));
    let (x, y) = (q / a, if q == 0.0 { 0.0 } else { c / q });
    Some(if x < y { [x, y] } else { [y, x] })
}

impl Ray {
    fn at(&self, distance: f64) -> Vector3<f64> {
        self.origin + self.direction * distance
    }

    /// The upper side of z = 0; a positive size bounds it.
    fn plane(&self, size: Vector3<f64>) -> Meeting {
        if self.direction.z >= 0.0 || self.origin.z < 0.0 {
            return None;
        }
        let distance = -self.origin.z / self.direction.z;
        let place = self.at(distance);
        let within = |x: f64, bound: f64| bound <= 0.0 || x.abs() <= bound;
        (within(place.x, size.x) && within(place.y, size.y)).then_some((distance, Vector3::z()))
    }

    /// An ellipsoid about `centre` is the unit sphere in coordinates divided by its half axes.
    fn ellipsoid(&self, axes: Vector3<f64>) -> Meeting {
        let (p, d) = (self.origin.component_div(&axes), self.direction.component_div(&axes));
        let both = roots(d.norm_squared(), p.dot(&d), p.norm_squared() - 1.0)?;
        let distance = both.into_iter().find(|distance| *distance >= 0.0)?;
        Some((distance, (p + d * distance).component_div(&axes).normalize()))
    }

    /// The round side of a cylinder about z between -half and half.
    fn side(&self, radius: f64, half: f64) -> Meeting {
        let (p, d) = (self.origin.xy(), self.direction.xy());
        let both = roots(d.norm_squared(), p.dot(&d), p.norm_squared() - radius * radius)?;
        let distance = both.into_iter().find(|&distance| distance >= 0.0 && self.at(distance).z.abs() <= half)?;
        let place = self.at(distance).xy() / radius;
        Some((distance, Vector3::new(place.x, place.y, 0.0)))
    }

    fn cylinder(&self, radius: f64, half: f64) -> Meeting {
        let mut found = self.side(radius, half);
        for sense in [-1.0, 1.0] {
            let distance = (sense * half - self.origin.z) / self.direction.z;
            if distance >= 0.0 && self.at(distance).xy().norm_squared() <= radius * radius {
                found = first(found, Some((distance, Vector3::z() * sense)));
            }
        }
        found
    }

    fn capsule(&self, radius: f64, half: f64) -> Meeting {
        let mut found = self.side(radius, half);
        for sense in [-1.0, 1.0] {
            let centre = Vector3::z() * (sense * half);
            let p = self.origin - centre;
            let both = roots(self.direction.norm_squared(), p.dot(&self.direction), p.norm_squared() - radius * radius);
            // Of the ball at an end only the outer half is surface.
            let outer = |distance: &f64| *distance >= 0.0 && self.at(*distance).z * sense >= half;
            if let Some(distance) = both.into_iter().flatten().find(outer) {
                found = first(found, Some((distance, (self.at(distance) - centre) / radius)));
            }
        }
        found
    }

    /// A box about `centre`: the ray is inside from the last slab it enters to the first it leaves.
    fn cuboid(&self, centre: Vector3<f64>, half: Vector3<f64>) -> Meeting {
        let (mut enter, mut leave) = ((f64::NEG_INFINITY, Vector3::zeros()), (f64::INFINITY, Vector3::zeros()));
        for axis in 0..3 {
            let (p, d) = (self.origin[axis] - centre[axis], self.direction[axis]);
            if d == 0.0 {
                if p.abs() > half[axis] {
                    return None;
                }
                continue;
            }
            let normal = Vector3::ith(axis, d.signum());
            let (near, far) = ((-half[axis] * d.signum() - p) / d, (half[axis] * d.signum() - p) / d);
            if near > enter.0 {
                enter = (near, -normal);
            }
            if far < leave.0 {
                leave = (far, normal);
            }
        }
        if enter.0 > leave.0 || leave.0 < 0.0 || leave.0 == f64::INFINITY {
            return None;
        }
        Some(if enter.0 >= 0.0 { enter } else { leave })
    }

    /// A triangle, from either side; the normal is that of its corners' sense (Möller and Trumbore 1997).
    fn triangle(&self, [a, b, c]: [Vector3<f64>; 3]) -> Meeting {
        let (u, v) = (b - a, c - a);
        let normal = u.cross(&v);
        let slope = -self.direction.dot(&normal);
        if slope == 0.0 {
            return None;
        }
        let from = self.origin - a;
        let turned = from.cross(&self.direction);
        let (x, y) = (v.dot(&turned) / slope, -u.dot(&turned) / slope);
        let distance = from.dot(&normal) / slope;
        (distance >= 0.0 && x >= 0.0 && y >= 0.0 && x + y <= 1.0).then(|| (distance, normal.normalize()))
    }

    fn mesh(&self, mesh: &Mesh) -> Meeting {
        let corners = |triangle: &[usize; 3]| triangle.map(|corner| mesh.vertices[corner]);
        mesh.triangles.iter().fold(None, |found, triangle| first(found, self.triangle(corners(triangle))))
    }

    fn height_field(&self, field: &HeightField) -> Meeting {
        let [x, y] = field.radius;
        let half = Vector3::new(x, y, 0.5 * (field.elevation + field.base));
        let centre = Vector3::new(0.0, 0.0, 0.5 * (field.elevation - field.base));
        // The part of the ray above the rectangle, which names the cells it can meet.
        let span = self.span(centre, half)?;
        let ends = span.map(|distance| self.at(distance));
        let cells = |axis: usize, count: usize, radius: f64| {
            let index = |end: Vector3<f64>| (end[axis] / radius + 1.0) * 0.5 * (count - 1) as f64;
            let (low, high) = (index(ends[0]).at_most(index(ends[1])), index(ends[0]).at_least(index(ends[1])));
            // One cell more on both sides covers the rounding.
            let low = (low - 1.0).at_least(0.0) as usize;
            low..((high + 2.0).at_least(0.0) as usize).min(count - 1)
        };
        let columns = cells(0, field.columns, x);
        let mut found = None;
        for row in cells(1, field.rows, y) {
            for column in columns.clone() {
                let [a, b] = [field.point(row, column), field.point(row, column + 1)];
                let [c, d] = [field.point(row + 1, column), field.point(row + 1, column + 1)];
                found = first(found, first(self.triangle([a, d, c]), self.triangle([a, b, d])));
            }
        }
        first(found, first(self.skirt(field), self.floor(field)))
    }

    /// The vertical sides below the edge of a height field.
    fn skirt(&self, field: &HeightField) -> Meeting {
        let mut found = None;
        for axis in [0, 1] {
            let counts = [field.columns, field.rows];
            let (radius, other) = (field.radius[axis], field.radius[1 - axis]);
            for (sense, edge) in [(-1.0, 0), (1.0, counts[axis] - 1)] {
                let distance = (sense * radius - self.origin[axis]) / self.direction[axis];
                let place = self.at(distance);
                let steps = counts[1 - axis] - 1;
                let along = (place[1 - axis] / other + 1.0) * 0.5 * steps as f64;
                if !(distance >= 0.0 && along >= 0.0 && along <= steps as f64 && place.z >= -field.base) {
                    continue;
                }
                let cell = (along as usize).min(steps - 1);
                let height = |index: usize| if axis == 0 { field.point(index, edge).z } else { field.point(edge, index).z };
                let share = along - cell as f64;
                if place.z <= height(cell) * (1.0 - share) + height(cell + 1) * share {
                    found = first(found, Some((distance, Vector3::ith(axis, sense))));
                }
            }
        }
        found
    }

    /// The underside of a height field.
    fn floor(&self, field: &HeightField) -> Meeting {
        let distance = (-field.base - self.origin.z) / self.direction.z;
        let place = self.at(distance);
        let within = place.x.abs() <= field.radius[0] && place.y.abs() <= field.radius[1];
        (distance >= 0.0 && within).then(|| (distance, -Vector3::z()))
    }

    /// Where the ray is inside a box.
    fn span(&self, centre: Vector3<f64>, half: Vector3<f64>) -> Option<[f64; 2]> {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (p, d) = (self.origin[axis] - centre[axis], self.direction[axis]);
            if d == 0.0 {
                if p.abs() > half[axis] {
                    return None;
                }
                continue;
            }
            enter = enter.at_least((-half[axis] * d.signum() - p) / d);
            leave = leave.at_most((half[axis] * d.signum() - p) / d);
        }
        (enter <= leave && leave.is_finite()).then_some([enter, leave])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// MuJoCo shoots from outside and inside; here every hit is checked to lie on the surface, by the shape's own equation.
    #[test]
    fn every_hit_lies_on_the_surface_and_nothing_is_hit_before() {
        let size = Vector3::new(0.3, 0.5, 0.2);
        let inside = |kind: GeomKind, p: Vector3<f64>| match kind {
            GeomKind::Sphere => p.norm() / size.x,
            GeomKind::Ellipsoid => p.component_div(&size).norm(),
            GeomKind::Capsule => (p - Vector3::z() * p.z.clip(-size.y, size.y)).norm() / size.x,
            GeomKind::Cylinder => (p.xy().norm() / size.x).at_least(p.z.abs() / size.y),
            _ => p.component_div(&size).amax(),
        };
        for kind in [GeomKind::Sphere, GeomKind::Ellipsoid, GeomKind::Capsule, GeomKind::Cylinder, GeomKind::Box] {
            let position = Vector3::new(0.1, -0.2, 0.3);
            let rotation = nalgebra::Rotation3::from_euler_angles(0.3, -0.5, 0.9).into_inner();
            let placed = Placed { kind, position, rotation, size, asset: Asset::None };
            let mut hits = 0;
            for k in 0..400 {
                let number = |i: usize| libm::sin(1.3 * k as f64 + 2.1 * i as f64 * (k as f64 + 1.0));
                let origin = Vector3::from_fn(|i, _| number(i));
                let direction = position - origin + Vector3::from_fn(|i, _| number(i + 3)) * 0.5;
                let level = |distance: f64| inside(kind, placed.local(origin + direction * distance)) - 1.0;
                let found = meet(&placed, origin, direction);
                let limit = found.map_or(5.0, |(distance, _)| distance);
                hits += usize::from(found.is_some());
                if let Some((distance, normal)) = found {
                    assert!(level(distance).abs() < 1e-10, "{kind:?} {k}: {}", level(distance));
                    assert!((level(distance + 1e-6) > level(distance - 1e-6)) == (normal.dot(&direction) > 0.0), "{kind:?} {k}");
                }
                let side = level(0.0).signum();
                for step in 1..100 {
                    assert!(level(limit * f64::from(step) / 100.0) * side > -1e-9, "{kind:?} {k}: passed a surface");
                }
            }
            assert!(hits > 60, "{kind:?}: {hits} hits");
        }
    }
}

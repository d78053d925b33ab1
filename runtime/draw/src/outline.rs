//! Outlines of convex shapes in an orthographic picture: exact for spheres, capsules and ellipsoids.

use super::camera::Camera;
use super::path::Path;
use msk_physics::model::{GeomKind, HeightField, Mesh};
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// A shape in the world: kind, size (m), centre (m) and orientation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape<'a> {
    pub kind: GeomKind,
    pub size: Vector3<f64>,
    pub centre: Vector3<f64>,
    pub rotation: Matrix3<f64>,
    /// What a mesh looks like.
    pub mesh: Option<&'a Mesh>,
}

impl Shape<'_> {
    /// Appends the outline as closed figures that all turn the same way, so that overlapping outlines fill as their union.
    /// Planes have none.
    pub fn outline(&self, camera: &Camera, path: &mut Path) {
        let centre = camera.project(self.centre);
        let axis = |index: usize| camera.direction(self.rotation.column(index).into_owned());
        let radius = self.size.x * 1000.0;
        match self.kind {
            GeomKind::Plane | GeomKind::HeightField => {}
            GeomKind::Mesh => {
                let corners = self.mesh.into_iter().flat_map(|mesh| &mesh.hull.vertices);
                path.polygon(&hull(corners.map(|corner| camera.project(self.centre + self.rotation * corner)).collect()));
            }
            GeomKind::Sphere => path.ellipse(centre, [radius, radius], 0.0),
            GeomKind::Capsule => path.stadium(centre - axis(2) * self.size.y, centre + axis(2) * self.size.y, radius),
            GeomKind::Ellipsoid => {
                // The shadow of an ellipsoid with half axes a_i is the ellipse with matrix Σ a_i a_i' of the projected a_i.
                let columns: Vec<Vector2<f64>> = (0..3).map(|index| axis(index) * self.size[index]).collect();
                let matrix: Matrix2<f64> = columns.iter().map(|column| column * column.transpose()).sum();
                let (half_axes, turn) = principal(matrix);
                path.ellipse(centre, half_axes, turn);
            }
            GeomKind::Box => {
                let corner = |index: usize| {
                    let side = |bit: usize| if index >> bit & 1 == 1 { self.size[bit] } else { -self.size[bit] };
                    centre + axis(0) * side(0) + axis(1) * side(1) + axis(2) * side(2)
                };
                path.polygon(&hull((0..8).map(corner).collect()));
            }
            GeomKind::Cylinder => {
                const SIDES: u32 = 48;
                let rim = |index: u32| {
                    let (sin, cos) = libm::sincos(f64::from(index) * core::f64::consts::TAU / f64::from(SIDES));
                    (axis(0) * cos + axis(1) * sin) * self.size.x
                };
                let ends = [axis(2) * self.size.y, axis(2) * -self.size.y];
                path.polygon(&hull((0..SIDES).flat_map(|index| ends.map(|end| centre + end + rim(index))).collect()));
            }
        }
    }
}

impl Shape<'_> {
    /// Appends the surface of a height field: each of its cells, which together fill as one.
    pub fn relief(&self, field: &HeightField, camera: &Camera, path: &mut Path) {
        let place = |row: usize, column: usize| camera.project(self.centre + self.rotation * field.point(row, column));
        for row in 0..field.rows - 1 {
            for column in 0..field.columns - 1 {
                let corners = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)];
                path.polygon(&hull(corners.map(|(row, column)| place(row, column)).to_vec()));
            }
        }
    }
}

/// Half axes (square roots of the eigenvalues) of a symmetric matrix, and the angle of the first (rad).
fn principal(m: Matrix2<f64>) -> ([f64; 2], f64) {
    let mean = 0.5 * (m.m11 + m.m22);
    let (difference, off) = (0.5 * (m.m11 - m.m22), m.m12);
    let spread = difference.hypot(off);
    ([(mean + spread).sqrt(), (mean - spread).max(0.0).sqrt()], 0.5 * libm::atan2(off, difference))
}

/// The convex hull, clockwise in a picture whose y axis points down (Andrew's monotone chain).
fn hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp(&(point - b)) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter().copied());
    all.extend(half(&mut points.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::View;
    use msk_runtime::body::shape::support;
    use nalgebra::Rotation3;

    #[test]
    fn the_shadow_of_an_ellipsoid_reaches_as_far_as_the_ellipsoid() {
        let turned = Rotation3::from_euler_angles(0.4, -1.1, 0.7).into_inner();
        let size = Vector3::new(0.1, 0.3, 0.2);
        let camera = Camera::new(View::Side);
        let columns = (0..3).map(|i| camera.direction(turned.column(i).into_owned()) * size[i]);
        let ([a, b], angle) = principal(columns.map(|c| c * c.transpose()).sum());
        for direction in [Vector3::x(), Vector3::z(), Vector3::new(0.6, 0.0, 0.8)] {
            let flat = camera.direction(direction) / 1000.0;
            let (sin, cos) = angle.sin_cos();
            let reach = (a * (flat.x * cos + flat.y * sin)).hypot(b * (flat.y * cos - flat.x * sin));
            let expected = 1000.0 * support(GeomKind::Ellipsoid, size, turned.transpose() * direction);
            assert!((reach - expected).abs() < 1e-9, "{reach} {expected}");
        }
    }

    #[test]
    fn the_hull_keeps_corners_only() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5], [0.5, 0.0]];
        assert_eq!(hull(square.map(Vector2::from).to_vec()), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vector2::from));
    }
}

//! How far a shape reaches in a direction: the support function of convex shapes.

use msk_physics::model::GeomKind;
use nalgebra::Vector3;

/// How far a shape of `kind` and `size` (m) reaches from its centre along `direction` (any length, in the shape's frame):
/// the maximum of direction · x over its points x.
pub fn support(kind: GeomKind, size: Vector3<f64>, direction: Vector3<f64>) -> f64 {
    let d = direction;
    match kind {
        GeomKind::Sphere => size.x * d.norm(),
        GeomKind::Capsule => size.x * d.norm() + size.y * d.z.abs(),
        GeomKind::Ellipsoid => size.component_mul(&d).norm(),
        GeomKind::Cylinder => size.x * d.xy().norm() + size.y * d.z.abs(),
        // A mesh reaches as far as its bounding box at most.
        GeomKind::Box | GeomKind::Mesh | GeomKind::HeightField => size.dot(&d.abs()),
        // A half space below z = 0: bounded only straight upwards.
        GeomKind::Plane if d.x == 0.0 && d.y == 0.0 && d.z >= 0.0 => 0.0,
        GeomKind::Plane => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_reaches_as_far_as_its_farthest_point() {
        let size = Vector3::new(0.1, 0.3, 0.2);
        let oblique = Vector3::new(0.6, 0.0, -0.8);
        assert_eq!(support(GeomKind::Sphere, size, oblique), 0.1);
        assert!((support(GeomKind::Capsule, size, oblique) - (0.1 + 0.3 * 0.8)).abs() < 1e-15);
        assert!((support(GeomKind::Cylinder, size, oblique) - (0.1 * 0.6 + 0.3 * 0.8)).abs() < 1e-15);
        assert!((support(GeomKind::Box, size, oblique) - (0.1 * 0.6 + 0.2 * 0.8)).abs() < 1e-15);
        let farthest = (0..100_000).map(|i| {
            let angle = f64::from(i) * core::f64::consts::TAU / 100_000.0;
            oblique.dot(&Vector3::new(0.1 * angle.cos(), 0.0, 0.2 * angle.sin()))
        });
        let farthest = farthest.fold(f64::MIN, f64::max);
        assert!((support(GeomKind::Ellipsoid, size, oblique) - farthest).abs() < 1e-9);
    }

    #[test]
    fn a_plane_ends_only_straight_above() {
        assert_eq!(support(GeomKind::Plane, Vector3::zeros(), Vector3::z()), 0.0);
        assert_eq!(support(GeomKind::Plane, Vector3::zeros(), Vector3::x()), f64::INFINITY);
    }
}

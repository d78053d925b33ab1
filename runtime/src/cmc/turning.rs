//! Turns about the vertical.

use msk_physics::rotation::multiply;
use nalgebra::{Vector2, Vector3};

/// The shorter turn to the left from one heading to another, rad.
pub(super) fn between(from: f64, to: f64) -> f64 {
    let turn = to - from;
    turn - core::f64::consts::TAU * (turn / core::f64::consts::TAU).round()
}

/// A level vector, turned to the left by an angle, rad: from the axes of a heading to those of the world.
pub(super) fn level(vector: Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(angle);
    Vector2::new(cos * vector.x - sin * vector.y, sin * vector.x + cos * vector.y)
}

/// The same of a vector of any direction.
pub(super) fn vector(vector: &Vector3<f64>, angle: f64) -> Vector3<f64> {
    let level = level(vector.xy(), angle);
    Vector3::new(level.x, level.y, vector.z)
}

/// An orientation, turned to the left by an angle, rad; to the last bit the same where that is zero.
pub(super) fn orientation(quaternion: &[f64; 4], angle: f64) -> [f64; 4] {
    if angle == 0.0 {
        return *quaternion;
    }
    let (sin, cos) = libm::sincos(0.5 * angle);
    multiply(&[cos, 0.0, 0.0, sin], quaternion)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};
    use msk_physics::rotation::matrix;

    #[test]
    fn vectors_and_orientations_turn_alike() {
        let quaternion = [0.5, 0.5, -0.5, 0.5];
        let arm = Vector3::new(0.3, -0.2, 0.7);
        let found = matrix(&orientation(&quaternion, 0.8)) * arm;
        assert!((found - vector(&(matrix(&quaternion) * arm), 0.8)).norm() < 1e-12);
        assert!((level(Vector2::x(), FRAC_PI_2) - Vector2::y()).norm() < 1e-12);
    }

    #[test]
    fn the_shorter_way_round_is_taken() {
        assert!((between(0.9 * PI, -0.9 * PI) - 0.2 * PI).abs() < 1e-12);
        assert!((between(5.0, 5.0 - 4.0 * PI)).abs() < 1e-12);
    }
}

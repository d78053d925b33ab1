//! Mass properties of solids, and how they add up to a body's principal moments.

use super::rotation::{self, IDENTITY};
use super::{GeomKind, Quaternion};
use crate::scalar::Real;
use core::f64::consts::PI;
use nalgebra::{Matrix3, Vector3};

/// A mass, its centre and its principal moments about that centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassProperties {
    /// kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centre: Vector3<f64>,
    /// Principal axes.
    pub axes: Quaternion,
    /// Principal moments, kg m².
    pub moments: Vector3<f64>,
}

/// Volume of a primitive solid, m³; zero for planes.
pub fn volume(kind: GeomKind, size: Vector3<f64>) -> f64 {
    let [a, b, c] = [size.x, size.y, size.z];
    match kind {
        // Meshes bring their own figures; a height field carries no mass.
        GeomKind::Plane | GeomKind::HeightField | GeomKind::Mesh => 0.0,
        GeomKind::Sphere => 4.0 / 3.0 * PI * a * a * a,
        GeomKind::Capsule => PI * a * a * (2.0 * b + 4.0 / 3.0 * a),
        GeomKind::Cylinder => PI * a * a * 2.0 * b,
        GeomKind::Ellipsoid => 4.0 / 3.0 * PI * a * b * c,
        GeomKind::Box => 8.0 * a * b * c,
    }
}

/// Principal moments of a primitive solid of uniform density about its centre, in its own frame, kg m².
pub fn moments(kind: GeomKind, size: Vector3<f64>, mass: f64) -> Vector3<f64> {
    let [a, b, c] = [size.x, size.y, size.z];
    let round = |across: f64, along: f64| Vector3::new(across, across, along);
    match kind {
        GeomKind::Plane | GeomKind::HeightField | GeomKind::Mesh => Vector3::zeros(),
        GeomKind::Sphere => Vector3::repeat(0.4 * mass * a * a),
        GeomKind::Capsule => {
            // Two hemispheres, their centres of mass 3/8 a beyond the ends of a cylinder.
            let height = 2.0 * b;
            let caps = mass * 4.0 * a / (4.0 * a + 3.0 * height);
            let shaft = mass - caps;
            let across = shaft * (3.0 * a * a + height * height) / 12.0
                + caps * (0.4 * a * a + 0.375 * a * height + 0.25 * height * height);
            round(across, 0.5 * shaft * a * a + 0.4 * caps * a * a)
        }
        GeomKind::Cylinder => round(mass * (3.0 * a * a + 4.0 * b * b) / 12.0, 0.5 * mass * a * a),
        GeomKind::Ellipsoid => Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) * (mass / 5.0),
        GeomKind::Box => Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) * (mass / 3.0),
    }
}

/// The mass properties of several solids rigidly joined, all given in one frame; `None` where they have no mass.
pub fn combine(parts: &[MassProperties]) -> Option<MassProperties> {
    if let [single] = parts {
        return (single.mass > 0.0).then_some(*single);
    }
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    if mass.is_nan() || mass <= 0.0 {
        return None;
    }
    let centre = parts.iter().map(|part| part.centre * part.mass).sum::<Vector3<f64>>() / mass;
    let mut total = Matrix3::zeros();
    for part in parts {
        let axes = rotation::matrix(part.axes);
        let offset = part.centre - centre;
        // Steiner: J + m (|d|² 1 - d dᵀ).
        total += axes * Matrix3::from_diagonal(&part.moments) * axes.transpose()
            + (Matrix3::identity() * offset.norm_squared() - offset * offset.transpose()) * part.mass;
    }
    let (moments, axes) = principal(&total);
    Some(MassProperties { mass, centre, axes, moments })
}

/// Principal moments of a symmetric matrix in descending order, and the axes they belong to.
///
/// Classical Jacobi rotations, the largest off-diagonal element first (Golub & Van Loan 8.5); a matrix that is already
/// diagonal and in order keeps its axes exactly. Of the possible axes these are the ones that MuJoCo takes, which matters
/// where a free body is aligned with them.
pub fn principal(matrix: &Matrix3<f64>) -> (Vector3<f64>, Quaternion) {
    let mut diagonalised = *matrix;
    let mut axes = Matrix3::identity();
    let scale = matrix.iter().fold(0.0_f64, |most, x| most.at_least(x.abs()));
    // Three rotations or so square the off-diagonal part: twenty suffice, the bound only guards against surprises.
    for _ in 0..96 {
        let off = |i: usize, j: usize| diagonalised[(i, j)].abs();
        let (i, j) = if off(0, 1) > off(0, 2) && off(0, 1) > off(1, 2) {
            (0, 1)
        } else if off(0, 2) > off(1, 2) {
            (0, 2)
        } else {
            (1, 2)
        };
        if off(i, j) <= f64::EPSILON * 1e-2 * scale {
            break;
        }
        let theta = (diagonalised[(j, j)] - diagonalised[(i, i)]) / (2.0 * diagonalised[(i, j)]);
        let tangent = if theta >= 0.0 { 1.0 } else { -1.0 } / (theta.abs() + (1.0 + theta * theta).sqrt());
        let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
        let sine = tangent * cosine;
        let mut turn = Matrix3::identity();
        (turn[(i, i)], turn[(j, j)], turn[(i, j)], turn[(j, i)]) = (cosine, cosine, sine, -sine);
        diagonalised = turn.transpose() * diagonalised * turn;
        (diagonalised[(i, j)], diagonalised[(j, i)]) = (0.0, 0.0);
        axes *= turn;
    }
    in_descending_order(diagonalised.diagonal(), axes)
}

/// Sorts moments and axes together; a swapped pair of axes is turned by a quarter so that the frame stays right-handed.
fn in_descending_order(mut moments: Vector3<f64>, mut axes: Matrix3<f64>) -> (Vector3<f64>, Quaternion) {
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if moments[i] < moments[j] {
            moments.swap_rows(i, j);
            axes.swap_columns(i, j);
            let mut flipped = axes.column_mut(j);
            flipped.neg_mut();
        }
    }
    let identity = axes == Matrix3::identity();
    (moments, if identity { IDENTITY } else { rotation::from_matrix(&axes) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_axes_rebuild_the_matrix() {
        let matrix = Matrix3::new(3.0, 0.2, -0.4, 0.2, 1.0, 0.1, -0.4, 0.1, 2.0);
        let (moments, axes) = principal(&matrix);
        assert!(moments.x >= moments.y && moments.y >= moments.z);
        let rotation = rotation::matrix(axes);
        assert!((rotation * Matrix3::from_diagonal(&moments) * rotation.transpose() - matrix).norm() < 1e-14);
    }

    #[test]
    fn a_capsule_without_a_shaft_is_a_ball() {
        let size = Vector3::new(0.3, 0.0, 0.0);
        assert!((volume(GeomKind::Capsule, size) - volume(GeomKind::Sphere, size)).abs() < 1e-16);
        let difference = moments(GeomKind::Capsule, size, 2.0) - moments(GeomKind::Sphere, size, 2.0);
        assert!(difference.norm() < 1e-16);
    }

    #[test]
    fn two_half_boxes_weigh_what_the_whole_weighs() {
        let half = |x: f64| MassProperties {
            mass: 1.0,
            centre: Vector3::new(x, 0.0, 0.0),
            axes: IDENTITY,
            moments: moments(GeomKind::Box, Vector3::new(0.5, 0.2, 0.1), 1.0),
        };
        let whole = combine(&[half(-0.5), half(0.5)]).unwrap();
        let expected = moments(GeomKind::Box, Vector3::new(1.0, 0.2, 0.1), 2.0);
        assert!((whole.moments - Vector3::new(expected.z, expected.y, expected.x)).norm() < 1e-15);
        assert!(combine(&[]).is_none());
    }
}

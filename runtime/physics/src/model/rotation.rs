//! Rotations as unit quaternions w x y z, in `f64`: what the reader of models needs, not the physics' inner loops.

use super::Quaternion;
use nalgebra::{Matrix3, Vector3};

/// No rotation.
pub const IDENTITY: Quaternion = [1.0, 0.0, 0.0, 0.0];

/// A norm this close to one is one: normalising is then the identity, so that reading back a written model changes no bit.
const UNIT_TOLERANCE: f64 = 1e-15;

/// Shorter vectors have no direction (MuJoCo's `mjMINVAL`).
const SHORTEST: f64 = 1e-15;

/// The unit quaternion along `q`, or `None` where `q` is (nearly) zero or its square overflows.
pub fn normalized(q: Quaternion) -> Option<Quaternion> {
    let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(norm >= SHORTEST && norm.is_finite()) {
        return None;
    }
    // Plain norm, plain division: the bits that MuJoCo's compiler gives. Its iterative collision routines (capsule against
    // ellipsoid) magnify a difference in the last bit of an orientation to 1e-6 of the acceleration.
    if (norm - 1.0).abs() <= UNIT_TOLERANCE { Some(q) } else { Some(q.map(|x| x / norm)) }
}

/// The unit vector along `v`, or `None` where `v` is (nearly) zero.
pub fn unit_vector(v: Vector3<f64>) -> Option<Vector3<f64>> {
    let [x, y, z, _] = normalized([v.x, v.y, v.z, 0.0])?;
    Some(Vector3::new(x, y, z))
}

/// The product `a b`: rotate by `b`, then by `a`.
pub fn product(a: Quaternion, b: Quaternion) -> Quaternion {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// `v` rotated by `q`.
pub fn rotate(q: Quaternion, v: Vector3<f64>) -> Vector3<f64> {
    matrix(q) * v
}

/// The rotation matrix of `q`.
pub fn matrix([w, x, y, z]: Quaternion) -> Matrix3<f64> {
    Matrix3::new(
        w * w + x * x - y * y - z * z,
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        w * w - x * x + y * y - z * z,
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        w * w - x * x - y * y + z * z,
    )
}

/// The rotation by `angle` radians about the unit vector `axis`.
pub fn about(axis: Vector3<f64>, angle: f64) -> Quaternion {
    let (sin, cos) = libm::sincos(0.5 * angle);
    [cos, axis.x * sin, axis.y * sin, axis.z * sin]
}

/// The quaternion of a rotation matrix whose columns are the frame's axes, w not negative.
///
/// The largest of the four components is computed first, from the trace or a diagonal element, so that nothing is divided
/// by a small number (Shepperd 1978).
pub fn from_matrix(m: &Matrix3<f64>) -> Quaternion {
    let trace = m[(0, 0)] + m[(1, 1)] + m[(2, 2)];
    let q = if trace > 0.0 {
        let w = 0.5 * (1.0 + trace).sqrt();
        let scale = 0.25 / w;
        [w, scale * (m[(2, 1)] - m[(1, 2)]), scale * (m[(0, 2)] - m[(2, 0)]), scale * (m[(1, 0)] - m[(0, 1)])]
    } else {
        let i = if m[(0, 0)] > m[(1, 1)] && m[(0, 0)] > m[(2, 2)] {
            0
        } else if m[(1, 1)] > m[(2, 2)] {
            1
        } else {
            2
        };
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let largest = 0.5 * (1.0 + m[(i, i)] - m[(j, j)] - m[(k, k)]).sqrt();
        let scale = 0.25 / largest;
        let mut q = [scale * (m[(k, j)] - m[(j, k)]), 0.0, 0.0, 0.0];
        q[1 + i] = largest;
        q[1 + j] = scale * (m[(j, i)] + m[(i, j)]);
        q[1 + k] = scale * (m[(k, i)] + m[(i, k)]);
        q
    };
    normalized(q).unwrap_or(IDENTITY)
}

/// The smallest rotation that takes the z axis to the direction of `v`; a half turn about x where they are opposite.
pub fn from_z_axis(v: Vector3<f64>) -> Option<Quaternion> {
    let direction = unit_vector(v)?;
    let cross = Vector3::new(-direction.y, direction.x, 0.0);
    let sine = cross.norm();
    if sine < 1e-10 {
        return Some(if direction.z < 0.0 { [0.0, 1.0, 0.0, 0.0] } else { IDENTITY });
    }
    normalized(about(cross / sine, libm::atan2(sine, direction.z)))
}

/// The frame whose x axis points along `x` and whose y axis lies in the half plane of `y`.
pub fn from_xy_axes(x: Vector3<f64>, y: Vector3<f64>) -> Option<Quaternion> {
    let x = unit_vector(x)?;
    let y = unit_vector(y - x * x.dot(&y))?;
    Some(from_matrix(&Matrix3::from_columns(&[x, y, x.cross(&y)])))
}

/// Rotations by the three `angles` (radians) in turn about the axes of `sequence`: lower-case axes turn with the frame,
/// upper-case axes stay fixed. `None` where the sequence holds another letter.
pub fn from_euler(angles: [f64; 3], sequence: &[u8; 3]) -> Option<Quaternion> {
    let mut q = IDENTITY;
    for (angle, letter) in angles.into_iter().zip(sequence) {
        let axis = match letter.to_ascii_lowercase() {
            b'x' => Vector3::x(),
            b'y' => Vector3::y(),
            b'z' => Vector3::z(),
            _ => return None,
        };
        let turn = about(axis, angle);
        q = if letter.is_ascii_lowercase() { product(q, turn) } else { product(turn, q) };
    }
    normalized(q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};

    fn close(a: Vector3<f64>, b: Vector3<f64>) -> bool {
        (a - b).norm() < 1e-14
    }

    #[test]
    fn intrinsic_and_extrinsic_angles_turn_in_opposite_order() {
        let intrinsic = from_euler([0.3, -0.7, 1.1], b"xyz").unwrap();
        let extrinsic = from_euler([1.1, -0.7, 0.3], b"ZYX").unwrap();
        assert!(intrinsic.iter().zip(extrinsic).all(|(a, b)| (a - b).abs() < 1e-15));
        assert!(from_euler([0.0; 3], b"xyw").is_none());
    }

    #[test]
    fn z_axis_forms_reach_their_target_even_when_opposite() {
        for target in [Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.0, 0.0, -2.0), Vector3::new(0.0, -1.0, 0.0)] {
            let q = from_z_axis(target).unwrap();
            assert!(close(rotate(q, Vector3::z()), target.normalize()), "{target}");
        }
        assert!(from_z_axis(Vector3::zeros()).is_none());
    }

    #[test]
    fn a_matrix_and_its_quaternion_are_the_same_rotation() {
        for angle in [0.0, 0.4, FRAC_PI_2, 3.0, PI] {
            for axis in [Vector3::x(), Vector3::new(1.0, -2.0, 0.5).normalize(), -Vector3::z()] {
                let m = matrix(about(axis, angle));
                assert!((matrix(from_matrix(&m)) - m).norm() < 1e-14, "{angle} about {axis}");
            }
        }
    }

    #[test]
    fn normalising_twice_changes_no_bit() {
        let once = normalized([0.1, -0.7, 0.3, 0.2]).unwrap();
        assert_eq!(normalized(once), Some(once));
        assert_eq!(normalized([0.0; 4]), None);
        assert_eq!(normalized([f64::MAX; 4]), None);
    }
}

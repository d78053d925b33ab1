//! Orientations of scene elements as unit quaternions w x y z.

/// No turn.
pub(crate) const NONE: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// First `b`, then `a`.
pub(crate) fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// A turn about one axis.
fn about(axis: usize, angle: f64) -> [f64; 4] {
    let (sin, cos) = libm::sincos(0.5 * angle);
    let mut turn = [cos, 0.0, 0.0, 0.0];
    turn[1 + axis] = sin;
    turn
}

/// Yaw, then pitch (nose down positive), then roll, each about the axes that the turns before it have made; rad.
pub(crate) fn turned([roll, pitch, yaw]: [f64; 3]) -> [f64; 4] {
    product(about(2, yaw), product(about(1, pitch), about(0, roll)))
}

/// The shortest turn that takes z to a unit vector; half a turn about x where it points down.
pub(crate) fn z_to([x, y, z]: [f64; 3]) -> [f64; 4] {
    let length = libm::sqrt(2.0 * (1.0 + z));
    if length < 1e-9 {
        return [0.0, 1.0, 0.0, 0.0];
    }
    // The half angle's cosine and sine from (1 + z.v, z x v).
    [0.5 * length, -y / length, x / length, 0.0]
}

/// The vector divided by its length; `None` of a vector without direction.
pub(crate) fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = length(vector);
    (length > 0.0 && length.is_finite()).then(|| vector.map(|part| part / length))
}

/// Euclidean length.
pub(crate) fn length([x, y, z]: [f64; 3]) -> f64 {
    libm::sqrt(x * x + y * y + z * z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vector turned by a quaternion.
    fn apply(turn: [f64; 4], [x, y, z]: [f64; 3]) -> [f64; 3] {
        let back = [turn[0], -turn[1], -turn[2], -turn[3]];
        let [_, x, y, z] = product(product(turn, [0.0, x, y, z]), back);
        [x, y, z]
    }

    fn close(a: [f64; 3], b: [f64; 3]) {
        assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-12), "{a:?} {b:?}");
    }

    #[test]
    fn yaw_turns_left_pitch_lowers_the_nose_and_roll_the_right_side() {
        let quarter = std::f64::consts::FRAC_PI_2;
        close(apply(turned([0.0, 0.0, quarter]), [1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]);
        close(apply(turned([0.0, quarter, 0.0]), [1.0, 0.0, 0.0]), [0.0, 0.0, -1.0]);
        close(apply(turned([quarter, 0.0, 0.0]), [0.0, -1.0, 0.0]), [0.0, 0.0, -1.0]);
    }

    #[test]
    fn the_axis_goes_where_it_is_set() {
        for direction in [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.6, 0.0, -0.8], [-0.48, 0.64, 0.6]] {
            close(apply(z_to(direction), [0.0, 0.0, 1.0]), direction);
        }
        assert_eq!(unit([0.0; 3]), None);
        close(unit([0.0, 3.0, 4.0]).unwrap(), [0.0, 0.6, 0.8]);
    }
}

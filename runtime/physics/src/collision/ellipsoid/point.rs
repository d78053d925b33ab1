//! A point and an ellipsoid, or an ellipse.

use crate::scalar::Real;

/// Newton's steps at most.
const MOST_STEPS: usize = 100;

/// Signed distance of `point` to the ellipsoid with half axes `axes` along the coordinate axes, and the outward unit normal
/// at the nearest point of its surface; in the lanes of the mask.
#[inline(always)]
pub(super) fn point_to_ellipsoid<T: Real, const N: usize>(lanes: T::Mask, axes: &[T; N], point: &[T; N]) -> (T, [T; N]) {
    // The nearest point is x_i = a_i² y_i / (t + a_i²) for the largest root of  sum (a_i y_i / (t + a_i²))² = 1,
    // written in s = t + a_min² >= 0 so that points close to the smallest axis' plane keep their precision.
    let (zero, two) = (T::splat(0.0), T::splat(2.0));
    let (least, smallest) = smallest(axes);
    let mut excess = [zero; N];
    let mut moves = [T::mask(|_| false); N];
    let mut s = zero;
    for i in 0..N {
        excess[i] = (axes[i] - least) * (axes[i] + least);
        moves[i] = T::or(point[i].less(zero), zero.less(point[i]));
        s = s.at_least(axes[i] * point[i].abs() - excess[i]);
    }
    // A lane that has its root keeps it while others go on.
    let mut going = lanes;
    for _ in 0..MOST_STEPS {
        let (mut value, mut slope) = (T::splat(-1.0), zero);
        for i in 0..N {
            let ratio = axes[i] * point[i] / (s + excess[i]);
            value = T::select(moves[i], value + ratio * ratio, value);
            slope = T::select(moves[i], slope - two * ratio * ratio / (s + excess[i]), slope);
        }
        // The function is convex and falling, so Newton's steps grow s monotonically up to the root.
        let flat = T::and(slope.is_at_most(zero), zero.is_at_most(slope));
        let next = s - value / slope;
        let done = T::or(T::or(value.is_at_most(zero), flat), next.is_at_most(s));
        going = T::and(going, T::not(done));
        if !T::any(going) {
            break;
        }
        s = T::select(going, next, s);
    }
    // x_i / a_i² is the normal's direction; where s + excess vanishes, the remaining length of the unit vector x_i / a_i.
    let mut unit = [zero; N];
    for i in 0..N {
        let over = s + excess[i];
        unit[i] = T::select(zero.less(over), axes[i] * point[i] / over, zero);
    }
    let level = s.is_at_most(zero);
    if T::any(level) {
        let mut others = T::splat(-0.0);
        for i in 0..N {
            others = T::select(smallest[i], others, others + unit[i] * unit[i]);
        }
        let rest = (T::splat(1.0) - others).at_least(zero).sqrt();
        for i in 0..N {
            unit[i] = T::select(T::and(level, smallest[i]), rest, unit[i]);
        }
    }
    let mut normal = [zero; N];
    let mut square = T::splat(-0.0);
    for i in 0..N {
        normal[i] = unit[i] / axes[i];
        square += normal[i] * normal[i];
    }
    let length = square.sqrt();
    let mut distance = T::splat(-0.0);
    for i in 0..N {
        normal[i] /= length;
        distance += normal[i] * (point[i] - axes[i] * unit[i]);
    }
    (distance, normal)
}

/// The smallest of several numbers, and where it stands; of equal ones the first.
#[inline(always)]
fn smallest<T: Real, const N: usize>(values: &[T; N]) -> (T, [T::Mask; N]) {
    let mut least = values[0];
    let mut stands = [T::mask(|_| false); N];
    stands[0] = T::mask(|_| true);
    for i in 1..N {
        let less = values[i].less(least);
        least = T::select(less, values[i], least);
        for before in stands.iter_mut().take(i) {
            *before = T::and(*before, T::not(less));
        }
        stands[i] = less;
    }
    (least, stands)
}

#[cfg(test)]
mod tests {
    use super::point_to_ellipsoid as solve;
    use crate::scalar::Real;

    fn point_to_ellipsoid(axes: [f64; 3], point: [f64; 3]) -> (f64, [f64; 3]) {
        solve(true, &axes, &point)
    }

    #[test]
    fn a_point_on_an_axis_lies_beyond_or_before_the_surface_by_the_difference() {
        let (outside, normal) = point_to_ellipsoid([3.0, 2.0, 1.0], [0.0, 0.0, 1.5]);
        assert!((outside - 0.5).abs() < 1e-15 && (normal[2] - 1.0).abs() < 1e-15);
        let (inside, _) = point_to_ellipsoid([3.0, 2.0, 1.0], [0.0, 0.0, 0.25]);
        assert!((inside + 0.75).abs() < 1e-15);
        let (centre, normal) = point_to_ellipsoid([3.0, 2.0, 1.0], [0.0; 3]);
        assert!((centre + 1.0).abs() < 1e-15 && (normal[2].abs() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_nearest_point_is_stationary() {
        for k in 0..500 {
            let point: [f64; 3] = core::array::from_fn(|i| 4.0 * libm::sin(1.7 * k as f64 + 2.3 * i as f64 * (k as f64 + 1.0)));
            let axes = [0.085, 1.3, 0.4];
            let (distance, normal) = point_to_ellipsoid(axes, point);
            // Moving back along the normal lands on the surface, where the surface has that normal.
            let foot: [f64; 3] = core::array::from_fn(|i| point[i] - distance * normal[i]);
            let level: f64 = (0..3).map(|i| (foot[i] / axes[i]).squared()).sum();
            assert!((level - 1.0).abs() < 1e-10, "level {level} at {point:?}");
        }
    }
}

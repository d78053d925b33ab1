//! Quaternions w x y z over the physics' scalar.

use crate::scalar::Real;
use nalgebra::{Matrix3, Vector3};

/// Constant quaternion in every lane.
#[inline(always)]
pub fn constant_quaternion<T: Real>(q: &[f64; 4]) -> [T; 4] {
    q.map(T::splat)
}

/// a b: first `b`, then `a`.
#[inline(always)]
pub fn multiply<T: Real>(a: &[T; 4], b: &[T; 4]) -> [T; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// The inverse of a unit quaternion.
#[inline(always)]
pub fn conjugate<T: Real>(q: &[T; 4]) -> [T; 4] {
    [q[0], -q[1], -q[2], -q[3]]
}

/// The unit quaternion in the direction of `q`; the identity where `q` vanishes.
#[inline(always)]
pub fn normalize<T: Real>(q: &[T; 4]) -> [T; 4] {
    let norm = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    let vanishes = norm.less(T::splat(MINIMUM));
    let inverse = T::splat(1.0) / T::select(vanishes, T::splat(1.0), norm);
    let part = |value: T, identity: f64| T::select(vanishes, T::splat(identity), value * inverse);
    [part(q[0], 1.0), part(q[1], 0.0), part(q[2], 0.0), part(q[3], 0.0)]
}

/// Below this a length counts as zero (MuJoCo's `mjMINVAL`).
pub const MINIMUM: f64 = 1e-15;

/// Rotation by `angle` (rad) about the unit vector `axis`.
#[inline(always)]
pub fn from_axis_angle<T: Real>(axis: &Vector3<T>, angle: T) -> [T; 4] {
    let (sin, cos) = (angle * T::splat(0.5)).sin_cos();
    [cos, axis.x * sin, axis.y * sin, axis.z * sin]
}

/// Rotation matrix of a unit quaternion.
#[inline(always)]
pub fn matrix<T: Real>(q: &[T; 4]) -> Matrix3<T> {
    let [w, x, y, z] = *q;
    let two = T::splat(2.0);
    let (xx, yy, zz, ww) = (x * x, y * y, z * z, w * w);
    Matrix3::new(
        ww + xx - yy - zz,
        two * (x * y - w * z),
        two * (x * z + w * y),
        two * (x * y + w * z),
        ww - xx + yy - zz,
        two * (y * z - w * x),
        two * (x * z - w * y),
        two * (y * z + w * x),
        ww - xx - yy + zz,
    )
}

/// The quaternion after turning `q` for `time` seconds at `angular_velocity` (rad/s, in the axes of the turning frame).
#[inline(always)]
pub fn integrate<T: Real>(q: &[T; 4], angular_velocity: &Vector3<T>, time: T) -> [T; 4] {
    let speed = super::spatial::norm(angular_velocity);
    let still = speed.less(T::splat(MINIMUM));
    let inverse = T::splat(1.0) / T::select(still, T::splat(1.0), speed);
    let axis = super::spatial::scale(angular_velocity, inverse);
    let turn = from_axis_angle(&axis, speed * time);
    normalize(&multiply(q, &turn))
}

/// Rotation vector (axis times angle in (-pi, pi], rad) from `from` to `to`, in the axes of `from`.
#[inline(always)]
pub fn difference<T: Real>(to: &[T; 4], from: &[T; 4]) -> Vector3<T> {
    let inverse = [from[0], -from[1], -from[2], -from[3]];
    let d = multiply(&inverse, to);
    let axis = Vector3::new(d[1], d[2], d[3]);
    let sin = super::spatial::norm(&axis);
    let pi = T::splat(core::f64::consts::PI);
    let angle = T::splat(2.0) * sin.atan2(d[0]);
    let angle = T::select(pi.less(angle), angle - pi - pi, angle);
    let still = sin.less(T::splat(MINIMUM));
    let inverse = T::splat(1.0) / T::select(still, T::splat(1.0), sin);
    super::spatial::scale(&axis, T::select(still, T::splat(0.0), angle * inverse))
}

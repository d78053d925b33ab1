//! Spatial vectors: an angular and a linear part about one reference point, in world axes.
//!
//! All spatial quantities of a kinematic tree refer to the tree's centre of mass at the current configuration, which keeps
//! the numbers of a body far from the world origin small. A motion is (angular velocity, velocity of the point that
//! coincides with the reference); a force is (moment about the reference, force).

use crate::{batch::one_lane, scalar::Real};
use nalgebra::{Matrix3, Vector3};

/// Angular then linear part.
pub type Spatial<T> = [Vector3<T>; 2];

/// The zero vector.
#[inline(always)]
pub fn zero<T: Real>() -> Vector3<T> {
    Vector3::from_element(T::splat(0.0))
}

/// The zero spatial vector.
#[inline(always)]
pub fn spatial_zero<T: Real>() -> Spatial<T> {
    [zero(), zero()]
}

/// Constant vector in every lane.
#[inline(always)]
pub fn constant<T: Real>(value: &Vector3<f64>) -> Vector3<T> {
    Vector3::new(T::splat(value.x), T::splat(value.y), T::splat(value.z))
}

/// A vector as it is in one lane.
#[inline(always)]
pub fn lane_of<T: Real>(v: &Vector3<T>, lane: usize) -> Vector3<f64> {
    Vector3::new(v.x.lane(lane), v.y.lane(lane), v.z.lane(lane))
}

/// A matrix as it is in one lane.
#[inline(always)]
pub fn matrix_of<T: Real>(m: &Matrix3<T>, lane: usize) -> Matrix3<f64> {
    let at = |row: usize, column: usize| m[(row, column)].lane(lane);
    Matrix3::new(at(0, 0), at(0, 1), at(0, 2), at(1, 0), at(1, 1), at(1, 2), at(2, 0), at(2, 1), at(2, 2))
}

/// a . b
#[inline(always)]
pub fn dot<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> T {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// a x b
#[inline(always)]
pub fn cross<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// -v
#[inline(always)]
pub fn opposite<T: Real>(v: &Vector3<T>) -> Vector3<T> {
    Vector3::new(-v.x, -v.y, -v.z)
}

/// v s
#[inline(always)]
pub fn scale<T: Real>(v: &Vector3<T>, s: T) -> Vector3<T> {
    Vector3::new(v.x * s, v.y * s, v.z * s)
}

/// v / s
#[inline(always)]
pub fn over<T: Real>(v: &Vector3<T>, s: T) -> Vector3<T> {
    Vector3::new(v.x / s, v.y / s, v.z / s)
}

/// a + b
#[inline(always)]
pub fn plus<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x + b.x, a.y + b.y, a.z + b.z)
}

/// a - b
#[inline(always)]
pub fn minus<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x - b.x, a.y - b.y, a.z - b.z)
}

/// Euclidean norm.
#[inline(always)]
pub fn norm<T: Real>(v: &Vector3<T>) -> T {
    dot(v, v).sqrt()
}

/// R v
#[inline(always)]
pub fn rotate<T: Real>(r: &Matrix3<T>, v: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        r.m11 * v.x + r.m12 * v.y + r.m13 * v.z,
        r.m21 * v.x + r.m22 * v.y + r.m23 * v.z,
        r.m31 * v.x + r.m32 * v.y + r.m33 * v.z,
    )
}

/// R' v
#[inline(always)]
pub fn rotate_back<T: Real>(r: &Matrix3<T>, v: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        r.m11 * v.x + r.m21 * v.y + r.m31 * v.z,
        r.m12 * v.x + r.m22 * v.y + r.m32 * v.z,
        r.m13 * v.x + r.m23 * v.y + r.m33 * v.z,
    )
}

/// A B
#[inline(always)]
pub fn product<T: Real>(a: &Matrix3<T>, b: &Matrix3<T>) -> Matrix3<T> {
    let x = rotate(a, &Vector3::new(b.m11, b.m21, b.m31));
    let y = rotate(a, &Vector3::new(b.m12, b.m22, b.m32));
    let z = rotate(a, &Vector3::new(b.m13, b.m23, b.m33));
    Matrix3::new(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z)
}

/// A'
#[inline(always)]
pub fn transposed<T: Real>(a: &Matrix3<T>) -> Matrix3<T> {
    Matrix3::new(a.m11, a.m21, a.m31, a.m12, a.m22, a.m32, a.m13, a.m23, a.m33)
}

/// Power of a force along a motion (or any pairing of the two).
#[inline(always)]
pub fn pair<T: Real>(a: &Spatial<T>, b: &Spatial<T>) -> T {
    dot(&a[0], &b[0]) + dot(&a[1], &b[1])
}

/// to += v s
#[inline(always)]
pub fn add_scaled<T: Real>(to: &mut Spatial<T>, v: &Spatial<T>, s: T) {
    to[0] += scale(&v[0], s);
    to[1] += scale(&v[1], s);
}

/// to += v
#[inline(always)]
pub fn add<T: Real>(to: &mut Spatial<T>, v: &Spatial<T>) {
    to[0] += v[0];
    to[1] += v[1];
}

/// Rate of change of a motion vector `m` that is carried along with velocity `v`.
#[inline(always)]
pub fn cross_motion<T: Real>(v: &Spatial<T>, m: &Spatial<T>) -> Spatial<T> {
    [cross(&v[0], &m[0]), cross(&v[0], &m[1]) + cross(&v[1], &m[0])]
}

/// Rate of change of a force vector `f` that is carried along with velocity `v`.
#[inline(always)]
pub fn cross_force<T: Real>(v: &Spatial<T>, f: &Spatial<T>) -> Spatial<T> {
    [cross(&v[0], &f[0]) + cross(&v[1], &f[1]), cross(&v[0], &f[1])]
}

/// Inertia of a body (or of several) about the reference point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpatialInertia<T: Real> {
    /// Rotational inertia about the reference point: xx, yy, zz, xy, xz, yz, kg m².
    pub rotational: [T; 6],
    /// Mass times the offset of the centre of mass from the reference point, kg m.
    pub first_moment: Vector3<T>,
    /// Mass, kg.
    pub mass: T,
}

one_lane!(SpatialInertia { rotational, first_moment, mass });

impl<T: Real> SpatialInertia<T> {
    /// Nothing.
    pub fn zero() -> Self {
        Self { rotational: [T::splat(0.0); 6], first_moment: zero(), mass: T::splat(0.0) }
    }

    /// A body with principal moments `inertia` along the columns of `axes`, its centre of mass at `offset` from the reference.
    #[inline(always)]
    pub fn of_body(mass: T, inertia: &Vector3<T>, axes: &Matrix3<T>, offset: &Vector3<T>) -> Self {
        // R diag(I) R' + m (|d|² 1 - d d')
        // A function, because closures are not compiled for the instructions in use.
        #[inline(always)]
        fn entry<T: Real>(axes: &Matrix3<T>, inertia: &Vector3<T>, i: usize, j: usize) -> T {
            axes[(i, 0)] * inertia.x * axes[(j, 0)]
                + axes[(i, 1)] * inertia.y * axes[(j, 1)]
                + axes[(i, 2)] * inertia.z * axes[(j, 2)]
        }
        let d = offset;
        Self {
            rotational: [
                entry(axes, inertia, 0, 0) + mass * (d.y * d.y + d.z * d.z),
                entry(axes, inertia, 1, 1) + mass * (d.x * d.x + d.z * d.z),
                entry(axes, inertia, 2, 2) + mass * (d.x * d.x + d.y * d.y),
                entry(axes, inertia, 0, 1) - mass * d.x * d.y,
                entry(axes, inertia, 0, 2) - mass * d.x * d.z,
                entry(axes, inertia, 1, 2) - mass * d.y * d.z,
            ],
            first_moment: scale(d, mass),
            mass,
        }
    }

    /// Both together.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        for (mine, theirs) in self.rotational.iter_mut().zip(&other.rotational) {
            *mine += *theirs;
        }
        self.first_moment += other.first_moment;
        self.mass += other.mass;
    }

    /// Momentum (angular about the reference, linear) of the motion `v`.
    #[inline(always)]
    pub fn momentum(&self, v: &Spatial<T>) -> Spatial<T> {
        let [xx, yy, zz, xy, xz, yz] = self.rotational;
        let w = &v[0];
        let angular =
            Vector3::new(xx * w.x + xy * w.y + xz * w.z, xy * w.x + yy * w.y + yz * w.z, xz * w.x + yz * w.y + zz * w.z)
                + cross(&self.first_moment, &v[1]);
        [angular, scale(&v[1], self.mass) - cross(&self.first_moment, w)]
    }
}

//! What colliders in closed form see and find in all lanes at once.
//!
//! Such a collider is written over [`Real`]: the same source takes one episode in `f64` and eight in lanes. Where `f64` would take one of
//! two branches, lanes take both and select, so every lane gets the bits that its episode gets alone.

use super::{ContactPoint, Placed};
use crate::{
    scalar::Real,
    spatial::{cross, dot, lane_of, matrix_of, minus, norm, over, scale},
};
use nalgebra::{Matrix3, Vector3};

/// Two shapes, the first not after the second in [`GeomKind`](crate::model::GeomKind)'s order.
pub(super) struct Pair<'a, T: Real> {
    pub shapes: [Placed<'a, T>; 2],
    /// Distance up to which they touch, m.
    pub reach: T,
    /// The lanes in which the answer is asked for.
    pub lanes: T::Mask,
}

/// A contact in the lanes that have it; in the others its numbers mean nothing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch<T: Real> {
    pub lanes: T::Mask,
    pub distance: T,
    pub position: Vector3<T>,
    pub frame: Matrix3<T>,
}

impl<T: Real> Touch<T> {
    /// Appends it to what has been found, if any lane has it.
    #[inline(always)]
    pub fn note(self, found: &mut Vec<Self>) {
        if T::any(self.lanes) {
            found.push(self);
        }
    }

    /// What a lane has of it.
    #[inline(always)]
    pub fn in_lane(&self, lane: usize) -> Option<ContactPoint> {
        T::holds(self.lanes, lane).then(|| ContactPoint {
            distance: self.distance.lane(lane),
            position: lane_of(&self.position, lane),
            frame: matrix_of(&self.frame, lane),
        })
    }
}

/// A contact frame with rows normal, tangent, tangent: the first tangent near `along` if given, else near y, or z where the
/// normal is close to y.
#[inline(always)]
pub(super) fn frame_of<T: Real>(normal: Vector3<T>, along: Option<Vector3<T>>) -> Matrix3<T> {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let lies = normal.y.abs().less(T::splat(0.5));
    let default = Vector3::new(zero, T::select(lies, one, zero), T::select(lies, zero, one));
    let tangent = across(&normal, &along.unwrap_or(default));
    let (mut tangent, short) = unit(&tangent, 1e-15);
    if T::any(short) {
        let other = across(&normal, &default);
        tangent = choose(short, &over(&other, norm(&other)), &tangent);
    }
    let last = cross(&normal, &tangent);
    Matrix3::new(normal.x, normal.y, normal.z, tangent.x, tangent.y, tangent.z, last.x, last.y, last.z)
}

/// What is left of a vector across a unit vector.
#[inline(always)]
fn across<T: Real>(normal: &Vector3<T>, hint: &Vector3<T>) -> Vector3<T> {
    minus(hint, &scale(normal, dot(normal, hint)))
}

/// A vector over its length, and where it has none: where its length is at most `least`.
#[inline(always)]
pub(super) fn unit<T: Real>(v: &Vector3<T>, least: f64) -> (Vector3<T>, T::Mask) {
    let length = norm(v);
    (over(v, length), length.is_at_most(T::splat(least)))
}

/// `a` where the mask holds, `b` elsewhere.
#[inline(always)]
pub(super) fn choose<T: Real>(mask: T::Mask, a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(T::select(mask, a.x, b.x), T::select(mask, a.y, b.y), T::select(mask, a.z, b.z))
}

#[cfg(test)]
mod tests;

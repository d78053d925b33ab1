//! The path of a gait: a body that is pushed off it, or steps unevenly, comes back to it.

use super::super::turning;
use msk_physics::scalar::Real;
use nalgebra::Vector2;

/// A body that is further off its path forgets it, m: one that was pushed goes on where it is.
const FURTHEST: f64 = 0.3;
/// The greatest speed with which a body comes back, m/s: steps aside cost balance.
const FASTEST: f64 = 0.1;

/// The point of a path that is nearest to the body, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Path(pub Vector2<f64>);

impl Path {
    /// The velocity, in the axes of a heading, that goes on along the path with one, and comes back to it with a rate of `returning` (1/s).
    pub fn follow(&mut self, place: Vector2<f64>, velocity: Vector2<f64>, heading: f64, returning: f64) -> Vector2<f64> {
        let pace = velocity.norm();
        if pace <= 0.0 {
            self.0 = place;
            return velocity;
        }
        let along = velocity / pace;
        let off = turning::level(place - self.0, -heading);
        let off = off - along * off.dot(&along);
        let off = off * (FURTHEST / off.norm().at_least(FURTHEST));
        self.0 = place - turning::level(off, heading);
        let back = off * returning;
        velocity - back * (FASTEST / back.norm().at_least(FASTEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_pushed_aside_comes_back(aside in -0.3..0.3_f64, heading in -3.0..3.0_f64, forward in 0.3..2.0_f64) {
            let start = Vector2::new(1.0, -2.0);
            let mut path = Path(start);
            let mut place = start + turning::level(Vector2::new(0.0, aside), heading);
            for _ in 0..1000 {
                place += turning::level(path.follow(place, Vector2::new(forward, 0.0), heading, 1.0), heading) * 0.01;
            }
            let way = turning::level(place - start, -heading);
            prop_assert!((way.x - 10.0 * forward).abs() < 1e-9 && way.y.abs() < 0.01, "{way:?}");
        }
    }

    #[test]
    fn what_is_pushed_far_goes_on_there() {
        let mut path = Path(Vector2::zeros());
        path.follow(Vector2::new(0.0, 2.0), Vector2::new(1.0, 0.0), 0.0, 1.0);
        assert!((path.0 - Vector2::new(0.0, 2.0 - FURTHEST)).norm() < 1e-12);
    }
}

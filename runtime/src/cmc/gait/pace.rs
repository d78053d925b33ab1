//! The manner in which a body walks at a pace.
//!
//! Up to [`SLOW`] it walks in one manner. In that a faster body stumbles: the leg behind ends before its push does, and weight drops on the foot ahead;
//! that foot is still on its way, and high; it lands too far ahead, and brakes. So with a faster pace knees bend more, heels rise, steps take less time, a foot
//! begins its way earlier, goes lower and lands shorter, the trunk leans forward, and the momentum of the swing is foreseen (`pendulum`).

use super::pendulum::Timing;
use msk_physics::scalar::Real;

/// The fastest pace of the slow manner, m/s.
const SLOW: f64 = 1.0;

/// How a body walks forward at a pace. The numbers were found by random searches for what walks furthest, the slow ones also on waves and stairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Manner {
    pub timing: Timing,
    /// How fast it changes its pace, m/s².
    pub quickening: f64,
    /// By how much it is lower than one that stands, m, so that its knees are bent.
    pub lower: f64,
    /// How far it leans forward, rad.
    pub lean: f64,
    /// How far a foot reaches ahead, m.
    pub reach: f64,
    /// How far short of where the pendulum has it a foot lands, m: the foot overshoots, and landing brakes.
    pub short: f64,
    /// How high a foot is lifted on its way, m.
    pub lift: f64,
    /// For how long before the other foot bears alone a foot begins its way, s: meanwhile it bears, and its leg gathers way.
    pub early: f64,
    /// How far ahead of its time a foot is to go its way, s: muscles take tens of milliseconds to follow.
    pub ahead: f64,
    /// Which share of the angular momentum of the swing is foreseen.
    pub foreseen: f64,
    /// How fast it comes back to its path, 1/s.
    pub returning: f64,
    /// How much more the height of a foot on its way counts than its way along the ground.
    pub clearing: f64,
    /// How much the heel of a foot that the body has passed shall rest: its weight, squared.
    pub heel: f64,
}

impl Manner {
    /// That of a pace forward, m/s.
    pub fn of(pace: f64) -> Self {
        let haste = (pace - SLOW).clip(0.0, 1.0);
        let of = |slow: f64, more: f64| slow + more * haste;
        Self {
            timing: Timing { both: of(0.063, -0.0148), single: of(0.39, -0.029) },
            quickening: of(0.85, 0.519),
            lower: of(0.046, 0.0496),
            lean: of(0.054, 0.291),
            reach: of(0.7, 0.154),
            short: of(0.0, 0.187),
            lift: of(0.038, -0.026),
            early: of(0.0, 0.048),
            ahead: of(0.0, 0.0227),
            foreseen: of(0.0, 1.5),
            returning: of(0.0, 2.23),
            clearing: of(1.0, 0.94),
            heel: of(1.26, -1.25),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_slow_walks_in_one_manner_and_what_is_faster_changes_it_little_by_little(slow in 0.0..SLOW, pace in 0.0..2.5_f64) {
            prop_assert_eq!(Manner::of(slow), Manner::of(0.0));
            let [before, after] = [pace, pace + 0.01].map(Manner::of);
            prop_assert!((after.lean - before.lean).abs() < 0.005 && (after.lower - before.lower).abs() < 0.001);
            prop_assert!(after.heel > 0.0 && after.early < after.timing.both && after.reach < 1.0);
        }
    }
}

//! The manner in which a body walks at a pace.
//!
//! Up to [`SLOW`] it walks in one manner. In that a faster body stumbles: the leg behind ends before its push does, and weight drops on the foot ahead;
//! that foot is still on its way, and high; it lands too far ahead, and brakes. So with a faster pace knees bend more, heels rise, a foot begins its
//! way earlier and lands shorter, the trunk leans forward, and the momentum of the swing is foreseen (`pendulum`).

use msk_physics::scalar::Real;

/// The fastest pace of the slow manner, m/s.
const SLOW: f64 = 1.0;

/// How a body walks forward at a pace. The numbers were found by random searches for what walks furthest, the slow ones also on waves and stairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Manner {
    /// By how much it is lower than one that stands, m, so that its knees are bent.
    pub lower: f64,
    /// How far it leans forward, rad.
    pub lean: f64,
    /// How far a foot reaches ahead, m.
    pub reach: f64,
    /// How far short of where the pendulum has it a foot lands, m: the foot overshoots, and landing brakes.
    pub short: f64,
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
            lower: of(0.046, 0.05),
            lean: of(0.054, 0.25),
            reach: of(0.7, 0.25),
            short: of(0.0, 0.2),
            early: of(0.0, 0.05),
            ahead: of(0.0, 0.03),
            foreseen: of(0.0, 1.0),
            returning: of(0.0, 1.17),
            clearing: of(1.0, 0.7),
            heel: of(1.26, -1.2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pendulum::BOTH;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_slow_walks_in_one_manner_and_what_is_faster_changes_it_little_by_little(slow in 0.0..SLOW, pace in 0.0..2.5_f64) {
            prop_assert_eq!(Manner::of(slow), Manner::of(0.0));
            let [before, after] = [pace, pace + 0.01].map(Manner::of);
            prop_assert!((after.lean - before.lean).abs() < 0.005 && (after.lower - before.lower).abs() < 0.001);
            prop_assert!(after.heel > 0.0 && after.early < BOTH && after.reach < 1.0);
        }
    }
}

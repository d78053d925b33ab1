//! The manner in which a body walks at a pace.
//!
//! Up to [`SLOW`] it walks in one manner. In that a faster body stumbles: the leg behind ends before its push does, and weight drops on the foot ahead;
//! that foot is still on its way, and high; it lands too far ahead, and brakes. So with a faster pace knees bend more, heels rise, steps take less time, a foot
//! begins its way earlier, goes lower and lands shorter, feet are further apart, the trunk leans forward, and the momentum of the swing is foreseen (`pendulum`).

use super::pendulum::Timing;
use msk_physics::scalar::Real;

/// The fastest pace of the slow manner, m/s.
const SLOW: f64 = 1.0;

/// How a body walks forward at a pace. The numbers were found by random searches for what walks furthest, the slow ones also on waves and stairs; the fast
/// ones, by the evolution strategy CMA-ES (Hansen, The CMA evolution strategy: a tutorial, 2016), for what also lasts in eight episodes of `run`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Manner {
    pub timing: Timing,
    /// How fast it changes its pace, m/s².
    pub quickening: f64,
    /// How many times as far as its pace feet are to go, which land short of that.
    pub stride: f64,
    /// By how much it is lower than one that stands, m, so that its knees are bent.
    pub lower: f64,
    /// How far it leans forward, rad.
    pub lean: f64,
    /// Between the middles of the soles of a body that goes straight on, m.
    pub width: f64,
    /// How far to the side of the middle of a sole the centre of pressure may be, m.
    pub aside: f64,
    /// How much the foot that bears shall rest: a weight, squared.
    pub stance: f64,
    /// How many times as stiff as usual the root, and the joints, are held.
    pub firmness: [f64; 2],
    /// How far a foot reaches ahead, m.
    pub reach: f64,
    /// How far short of where the pendulum has it a foot lands, m: the foot overshoots, and landing brakes.
    pub short: f64,
    /// How high a foot is lifted on its way, m.
    pub lift: f64,
    /// For how long before the other foot bears alone a foot begins its way, s: meanwhile it bears, and its leg gathers way. Where both bear for less than
    /// that, it is ahead by the rest.
    pub early: f64,
    /// How far ahead of its time a foot is to go its way, s: muscles take tens of milliseconds to follow.
    pub ahead: f64,
    /// Which share of the angular momentum of the swing is foreseen.
    pub foreseen: f64,
    /// How fast it comes back to its path, 1/s.
    pub returning: f64,
    /// How a foot on its way is damped, 1/s.
    pub damping: f64,
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
            timing: Timing { both: of(0.063, -0.0199), single: of(0.39, -0.0091) },
            quickening: of(0.85, 0.873),
            stride: of(1.0, 0.098),
            lower: of(0.046, 0.0363),
            lean: of(0.054, 0.231),
            width: of(0.16, 0.0255),
            aside: of(0.03, 0.013),
            stance: of(1.26, -0.271),
            firmness: [of(1.0, 0.252), of(1.0, -0.167)],
            reach: of(0.7, 0.245),
            short: of(0.0, 0.221),
            lift: of(0.038, -0.036),
            early: of(0.0, 0.0563),
            ahead: of(0.0, 0.0149),
            foreseen: of(0.0, 2.13),
            returning: of(0.0, 2.84),
            damping: of(42.0, 8.6),
            clearing: of(1.0, 0.919),
            heel: of(1.26, -1.259),
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
            prop_assert!(after.heel > 0.0 && after.early < after.timing.single && after.reach < 1.0);
        }
    }
}

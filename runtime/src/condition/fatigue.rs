//! Fatigue: the three-compartment model.
//!
//! The motor units of a muscle are active (A), resting (R) or fatigued (F), with A + R + F = 1. A drive C recruits resting
//! units towards the target that the excitation sets, active ones tire at a rate, and fatigued ones recover to rest:
//!
//! A' = C - fatigue A,  R' = -C + recovery F,  F' = fatigue A - recovery F
//!
//! (Xia and Frey-Law, "A theoretical approach for modeling peripheral muscle fatigue and recovery", J. Biomech. 41, 2008.)
//! While no more is asked than is active, blood flows freely and recovery is faster by a multiplier (Looft, Herkert and
//! Frey-Law, "Modification of a three-compartment muscle fatigue model to predict peak torque decline during intermittent
//! tasks", J. Biomech. 77, 2018). The drive follows the muscle's own activation dynamics.
//!
//! What a muscle can bring up is 1 - F: excitation beyond it has no effect.

use super::{ConditionError, within};
use msk_physics::model::{Dynamics, Model};
use msk_physics::scalar::Real;
use serde::{Deserialize, Serialize};

/// Rates of fatigue, the same for all muscles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Fatigue {
    /// Rate at which active units tire, 1/s. Frey-Law, Looft and Heitsman 2012 find 0.00589 for the ankle to 0.0182 for the
    /// shoulder.
    pub fatigue: f64,
    /// Rate at which fatigued units recover during effort, 1/s: 0.00058 for the ankle to 0.00168 for the shoulder.
    pub recovery: f64,
    /// How many times faster they recover at rest.
    pub rest: f64,
}

impl Default for Fatigue {
    /// Those of the published benchmark code: a recovery during effort ten times slower than the literature's for all joints
    /// (0.00094 / s, multiplier 15), with the same recovery at rest.
    fn default() -> Self {
        Self { fatigue: 0.00912, recovery: 9.4e-5, rest: 150.0 }
    }
}

impl Fatigue {
    /// Whether all rates make sense.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self) -> Result<(), ConditionError> {
        within("rate of fatigue", self.fatigue, 1.0)?;
        within("rate of recovery", self.recovery, 1.0)?;
        within("rest multiplier", self.rest, 1000.0)
    }
}

/// The compartments of all muscles: part of an episode's snapshot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Compartments {
    active: Vec<f64>,
    fatigued: Vec<f64>,
}

impl Compartments {
    /// Fresh muscles, all at rest.
    pub fn new(muscles: usize) -> Self {
        Self { active: vec![0.0; muscles], fatigued: vec![0.0; muscles] }
    }

    /// Number of muscles; 0 if the lists of what came from outside differ in length.
    pub(crate) fn len(&self) -> usize {
        if self.active.len() == self.fatigued.len() { self.active.len() } else { 0 }
    }

    /// Active, resting and fatigued share of a muscle.
    pub fn of(&self, muscle: usize) -> [f64; 3] {
        let (active, fatigued) = (self.active[muscle], self.fatigued[muscle]);
        [active, 1.0 - active - fatigued, fatigued]
    }

    /// Lets `elapsed` seconds pass at these excitations, and limits each to what its muscle can still bring up.
    pub fn advance(&mut self, rates: &Fatigue, model: &Model, elapsed: f64, excitations: &mut [f64]) {
        for (muscle, excitation) in excitations.iter_mut().enumerate() {
            let Dynamics::Muscle([rise, fall, _]) = model.actuators.dynamics[muscle] else { continue };
            let fatigued = self.pass(rates, [rise, fall], elapsed, muscle, excitation.clip(0.0, 1.0));
            *excitation = excitation.at_most(1.0 - fatigued);
        }
    }

    /// Moves units of one muscle between compartments: every flow is at most what its source holds, so that shares stay in
    /// 0..1 and their sum is kept. Gives the fatigued share.
    fn pass(&mut self, rates: &Fatigue, times: [f64; 2], elapsed: f64, muscle: usize, target: f64) -> f64 {
        let [active, resting, fatigued] = self.of(muscle);
        let pace = 0.5 + 1.5 * active;
        let short = target - active;
        let time = if short > 0.0 { times[0] * pace } else { times[1] / pace };
        // The drive reaches its target at the earliest, and never recruits units that are not at rest.
        let drive = (short * (elapsed / time.at_least(elapsed.at_least(f64::MIN_POSITIVE)))).at_most(resting.at_least(0.0));
        let recovery = if active >= target { rates.recovery * rates.rest } else { rates.recovery };
        let tired = -libm::expm1(-rates.fatigue * elapsed) * active;
        let recovered = -libm::expm1(-recovery * elapsed) * fatigued;
        self.active[muscle] = (active + drive - tired).clip(0.0, 1.0);
        self.fatigued[muscle] = (fatigued + tired - recovered).clip(0.0, 1.0 - self.active[muscle]);
        self.fatigued[muscle]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMES: [f64; 2] = [0.01, 0.04];
    const STEP: f64 = 0.01;

    /// Runs one muscle until `until` holds of its compartments, and gives the time, s.
    fn time_until(rates: &Fatigue, target: f64, until: impl Fn([f64; 3]) -> bool) -> f64 {
        let mut muscle = Compartments::new(1);
        for count in 1..1_000_000 {
            muscle.pass(rates, TIMES, STEP, 0, target);
            // The first moments recruit.
            if count > 50 && until(muscle.of(0)) {
                return f64::from(count) * STEP;
            }
        }
        f64::INFINITY
    }

    #[test]
    fn the_compartments_always_sum_to_one_and_none_is_negative() {
        let mut muscle = Compartments::new(1);
        let rates = Fatigue { fatigue: 0.5, recovery: 0.2, rest: 30.0 };
        for count in 0..20_000_u32 {
            // A target that jumps about, faster and slower than the compartments move.
            let target = f64::from(count / 7 * 7919 % 101) / 100.0;
            muscle.pass(&rates, TIMES, STEP, 0, target);
            let shares = muscle.of(0);
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-15, "{shares:?}");
            assert!(shares.iter().all(|share| (-1e-15..=1.0).contains(share)), "{shares:?}");
        }
    }

    /// Endurance time: how long a load can be held. The power laws are those that Frey-Law and Avin (Ergonomics 53, 2010)
    /// fitted to 194 publications; the rates those that Frey-Law et al. (2012) fitted to the laws.
    #[test]
    fn endurance_times_are_those_of_the_literature() {
        let joints = [("ankle", 0.00589, 0.00058, 34.71, -2.06), ("shoulder", 0.0182, 0.00168, 14.86, -1.83)];
        for (joint, fatigue, recovery, scale, power) in joints {
            let rates = Fatigue { fatigue, recovery, rest: 15.0 };
            for load in [0.3, 0.4, 0.5, 0.6, 0.7] {
                let found = time_until(&rates, load, |[_, _, fatigued]| 1.0 - fatigued <= load);
                let expected = scale * libm::pow(load, power);
                assert!((found / expected - 1.0).abs() < 0.35, "{joint} at {load}: {found} s, not {expected} s");
            }
        }
        // A full effort sinks to one half within one to two minutes; a light one is held for many.
        let usual = Fatigue::default();
        assert!((60.0..120.0).contains(&time_until(&usual, 1.0, |[active, ..]| active < 0.5)));
        assert!(time_until(&usual, 0.1, |[_, _, fatigued]| fatigued > 0.5) > 500.0);
    }

    #[test]
    fn held_effort_ends_in_the_balance_of_fatigue_and_recovery() {
        let rates = Fatigue { fatigue: 0.05, recovery: 0.02, rest: 1.0 };
        let mut muscle = Compartments::new(1);
        (0..200_000).for_each(|_| {
            muscle.pass(&rates, TIMES, STEP, 0, 1.0);
        });
        let [active, _, fatigued] = muscle.of(0);
        // Flows are exact over a step of 10 ms each by itself: their balance is off by the rates times the step.
        let ratio = fatigued * rates.recovery / (active * rates.fatigue);
        assert!((ratio - 1.0).abs() < rates.fatigue * STEP, "{ratio}");
    }

    #[test]
    fn rest_brings_a_tired_muscle_back_and_the_multiplier_hastens_it() {
        let recovery_after_a_minute = |rest: f64| {
            let rates = Fatigue { rest, ..Fatigue::default() };
            let mut muscle = Compartments::new(1);
            (0..6000).for_each(|_| {
                muscle.pass(&rates, TIMES, STEP, 0, 1.0);
            });
            let tired = muscle.of(0)[2];
            (0..6000).for_each(|_| {
                muscle.pass(&rates, TIMES, STEP, 0, 0.0);
            });
            let rested = muscle.of(0);
            assert!(tired > 0.3 && rested[0] < 1e-9);
            rested[2] / tired
        };
        // The remainder after a minute of rest: exp(-r R t).
        let [slow, fast] = [1.0, 150.0].map(recovery_after_a_minute);
        assert!((fast - libm::exp(-150.0 * 9.4e-5 * 60.0)).abs() < 0.01, "{fast}");
        assert!(slow > 0.99 && slow < 1.01, "{slow}");
    }
}

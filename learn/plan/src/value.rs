//! What an imagined episode is worth.
//!
//! The reward of the horizon counts in full, that of the tail by a share. Failing is priced in steps of the largest reward in sight:
//! within the horizon it costs more than all reward that could be had there, and the more the earlier, so that failing is never best and
//! rounds in which everything fails still prefer what fails late. In the tail, which has no plan and may yet be saved by one, the
//! price falls to nothing towards its end. A success termination and the end of time are no failures.

use msk_physics::scalar::Real;

/// What came of one plan.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Trace {
    /// Sum of the rewards in the horizon, and in the tail.
    pub rewards: [f64; 2],
    /// Control steps that were taken.
    pub steps: u32,
    /// The largest size of a reward before the last step of an episode that failed.
    pub largest: f64,
    /// Whether a termination or a fault ended it.
    pub failed: bool,
}

/// How traces are judged.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Judge {
    /// Control steps of the horizon, and of the tail.
    pub steps: [u32; 2],
    /// By how much a reward in the tail counts.
    pub share: f64,
    /// Price of failing at the beginning of the tail, in steps of the largest reward.
    pub price: f64,
}

impl Judge {
    /// The value of each trace; greater is better.
    pub fn values(&self, traces: &[Trace]) -> Vec<f64> {
        let unit = traces.iter().map(|trace| trace.largest).fold(0.0, f64::at_least);
        // Without any reward only failing tells plans apart.
        let unit = if unit > 0.0 { unit } else { 1.0 };
        traces.iter().map(|trace| self.value(trace, unit)).collect()
    }

    fn value(&self, trace: &Trace, unit: f64) -> f64 {
        let [horizon, tail] = self.steps.map(f64::from);
        let reward = trace.rewards[0] + self.share * trace.rewards[1];
        if !trace.failed {
            return reward;
        }
        let taken = f64::from(trace.steps);
        if taken > horizon {
            let left = 1.0 - (taken - horizon) / (tail + 1.0);
            return reward - unit * self.price * left;
        }
        // No reward is larger than `unit`, so that surviving a step more outweighs whatever it brings.
        reward - unit * (2.0 * horizon + self.share * tail + self.price + 2.0 * (horizon - taken))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const JUDGE: Judge = Judge { steps: [10, 5], share: 0.5, price: 10.0 };

    fn trace(rewards: [f64; 2], steps: u32, failed: bool) -> Trace {
        Trace { rewards, steps, largest: 1.0, failed }
    }

    #[test]
    fn failing_is_worse_than_the_worst_that_survives() {
        let worst = trace([-10.0, -5.0], 15, false);
        let rich = trace([9.0, 0.0], 9, true);
        let values = JUDGE.values(&[worst, rich]);
        assert!(values[0] > values[1], "{values:?}");
    }

    #[test]
    fn failing_later_is_better_whatever_it_earns() {
        let values: Vec<f64> =
            JUDGE.values(&[trace([3.0, 0.0], 3, true), trace([2.0, 0.0], 4, true), trace([1.0, 0.0], 5, true)]);
        assert!(values[0] < values[1] && values[1] < values[2], "{values:?}");
        let same = JUDGE.values(&[trace([3.0, 0.0], 7, true), trace([2.0, 0.0], 7, true)]);
        assert!(same[0] > same[1], "{same:?}");
    }

    #[test]
    fn failing_in_the_tail_costs_less_towards_its_end() {
        let values = JUDGE.values(&[11, 12, 15].map(|steps| trace([5.0, 0.0], steps, true)));
        let survivor = JUDGE.values(&[trace([5.0, 0.0], 15, false)])[0];
        assert!(values[0] < values[1] && values[1] < values[2] && values[2] < survivor, "{values:?} {survivor}");
        assert!(values[0] > JUDGE.values(&[trace([5.0, 0.0], 10, true)])[0]);
    }

    #[test]
    fn an_end_that_is_no_failure_keeps_what_it_has_earned() {
        assert_eq!(JUDGE.values(&[trace([4.0, 0.0], 4, false)]), [4.0]);
        assert_eq!(JUDGE.values(&[Trace::default()]), [0.0]);
    }
}

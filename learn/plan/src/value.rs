//! What an imagined episode is worth.
//!
//! The reward of the horizon counts once, that of the tail, which stands for all that comes later, with a weight. An end from which a fall is
//! likely costs, the more the further the capture point is from where it is safe. Failing is priced in steps of the largest reward in sight:
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
    /// Sum of the sizes of all these.
    pub sizes: f64,
    /// Whether a termination or a fault ended it.
    pub failed: bool,
    /// By how much the capture point missed its place well within the support at the end, m; zero if an ending of the task came first.
    pub imbalance: f64,
}

/// By how much the capture point may miss its place before more of it costs no more, m.
pub const IMBALANCE: f64 = 0.3;

/// What prices are measured by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Units {
    /// The largest size of a reward in sight: failing costs more than any.
    pub largest: f64,
    /// The mean size: a rare large reward does not change what balance is worth.
    pub usual: f64,
}

impl Units {
    /// Those of the traces of a round; 1 without any reward, where only failing tells plans apart.
    pub fn of(traces: &[Trace]) -> Self {
        let largest = traces.iter().map(|trace| trace.largest).fold(0.0, f64::at_least);
        let steps: f64 = traces.iter().map(|trace| f64::from(trace.steps)).sum();
        let usual = traces.iter().map(|trace| trace.sizes).sum::<f64>() / steps.at_least(1.0);
        if usual > 0.0 { Self { largest, usual } } else { Self { largest: 1.0, usual: 1.0 } }
    }
}

/// What a plan asks for, beside what comes of it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Asked {
    /// How far it is from asking for nothing, 0 to 1.
    pub change: f64,
    /// How far a body that walks leaves the way straight ahead, 0 to 1.
    pub astray: f64,
    /// Whether it is neither the present plan nor that one straight on.
    pub other: bool,
}

/// How traces are judged.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Judge {
    /// Control steps of the horizon, and of the tail.
    pub steps: [u32; 2],
    /// How many times a reward in the tail counts.
    pub tail_weight: f64,
    /// Price of failing at the beginning of the tail, in steps of the largest reward.
    pub failure_price: f64,
    /// Price of an [`IMBALANCE`] at the end, in steps of the usual reward.
    pub balance_price: f64,
    /// How much better another plan has to be than the present one, in steps of the usual reward.
    pub stay_price: f64,
    /// Price of a pace that goes aside and turns as fast as it can, in steps of the usual reward.
    pub stray_price: f64,
    /// Price of a plan whose entries are all at the ends of their ranges, in steps of the usual reward.
    pub change_price: f64,
}

impl Judge {
    /// The value of each trace, whose plan has asked for so much; greater is better.
    pub fn values(&self, traces: &[Trace], asked: &[Asked]) -> Vec<f64> {
        let units = Units::of(traces);
        let [change, stray, stay] = [self.change_price, self.stray_price, self.stay_price].map(|price| units.usual * price);
        let value = |(trace, asked): (&Trace, &Asked)| {
            self.value(trace, units) - change * asked.change - if asked.other { stay } else { 0.0 } - stray * asked.astray
        };
        traces.iter().zip(asked).map(value).collect()
    }

    fn value(&self, trace: &Trace, units: Units) -> f64 {
        let Self { tail_weight, failure_price, balance_price, .. } = *self;
        let [horizon, tail] = self.steps.map(f64::from);
        let reward = trace.rewards[0] + tail_weight * trace.rewards[1];
        if !trace.failed {
            return reward - units.usual * balance_price * (trace.imbalance / IMBALANCE).at_most(1.0);
        }
        let unit = units.largest;
        let taken = f64::from(trace.steps);
        if taken > horizon {
            let missing = horizon + tail - taken;
            let left = (missing + 1.0) / (tail + 1.0);
            return reward - unit * (failure_price * left + tail_weight * missing + balance_price);
        }
        // No reward is larger than `unit`, so that surviving a step more outweighs whatever it brings.
        let worst = 2.0 * horizon + tail_weight * tail + failure_price + balance_price;
        reward - unit * (worst + 2.0 * (horizon - taken))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const JUDGE: Judge = Judge {
        steps: [10, 5],
        tail_weight: 0.5,
        failure_price: 10.0,
        balance_price: 4.0,
        stay_price: 0.0,
        stray_price: 0.0,
        change_price: 0.0,
    };

    const ONE: Units = Units { largest: 1.0, usual: 1.0 };

    fn trace(rewards: [f64; 2], steps: u32, failed: bool) -> Trace {
        Trace { rewards, steps, largest: 1.0, sizes: f64::from(steps), failed, imbalance: 0.0 }
    }

    fn judged(traces: &[Trace]) -> Vec<f64> {
        JUDGE.values(traces, &vec![Asked::default(); traces.len()])
    }

    #[test]
    fn of_two_plans_that_earn_the_same_the_smaller_one_is_better() {
        let judge = Judge { change_price: 2.0, ..JUDGE };
        let same = [trace([5.0, 0.0], 15, false); 2];
        let asked = [0.25, 0.0].map(|change| Asked { change, ..Asked::default() });
        assert_eq!(judge.values(&same, &asked), [4.5, 5.0]);
    }

    #[test]
    fn another_plan_has_to_be_better_by_the_price_of_leaving_the_present_one() {
        let judge = Judge { stay_price: 0.5, ..JUDGE };
        let traces = [trace([5.0, 0.0], 15, false), trace([5.75, 0.0], 15, false)];
        let asked = [false, true].map(|other| Asked { other, ..Asked::default() });
        assert_eq!(judge.values(&traces, &asked), [5.0, 5.25]);
    }

    #[test]
    fn of_two_paces_that_earn_the_same_the_one_straight_on_is_better() {
        let judge = Judge { stray_price: 0.5, ..JUDGE };
        let asked = [0.5, 0.0].map(|astray| Asked { astray, ..Asked::default() });
        assert_eq!(judge.values(&[trace([5.0, 0.0], 15, false); 2], &asked), [4.75, 5.0]);
    }

    #[test]
    fn a_rare_large_reward_changes_what_failing_costs_and_not_what_balance_does() {
        let rich = Trace { largest: 100.0, sizes: 15.0, ..trace([5.0, 0.0], 15, false) };
        let poor = Trace { imbalance: 0.3, ..trace([5.0, 0.0], 15, false) };
        assert_eq!(judged(&[rich, poor]), [5.0, 1.0]);
    }

    #[test]
    fn failing_is_worse_than_the_worst_that_survives() {
        let worst = trace([-10.0, -5.0], 15, false);
        let rich = trace([9.0, 0.0], 9, true);
        let values = judged(&[worst, rich]);
        assert!(values[0] > values[1], "{values:?}");
    }

    #[test]
    fn failing_later_is_better_whatever_it_earns() {
        let values: Vec<f64> = judged(&[trace([3.0, 0.0], 3, true), trace([2.0, 0.0], 4, true), trace([1.0, 0.0], 5, true)]);
        assert!(values[0] < values[1] && values[1] < values[2], "{values:?}");
        let same = judged(&[trace([3.0, 0.0], 7, true), trace([2.0, 0.0], 7, true)]);
        assert!(same[0] > same[1], "{same:?}");
    }

    #[test]
    fn failing_in_the_tail_costs_less_towards_its_end() {
        let values = judged(&[11, 12, 15].map(|steps| trace([5.0, 0.0], steps, true)));
        let survivor = judged(&[trace([5.0, 0.0], 15, false)])[0];
        assert!(values[0] < values[1] && values[1] < values[2] && values[2] < survivor, "{values:?} {survivor}");
        assert!(values[0] > judged(&[trace([5.0, 0.0], 10, true)])[0]);
    }

    #[test]
    fn an_unbalanced_end_costs_up_to_its_price_and_less_than_failing() {
        let values =
            [0.0, 0.15, 0.3, 5.0].map(|imbalance| JUDGE.value(&Trace { imbalance, ..trace([5.0, 2.0], 15, false) }, ONE));
        assert_eq!(values, [6.0, 4.0, 2.0, 2.0]);
        assert!(values[3] > JUDGE.value(&trace([5.0, 2.0], 15, true), ONE));
    }

    #[test]
    fn an_end_that_is_no_failure_keeps_what_it_has_earned() {
        assert_eq!(judged(&[trace([4.0, 0.0], 4, false)]), [4.0]);
        assert_eq!(judged(&[Trace::default()]), [0.0]);
    }
}

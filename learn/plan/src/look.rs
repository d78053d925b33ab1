//! Which targets plans move: before the first plan of an episode, and now and again while the body walks, each choice is imagined by itself for some
//! seconds.

use crate::curve::Curve;
use crate::imagine::{Extent, Imaginer, Present, Proposal};
use crate::settings::{Settings, Targets};
use crate::space::Space;
use crate::value::Trace;
use msk_runtime::policy::PolicyContext;
use std::sync::atomic::AtomicBool;

/// The fastest pace forward.
const FASTEST: [f64; 3] = [1.0, 0.0, 0.0];

/// Those at which a fast gait is imagined.
const FAST_PACES: [[f64; 3]; 4] = [[0.7, 0.0, 0.0], [0.8, 0.0, 0.0], [0.9, 0.0, 0.0], FASTEST];

/// Paces at which a gait is imagined, as shares of the largest: forward, left, turn.
const PACES: [[f64; 3]; 16] = [
    [0.0, 0.0, 0.0],
    [0.3, 0.0, 0.0],
    [0.5, 0.0, 0.0],
    [0.6, 0.0, 0.0],
    [0.7, 0.0, 0.0],
    [0.8, 0.0, 0.0],
    FASTEST,
    [-0.3, 0.0, 0.0],
    [-0.6, 0.0, 0.0],
    [0.0, 0.7, 0.0],
    [0.0, -0.7, 0.0],
    [0.5, 0.0, 0.7],
    [0.5, 0.0, -0.7],
    [0.7, 0.0, 0.3],
    [0.7, 0.0, -0.3],
    [0.0, 0.0, 0.7],
];

/// What plans may move, a plan in it, and what was asked for in the last control step.
#[derive(Debug, Clone)]
pub(crate) struct Choice {
    pub space: Space,
    pub plan: Curve,
    pub entries: Vec<f64>,
}

impl Choice {
    /// Whether its plan asks for a pace, as shares of the largest.
    fn asks_for(&self, pace: [f64; 3]) -> bool {
        self.space.walks() && self.plan.values.get(self.space.pace()) == Some(&pace)
    }
}

/// A comparison of choices from the present on.
pub(crate) struct Look<'a> {
    pub context: &'a PolicyContext<'a>,
    pub imaginer: &'a Imaginer,
    pub settings: &'a Settings,
    /// How plans are imagined.
    pub extent: Extent,
    /// Control steps that are imagined of each choice; 0 to make none.
    pub steps: u32,
    pub stop: &'a AtomicBool,
}

impl Look<'_> {
    /// The space that serves best at the start of an episode, and the plan to begin with: `first`, the demonstration's or a gait's, as far as settings
    /// and the task leave them open. Of two that earn the same the one that stands first here is taken.
    ///
    /// # Errors
    /// As with [`Space::new`].
    pub fn choose(&self, first: Space) -> Result<Choice, String> {
        let Settings { targets, .. } = self.settings;
        let mut choices = vec![self.idle(first)];
        if self.steps > 0 {
            choices.extend(self.demonstrated()?.map(|space| self.idle(space)));
            choices.extend(self.walking(targets, &PACES));
        }
        let worths = self.worths(&choices, KEPT);
        // Of those that are worth the same the first; where the run is to stop, none was imagined to its end.
        let mut best = 0;
        for (index, worth) in worths.iter().enumerate() {
            // A gait that serves as well as a pose steps wherever its hands lead it.
            let Choice { space, .. } = &choices[index];
            let steps = space.walks() && space.reaches() && !choices[best].space.walks();
            if *worth > worths[best] || (steps && worth.is_about(&worths[best])) {
                best = index;
            }
        }
        let (best, worth) = (choices.swap_remove(best), worths[best]);
        Ok(self.faster(&best, &worth).unwrap_or(best))
    }

    /// A fast gait, where the fastest of usual paces is the best choice, and that is much better. It neither turns nor stops well, and falls on slopes and
    /// stairs, so it has to last for longer, on level ground.
    fn faster(&self, best: &Choice, worth: &Worth) -> Option<Choice> {
        let Settings { targets, .. } = self.settings;
        let [forward, left, turn] = targets.pace;
        let level = self.context.body.ground == self.context.body.level;
        if !best.asks_for(FASTEST) || targets.fast <= forward || !level {
            return None;
        }
        let mut fast = Targets { pace: [targets.fast, left, turn], ..targets.clone() };
        // It loses its balance where its trunk is bent.
        if targets.joints.is_empty() {
            (fast.joint_range, fast.arm_range) = (0.0, 0.0);
        }
        let mut choices = self.walking(&fast, &FAST_PACES);
        let worths = Self { steps: FAST_LOOKS * self.steps, ..*self }.worths(&choices, KEPT);
        let much = worths.iter().enumerate().filter(|(_, other)| other.is_more_than(worth, FASTER));
        let (fastest, _) = much.max_by(|(_, a), (_, b)| a.reward.total_cmp(&b.reward))?;
        Some(choices.swap_remove(fastest))
    }

    /// The demonstration from some time of it on, if it serves a body better that walks in `present` than to go on. A gait can stand by itself.
    pub fn again(&self, present: Choice) -> Option<Choice> {
        // What cannot be followed from here, though it could at the start of the episode, is no choice.
        let shown = self.demonstrated().ok().flatten()?;
        let length = Space::demonstration_length(self.context);
        let starts = (1..=PARTS).map(|part| length * f64::from(part) / f64::from(PARTS));
        let parts = starts.map(|start| self.idle(shown.clone().gone_on_from(start)));
        let mut choices: Vec<Choice> = [present].into_iter().chain(parts).collect();
        // From what a body changes over to there is no way back, so it has to last.
        let worths = self.worths(&choices, 1.0);
        let mut best = 0;
        for (index, worth) in worths.iter().enumerate() {
            if *worth > worths[best] && worth.is_more_than(&worths[0], MUCH) {
                best = index;
            }
        }
        (best > 0).then(|| choices.swap_remove(best))
    }

    /// A plan that asks for nothing.
    fn idle(&self, space: Space) -> Choice {
        let Settings { knots, interpolation, .. } = *self.settings;
        let (size, rest) = (space.size(self.context), space.rest());
        // One knot more than the horizon has, so that it can move on between them.
        Choice { space, plan: Curve::constant(rest, knots + 1, size, interpolation), entries: vec![rest; size] }
    }

    /// The demonstration, if it may be followed.
    fn demonstrated(&self) -> Result<Option<Space>, String> {
        Space::demonstrated(self.context, self.settings.space, &self.settings.targets)
    }

    /// The gait of these targets at constant paces, where the body may walk.
    fn walking(&self, targets: &Targets, paces: &[[f64; 3]]) -> Vec<Choice> {
        let space = Space::walking(self.context, self.settings.space, targets);
        space.map_or_else(Vec::new, |space| paces.iter().map(|&pace| self.paced(&space, pace)).collect())
    }

    /// A gait at a constant pace.
    fn paced(&self, space: &Space, pace: [f64; 3]) -> Choice {
        let (mut choice, mut speeds) = (self.idle(space.clone()), pace.into_iter());
        choice.plan.hold(space.pace(), || speeds.next().unwrap_or(0.0));
        choice
    }

    /// What choices are worth, where a pose lasts that does so for that share of the look; the only one that there is need not be imagined.
    fn worths(&self, choices: &[Choice], kept: f64) -> Vec<Worth> {
        if choices.len() == 1 {
            return vec![Worth::default()];
        }
        let proposals: Vec<Proposal<'_>> =
            choices.iter().map(|Choice { space, plan, entries }| Proposal { space, entries, plan }).collect();
        let horizon = self.extent.steps[0].min(self.steps);
        let extent = Extent { steps: [horizon, self.steps - horizon], ..self.extent };
        let present = Present { context: *self.context, name: "plan/look" };
        let traces = self.imaginer.play(&present, &proposals, extent, self.stop).unwrap_or_default();
        let worth = |(trace, choice): (&Trace, &Choice)| {
            // Plans keep up a pose that falls late; what a gait is when it falls, they see too late.
            let enough = if choice.space.walks() { self.steps } else { (kept * f64::from(self.steps)) as u32 };
            Worth::of(trace, enough)
        };
        let mut worths: Vec<Worth> = traces.iter().zip(choices).map(worth).collect();
        worths.resize(choices.len(), Worth::default());
        let walking = || choices.iter().map(|choice| choice.space.walks());
        let lasting = worths.iter().zip(walking()).filter(|(worth, walks)| *walks && worth.lasts).count();
        if LASTING * lasting < walking().filter(|walks| *walks).count() {
            // One pace among many that fall was lucky.
            let lucky = worths.iter_mut().zip(walking()).filter(|(worth, walks)| *walks && worth.lasts);
            lucky.for_each(|(worth, _)| (worth.lasts, worth.steps) = (false, self.steps));
        }
        worths
    }
}

/// What lasts is worth more than what fails, what fails later more, and else reward decides.
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd)]
struct Worth {
    lasts: bool,
    /// Control steps of what does not last.
    steps: u32,
    /// For each step.
    reward: f64,
}

/// For which share of the look a pose lasts by itself that lasts under plans.
const KEPT: f64 = 0.6;

/// Of a gait that can be relied on one in so many paces lasts.
const LASTING: usize = 2;

/// Rewards that differ by this share are about the same.
const ABOUT: f64 = 0.02;

/// By which share of its reward something else has to be better than to walk on, from which there is no way back, and a fast gait than a usual one.
const MUCH: f64 = 0.5;
const FASTER: f64 = 0.3;

/// For how many looks a fast gait has to last.
const FAST_LOOKS: u32 = 2;

/// Times of a demonstration from which a body may go on that has walked: so many, evenly over its length. With walking on they fit one group of lanes.
const PARTS: u32 = 6;

impl Worth {
    /// Whether it is worth about as much as another.
    fn is_about(&self, other: &Self) -> bool {
        let near = (self.reward - other.reward).abs() <= ABOUT * other.reward.abs();
        (self.lasts, self.steps) == (other.lasts, other.steps) && near
    }

    /// Whether it lasts, and earns more than another by a share of that.
    fn is_more_than(&self, other: &Self, share: f64) -> bool {
        self.lasts && self.reward - other.reward > share * other.reward.abs()
    }

    /// Of a trace that lasts if it does not fail within so many control steps.
    fn of(trace: &Trace, enough: u32) -> Self {
        let lasts = !trace.failed || trace.steps > enough;
        let reward = (trace.rewards[0] + trace.rewards[1]) / f64::from(trace.steps.max(1));
        Self { lasts, steps: if lasts { 0 } else { trace.steps }, reward }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worth(failed: bool, steps: u32, reward: f64) -> Worth {
        Worth::of(&Trace { failed, steps, rewards: [reward, 0.0], ..Trace::default() }, 60)
    }

    #[test]
    fn what_lasts_is_worth_more_than_what_earns_more_and_falls() {
        assert!(worth(false, 100, 10.0) > worth(true, 50, 100.0));
        assert!(worth(true, 50, 1.0) > worth(true, 40, 100.0));
    }

    #[test]
    fn what_falls_late_lasts_and_is_worth_what_it_earns_in_a_step() {
        assert!(worth(true, 80, 100.0) > worth(false, 100, 110.0));
        assert!(worth(true, 60, 100.0) < worth(false, 100, 110.0));
    }
}

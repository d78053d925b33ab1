//! Which targets plans move: before the first plan of an episode each choice is imagined by itself for some seconds.

use crate::curve::Curve;
use crate::imagine::{Extent, Imaginer, Present};
use crate::settings::Settings;
use crate::space::Space;
use crate::value::Trace;
use msk_runtime::policy::PolicyContext;
use std::sync::atomic::AtomicBool;

/// Paces at which a gait is imagined, as shares of the largest: forward, left, turn.
const PACES: [[f64; 3]; 16] = [
    [0.0, 0.0, 0.0],
    [0.3, 0.0, 0.0],
    [0.5, 0.0, 0.0],
    [0.6, 0.0, 0.0],
    [0.7, 0.0, 0.0],
    [0.8, 0.0, 0.0],
    [1.0, 0.0, 0.0],
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

/// A comparison of choices at the start of an episode.
pub(crate) struct Look<'a> {
    pub context: &'a PolicyContext<'a>,
    pub imaginer: &'a Imaginer,
    /// How plans are imagined.
    pub extent: Extent,
    /// Control steps that are imagined of each choice; 0 to make none.
    pub steps: u32,
    pub stop: &'a AtomicBool,
}

impl Look<'_> {
    /// The space that serves best, and the plan to begin with: `first`, the demonstration's or a gait's, as far as settings and the task leave them
    /// open. Of two that earn the same the one that stands first here is taken.
    ///
    /// # Errors
    /// As with [`Space::new`].
    pub fn choose(&self, first: Space, settings: &Settings) -> Result<(Space, Curve), String> {
        let idle = |space: &Space| {
            // One knot more than the horizon has, so that it can move on between them.
            Curve::constant(space.rest(self.context), settings.knots + 1, space.size(self.context), settings.interpolation)
        };
        if self.steps == 0 {
            let plan = idle(&first);
            return Ok((first, plan));
        }
        let shown = Space::demonstrated(self.context, settings.space, &settings.targets)?;
        let walking = Space::walking(self.context, settings.space, &settings.targets);
        let plan = idle(&first);
        if shown.is_none() && walking.is_none() {
            return Ok((first, plan));
        }
        let mut choices = vec![(first, vec![plan])];
        choices.extend(shown.map(|space| {
            let plan = idle(&space);
            (space, vec![plan])
        }));
        choices.extend(walking.map(|space| {
            let paced = |pace: [f64; 3]| {
                let (mut plan, mut speeds) = (idle(&space), pace.into_iter());
                plan.hold(space.pace(), || speeds.next().unwrap_or(0.0));
                plan
            };
            let plans = PACES.map(paced).to_vec();
            (space, plans)
        }));
        // Of those that are worth the same the first; where the run is to stop, none was imagined to its end.
        let (mut best, mut chosen) = (Worth::default(), (0, 0));
        for (choice, (space, plans)) in choices.iter().enumerate() {
            for (plan, worth) in self.worths(space, plans).into_iter().enumerate() {
                // A gait that serves as well as a pose steps wherever its hands lead it.
                let steps = space.walks() && space.reaches() && !choices[chosen.0].0.walks();
                let goes_on = steps && worth.is_about(&best);
                if worth > best || goes_on {
                    (best, chosen) = (worth, (choice, plan));
                }
            }
        }
        let (choice, plan) = chosen;
        let (space, mut plans) = choices.swap_remove(choice);
        Ok((space, plans.swap_remove(plan)))
    }

    /// What the plans of a space are worth.
    fn worths(&self, space: &Space, plans: &[Curve]) -> Vec<Worth> {
        let entries = vec![self.extent.rest; space.size(self.context)];
        let present = Present { context: *self.context, space, entries: &entries, name: "plan/look" };
        let traces = self.imaginer.play(&present, plans, Extent { steps: [self.steps, 0], ..self.extent }, self.stop);
        // Plans keep up a pose that falls late; what a gait is when it falls, they see too late.
        let enough = if space.walks() { self.steps } else { (KEPT * f64::from(self.steps)) as u32 };
        let mut worths: Vec<Worth> = traces.unwrap_or_default().iter().map(|trace| Worth::of(trace, enough)).collect();
        let lasting = worths.iter().filter(|worth| worth.lasts).count();
        if LASTING * lasting < worths.len() {
            // One pace among many that fall was lucky.
            worths.iter_mut().filter(|worth| worth.lasts).for_each(|worth| (worth.lasts, worth.steps) = (false, self.steps));
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

impl Worth {
    /// Whether it is worth about as much as another.
    fn is_about(&self, other: &Self) -> bool {
        let near = (self.reward - other.reward).abs() <= ABOUT * other.reward.abs();
        (self.lasts, self.steps) == (other.lasts, other.steps) && near
    }

    /// Of a trace that lasts if it does not fail within so many control steps.
    fn of(trace: &Trace, enough: u32) -> Self {
        let lasts = !trace.failed || trace.steps > enough;
        let reward = trace.rewards[0] / f64::from(trace.steps.max(1));
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

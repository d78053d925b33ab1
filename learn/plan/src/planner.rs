//! The policy: plan, act on the first part of the plan, plan anew.

use crate::curve::Curve;
use crate::imagine::{Extent, Imaginer, Present, Proposal};
use crate::look::{Choice, Look};
use crate::proposal::Noise;
use crate::search::Search;
use crate::settings::Settings;
use crate::space::Space;
use crate::value::{Asked, Judge};
use msk_runtime::action::{ControlMemory, Controls, follow_share};
use msk_runtime::episode::{Engine, Stream};
use msk_runtime::policy::{ActsOn, Policy, PolicyContext, PolicyError};
use std::sync::atomic::AtomicBool;

/// Receding-horizon search on the reward of the task.
pub struct Planner<'a> {
    name: String,
    settings: Settings,
    stop: &'a AtomicBool,
    present: Option<Planning>,
}

/// What planning in an episode takes.
struct Planning {
    /// The model, to tell episodes of other tasks.
    engine: Engine,
    imaginer: Imaginer,
    /// As they are given.
    settings: Settings,
    followed: Followed,
    /// The control step of the last look, or until which none is taken.
    looked: u32,
    memory: ControlMemory,
}

/// What is followed, and how it is planned.
struct Followed {
    space: Space,
    search: Search,
    /// Those of its space.
    settings: Settings,
    judge: Judge,
    extent: Extent,
    /// The entry that asks for nothing.
    rest: f64,
    /// When the plan was made, in control steps.
    planned: Option<u32>,
    /// What the plan asks for now, and what is done about it.
    asked: Vec<f64>,
    entries: Vec<f64>,
}

impl<'a> Planner<'a> {
    /// A planner that gives up with [`PolicyError::Interrupted`] when `stop` becomes true.
    pub fn new(name: impl Into<String>, settings: Settings, stop: &'a AtomicBool) -> Self {
        Self { name: name.into(), settings, stop, present: None }
    }

    fn unable(&self, reason: impl ToString) -> PolicyError {
        PolicyError::Unable { policy: self.name.clone(), reason: reason.to_string() }
    }
}

impl Policy for Planner<'_> {
    fn name(&self) -> &str {
        &self.name
    }

    fn acts_on(&self) -> ActsOn {
        self.present.as_ref().map_or(ActsOn::Task, |planning| planning.followed.space.acts_on())
    }

    fn reset(&mut self, context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        let before = self.present.take();
        let planning = Planning::new(context, &self.settings, before, self.stop);
        self.present = Some(planning.map_err(|reason| self.unable(reason))?);
        Ok(())
    }

    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        let Self { stop, present, .. } = self;
        let Some(planning) = present else { return Err(self.unable("it has not been reset")) };
        planning.plan(context, stop)?;
        planning.act(context, action).map_err(|reason| self.unable(reason))
    }
}

impl Planning {
    fn new(context: &PolicyContext<'_>, settings: &Settings, before: Option<Self>, stop: &AtomicBool) -> Result<Self, String> {
        let space = Space::new(context, settings.space, &settings.targets)?;
        if steps(settings.horizon, context.task.control_frequency) == 0 {
            let (horizon, period) = (settings.horizon, context.engine.control_period());
            return Err(format!("its horizon of {horizon} s is shorter than a control step of {period} s"));
        }
        // Memory of the same task is worth keeping.
        let imaginer = match before {
            Some(before) if before.engine.is(context.engine) => before.imaginer,
            _ => Imaginer::new(context.engine.imagining(settings.coarseness).map_err(|error| error.to_string())?),
        };
        let choice = look(context, settings, &imaginer, stop).choose(space)?;
        Ok(Self {
            engine: context.engine.clone(),
            imaginer,
            settings: settings.clone(),
            followed: Followed::new(context, choice, settings),
            looked: context.step + steps(SETTLING, context.task.control_frequency),
            memory: ControlMemory::default(),
        })
    }

    /// Plans where the present plan has been followed for long enough.
    fn plan(&mut self, context: &PolicyContext<'_>, stop: &AtomicBool) -> Result<(), PolicyError> {
        if let Some(planned) = self.followed.planned {
            let since = context.step - planned;
            if since < self.followed.settings.replan {
                return Ok(());
            }
            self.followed.advance(since);
            self.look_again(context, stop);
        }
        let followed = &mut self.followed;
        let rounds = if followed.planned.is_some() { followed.settings.rounds } else { followed.settings.first_rounds };
        let name = format!("plan/{}", context.step);
        // Who follows a motion, or walks, leaves the support on purpose, and is caught by the next step.
        let stands = context.task.followed(context.progress).is_none() && !followed.space.walks();
        let extent = Extent { balance: stands && followed.settings.balance_price > 0.0, ..followed.extent };
        for round in 0..rounds {
            let plans = followed.proposals(context, round);
            let Followed { space, entries, .. } = &*followed;
            let proposals: Vec<Proposal<'_>> = plans.iter().map(|plan| Proposal { space, entries, plan }).collect();
            let present = Present { context: *context, name: &name };
            let traces = self.imaginer.play(&present, &proposals, extent, stop).ok_or(PolicyError::Interrupted)?;
            let values = followed.judge.values(&traces, &followed.asked_by(&plans));
            followed.search.update(&plans, &values, &followed.settings);
        }
        followed.planned = Some(context.step);
        Ok(())
    }

    /// Changes over, where the body walks and it is time to ask, to what serves better than to walk on.
    fn look_again(&mut self, context: &PolicyContext<'_>, stop: &AtomicBool) {
        let again = steps(self.settings.look_again, context.task.control_frequency);
        if !self.followed.space.walks() || again == 0 || context.step.saturating_sub(self.looked) < again {
            return;
        }
        self.looked = context.step;
        let better = look(context, &self.settings, &self.imaginer, stop).again(self.followed.choice());
        if let Some(better) = better {
            self.followed = Followed::new(context, better, &self.settings);
        }
    }

    /// Writes the action of the present step.
    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), String> {
        match self.followed.take(context.step, action) {
            Some((controls, entries)) => {
                controls.act(context, entries, &mut self.memory, action).map_err(|error| error.to_string())
            }
            None => Ok(()),
        }
    }
}

impl Followed {
    /// Begins with a choice.
    fn new(context: &PolicyContext<'_>, choice: Choice, given: &Settings) -> Self {
        let Choice { space, plan, entries } = choice;
        let frequency = context.task.control_frequency;
        let walks = space.walks();
        let settings = if walks { given.walking(|time| steps(time, frequency)) } else { given.clone() };
        let extent = extent(context, &settings);
        let sight = f64::from(extent.steps[0] + extent.steps[1]);
        Self {
            search: Search::around(plan, &settings),
            judge: Judge {
                steps: extent.steps,
                tail_weight: settings.tail_weight,
                failure_price: settings.failure_price * frequency,
                balance_price: settings.balance_price * frequency,
                // A body that changes its pace for next to nothing stumbles.
                stay_price: if walks { STAY * sight } else { 0.0 },
                stray_price: if walks { ASTRAY * sight } else { 0.0 },
                change_price: settings.change_price * f64::from(extent.steps[0]),
            },
            rest: space.rest(),
            space,
            settings,
            extent,
            planned: None,
            asked: entries.clone(),
            entries,
        }
    }

    /// What it is at present.
    fn choice(&self) -> Choice {
        Choice { space: self.space.clone(), plan: self.search.plan.clone(), entries: self.entries.clone() }
    }

    /// Goes on by so many control steps.
    fn advance(&mut self, steps: u32) {
        let share = f64::from(steps) / f64::from(self.extent.steps[0]);
        self.search.advance(share, self.rest, &self.settings);
    }

    /// What the plans of a round ask for. One that goes straight on where the present one does not is no other: a body that has come to go aside or
    /// to turn for next to nothing stops doing so.
    fn asked_by(&self, plans: &[Curve]) -> Vec<Asked> {
        let asked = plans.iter().enumerate().map(|(index, plan)| Asked {
            change: plan.mean_square(self.rest),
            astray: plan.mean_distance(self.space.astray(), self.rest),
            other: ![PRESENT, SETTLED].contains(&index),
        });
        asked.collect()
    }

    /// The plans of a round: the present one, none at all, the mean of good ones, the present one as it fades or, of a body that walks, straight on, and
    /// proposals around these.
    fn proposals(&self, context: &PolicyContext<'_>, round: u32) -> Vec<Curve> {
        let (settings, Search { plan, mean, deviation }) = (&self.settings, &self.search);
        let walks = self.space.walks();
        let settled = if walks { plan.without(self.space.astray(), self.rest) } else { plan.fading(self.rest) };
        let idle = Curve { values: vec![self.rest; plan.values.len()], ..plan.clone() };
        let noise = Noise { colour: settings.colour, part: settings.part };
        let own = if settings.seed == 0 { String::new() } else { format!("seed {}/", settings.seed) };
        let around = [plan, mean, plan, mean, plan, mean, plan, &idle];
        let mut plans = vec![plan.clone(), idle.clone(), mean.clone(), settled];
        plans.extend((4..settings.samples).map(|index| {
            let mut stream = Stream::new(context.key, &format!("policy/plan/{own}{}/{round}/{index}", context.step));
            let mut plan = noise.propose(index, around[index % around.len()], deviation, &mut stream);
            if index % 4 == 1 {
                plan.hold(self.space.pace(), || 2.0 * stream.uniform() - 1.0);
            }
            if index % 8 == 1 {
                plan.hold(self.space.astray(), || self.rest);
            }
            plan
        }));
        plans
    }

    /// What the plan asks for at a control step: an action, or entries of the controls that have to act.
    fn take(&mut self, step: u32, action: &mut [f64]) -> Option<(&mut Controls, &[f64])> {
        let since = step - self.planned.unwrap_or(step);
        self.search.plan.at(f64::from(since) / f64::from(self.extent.steps[0]), &mut self.asked);
        self.extent.smooth(&self.asked, &mut self.entries);
        self.space.take(&self.entries, action)
    }
}

/// A look from the present on.
fn look<'a>(context: &'a PolicyContext<'a>, settings: &'a Settings, imaginer: &'a Imaginer, stop: &'a AtomicBool) -> Look<'a> {
    let steps = steps(settings.look, context.task.control_frequency);
    Look { context, imaginer, settings, extent: extent(context, settings), steps, stop }
}

/// How plans of these settings are imagined.
fn extent(context: &PolicyContext<'_>, settings: &Settings) -> Extent {
    let in_steps = |time: f64| steps(time, context.task.control_frequency);
    let Settings { horizon, tail, hold, rough, avoid_success, .. } = *settings;
    Extent {
        steps: [horizon, tail].map(in_steps),
        hold: in_steps(hold).max(1),
        rough,
        avoid_success,
        balance: false,
        follow: follow_share(context.engine.control_period(), settings.smooth),
    }
}

/// For how long the first plans of an episode improve before they are compared with anything else, s.
const SETTLING: f64 = 1.0;

/// By which share of the reward in sight another pace has to be better than the present one.
const STAY: f64 = 0.1;

/// By which share of it a pace has to be better that goes aside and turns as fast as it can than one straight on: what it leads to lies out of sight.
const ASTRAY: f64 = 0.03;

/// Places among the plans of a round: of the present one, and of what is closest to it and asks for less.
const PRESENT: usize = 0;
const SETTLED: usize = 3;

/// Control steps that come nearest to a time, s.
fn steps(time: f64, frequency: f64) -> u32 {
    // Settings bound the time, the checker the frequency.
    (time * frequency).round() as u32
}

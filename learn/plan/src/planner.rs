//! The policy: plan, act on the first part of the plan, plan anew.

use crate::curve::Curve;
use crate::imagine::{Extent, Imaginer, Present};
use crate::look::Look;
use crate::proposal::Noise;
use crate::search::Search;
use crate::settings::Settings;
use crate::space::Space;
use crate::value::Judge;
use msk_runtime::action::{ControlMemory, follow_share};
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
    space: Space,
    search: Search,
    /// Those of its space.
    settings: Settings,
    judge: Judge,
    extent: Extent,
    /// When the plan was made, in control steps.
    planned: Option<u32>,
    /// What the plan asks for now, and what is done about it.
    asked: Vec<f64>,
    entries: Vec<f64>,
    memory: ControlMemory,
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
        self.present.as_ref().map_or(ActsOn::Task, |planning| planning.space.acts_on())
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
        let rest = space.rest(context);
        let in_steps = |time: f64| steps(time, context.task.control_frequency);
        if in_steps(settings.horizon) == 0 {
            let (horizon, period) = (settings.horizon, context.engine.control_period());
            return Err(format!("its horizon of {horizon} s is shorter than a control step of {period} s"));
        }
        let follow = follow_share(context.engine.control_period(), settings.smooth);
        // Memory of the same task is worth keeping.
        let imaginer = match before {
            Some(before) if before.engine.is(context.engine) => before.imaginer,
            _ => Imaginer::new(context.engine.imagining(settings.coarseness).map_err(|error| error.to_string())?),
        };
        let hold = in_steps(settings.hold).max(1);
        let extent = |settings: &Settings| {
            let Settings { horizon, tail, rough, avoid_success, .. } = *settings;
            Extent { steps: [horizon, tail].map(in_steps), hold, rough, avoid_success, balance: false, rest, follow }
        };
        let look = Look { context, imaginer: &imaginer, extent: extent(settings), steps: in_steps(settings.look), stop };
        let (space, plan) = look.choose(space, settings)?;
        let walks = space.walks();
        let settings = if walks { settings.walking(in_steps) } else { settings.clone() };
        let extent = extent(&settings);
        let (width, search) = (space.size(context), Search::around(plan, &settings));
        let sight = f64::from(extent.steps[0] + extent.steps[1]);
        Ok(Self {
            engine: context.engine.clone(),
            imaginer,
            space,
            search,
            judge: Judge {
                steps: extent.steps,
                tail_weight: settings.tail_weight,
                failure_price: settings.failure_price * context.task.control_frequency,
                balance_price: settings.balance_price * context.task.control_frequency,
                // A body that changes its pace for next to nothing stumbles.
                stay_price: if walks { STAY * sight } else { 0.0 },
                change_price: settings.change_price * f64::from(extent.steps[0]),
            },
            settings,
            extent,
            planned: None,
            asked: vec![rest; width],
            entries: vec![rest; width],
            memory: ControlMemory::default(),
        })
    }

    /// Plans where the present plan has been followed for long enough.
    fn plan(&mut self, context: &PolicyContext<'_>, stop: &AtomicBool) -> Result<(), PolicyError> {
        let settings = &self.settings;
        let since = self.planned.map(|planned| context.step - planned);
        let rounds = match since {
            Some(since) if since < settings.replan => return Ok(()),
            Some(since) => {
                let share = f64::from(since) / f64::from(self.extent.steps[0]);
                self.search.advance(share, self.extent.rest, settings);
                settings.rounds
            }
            None => settings.first_rounds,
        };
        let name = format!("plan/{}", context.step);
        // Who follows a motion, or walks, leaves the support on purpose, and is caught by the next step.
        let stands = context.task.followed(context.progress).is_none() && !self.space.walks();
        let extent = Extent { balance: stands && settings.balance_price > 0.0, ..self.extent };
        for round in 0..rounds {
            let plans = self.proposals(context, round);
            let present = Present { context: *context, space: &self.space, entries: &self.entries, name: &name };
            let traces = self.imaginer.play(&present, &plans, extent, stop).ok_or(PolicyError::Interrupted)?;
            let changes: Vec<f64> = plans.iter().map(|plan| plan.mean_square(self.extent.rest)).collect();
            let values = self.judge.values(&traces, &changes);
            self.search.update(&plans, &values, settings);
        }
        self.planned = Some(context.step);
        Ok(())
    }

    /// The plans of a round: the present one, none at all, the mean of good ones, the present one as it fades, and proposals around these.
    fn proposals(&self, context: &PolicyContext<'_>, round: u32) -> Vec<Curve> {
        let (settings, Search { plan, mean, deviation }) = (&self.settings, &self.search);
        let fading = plan.fading(self.extent.rest);
        let idle = Curve { values: vec![self.extent.rest; plan.values.len()], ..plan.clone() };
        let noise = Noise { colour: settings.colour, part: settings.part };
        let own = if settings.seed == 0 { String::new() } else { format!("seed {}/", settings.seed) };
        let around = [plan, mean, plan, mean, plan, mean, plan, &idle];
        let mut plans = vec![plan.clone(), idle.clone(), mean.clone(), fading];
        plans.extend((4..settings.samples).map(|index| {
            let mut stream = Stream::new(context.key, &format!("policy/plan/{own}{}/{round}/{index}", context.step));
            let mut plan = noise.propose(index, around[index % around.len()], deviation, &mut stream);
            if index % 4 == 1 {
                plan.hold(self.space.pace(), || 2.0 * stream.uniform() - 1.0);
            }
            plan
        }));
        plans
    }

    /// Writes the action of the present step.
    fn act(&mut self, context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), String> {
        let since = context.step - self.planned.unwrap_or(context.step);
        self.search.plan.at(f64::from(since) / f64::from(self.extent.steps[0]), &mut self.asked);
        self.extent.smooth(&self.asked, &mut self.entries);
        match self.space.take(&self.entries, action) {
            Some((controls, entries)) => {
                controls.act(context, entries, &mut self.memory, action).map_err(|error| error.to_string())
            }
            None => Ok(()),
        }
    }
}

/// By which share of the reward in sight another pace has to be better than the present one.
const STAY: f64 = 0.1;

/// Control steps that come nearest to a time, s.
fn steps(time: f64, frequency: f64) -> u32 {
    // Settings bound the time, the checker the frequency.
    (time * frequency).round() as u32
}

//! An episode of doing nothing: a task whose reward or success `zero` gets is not learnt.
//!
//! Every muscle rests, whatever the action space, for one episode, to its end or for [`MOST_STEPS`]. That must not succeed. The policy
//! `cmc` holds the pose for as many steps: a task in which resting earns more per step rewards giving up.

use super::at;
use crate::together::{self, LaneRollout};
use msk_compiler::diagnostics::codes::probing;
use msk_compiler::diagnostics::{Diagnostic, Stage, allowance};
use msk_physics::lanes::WIDTH;
use msk_program::numbers::for_people;
use msk_program::task::CompiledTask;
use msk_runtime::action::REST;
use msk_runtime::episode::{Ending, Engine, Episode, EpisodeKey, GroupScratch};
use msk_runtime::library::BodyLibrary;
use msk_runtime::policy::{ActsOn, ComputedMuscleControl, Policy, PolicyContext, PolicyError};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Control steps that are played at most.
const MOST_STEPS: u32 = 3000;

/// Resting earns more than holding the pose if it does by this part of what holding earns.
const MARGIN: f64 = 0.05;

/// Plays an episode of each task at rest, on all cores, and one that holds the pose for as long: what no `allow` covers, and every `allow`
/// of what this looks for that covers nothing. `played` is called after each task.
///
/// Both are played at once, and so are those of tasks on one model.
pub fn episodes(tasks: &[Arc<CompiledTask>], bodies: &BodyLibrary, played: &(dyn Fn() + Sync)) -> Vec<Diagnostic> {
    let threads = rayon::current_num_threads();
    let width = tasks.len().div_ceil(threads).clamp(1, WIDTH / 2);
    let engine = |task: &Arc<CompiledTask>| {
        let staged = bodies.stage(&task.body, &task.scene).ok()?;
        Engine::new(staged.model, staged.body, task.clone()).ok()
    };
    let engines: Vec<Option<Engine>> = tasks.par_iter().map(engine).collect();
    // Those that cannot be played are judged by their absence.
    let known = engines.iter().enumerate().filter_map(|(place, engine)| Some((place, engine.as_ref()?)));
    let (queue, found) = (Mutex::new(known.collect::<VecDeque<_>>()), Mutex::new(vec![None; tasks.len()]));
    let work = |_| {
        let mut claim = |present: Option<&Engine>| {
            let mut queue = queue.lock().unwrap_or_else(PoisonError::into_inner);
            let fits = |engine: &Engine| present.is_none_or(|present| engine.goes_with(present));
            queue.iter().position(|(_, engine)| fits(engine)).and_then(|place| queue.remove(place))
        };
        let mut done = |pair: Pair<'_>| {
            let came = pair.rest().map(|rest| (rest, pair.held()));
            found.lock().unwrap_or_else(PoisonError::into_inner)[pair.task] = came;
            played();
        };
        play(width, &mut claim, &mut done);
    };
    (0..threads).into_par_iter().for_each(work);
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    let judged = tasks.iter().zip(found).map(|(task, found)| {
        let (mut warnings, mut allowances) = (Vec::new(), task.places.allowances.clone());
        match found {
            Some((rest, held)) => judge(task, &rest, held.as_ref(), &mut warnings),
            // Nothing is known of a task that cannot be played, so no `allow` is needless.
            None => allowances.iter_mut().for_each(|allowance| allowance.fulfilled = true),
        }
        allowance::apply(&mut allowances, &mut warnings);
        (warnings, allowances)
    });
    let (warnings, allowances): (Vec<_>, Vec<_>) = judged.unzip();
    let mut found = warnings.concat();
    found.extend(allowance::unfulfilled(allowances.iter().flatten(), Stage::Play));
    found
}

/// Muscles at rest. The policy `zero` gives the entry of the action space that asks for nothing, which may be a controller at work.
struct Resting;

impl Policy for Resting {
    fn name(&self) -> &str {
        "rest"
    }

    fn acts_on(&self) -> ActsOn {
        ActsOn::Muscles
    }

    fn reset(&mut self, _context: &PolicyContext<'_>) -> Result<(), PolicyError> {
        Ok(())
    }

    fn act(&mut self, _context: &PolicyContext<'_>, action: &mut [f64]) -> Result<(), PolicyError> {
        action.fill(REST);
        Ok(())
    }
}

/// What came of an episode.
#[derive(Clone)]
struct Played {
    steps: u32,
    success: bool,
    /// The contribution of each term to the return.
    terms: Vec<f64>,
}

impl Played {
    /// Of an episode that was played; `None` if a fault has ended it.
    fn of(episode: &Episode) -> Option<Self> {
        let (steps, terms) = (episode.steps(), episode.totals().to_vec());
        let whole = steps > 0 && !matches!(episode.ending(), Some(Ending::Fault(_)));
        whole.then(|| Self { steps, success: episode.ending().is_some() && episode.report().success, terms })
    }

    fn per_step(&self, sum: f64) -> f64 {
        sum / f64::from(self.steps)
    }

    fn mean(&self) -> f64 {
        self.per_step(self.terms.iter().sum())
    }
}

/// Looks at one task: what came of resting, and of holding the pose if the policy can act.
fn judge(task: &CompiledTask, rest: &Played, held: Option<&Played>, warnings: &mut Vec<Diagnostic>) {
    if rest.success {
        let message = format!("doing nothing succeeds in `{}`", task.name);
        let diagnostic = at(probing::REST_SUCCEEDS, task.places.success, message)
            .found(format!("success after {} steps with every muscle at rest", rest.steps))
            .help("require something that only the movement achieves, or write `allow rest_succeeds \"...\"`");
        warnings.push(diagnostic);
    }
    // A policy that cannot act sets no measure.
    let Some(held) = held else { return };
    let (resting, holding) = (rest.mean(), held.mean());
    if resting > holding + MARGIN * holding.abs() {
        let gain = |index: usize| rest.per_step(rest.terms[index]) - held.per_step(held.terms[index]);
        let most = (0..task.terms.len()).max_by(|&a, &b| gain(a).total_cmp(&gain(b)));
        let Some((most, place)) = most.and_then(|most| Some((most, *task.places.terms.get(most)?))) else { return };
        let name = &task.terms[most].name;
        let message =
            format!("in `{}` doing nothing earns more than holding the pose, most of all by the term `{name}`", task.name);
        let diagnostic = at(probing::REWARDS_REST, place, message)
            .expected(format!("at rest less than {} per step, as `cmc` earns over {} steps", for_people(holding), held.steps))
            .found(format!("{} per step, {} more by `{name}`", for_people(resting), for_people(gain(most))))
            .help(
                "reward what a fall ends, or charge the termination; if holding the pose is not intended, write `allow rewards_rest \"...\"`",
            );
        warnings.push(diagnostic);
    }
}

/// The first episode of a task twice, at rest and held, step by step: the second lasts no longer than the first. `None` in place of one whose policy
/// cannot act.
struct Pair<'a> {
    /// The place of the task.
    task: usize,
    engine: &'a Engine,
    rollouts: [Option<LaneRollout<'a>>; 2],
}

impl<'a> Pair<'a> {
    /// Begins both in two lanes from `lane` on.
    fn begin((task, engine): (usize, &'a Engine), lane: usize, scratch: &mut GroupScratch) -> Self {
        let policies: [Box<dyn Policy>; 2] = [Box::new(Resting), Box::<ComputedMuscleControl>::default()];
        let mut lanes = lane..;
        let rollouts = policies.map(|policy| {
            let mut rollout = LaneRollout::new(engine, engine.task().weights(), policy);
            rollout.reset(lanes.next()?, EpisodeKey::default(), scratch, &mut |_| {}).ok()?;
            Some(rollout)
        });
        Self { task, engine, rollouts }
    }

    /// Whether the first, on which the second depends, is over.
    fn is_over(&self) -> bool {
        self.rollouts[0].as_ref().is_none_or(|rest| rest.is_over() || rest.episode.steps() >= MOST_STEPS)
    }

    fn rest(&self) -> Option<Played> {
        Played::of(&self.rollouts[0].as_ref()?.episode)
    }

    fn held(&self) -> Option<Played> {
        Played::of(&self.rollouts[1].as_ref()?.episode)
    }
}

/// Gives the next task by its place, which plays on the model of the engine, if there is one.
type Claim<'c, 'a> = dyn FnMut(Option<&Engine>) -> Option<(usize, &'a Engine)> + 'c;

/// Plays the pairs that `claim` gives, up to `width` at once, each on the model of those that are being played; `done` gets each that is over.
fn play<'a>(width: usize, claim: &mut Claim<'_, 'a>, done: &mut dyn FnMut(Pair<'a>)) {
    let mut scratch: Option<GroupScratch> = None;
    let mut pairs: [Option<Pair<'a>>; WIDTH / 2] = Default::default();
    loop {
        for index in 0..width {
            while pairs[index].is_none() {
                let present = pairs.iter().flatten().next().map(|pair| pair.engine);
                let Some((task, engine)) = claim(present) else { break };
                let known = scratch.take().filter(|scratch| scratch.serves(engine));
                let scratch = scratch.insert(known.unwrap_or_else(|| engine.group_scratch(2 * width)));
                let pair = Pair::begin((task, engine), 2 * index, scratch);
                if pair.is_over() { done(pair) } else { pairs[index] = Some(pair) }
            }
        }
        let Some(scratch) = scratch.as_mut().filter(|_| pairs.iter().any(Option::is_some)) else { return };
        let mut lanes: [Option<&mut LaneRollout<'a>>; WIDTH] = Default::default();
        for (lanes, pair) in lanes.chunks_mut(2).zip(&mut pairs) {
            let rollouts = pair.iter_mut().flat_map(|pair| &mut pair.rollouts);
            lanes.iter_mut().zip(rollouts).for_each(|(lane, rollout)| *lane = rollout.as_mut());
        }
        for (lane, _) in together::step(lanes, scratch) {
            if let Some(pair) = &mut pairs[lane / 2] {
                pair.rollouts[lane % 2] = None;
            }
        }
        for place in &mut pairs {
            place.take_if(|pair| pair.is_over()).into_iter().for_each(&mut *done);
        }
    }
}

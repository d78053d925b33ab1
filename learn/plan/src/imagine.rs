//! Imagined episodes under plans, in the lanes of the simulator.

use crate::curve::Curve;
use crate::space::Space;
use crate::value::Trace;
use msk_physics::Rates;
use msk_physics::lanes::WIDTH;
use msk_physics::scalar::Real;
use msk_runtime::action::Action;
use msk_runtime::body::sensors::Snapshot;
use msk_runtime::episode::{Controlled, Ending, Engine, Episode, GroupScratch, Member};
use msk_runtime::policy::PolicyContext;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// A shape that is no more than this above the ground bears weight, m.
const NEAR: f64 = 0.01;

/// The margin within the support that a controller without foresight needs to keep a body up, m.
const SAFE: f64 = 0.06;

/// How long plans are played, and how closely.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    /// Control steps of the horizon, and of the tail.
    pub steps: [u32; 2],
    /// Control steps for which muscles keep what the controller of a space has asked for once.
    pub hold: u32,
    /// Whether controllers share forces out roughly.
    pub rough: bool,
    /// Whether ending with success is a failure.
    pub avoid_success: bool,
    /// Whether it is measured how well the body is balanced at the end.
    pub balance: bool,
    /// By which share of the way entries come nearer to what a plan asks for at each control step.
    pub follow: f64,
}

impl Extent {
    /// Moves entries towards what a plan asks for, by one control step.
    pub fn smooth(&self, asked: &[f64], entries: &mut [f64]) {
        entries.iter_mut().zip(asked).for_each(|(entry, asked)| *entry += self.follow * (asked - *entry));
    }
}

/// Plays plans from the present on.
pub(crate) struct Imaginer {
    engine: Engine,
    /// Memory that no group uses now. It decides nothing.
    memory: Mutex<Vec<Memory>>,
}

/// What a group of lanes is played in.
struct Memory {
    scratch: GroupScratch,
    lanes: Vec<Lane>,
}

struct Lane {
    episode: Episode,
    rates: Option<Rates>,
    space: Space,
    /// What the plan asks for now, what is done about it, and the action that this becomes.
    asked: Vec<f64>,
    entries: Vec<f64>,
    action: Vec<f64>,
    trace: Trace,
}

/// The present, from which plans are played.
pub(crate) struct Present<'a> {
    /// The real episode with its policy.
    pub context: PolicyContext<'a>,
    /// What imagined chance is named after.
    pub name: &'a str,
}

/// What is played from the present on.
#[derive(Clone, Copy)]
pub(crate) struct Proposal<'a> {
    /// The controller at present.
    pub space: &'a Space,
    /// The entries of the last control step.
    pub entries: &'a [f64],
    pub plan: &'a Curve,
}

impl Imaginer {
    /// For episodes of `engine`, an engine of imagined episodes.
    pub fn new(engine: Engine) -> Self {
        Self { engine, memory: Mutex::default() }
    }

    /// Plays every proposal; `None` if `stop` became true before the end.
    pub fn play(
        &self,
        present: &Present<'_>,
        proposals: &[Proposal<'_>],
        extent: Extent,
        stop: &AtomicBool,
    ) -> Option<Vec<Trace>> {
        // Groups are fixed, so that the bits of a trace depend on no number of threads.
        let groups: Vec<Option<Vec<Trace>>> =
            proposals.par_chunks(WIDTH).map(|proposals| self.group(present, proposals, extent, stop)).collect();
        Some(groups.into_iter().collect::<Option<Vec<_>>>()?.concat())
    }

    fn group(&self, present: &Present<'_>, proposals: &[Proposal<'_>], extent: Extent, stop: &AtomicBool) -> Option<Vec<Trace>> {
        let known = self.memory.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut memory = known.unwrap_or_else(|| Memory { scratch: self.engine.group_scratch(WIDTH), lanes: Vec::new() });
        memory.begin(&self.engine, present, proposals, extent.rough);
        let played = memory.play(&self.engine, present.context.weights, proposals, extent, stop);
        let traces = played.then(|| memory.lanes.iter().take(proposals.len()).map(|lane| lane.trace).collect());
        self.memory.lock().unwrap_or_else(PoisonError::into_inner).push(memory);
        traces
    }
}

impl Memory {
    fn begin(&mut self, engine: &Engine, present: &Present<'_>, proposals: &[Proposal<'_>], rough: bool) {
        let Present { context, name } = present;
        for (index, &Proposal { space, entries: before, plan }) in proposals.iter().enumerate() {
            if index == self.lanes.len() {
                let (episode, space) = (engine.episode(), space.clone());
                let (asked, entries, action) = (Vec::new(), Vec::new(), Vec::new());
                self.lanes.push(Lane { episode, rates: None, space, asked, entries, action, trace: Trace::default() });
            }
            let lane = &mut self.lanes[index];
            engine.imagine(context.episode, name, &mut lane.episode);
            lane.space.clone_from(space);
            // A step depends on forces more closely than a pose does.
            if rough && !space.walks() {
                lane.space.make_rough();
                lane.episode.make_rough();
            }
            lane.asked.resize(plan.width, 0.0);
            lane.entries.clear();
            lane.entries.extend_from_slice(before);
            lane.action.resize(space.acts_on().size(context.task, context.body), 0.0);
            lane.rates = None;
            lane.trace = Trace::default();
            if !self.scratch.bring(index, engine, &lane.episode) {
                lane.trace.failed = true;
            }
        }
    }

    /// Plays all lanes to their ends; gives whether it got there before `stop` became true.
    fn play(&mut self, engine: &Engine, weights: &[f64], proposals: &[Proposal<'_>], extent: Extent, stop: &AtomicBool) -> bool {
        let Self { scratch, lanes } = self;
        let lanes = &mut lanes[..proposals.len()];
        let [horizon, tail] = extent.steps;
        for step in 0..horizon + tail {
            if stop.load(Ordering::Relaxed) {
                return false;
            }
            let asking = lanes.iter_mut().zip(proposals).enumerate().filter(|(_, (lane, _))| lane.goes_on());
            let mut controlled: Vec<Controlled<'_>> =
                asking.filter_map(|(index, (lane, own))| lane.ask(index, step, own.plan, extent, engine, weights)).collect();
            let acted = scratch.control(&mut controlled);
            // Controls that cannot act where the real ones could do not occur; it would be a failure.
            let unable = controlled.iter().zip(acted).filter(|(_, acted)| acted.is_err()).map(|(member, _)| member.lane);
            let unable: Vec<usize> = unable.collect();
            unable.into_iter().for_each(|lane| lanes[lane].trace.failed = true);
            if !lanes.iter().any(Lane::goes_on) {
                return true;
            }
            scratch.step(lanes.iter_mut().map(|lane| {
                let goes_on = lane.goes_on();
                let Lane { episode, rates, space, action, .. } = lane;
                let action = Action { acts_on: space.acts_on(), entries: action };
                goes_on.then_some(Member { engine, episode, rates, weights, action })
            }));
            lanes.iter_mut().for_each(|lane| lane.note(step, extent));
        }
        if extent.balance {
            for (index, lane) in lanes.iter_mut().enumerate().filter(|(_, lane)| lane.goes_on()) {
                lane.trace.imbalance = imbalance(&engine.context(&lane.episode, weights, scratch.lane(index)).snapshot());
            }
        }
        true
    }
}

/// By how much the capture point of a body without a fixed base misses [`SAFE`], m.
fn imbalance(snapshot: &Snapshot<'_>) -> f64 {
    match snapshot.body.root.free {
        Some(_) => snapshot.capture_margin(NEAR).map_or(0.0, |margin| (SAFE - margin).at_least(0.0)),
        None => 0.0,
    }
}

impl Lane {
    fn goes_on(&self) -> bool {
        !self.trace.failed && self.episode.ending().is_none()
    }

    /// Makes the action of a step of what the plan asks for, in the tail of what it asked for last; or gives what has to act for that.
    fn ask<'a>(
        &'a mut self,
        index: usize,
        step: u32,
        plan: &Curve,
        extent: Extent,
        engine: &'a Engine,
        weights: &'a [f64],
    ) -> Option<Controlled<'a>> {
        let Extent { steps: [horizon, _], hold, .. } = extent;
        let Self { episode, space, asked, entries, action, .. } = self;
        plan.at((f64::from(step) / f64::from(horizon)).at_most(1.0), asked);
        extent.smooth(asked, entries);
        // What looks at the state is worth most of the time that it takes.
        if matches!(space, Space::Other(_)) && !step.is_multiple_of(space.hold(hold)) {
            return None;
        }
        let (controls, entries) = space.take(entries, action)?;
        Some(Controlled { lane: index, engine, episode, weights, controls, entries, action })
    }

    /// Adds the step that was taken to the trace.
    fn note(&mut self, step: u32, Extent { steps: [horizon, _], avoid_success, .. }: Extent) {
        let Self { episode, trace, .. } = self;
        // One that had ended before has taken no step.
        if trace.failed || trace.steps != step {
            return;
        }
        let succeeds = episode.ending().is_some() && episode.report().success;
        let failed = matches!(episode.ending(), Some(Ending::Terminated(_) | Ending::Fault(_)));
        trace.failed = failed || (avoid_success && succeeds);
        if matches!(episode.ending(), Some(Ending::Fault(_))) {
            trace.steps += 1;
            return;
        }
        let reward = episode.report().reward;
        trace.rewards[usize::from(step >= horizon)] += reward;
        trace.steps += 1;
        if !trace.failed {
            trace.largest = trace.largest.at_least(reward.abs());
            trace.sizes += reward.abs();
        }
    }
}

//! Action spaces: from a policy's action to what the muscles and joints of an episode are asked for.
//!
//! 1. Entries of an action of the task's own space are clipped to [-1, 1], scaled, delayed and filtered.
//! 2. The target of the space makes one action per muscle of them, or torques; computed muscle control and the controller beneath a
//!    residual look at the present state for that.
//! 3. Where the space asks for activations, such actions give way to those that lead there.
//! 4. The excitation map of the body makes excitations of the actions of muscles.

mod base;
mod controls;
mod delay;
mod excitation;

pub use controls::Controls;
pub(crate) use excitation::action as action_for;
pub use excitation::{REST, excitation};

use crate::body::Body;
use crate::cmc::{ActivationInverse, ControlError, ControlScratch, Moment, Offsets, Present, Tracker, Walk};
use crate::policy::PolicyContext;
use base::Base;
use delay::Delay;
use msk_physics::scalar::Real;
use msk_program::action::{ActionSpace, ActionTarget, Along, BaseController, BaseNetwork, TrackingOffsets};
use msk_program::task::CompiledTask;
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Which entries an action has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ActsOn {
    /// Those of the task's action space.
    #[default]
    Task,
    /// One per muscle, whatever the action space of the task: what is scaled, delayed or filtered there is not here.
    Muscles,
}

impl ActsOn {
    /// Number of entries of such an action.
    pub fn size(self, task: &CompiledTask, body: &Body) -> usize {
        match self {
            Self::Task => task.action.size(body.muscles.len()),
            Self::Muscles => body.muscles.len(),
        }
    }
}

/// What a policy gives for one control step: entries in [-1, 1]; what lies outside is clipped.
#[derive(Debug, Clone, Copy)]
pub struct Action<'a> {
    /// Which entries these are.
    pub acts_on: ActsOn,
    /// In the order of the action space, or of the body's muscles.
    pub entries: &'a [f64],
}

impl<'a> From<&'a [f64]> for Action<'a> {
    fn from(entries: &'a [f64]) -> Self {
        Self { acts_on: ActsOn::Task, entries }
    }
}

impl<'a> From<&'a Vec<f64>> for Action<'a> {
    fn from(entries: &'a Vec<f64>) -> Self {
        entries.as_slice().into()
    }
}

impl<'a, const SIZE: usize> From<&'a [f64; SIZE]> for Action<'a> {
    fn from(entries: &'a [f64; SIZE]) -> Self {
        entries.as_slice().into()
    }
}

impl<'a> From<&'a ActionBuffer> for Action<'a> {
    fn from(buffer: &'a ActionBuffer) -> Self {
        Self { acts_on: buffer.acts_on, entries: &buffer.entries }
    }
}

/// The action of a policy over an episode, written by [`Policy::act`](crate::policy::Policy::act).
#[derive(Debug, Clone)]
pub struct ActionBuffer {
    acts_on: ActsOn,
    /// In the order of the action space, or of the body's muscles.
    pub entries: Vec<f64>,
}

impl ActionBuffer {
    /// The action that asks for nothing.
    pub fn new(acts_on: ActsOn, task: &CompiledTask, body: &Body) -> Self {
        let rest = if acts_on == ActsOn::Task { task.action.rest() } else { REST };
        Self { acts_on, entries: vec![rest; acts_on.size(task, body)] }
    }
}

/// What of the actions of an episode has consequences later.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ActionState {
    /// The last action, in the task's space; empty where that is one entry per muscle.
    pub entries: Vec<f64>,
    /// The action that reached each muscle.
    pub muscles: Vec<f64>,
    delay: Delay,
    /// The output of the filter.
    filtered: Vec<f64>,
    /// Computed muscle control, where the space needs it. It belongs to a model, so it is not written.
    #[serde(skip)]
    tracker: Option<Box<Tracker>>,
}

impl ActionState {
    /// That of an episode which has not begun, of a body with so many muscles.
    pub fn new(space: &ActionSpace, muscles: usize) -> Self {
        let size = if space.is_default() { 0 } else { space.size(muscles) };
        let tracker = follows(space).map(|along| Box::new(Tracker::new(along)));
        let mut state = Self {
            entries: vec![0.0; size],
            muscles: vec![REST; muscles],
            delay: Delay::new(size, if space.is_default() { 0 } else { space.latency }),
            filtered: vec![0.0; size],
            tracker,
        };
        state.clear(space);
        state
    }

    /// Forgets the episode before.
    pub fn clear(&mut self, space: &ActionSpace) {
        let rest = space.rest();
        self.entries.fill(rest);
        self.filtered.fill(rest);
        self.delay.fill(rest);
        self.muscles.fill(REST);
    }

    /// Prepares for an episode, which has just been reset.
    ///
    /// # Errors
    /// A body or task that the controller of the space cannot control.
    pub fn reset(&mut self, moment: &Moment<'_>) -> Result<(), ControlError> {
        self.tracker.as_mut().map_or(Ok(()), |tracker| tracker.reset(moment))
    }

    /// Lets its controller act roughly from now on, in less time: for imagined episodes.
    pub fn make_rough(&mut self) {
        if let Some(tracker) = &mut self.tracker {
            tracker.make_rough();
        }
    }

    /// Whether it has the shape of another one of the same task.
    pub fn fits(&self, other: &Self) -> bool {
        let sizes = |state: &Self| [state.entries.len(), state.muscles.len(), state.filtered.len()];
        sizes(self) == sizes(other) && self.delay.fits(&other.delay) && self.tracker.is_some() == other.tracker.is_some()
    }

    /// Whether the next action depends on the present state.
    pub fn looks_at_state(&self) -> bool {
        self.tracker.is_some()
    }

    /// Takes an action whose entries are finite. Where forces have to be shared out for it, that is to be [done](Self::allocate) before
    /// it is [finished](Self::finish).
    ///
    /// # Errors
    /// The controller of the space has not been reset.
    pub fn begin(
        &mut self,
        action: Action<'_>,
        space: &ActionSpace,
        moment: &Moment<'_>,
        control: &mut ControlMemory,
    ) -> Result<Taken, ControlError> {
        match action.acts_on {
            ActsOn::Muscles => self.entries.fill(space.rest()),
            ActsOn::Task if space.is_default() => {}
            ActsOn::Task => {
                self.pass(action.entries, space, 1.0 / moment.task.control_frequency);
                return self.ask(space, moment, control);
            }
        }
        self.muscles.iter_mut().zip(action.entries).for_each(|(kept, entry)| *kept = entry.clip(-1.0, 1.0));
        Ok(Taken::Wholly)
    }

    /// Shares out the forces that its controller has asked for.
    pub fn allocate(&mut self, present: &Present<'_>, control: &mut ControlMemory) {
        if let (Some(tracker), Some(scratch)) = (&mut self.tracker, control.get_mut()) {
            tracker.allocate(present, scratch);
        }
    }

    /// The controller, where there is one.
    pub fn tracker_mut(&mut self) -> Option<&mut Tracker> {
        self.tracker.as_deref_mut()
    }

    /// Clips, scales, delays and filters the entries of an action.
    fn pass(&mut self, entries: &[f64], space: &ActionSpace, period: f64) {
        self.entries.iter_mut().zip(entries).for_each(|(kept, entry)| *kept = entry.clip(-1.0, 1.0));
        // The exact answer of dy/dt = (a - y) / τ to an entry that is held for a period.
        let share = follow_share(period, space.filter);
        let scaled = self.entries.iter().map(|entry| space.scale * entry);
        let delayed = self.delay.advance(scaled);
        for (filtered, &entry) in self.filtered.iter_mut().zip(delayed) {
            *filtered = if share < 1.0 { *filtered + share * (entry - *filtered) } else { entry };
        }
    }

    /// Asks the controller of the space for the forces that what has passed the filter takes.
    fn ask(&mut self, space: &ActionSpace, moment: &Moment<'_>, control: &mut ControlMemory) -> Result<Taken, ControlError> {
        if let Some(BaseController::Network(base)) = &space.residual {
            control.act(base, moment, &mut self.muscles)?;
            return Ok(Taken::Beside);
        }
        let offsets = match &space.target {
            ActionTarget::MuscleControl(targets) => moved(targets, &self.filtered),
            _ => Offsets::default(),
        };
        match &mut self.tracker {
            Some(tracker) => {
                let scratch = control.scratch.get_or_insert_with(|| Box::new(ControlScratch::new(&moment.present)));
                tracker.ask(moment, &offsets, scratch)?;
                Ok(Taken::AskingForces)
            }
            None if follows(space).is_some() => Err(ControlError::NotReset),
            None => Ok(Taken::Entries),
        }
    }

    /// Writes the action that reaches each muscle, and torques over all dofs, of what has been taken.
    pub fn finish(
        &mut self,
        taken: Taken,
        space: &ActionSpace,
        moment: &Moment<'_>,
        control: &mut ControlMemory,
        torques: &mut [f64],
    ) {
        let Self { muscles, filtered, tracker, .. } = self;
        let body = moment.present.body;
        match (taken, tracker, control.get_mut()) {
            (Taken::Wholly, ..) => return,
            // The muscles hold the action of the network.
            (Taken::Beside, ..) => {}
            (Taken::AskingForces, Some(tracker), Some(scratch)) => tracker.give(&moment.present, scratch, muscles),
            _ => muscles.fill(REST),
        }
        let residual = space.residual.is_some();
        let mut give = |muscle: usize, entry: f64| {
            if let Some(kept) = muscles.get_mut(muscle) {
                *kept = if residual { *kept + entry } else { entry }.clip(-1.0, 1.0);
            }
        };
        match &space.target {
            ActionTarget::AllMuscles => filtered.iter().enumerate().for_each(|(muscle, &entry)| give(muscle, entry)),
            ActionTarget::Muscles(chosen) => chosen.iter().zip(&*filtered).for_each(|(&muscle, &entry)| give(muscle, entry)),
            ActionTarget::Synergies(synergies) => {
                for (synergy, &entry) in synergies.iter().zip(&*filtered) {
                    synergy.muscles.iter().for_each(|&muscle| give(muscle, entry));
                }
            }
            ActionTarget::Torque { joints, ranges } => {
                for ((&joint, range), entry) in joints.iter().zip(ranges).zip(&*filtered) {
                    torques[body.joints[joint].dof] = range * entry;
                }
            }
            ActionTarget::MuscleControl(_) => {}
        }
        if space.activations {
            control.inverse(&moment.present).invert(&moment.present, moment.substeps, muscles);
        }
    }
}

/// A worker's memory for controllers of one model and body: filled when the first one acts.
#[derive(Debug, Clone, Default)]
pub struct ControlMemory {
    scratch: Option<Box<ControlScratch>>,
    network: Option<Box<Base>>,
    inverse: Option<Box<ActivationInverse>>,
}

impl ControlMemory {
    /// What it holds for a model, if a controller has acted.
    pub(crate) fn get_mut(&mut self) -> Option<&mut ControlScratch> {
        self.scratch.as_deref_mut()
    }

    /// For muscles that are asked for activations.
    fn inverse(&mut self, present: &Present<'_>) -> &mut ActivationInverse {
        self.inverse.get_or_insert_with(|| Box::new(ActivationInverse::new(present.model)))
    }

    /// Replaces actions of muscles by those that ask for the activations to which they lead within the control step.
    pub fn predict(&mut self, context: &PolicyContext<'_>, muscles: &mut [f64]) {
        let moment = context.moment();
        self.inverse(&moment.present).predict(&moment.present, moment.substeps, muscles);
    }

    /// Writes the action of a network for each muscle.
    fn act(&mut self, network: &Arc<BaseNetwork>, moment: &Moment<'_>, muscles: &mut [f64]) -> Result<(), ControlError> {
        let base = match self.network.take().filter(|base| base.is_of(network, moment)) {
            Some(base) => base,
            None => Box::new(Base::new(network, moment)?),
        };
        self.network.insert(base).act(moment, muscles)
    }
}

/// How far an action has been taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Taken {
    /// It says what each muscle does.
    Wholly,
    /// Its entries have passed the filter.
    Entries,
    /// They have, and a network has acted beside them.
    Beside,
    /// They have, and a controller has asked for forces.
    AskingForces,
}

/// What the controller of an action space follows; `None` for a space without one.
fn follows(space: &ActionSpace) -> Option<Along> {
    match (&space.target, &space.residual) {
        (ActionTarget::MuscleControl(offsets), _) => Some(offsets.along),
        (_, Some(BaseController::Demonstration)) => Some(Along::Demonstration),
        (_, Some(BaseController::MuscleControl)) => Some(Along::Reference),
        _ => None,
    }
}

/// Offsets of targets by the entries that move them.
fn moved(targets: &TrackingOffsets, entries: &[f64]) -> Offsets {
    let (joints, mut left) = entries.split_at(targets.joints.len().min(entries.len()));
    let joints = targets.joints.iter().zip(joints).map(|(&joint, entry)| (joint, targets.range * entry)).collect();
    let mut along_axes = |ranges: [f64; 3]| Vector3::from(ranges).component_mul(&Vector3::from(next(&mut left)));
    let mut if_moved = |range: f64| if range > 0.0 { along_axes([range; 3]) } else { Vector3::zeros() };
    let (center_of_mass, root) = (if_moved(targets.center_of_mass), if_moved(targets.root));
    let hands = targets.hands.iter().map(|&hand| (hand, along_axes([targets.reach; 3]))).collect();
    let pace = if targets.walks() { along_axes(targets.pace()) } else { Vector3::zeros() };
    let walk = Walk { velocity: Vector2::new(targets.speed() + pace.x, pace.y), turn: pace.z };
    let changes_over = targets.changes_over_to().is_some_and(|_| next::<1>(&mut left)[0] > Along::CHANGES_OVER);
    let priorities =
        if targets.priorities > 0.0 { next(&mut left).map(|entry: f64| targets.priorities * entry) } else { [0.0; 2] };
    Offsets { joints, center_of_mass, root, hands, priorities, walk, changes_over }
}

/// The first so many of the entries that are left; 0 where there are fewer.
fn next<const COUNT: usize>(left: &mut &[f64]) -> [f64; COUNT] {
    let Some((first, rest)) = left.split_first_chunk() else { return [0.0; COUNT] };
    *left = rest;
    *first
}

/// The share of its way that the output of a low-pass filter of first order goes in `period`, s; all of it without a time constant.
pub fn follow_share(period: f64, time_constant: f64) -> f64 {
    if time_constant > 0.0 { 1.0 - libm::exp(-period / time_constant) } else { 1.0 }
}

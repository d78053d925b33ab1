//! The classical Runge-Kutta method of fourth order.
//!
//! Orientations do not add: at each stage the turn since the step's start is a rotation vector t, whose rate is not the angular
//! velocity w but w + t x w / 2 + t x (t x w) / 12 + ... (Munthe-Kaas, BIT 38, 1998, in the turning frame's own axes; further
//! terms are beyond the method's order). The rates are what is combined.

use super::{advance_placed, advance_positions, keep_where};
use crate::{
    Fault, Workspace, actuation,
    lanes::WIDTH,
    model::{JointKind, Model},
    scalar::Real,
    spatial::{cross, scale},
    state::State,
    stepping,
};
use nalgebra::Vector3;
use std::sync::Arc;

/// How far each later stage is from the start, in steps; it stands that far along the rates of the stage before.
const STAGES: [f64; 3] = [0.5, 0.5, 1.0];
/// Weights of the four stages' rates.
const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

/// Scratch memory.
#[derive(Debug, Clone)]
pub struct RungeKutta<T: Real> {
    stage: State<T>,
    /// The rates of the latest stage, then their weighted sums.
    rates: Rates<T>,
    sums: Rates<T>,
    /// The rates of positions that led to the latest stage.
    before: Vec<T>,
    /// The first dof of each joint's three turning ones.
    turning: Arc<[usize]>,
}

#[derive(Debug, Clone)]
struct Rates<T> {
    position: Vec<T>,
    velocity: Vec<T>,
    activation: Vec<T>,
}

impl<T: Real> Rates<T> {
    fn new(model: &Model) -> Self {
        let zero = T::splat(0.0);
        Self { position: vec![zero; model.nv], velocity: vec![zero; model.nv], activation: vec![zero; model.na] }
    }

    fn pairs<'a>(&'a mut self, others: &'a Self) -> impl Iterator<Item = (&'a mut T, &'a T)> {
        let position = self.position.iter_mut().zip(&others.position);
        let velocity = self.velocity.iter_mut().zip(&others.velocity);
        position.chain(velocity).chain(self.activation.iter_mut().zip(&others.activation))
    }

    fn add(&mut self, others: &Self, weight: f64) {
        self.pairs(others).for_each(|(sum, rate)| *sum += T::splat(weight) * *rate);
    }

    fn set(&mut self, others: &Self, weight: f64) {
        self.pairs(others).for_each(|(sum, rate)| *sum = T::splat(weight) * *rate);
    }
}

impl<T: Real> RungeKutta<T> {
    /// Memory for `model`, whose turning dofs these are.
    pub(crate) fn of(model: &Model, turning: &Arc<[usize]>) -> Self {
        Self {
            stage: State::new(model),
            rates: Rates::new(model),
            sums: Rates::new(model),
            before: vec![T::splat(0.0); model.nv],
            turning: Arc::clone(turning),
        }
    }

    /// Takes the rates of the stage that lies `time` seconds along the rates taken before.
    fn take(&mut self, workspace: &Workspace<T>, time: T) {
        core::mem::swap(&mut self.before, &mut self.rates.position);
        self.rates.position.copy_from_slice(&self.stage.velocity);
        self.rates.velocity.copy_from_slice(&workspace.acceleration);
        self.rates.activation.copy_from_slice(&workspace.actuation.activation_rate);
        for &dof in self.turning.iter() {
            let at = |rates: &[T]| Vector3::new(rates[dof], rates[dof + 1], rates[dof + 2]);
            let (turn, spin) = (scale(&at(&self.before), time), at(&self.rates.position));
            let across = cross(&turn, &spin);
            let twice = cross(&turn, &across);
            let rate = spin + scale(&across, T::splat(0.5)) + scale(&twice, T::splat(1.0 / 12.0));
            self.rates.position[dof..dof + 3].copy_from_slice(rate.as_slice());
        }
    }
}

/// The first dof of each joint's three turning ones.
pub(crate) fn turning_dofs(model: &Model) -> Arc<[usize]> {
    let turning = |joint: usize| match model.joints.kind[joint] {
        JointKind::Free => Some(model.joints.dof_address[joint] + 3),
        JointKind::Ball => Some(model.joints.dof_address[joint]),
        JointKind::Hinge | JointKind::Slide => None,
    };
    (0..model.joints.kind.len()).filter_map(turning).collect()
}

/// Advances `state` by one step; `workspace` holds its forward pass on entry, that of the last stage on return. A lane with a fault
/// stays.
///
/// # Errors
/// As for [`forward`](stepping::forward), at any stage; `state` is then what it was before.
pub(super) fn runge_kutta<T: Real>(model: &Model, state: &mut State<T>, workspace: &mut Workspace<T>) -> Result<(), Fault> {
    let Some(mut method) = workspace.runge_kutta.take() else { return Ok(()) };
    let mut met = Met::none(workspace);
    workspace.take_faults(&mut met.faults);
    stages(model, state, workspace, &mut method, &mut met);
    let sums = &method.sums;
    let time = model.options.timestep;
    let activations = actuation::advanced(&workspace.actuation, &sums.activation, time, &state.activation);
    let checked = (&workspace.masked[..], &mut workspace.faults[..]);
    // What it finds is noted by lane.
    let _ = stepping::check_end(model, state, &sums.velocity, Some(&sums.position), activations, checked);
    workspace.take_faults(&mut met.faults);
    let lives = T::mask(|lane| !workspace.masked[lane]);
    if T::any(lives) {
        let step = T::splat(time);
        actuation::advance(&workspace.actuation, &sums.activation, time, lives, &mut state.activation);
        for (velocity, rate) in state.velocity.iter_mut().zip(&sums.velocity) {
            *velocity = T::select(lives, *velocity + step * *rate, *velocity);
        }
        advance_positions(model, &mut state.position, &sums.position, step, lives);
        advance_placed(state, step, lives);
        keep_where(lives, &mut state.fibre_length, &method.stage.fibre_length);
        keep_where(lives, &mut state.fibre_velocity, &method.stage.fibre_velocity);
        state.fibre_step = T::select(lives, step, state.fibre_step);
        state.time = T::select(lives, state.time + step, state.time);
        keep_where(lives, &mut state.warm_start, &workspace.acceleration);
    }
    workspace.runge_kutta = Some(method);
    met.leave(workspace);
    workspace.outcome()
}

/// Faults that lanes have met in this step: they are masked until its end.
struct Met {
    masked: [bool; WIDTH],
    faults: [Option<Fault>; WIDTH],
}

impl Met {
    fn none<T: Real>(workspace: &Workspace<T>) -> Self {
        let mut masked = [false; WIDTH];
        masked.iter_mut().zip(&workspace.masked).for_each(|(to, from)| *to = *from);
        Self { masked, faults: Default::default() }
    }

    /// Gives the lanes back with their faults.
    fn leave<T: Real>(self, workspace: &mut Workspace<T>) {
        workspace.masked.iter_mut().zip(self.masked).for_each(|(to, from)| *to = from);
        workspace.faults.iter_mut().zip(self.faults).for_each(|(to, from)| *to = from);
    }
}

fn stages<T: Real>(model: &Model, state: &State<T>, workspace: &mut Workspace<T>, method: &mut RungeKutta<T>, met: &mut Met) {
    method.stage.copy_from(state);
    // Fibres move implicitly, from where they are at the start to each stage and to the end: their error is of first order.
    workspace.actuation.keep_fibres(&mut method.stage, 0.0, T::mask(|_| true));
    method.take(workspace, T::splat(0.0));
    method.sums.set(&method.rates, WEIGHTS[0]);
    for (share, weight) in STAGES.into_iter().zip(&WEIGHTS[1..]) {
        let time = T::splat(share * model.options.timestep);
        let RungeKutta { stage, rates, .. } = &mut *method;
        stage.time = state.time + time;
        stage.fibre_step = time;
        stage.warm_start.copy_from_slice(&workspace.acceleration);
        stage.position.copy_from_slice(&state.position);
        advance_positions(model, &mut stage.position, &rates.position, time, T::mask(|_| true));
        let move_on = |stage: &mut [T], start: &[T], rates: &[T]| {
            for ((value, start), rate) in stage.iter_mut().zip(start).zip(rates) {
                *value = *start + time * *rate;
            }
        };
        move_on(&mut stage.velocity, &state.velocity, &rates.velocity);
        move_on(&mut stage.activation, &state.activation, &rates.activation);
        let _ = stepping::forward(model, stage, workspace);
        workspace.take_faults(&mut met.faults);
        if workspace.masked.iter().all(|masked| *masked) {
            return;
        }
        method.take(workspace, time);
        method.sums.add(&method.rates, *weight);
    }
}

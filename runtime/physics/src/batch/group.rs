//! Eight episodes that are stepped together, and moved into their lanes and out of them in between.

use super::{OneLane, PerLane};
use crate::{
    Fault, Instructions, Plan, State, Workspace, constrained,
    dispatch::{Stage, run},
    elastic::Fibres,
    integrator,
    kinematics::Kinematics,
    lanes::{Lanes, WIDTH},
    model::Model,
    smooth, stepping,
};
use nalgebra::Vector3;
use std::sync::Arc;

/// The lanes of one worker, for episodes that it does not keep in them: a [`Batch`](super::Batch) owns its episodes, a group
/// borrows eight at a time.
///
/// [`load`](Self::load) fills the lanes. Steps are [`integrate`](Self::integrate), then [`forward`](Self::forward). After the last
/// one [`store_states`](Self::store_states) and [`store_passes`](Self::store_passes) give back the states, their forward passes, and the
/// [`Rates`] from which the next step goes on. A lane that meets a [`Fault`] stays as it was and is left out. Every episode comes to the
/// bits that [`step`](crate::step) gives it alone.
#[derive(Debug, Clone)]
pub struct LaneGroup {
    model: Arc<Model>,
    state: State<Lanes>,
    workspace: Workspace<Lanes>,
    faults: [Option<Fault>; WIDTH],
}

/// The large parts of a forward pass, which take the time to [store](LaneGroup::store_passes) and which few need.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// Inertias of bodies, and the mass matrix.
    pub inertia: bool,
    /// Paths of tendons.
    pub tendons: bool,
}

impl Parts {
    /// The whole pass.
    pub const ALL: Self = Self { inertia: true, tendons: true };

    /// What either has.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { inertia: self.inertia || other.inertia, tendons: self.tendons || other.tendons }
    }
}

/// What a step needs of the forward pass of the state that it goes on from.
#[derive(Debug, Clone, PartialEq)]
pub struct Rates {
    acceleration: Vec<f64>,
    /// What the integrator applies, damping implicit.
    damped_acceleration: Vec<f64>,
    /// Where servos stand on their circles; none where all actuators are muscles.
    actuator_length: Vec<f64>,
    /// Fibres of elastic tendons: their lengths and velocities.
    fibres: Option<[Vec<f64>; 2]>,
}

impl Rates {
    /// Of the forward pass in `workspace`, whose factor of the mass matrix is lost.
    pub fn of(model: &Model, state: &State<f64>, workspace: &mut Workspace<f64>) -> Self {
        run(Stage::Damped, model, state, workspace);
        let Workspace { actuation, acceleration, damped_acceleration, .. } = &*workspace;
        Self {
            acceleration: acceleration.clone(),
            damped_acceleration: damped_acceleration.clone(),
            actuator_length: if actuation.are_muscles() { Vec::new() } else { actuation.length.clone() },
            fibres: actuation.fibres.as_ref().map(|fibres| [fibres.length.clone(), fibres.velocity.clone()]),
        }
    }

    fn write_lanes(ones: &PerLane<&Self>, workspace: &mut Workspace<Lanes>) {
        let Workspace { acceleration, damped_acceleration, actuation, .. } = workspace;
        OneLane::write_lanes(&ones.map(|one| one.map(|one| &one.acceleration)), acceleration);
        OneLane::write_lanes(&ones.map(|one| one.map(|one| &one.damped_acceleration)), damped_acceleration);
        OneLane::write_lanes(&ones.map(|one| one.map(|one| &one.actuator_length)), &mut actuation.length);
        if let Some(Fibres { length, velocity, .. }) = &mut actuation.fibres {
            let own = |which: usize| ones.map(|one| one.and_then(|one| one.fibres.as_ref()).map(|fibres| &fibres[which]));
            OneLane::write_lanes(&own(0), length);
            OneLane::write_lanes(&own(1), velocity);
        }
    }

    fn read_lane(&mut self, workspace: &Workspace<Lanes>, lane: usize) {
        self.acceleration.read_lane(&workspace.acceleration, lane);
        self.damped_acceleration.read_lane(&workspace.damped_acceleration, lane);
        self.actuator_length.read_lane(&workspace.actuation.length, lane);
        if let (Some([length, velocity]), Some(fibres)) = (&mut self.fibres, &workspace.actuation.fibres) {
            length.read_lane(&fibres.length, lane);
            velocity.read_lane(&fibres.velocity, lane);
        }
    }
}

impl LaneGroup {
    /// Empty lanes.
    pub fn of(model: &Arc<Model>, plan: &Plan) -> Self {
        let mut workspace = Workspace::of(model, plan);
        workspace.masked.fill(true);
        Self { model: Arc::clone(model), state: State::new(model), workspace, faults: Default::default() }
    }

    /// The same with these instructions of the processor instead of the widest.
    pub fn with_instructions(mut self, instructions: Instructions) -> Self {
        self.workspace = self.workspace.with_instructions(instructions);
        self
    }

    /// With fewer episodes than these, one after the other is faster: with AVX2 and AVX-512 a step of eight lanes takes as long as four or
    /// five steps alone, however many lanes hold an episode; with two numbers per register it takes as long as eight or nine.
    pub fn least(&self) -> usize {
        if self.workspace.arch_is_wide() { 5 } else { WIDTH + 1 }
    }

    /// Puts an episode into each lane, or none: its state, with controls that may be new, and the rates of the forward pass before.
    /// States and rates are of the group's model.
    pub fn load(&mut self, episodes: &[Option<(&State<f64>, &Rates)>; WIDTH]) {
        OneLane::write_lanes(&episodes.map(|episode| episode.map(|(state, _)| state)), &mut self.state);
        Rates::write_lanes(&episodes.map(|episode| episode.map(|(_, rates)| rates)), &mut self.workspace);
        self.workspace.masked.iter_mut().zip(episodes).for_each(|(masked, episode)| *masked = episode.is_none());
        self.faults = Default::default();
    }

    /// Puts the forward pass of a state into a lane, for those who look at [all lanes](Self::passes) before the next step. After a step
    /// each lane holds that of its own new state.
    pub fn hold(&mut self, lane: usize, state: &State<f64>, workspace: &Workspace<f64>) {
        state.write_lane(&mut self.state, lane);
        macro_rules! write {
            ($($field:ident),*) => {$(workspace.$field.write_lane(&mut self.workspace.$field, lane);)*};
        }
        write!(kinematics, inertia, tendons, actuation, forces);
    }

    /// The states of all lanes and their forward passes, but for constraints.
    pub fn passes(&self) -> (&State<Lanes>, &Workspace<Lanes>) {
        (&self.state, &self.workspace)
    }

    /// Fills the rates of activations from the present controls: after [`load`](Self::load), before the first step.
    pub fn excite(&mut self) {
        smooth::excite(&self.model, &self.state, &mut self.workspace);
    }

    /// Advances all states by one physics step, at the rates of the last forward pass; faults are noted by lane.
    pub fn integrate(&mut self) {
        self.workspace.faults.fill(None);
        let _ = integrator::advance(&self.model, &mut self.state, &mut self.workspace);
        self.workspace.take_faults(&mut self.faults);
    }

    /// Passes all states forward.
    pub fn forward(&mut self) {
        let _ = stepping::forward(&self.model, &self.state, &mut self.workspace);
        self.workspace.take_faults(&mut self.faults);
        run(Stage::Damped, &self.model, &self.state, &mut self.workspace);
    }

    /// Why the episode in a lane has not been stepped any more.
    pub fn take_fault(&mut self, lane: usize) -> Option<Fault> {
        self.faults[lane].take()
    }

    /// Finds the frames of all present states: for forces that follow bodies, between [`integrate`](Self::integrate) and
    /// [`forward`](Self::forward).
    pub fn place(&mut self) {
        run(Stage::Kinematics, &self.model, &self.state, &mut self.workspace);
    }

    /// Writes the frames of the episode in a lane over `kinematics`.
    pub fn store_frames(&self, lane: usize, kinematics: &mut Kinematics<f64>) {
        kinematics.read_lane(&self.workspace.kinematics, lane);
    }

    /// Sets the forces that act on the bodies of the episode in a lane from outside.
    pub fn set_body_force(&mut self, lane: usize, force: &[[Vector3<f64>; 2]]) {
        force.write_lane(self.state.body_force.as_mut_slice(), lane);
    }

    /// Writes the state of each lane that is asked for over the one given, from which it was [loaded](Self::load), as far as steps
    /// change it.
    pub fn store_states(&self, mut states: [Option<&mut State<f64>>; WIDTH]) {
        macro_rules! read {
            ($($field:ident),*) => {$(
                OneLane::read_lanes(&mut states.each_mut().map(|one| one.as_mut().map(|one| &mut one.$field)), &self.state.$field);
            )*};
        }
        read!(time, position, velocity, activation, fibre_length, fibre_velocity, fibre_step);
        read!(mocap_position, mocap_orientation, warm_start);
    }

    /// Writes the forward pass of each lane that is asked for over the workspace given, all but the factor of the mass matrix and the parts
    /// that are not wanted, and its rates over the rates. A lane's own contacts and rows are handed out, so it can be done once after each
    /// pass.
    pub fn store_passes(&mut self, passes: [Option<(&mut Workspace<f64>, &mut Rates)>; WIDTH], parts: Parts) {
        let mut workspaces: PerLane<&mut Workspace<f64>> = Default::default();
        for (lane, (place, pass)) in workspaces.iter_mut().zip(passes).enumerate() {
            let Some((workspace, rates)) = pass else { continue };
            rates.read_lane(&self.workspace, lane);
            *place = Some(workspace);
        }
        self.store(workspaces, parts);
    }

    /// Passes several states forward and takes no step: each workspace comes to hold what [`forward`](crate::forward) writes, all but the
    /// factor of the mass matrix. A workspace whose state meets a [`Fault`] stays as it was.
    ///
    /// What the lanes have held before is lost.
    pub fn pass(&mut self, episodes: [Option<(&State<f64>, &mut Workspace<f64>)>; WIDTH]) -> [Option<Fault>; WIDTH] {
        let mut workspaces: PerLane<&mut Workspace<f64>> = Default::default();
        let mut states: PerLane<&State<f64>> = [None; WIDTH];
        for (lane, (state, workspace)) in episodes.into_iter().enumerate().filter_map(|(lane, pair)| Some((lane, pair?))) {
            (states[lane], workspaces[lane]) = (Some(state), Some(workspace));
        }
        OneLane::write_lanes(&states, &mut self.state);
        self.workspace.masked.iter_mut().zip(&states).for_each(|(masked, state)| *masked = state.is_none());
        self.faults = Default::default();
        let _ = stepping::forward(&self.model, &self.state, &mut self.workspace);
        self.workspace.take_faults(&mut self.faults);
        for (workspace, fault) in workspaces.iter_mut().zip(&self.faults) {
            workspace.take_if(|_| fault.is_some());
        }
        self.store(workspaces, Parts::ALL);
        core::mem::take(&mut self.faults)
    }

    /// Writes the forward pass of each lane that is asked for over the workspace given, as far as it is wanted.
    fn store(&mut self, mut workspaces: PerLane<&mut Workspace<f64>>, parts: Parts) {
        let from = &mut self.workspace;
        constrained::complete(&self.model, &self.state, from, |lane| workspaces[lane].is_some());
        for (place, lane) in workspaces.iter_mut().zip(&mut from.lanes) {
            if let Some(own) = place.as_mut().and_then(|workspace| workspace.lanes.first_mut()) {
                core::mem::swap(own, lane);
            }
        }
        macro_rules! read {
            ($($field:ident),*) => {$(
                OneLane::read_lanes(&mut workspaces.each_mut().map(|one| one.as_mut().map(|one| &mut one.$field)), &from.$field);
            )*};
        }
        read!(kinematics, velocities, actuation, forces, acceleration, constraint_force);
        if parts.inertia {
            read!(inertia);
        }
        if parts.tendons {
            read!(tendons);
        }
    }
}

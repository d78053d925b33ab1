//! Eight episodes that are stepped together, and moved into their lanes and out of them in between.

use super::OneLane;
use crate::{
    Fault, Instructions, Plan, State, Workspace,
    dispatch::{Stage, run},
    integrator,
    kinematics::Kinematics,
    lanes::{Lanes, WIDTH},
    model::{Integrator, Model},
    smooth, stepping,
};
use nalgebra::Vector3;
use std::sync::Arc;

/// The lanes of one worker, for episodes that it does not keep in them: a [`Batch`](super::Batch) owns its episodes, a group
/// borrows eight at a time.
///
/// [`load`](Self::load) fills a lane. Steps are [`integrate`](Self::integrate), then [`forward`](Self::forward). After the last
/// one [`store_state`](Self::store_state) and [`store`](Self::store) give back the state, its forward pass, and the [`Rates`] from
/// which the next step goes on. A lane that meets a [`Fault`] stays as it was and is left out. Every episode comes to the bits
/// that [`step`](crate::step) gives it alone.
#[derive(Debug, Clone)]
pub struct LaneGroup {
    model: Arc<Model>,
    state: State<Lanes>,
    workspace: Workspace<Lanes>,
    faults: [Option<Fault>; WIDTH],
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

    fn write_lane(&self, workspace: &mut Workspace<Lanes>, lane: usize) {
        self.acceleration.write_lane(&mut workspace.acceleration, lane);
        self.damped_acceleration.write_lane(&mut workspace.damped_acceleration, lane);
        self.actuator_length.write_lane(&mut workspace.actuation.length, lane);
        if let (Some([length, velocity]), Some(fibres)) = (&self.fibres, &mut workspace.actuation.fibres) {
            length.write_lane(&mut fibres.length, lane);
            velocity.write_lane(&mut fibres.velocity, lane);
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
    /// Empty lanes; `None` for a model whose integrator takes episodes one by one.
    pub fn of(model: &Arc<Model>, plan: &Plan) -> Option<Self> {
        if model.options.integrator != Integrator::Euler {
            return None;
        }
        let mut workspace = Workspace::of(model, plan);
        workspace.masked.fill(true);
        Some(Self { model: Arc::clone(model), state: State::new(model), workspace, faults: Default::default() })
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

    /// Takes all episodes out of the lanes.
    pub fn clear(&mut self) {
        self.workspace.masked.fill(true);
        self.faults = Default::default();
    }

    /// Puts an episode into a lane: its state, with controls that may be new, and the rates of the forward pass before.
    /// State and rates are of the group's model, and `lane` is below [`WIDTH`].
    pub fn load(&mut self, lane: usize, state: &State<f64>, rates: &Rates) {
        state.write_lane(&mut self.state, lane);
        rates.write_lane(&mut self.workspace, lane);
        self.workspace.masked[lane] = false;
        self.faults[lane] = None;
    }

    /// Fills the rates of activations from the present controls: after [`load`](Self::load), before the first step.
    pub fn excite(&mut self) {
        smooth::excite(&self.model, &self.state, &mut self.workspace);
    }

    /// Advances all states by one physics step, at the rates of the last forward pass.
    pub fn integrate(&mut self) {
        self.workspace.faults.fill(None);
        // Faults are noted by lane.
        let _ = integrator::advance(&self.model, &mut self.state, &mut self.workspace);
        self.note_faults();
    }

    /// Passes all states forward.
    pub fn forward(&mut self) {
        let _ = stepping::forward(&self.model, &self.state, &mut self.workspace);
        self.note_faults();
        run(Stage::Damped, &self.model, &self.state, &mut self.workspace);
    }

    /// Leaves lanes out that have just met a fault.
    fn note_faults(&mut self) {
        let Workspace { faults, masked, .. } = &mut self.workspace;
        for (lane, found) in faults.iter_mut().enumerate() {
            if let Some(fault) = found.take().filter(|_| !masked[lane]) {
                self.faults[lane] = Some(fault);
                masked[lane] = true;
            }
        }
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

    /// Writes the state in a lane over `state`.
    pub fn store_state(&self, lane: usize, state: &mut State<f64>) {
        state.read_lane(&self.state, lane);
    }

    /// Writes the forward pass in a lane over `workspace`, all but the factor of the mass matrix, and its rates over `rates`. The lane's
    /// own contacts and rows are handed out, so it can be done once after each pass.
    pub fn store(&mut self, lane: usize, workspace: &mut Workspace<f64>, rates: &mut Rates) {
        let from = &mut self.workspace;
        workspace.kinematics.read_lane(&from.kinematics, lane);
        workspace.inertia.read_lane(&from.inertia, lane);
        workspace.tendons.read_lane(&from.tendons, lane);
        workspace.velocities.read_lane(&from.velocities, lane);
        workspace.actuation.read_lane(&from.actuation, lane);
        workspace.forces.read_lane(&from.forces, lane);
        workspace.acceleration.read_lane(&from.acceleration, lane);
        workspace.constraint_force.read_lane(&from.constraint_force, lane);
        if let Some(own) = workspace.lanes.first_mut() {
            core::mem::swap(own, &mut from.lanes[lane]);
        }
        rates.read_lane(from, lane);
    }
}

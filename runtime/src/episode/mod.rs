//! Episodes: a task on a body, from reset to its end.
//!
//! One control step follows the synchronous rule of the language:
//!
//! 1. the action becomes excitations, held while the physics takes its substeps;
//! 2. a forward pass of the new state gives one snapshot, from which the sensors fill the task's frame;
//! 3. the task advances its operators and evaluates terms, terminations and success;
//! 4. the end is decided, then the policy's observation is written.
//!
//! An [`Episode`] is a value: it can be cloned, moved between threads, and continued from a [`Snapshot`] bit for bit. What
//! goes wrong inside one (diverging physics, a term that is not finite) is a [`Fault`] of that episode alone.

mod beginning;
mod ending;
mod excitation;
mod playing;
mod pushes;
mod start;
mod streams;

pub use ending::{Ending, EpisodeError, Fault};
pub use excitation::{REST, excitation};
pub use start::{Penetration, Residual, StartReport};
pub use streams::{EpisodeKey, Stream};

use msk_physics::scalar::Real;
use streams::Streams;

use crate::body::{Body, sensors};
use crate::condition::{Compartments, Fatigue};
use crate::policy::PolicyContext;
use msk_compiler::task::{CompiledTask, Disturbance, StepReport, TaskState};
use msk_physics::model::Model;
use msk_physics::{self as physics, State, Workspace};
use nalgebra::Vector3;
use std::sync::Arc;

/// A task on a body: model, state, compiled task and seeds.
#[derive(Clone)]
pub struct Episode {
    model: Arc<Model>,
    body: Arc<Body>,
    task: Arc<CompiledTask>,
    weights: Vec<f64>,
    substeps: u32,
    fatigue: Option<Fatigue>,
    /// Whether steps that a script shows end with the whole forward pass; else with what of it knows no forces.
    forces: bool,
    present: Snapshot,
    /// Scratch: the forward pass of the present state.
    workspace: Workspace<f64>,
}

/// Everything that changes over an episode: plain data, from which it continues bit for bit.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    key: EpisodeKey,
    /// With the solver's warm start.
    state: State<f64>,
    /// Pushes that were added to those of the task.
    pushes: Vec<Disturbance>,
    /// With the states, clocks and operators of the task.
    task: TaskState,
    /// Where each random of the task draws from.
    streams: Streams,
    /// With the velocities of the previous step.
    memory: sensors::Memory,
    /// Of muscles that tire.
    compartments: Option<Compartments>,
    action: Vec<f64>,
    frame: Vec<f64>,
    observation: Vec<f64>,
    report: StepReport,
    ending: Option<Ending>,
}

/// A reward term of the present step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TermPay {
    /// Unweighted value.
    pub value: f64,
    /// Weight in force.
    pub weight: f64,
}

impl TermPay {
    /// What the term adds to the reward.
    pub fn pay(self) -> f64 {
        self.weight * self.value
    }
}

/// The reward of the present step, term by term.
#[derive(Debug, Clone, Copy)]
pub struct Reward<'a> {
    episode: &'a Episode,
}

impl Reward<'_> {
    /// Sum over all terms of weight times value.
    pub fn total(&self) -> f64 {
        self.episode.present.report.reward
    }

    /// The term of that name; `None` if the task has no such term.
    pub fn term(&self, name: &str) -> Option<TermPay> {
        let index = self.episode.task.terms.iter().position(|term| term.name == name)?;
        let value = *self.episode.present.report.terms.get(index)?;
        Some(TermPay { value, weight: self.episode.weights[index] })
    }
}

impl core::fmt::Debug for Episode {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Episode").field("task", &self.task.name).field("present", &self.present).finish_non_exhaustive()
    }
}

impl Episode {
    /// Episode 0 of seed 0, reset.
    ///
    /// # Errors
    /// A task for another body, or a control step that is not a whole number of physics steps.
    pub fn new(model: Arc<Model>, body: Arc<Body>, task: Arc<CompiledTask>) -> Result<Self, EpisodeError> {
        if task.body.name != body.name {
            let (expected, found) = (task.body.name.clone(), body.name.clone());
            return Err(EpisodeError::Body { task: task.name.clone(), expected, found });
        }
        let mut episode = Self {
            substeps: substeps(&task, model.options.timestep)?,
            weights: task.weights(),
            fatigue: None,
            forces: true,
            present: Snapshot {
                key: EpisodeKey::default(),
                state: State::new(&model),
                pushes: Vec::new(),
                task: TaskState::default(),
                streams: Streams::default(),
                memory: sensors::Memory::default(),
                compartments: None,
                action: vec![REST; body.muscles.len()],
                frame: vec![0.0; task.frame.size()],
                observation: vec![0.0; task.observation_size()],
                report: StepReport::default(),
                ending: None,
            },
            workspace: Workspace::new(&model),
            model,
            body,
            task,
        };
        episode.reset(EpisodeKey::default());
        Ok(episode)
    }

    /// The same episode with muscles that tire, reset: fresh ones begin it.
    pub fn with_fatigue(mut self, fatigue: Option<Fatigue>) -> Self {
        self.fatigue = fatigue;
        self.reset(self.present.key);
        self
    }

    /// Begins the episode `key`. A beginning from which the physics cannot start ends it at once, with a fault.
    pub fn reset(&mut self, key: EpisodeKey) {
        self.clear(key);
        if let Err(fault) = self.start(key, &[]) {
            self.present.ending = Some(Ending::Fault(fault));
        }
    }

    /// The same with randoms that are `given` (place, value) and not drawn. The report tells what the task computes before
    /// anything moves.
    pub fn reset_given(&mut self, key: EpisodeKey, given: &[(usize, Vec<f64>)]) {
        self.clear(key);
        match self.start(key, given) {
            Ok(()) => {
                let present = &mut self.present;
                self.task.report(&present.frame, &self.weights, &present.task, &mut present.report);
            }
            Err(fault) => self.present.ending = Some(Ending::Fault(fault)),
        }
    }

    /// Forgets the episode before.
    fn clear(&mut self, key: EpisodeKey) {
        let present = &mut self.present;
        present.key = key;
        present.state = State::new(&self.model);
        present.pushes.clear();
        present.task = TaskState::default();
        present.memory = sensors::Memory::default();
        present.compartments = self.fatigue.as_ref().map(|_| Compartments::new(self.body.muscles.len()));
        present.action.fill(REST);
        present.report = StepReport::default();
        present.ending = None;
        present.streams.start(key, &self.task.randoms);
    }

    /// Randoms that read no signal, the beginning, the first snapshot, the other randoms.
    fn start(&mut self, key: EpisodeKey, given: &[(usize, Vec<f64>)]) -> Result<(), Fault> {
        let present = &mut self.present;
        self.task.begin_given(&mut present.streams, &mut present.task, given)?;
        self.begin(key)?;
        self.measure(0.0);
        let present = &mut self.present;
        self.task.reset_given(&present.frame, &mut present.streams, &mut present.task, given)?;
        self.observe();
        Ok(())
    }

    /// Puts everything in its place, lets it settle if the task says so, and passes forward.
    fn begin(&mut self, key: EpisodeKey) -> Result<(), physics::Fault> {
        self.place(key);
        let Snapshot { state, task, .. } = &mut self.present;
        if let Some(settle) = &self.task.beginning(task).settle {
            beginning::settle(&self.model, settle, state, &mut self.workspace)?;
        }
        physics::forward(&self.model, state, &mut self.workspace)
    }

    /// Puts everything in its place.
    fn place(&mut self, key: EpisodeKey) {
        let (model, workspace) = (&*self.model, &mut self.workspace);
        let Snapshot { state, task, .. } = &mut self.present;
        beginning::begin(model, &self.body, &self.task.beginning(task), key, state, workspace);
        beginning::hold(model, &self.body, state, workspace);
    }

    /// What does not fit when the episode `key` begins, before anything settles.
    ///
    /// # Errors
    /// A beginning from which the physics cannot start.
    pub fn inspect_start(&self, key: EpisodeKey) -> Result<StartReport, Fault> {
        let mut other = self.clone();
        other.present.state = State::new(&self.model);
        other.present.task = TaskState::default();
        other.present.streams.start(key, &self.task.randoms);
        self.task.begin(&mut other.present.streams, &mut other.present.task)?;
        other.place(key);
        physics::forward(&self.model, &other.present.state, &mut other.workspace)?;
        Ok(StartReport::of(&self.model, &other.workspace))
    }

    /// Adds a push, as an evaluation does: it begins with the next control step and lasts `steps`. Force (N) and torque (N m)
    /// act on a landmark (an index into the body's) in world axes. The next reset takes it away.
    pub fn push(&mut self, landmark: usize, [force, torque]: [[f64; 3]; 2], steps: u32) {
        let start = self.steps();
        self.present.pushes.push(Disturbance { landmark, force, torque, start, steps });
    }

    /// Takes one control step with `action`, one entry in [-1, 1] per muscle; what lies outside is clipped.
    ///
    /// A step that meets a fault pays nothing, is not counted, and ends the episode.
    ///
    /// # Errors
    /// An action of the wrong length, or an episode that has ended.
    pub fn step(&mut self, action: &[f64]) -> Result<&StepReport, EpisodeError> {
        if self.present.ending.is_some() {
            return Err(EpisodeError::Ended);
        }
        let expected = self.body.muscles.len();
        if action.len() != expected {
            return Err(EpisodeError::ActionSize { expected, found: action.len() });
        }
        let steps = self.steps();
        if let Err(fault) = self.advance(action) {
            self.present.task.step = steps;
            self.present.report = StepReport::default();
            self.present.ending = Some(Ending::Fault(fault));
        }
        Ok(&self.present.report)
    }

    fn advance(&mut self, action: &[f64]) -> Result<(), Fault> {
        self.excite(action)?;
        self.simulate()?;
        self.measure(self.control_period());
        let present = &mut self.present;
        self.task.step(&present.frame, &self.weights, &mut present.streams, &mut present.task, &mut present.report)?;
        self.present.ending = self.judge();
        self.release()?;
        self.observe();
        Ok(())
    }

    /// Takes the physics steps of one control step; the workspace then holds the forward pass of the new state.
    ///
    /// It also held that of the old one, which saves a pass: a new excitation changes nothing in it but the rates of
    /// activation (a muscle's force follows its activation, unless it acts early).
    fn simulate(&mut self) -> Result<(), Fault> {
        let (model, workspace) = (&*self.model, &mut self.workspace);
        let Snapshot { state, pushes, task, .. } = &mut self.present;
        let taken = task.step;
        let acting = || self.task.disturbances.iter().chain(pushes.iter()).filter(|push| pushes::acts(push, taken));
        let pushed = acting().next().is_some();
        let forces_change = pushed || state.body_force.iter().flatten().any(|force| *force != Vector3::zeros());
        if forces_change {
            pushes::apply(acting(), model, &self.body, &workspace.kinematics, state);
        }
        if forces_change || model.actuators.early.contains(&true) {
            physics::forward(model, state, workspace)?;
        } else {
            physics::smooth::excite(model, state, workspace);
        }
        for _ in 0..self.substeps {
            physics::integrate(model, state, workspace)?;
            if pushed {
                physics::kinematics::update(model, state, &mut workspace.kinematics);
                pushes::apply(acting(), model, &self.body, &workspace.kinematics, state);
            }
            physics::forward(model, state, workspace)?;
        }
        Ok(())
    }

    /// Sets the excitations that an action asks for.
    fn excite(&mut self, action: &[f64]) -> Result<(), Fault> {
        if let Some(index) = action.iter().position(|value| !value.is_finite()) {
            let muscle = self.body.muscles[index].name.clone();
            return Err(Fault::Action { muscle, value: action[index], step: self.steps() + 1 });
        }
        let present = &mut self.present;
        for ((kept, control), value) in present.action.iter_mut().zip(&mut present.state.control).zip(action) {
            *kept = value.clip(-1.0, 1.0);
            *control = excitation(self.body.excitation, *kept);
        }
        let elapsed = 1.0 / self.task.control_frequency;
        if let (Some(rates), Some(compartments)) = (&self.fatigue, &mut present.compartments) {
            compartments.advance(rates, &self.model, elapsed, &mut present.state.control);
        }
        Ok(())
    }

    /// Fills the task's frame from the forward pass. `elapsed` is the time since the previous snapshot, s.
    fn measure(&mut self, elapsed: f64) {
        // The step that is being taken is counted by the task only when it is evaluated.
        let taken = if elapsed > 0.0 { self.present.task.step + 1 } else { 0 };
        let present = &mut self.present;
        let control = sensors::Control { action: &present.action, time: f64::from(taken) / self.task.control_frequency, elapsed };
        let snapshot =
            sensors::Snapshot { body: &self.body, model: &self.model, state: &present.state, workspace: &self.workspace };
        sensors::fill(&self.task.frame, &snapshot, &control, &mut present.memory, &mut present.frame);
    }

    /// Lets go what the task has said shall let go. The forward pass is then another one.
    fn release(&mut self) -> Result<(), Fault> {
        let Snapshot { state, report, .. } = &mut self.present;
        let mut changed = false;
        for (&index, _) in self.task.releases.iter().zip(&report.released).filter(|(_, lets_go)| **lets_go) {
            if let Some(connection) = self.body.connections.get(index) {
                changed |= core::mem::replace(&mut state.active[connection.equality], 0.0) != 0.0;
            }
        }
        if changed {
            physics::forward(&self.model, state, &mut self.workspace)?;
        }
        Ok(())
    }

    fn judge(&self) -> Option<Ending> {
        let report = &self.present.report;
        let holding =
            |reasons: &[bool]| reasons.iter().enumerate().filter(|(_, holds)| **holds).map(|(index, _)| index).collect();
        let (failures, finishes): (Vec<usize>, Vec<usize>) = (holding(&report.terminations), holding(&report.finishes));
        if !failures.is_empty() {
            return Some(Ending::Terminated(failures));
        }
        if !finishes.is_empty() {
            return Some(Ending::Finished(finishes));
        }
        report.truncated.then_some(Ending::Truncated)
    }

    fn observe(&mut self) {
        let present = &mut self.present;
        self.task.observe(&present.frame, &present.task, &mut present.observation);
    }

    /// Lets an episode that its task has ended go on, as if it had not: what the task measures is measured as ever, and the next
    /// step may end it again. Says whether it goes on; neither a fault nor the horizon can be passed.
    pub fn pass_end(&mut self) -> bool {
        let passes = self.present.ending.as_ref().is_none_or(Ending::is_of_task) && self.steps() < self.task.horizon;
        if passes {
            self.present.ending = None;
        }
        passes
    }

    /// All that is needed to continue from here bit for bit.
    pub fn snapshot(&self) -> Snapshot {
        self.present.clone()
    }

    /// Goes back (or forth) to a snapshot taken from an episode of the same task. Weights are settings and stay as they are.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.present.clone_from(snapshot);
        // The forward pass is a function of the state, so a fault here is the one that the snapshot already ended with.
        let _ = physics::forward(&self.model, &self.present.state, &mut self.workspace);
    }

    /// The task.
    pub fn task(&self) -> &Arc<CompiledTask> {
        &self.task
    }

    /// Which episode of which seed.
    pub fn key(&self) -> EpisodeKey {
        self.present.key
    }

    /// Control steps since reset.
    pub fn steps(&self) -> u32 {
        self.present.task.step
    }

    /// Length of a control step, s.
    pub fn control_period(&self) -> f64 {
        1.0 / self.task.control_frequency
    }

    /// Active, resting and fatigued units of the muscles, if they tire.
    pub fn compartments(&self) -> Option<&Compartments> {
        self.present.compartments.as_ref()
    }

    /// The physical state.
    pub fn state(&self) -> &State<f64> {
        &self.present.state
    }

    /// The sensor record of the present snapshot, laid out as the task's `frame` says.
    pub fn frame(&self) -> &[f64] {
        &self.present.frame
    }

    /// The present observation, in the order and units of the task's channels.
    pub fn observation(&self) -> &[f64] {
        &self.present.observation
    }

    /// What the task said of the last step.
    pub fn report(&self) -> &StepReport {
        &self.present.report
    }

    /// The last step's reward by terms.
    pub fn reward(&self) -> Reward<'_> {
        Reward { episode: self }
    }

    /// The weights in force, one per term.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The weights in force, one per term; changing them never recompiles.
    pub fn weights_mut(&mut self) -> &mut [f64] {
        &mut self.weights
    }

    /// How the episode has ended, if it has.
    pub fn ending(&self) -> Option<&Ending> {
        self.present.ending.as_ref()
    }

    /// Whether the task's success holds at the last step. An episode that ended in a fault has not succeeded.
    pub fn success(&self) -> bool {
        self.present.report.success
    }

    /// Where the task's markers are now: names and world positions, m.
    pub fn markers(&self) -> Vec<(String, [f64; 3])> {
        let place = |index: usize| self.task.marker(index, &self.present.frame, &self.present.task);
        let names = self.task.markers.iter().enumerate();
        names.filter_map(|(index, name)| Some((name.clone(), place(index)?))).collect()
    }

    /// What a policy may look at.
    pub fn context(&self) -> PolicyContext<'_> {
        PolicyContext {
            task: &self.task,
            body: &self.body,
            model: &self.model,
            key: self.present.key,
            step: self.steps(),
            substeps: self.substeps,
            progress: &self.present.task,
            observation: &self.present.observation,
            state: &self.present.state,
            workspace: &self.workspace,
        }
    }
}

/// Physics steps per control step.
fn substeps(task: &CompiledTask, timestep: f64) -> Result<u32, EpisodeError> {
    let substeps = 1.0 / (task.control_frequency * timestep);
    let whole = substeps.round();
    if (1.0..=1e6).contains(&whole) && (substeps - whole).abs() <= 1e-9 * whole {
        return Ok(whole as u32);
    }
    let (task, frequency) = (task.name.clone(), task.control_frequency);
    Err(EpisodeError::Substeps { task, frequency, timestep, substeps })
}

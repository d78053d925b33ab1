//! One episode after the other, with everything that playing it takes.

use super::{Ending, Engine, Episode, EpisodeError, EpisodeKey, Fault, Player, Scratch, StartReport, Weights};
use crate::action::Action;
use crate::body::Body;
use crate::condition::{Compartments, Fatigue};
use crate::policy::PolicyContext;
use msk_physics::model::Model;
use msk_physics::{self as physics, State};
use msk_program::task::{CompiledTask, Disturbance, ParameterError, StepReport, TaskState};
use std::sync::Arc;

/// A task on a body that a policy acts on: an engine, the present episode, the weights that reward it, and scratch.
#[derive(Clone)]
pub struct Environment {
    pub(super) engine: Engine,
    pub(super) weights: Weights,
    /// Those of the next episode, one per parameter; none if they are those of the task.
    pub(super) parameters: Vec<f64>,
    pub(super) episode: Episode,
    pub(super) scratch: Scratch,
}

/// A reward term of the present step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TermReward {
    /// Unweighted value.
    pub value: f64,
    /// Weight in force.
    pub weight: f64,
}

impl TermReward {
    /// What the term adds to the reward.
    pub fn contribution(self) -> f64 {
        self.weight * self.value
    }
}

/// The reward of the present step, term by term.
#[derive(Debug, Clone, Copy)]
pub struct Reward<'a> {
    environment: &'a Environment,
}

impl Reward<'_> {
    /// Sum over all terms of weight times value.
    pub fn total(&self) -> f64 {
        self.environment.episode.report.reward
    }

    /// The term of that name; `None` if the task has no such term.
    pub fn term(&self, name: &str) -> Option<TermReward> {
        let index = self.environment.engine.task.terms.iter().position(|term| term.name == name)?;
        let value = *self.environment.episode.report.terms.get(index)?;
        Some(TermReward { value, weight: self.environment.weights()[index] })
    }
}

impl core::fmt::Debug for Environment {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Environment")
            .field("task", &self.engine.task.name)
            .field("episode", &self.episode)
            .finish_non_exhaustive()
    }
}

impl Environment {
    /// Episode 0 of seed 0, reset.
    ///
    /// # Errors
    /// A task for another body, or a control step that is not a whole number of physics steps.
    pub fn new(model: Arc<Model>, body: Arc<Body>, task: Arc<CompiledTask>) -> Result<Self, EpisodeError> {
        Ok(Self::of(Engine::new(model, body, task)?))
    }

    /// Episode 0 of seed 0, reset.
    pub fn of(engine: Engine) -> Self {
        let (episode, scratch, weights) = (engine.episode(), engine.scratch(), Weights::of(&engine.task));
        let mut environment = Self { engine, weights, parameters: Vec::new(), episode, scratch };
        environment.reset(EpisodeKey::default());
        environment
    }

    /// The same environment with muscles that tire, reset: fresh ones begin it.
    pub fn with_fatigue(mut self, fatigue: Option<Fatigue>) -> Self {
        self.engine = self.engine.with_fatigue(fatigue);
        self.reset(self.episode.key);
        self
    }

    /// The same environment for scripts alone: see [`Engine::for_scripts`].
    pub fn for_scripts(mut self) -> Self {
        self.engine = self.engine.for_scripts();
        self
    }

    pub(super) fn player(&mut self) -> Player<'_> {
        self.engine.player(&mut self.episode, self.weights.in_force(), &mut self.scratch)
    }

    /// An episode about to begin, with its parameters.
    pub(super) fn beginning(&mut self) -> Player<'_> {
        self.episode.task.parameters.clone_from(&self.parameters);
        self.player()
    }

    /// Begins the episode `key`. An initial state from which the physics cannot start ends it at once, with a fault.
    pub fn reset(&mut self, key: EpisodeKey) {
        self.beginning().reset(key, &[]);
    }

    /// The same with randoms that are `given` (place, value) and not drawn. The report holds what the task computes before
    /// anything moves.
    pub fn reset_given(&mut self, key: EpisodeKey, given: &[(usize, Vec<f64>)]) {
        let mut player = self.beginning();
        player.reset(key, given);
        if player.episode.ending.is_none() {
            player.report();
        }
    }

    /// What does not fit when the episode `key` begins, before anything settles.
    ///
    /// # Errors
    /// An initial state from which the physics cannot start.
    pub fn inspect_start(&self, key: EpisodeKey) -> Result<StartReport, Fault> {
        let mut other = self.clone();
        let Episode { key: own, state, task, streams, .. } = &mut other.episode;
        *own = key;
        *state = State::new(&self.engine.model);
        *task = TaskState { parameters: self.parameters.clone(), ..TaskState::default() };
        streams.start(key, &self.engine.task.randoms);
        self.engine.task.begin(streams, task)?;
        other.player().vary()?;
        other.player().place(key)?;
        physics::forward(&self.engine.model, &other.episode.state, &mut other.scratch.workspace)?;
        Ok(StartReport::of(&self.engine.model, &other.scratch.workspace))
    }

    /// Adds a push, as an evaluation does: it begins with the next control step and lasts `steps`. Force (N) and torque (N m)
    /// act on a landmark (an index into the body's) in world axes. The next reset takes it away.
    pub fn push(&mut self, landmark: usize, [force, torque]: [[f64; 3]; 2], steps: u32) {
        let start = self.steps();
        self.episode.pushes.push(Disturbance { landmark, force, torque, start, steps, every: 0 });
    }

    /// Takes one control step with `action`, entries in [-1, 1]; what lies outside is clipped. A slice is an action of the task's own
    /// space: one entry per muscle, unless the task has an `act` block.
    ///
    /// A step that meets a fault is rewarded with 0, is not counted, and ends the episode.
    ///
    /// # Errors
    /// An action of the wrong length, or an episode that has ended.
    pub fn step<'a>(&mut self, action: impl Into<Action<'a>>) -> Result<&StepReport, EpisodeError> {
        self.player().step(action.into())?;
        Ok(&self.episode.report)
    }

    /// Lets an episode that its task has ended go on, as if it had not: what the task measures is measured as ever, and the next
    /// step may end it again. Returns whether it goes on; neither a fault nor the horizon can be passed.
    pub fn ignore_termination(&mut self) -> bool {
        let passes = self.episode.ending.as_ref().is_none_or(Ending::is_of_task) && self.steps() < self.engine.task.horizon;
        if passes {
            self.episode.ending = None;
        }
        passes
    }

    /// The present episode: all that is needed to go on from here bit for bit. A clone is a snapshot.
    pub fn episode(&self) -> &Episode {
        &self.episode
    }

    /// A copy of the present episode.
    pub fn snapshot(&self) -> Episode {
        self.episode.clone()
    }

    /// Goes back (or forth) to an episode of the same task, as it was when it was cloned. Weights are settings and stay as they are.
    pub fn restore(&mut self, episode: &Episode) {
        self.episode.clone_from(episode);
        // The forward pass is a function of the state, so a fault here is the one that the episode already ended with.
        let _ = self.scratch.pass(&self.engine.model, &self.episode.state);
    }

    /// What does not change while episodes are played.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// The task.
    pub fn task(&self) -> &Arc<CompiledTask> {
        &self.engine.task
    }

    /// Which episode of which seed.
    pub fn key(&self) -> EpisodeKey {
        self.episode.key
    }

    /// Control steps since reset.
    pub fn steps(&self) -> u32 {
        self.episode.task.step
    }

    /// Length of a control step, s.
    pub fn control_period(&self) -> f64 {
        self.engine.control_period()
    }

    /// Active, resting and fatigued units of the muscles, if they tire.
    pub fn compartments(&self) -> Option<&Compartments> {
        self.episode.compartments.as_ref()
    }

    /// The physical state.
    pub fn state(&self) -> &State<f64> {
        &self.episode.state
    }

    /// The sensor record of the present snapshot, laid out by the task's `frame`.
    pub fn frame(&self) -> &[f64] {
        &self.episode.frame
    }

    /// The present observation, in the order and units of the task's channels.
    pub fn observation(&self) -> &[f64] {
        &self.episode.observation
    }

    /// What only a critic sees: see [`Episode::critic_observation`].
    pub fn critic_observation(&self) -> &[f64] {
        self.episode.critic_observation()
    }

    /// The report of the last step.
    pub fn report(&self) -> &StepReport {
        &self.episode.report
    }

    /// The last step's reward by terms.
    pub fn reward(&self) -> Reward<'_> {
        Reward { environment: self }
    }

    /// The weights in force, one per term: at the present [progress](Self::set_progress) of a training.
    pub fn weights(&self) -> &[f64] {
        self.weights.in_force()
    }

    /// The weights of the end of a training, one per term. They differ from those in force only where a weight is scheduled.
    pub fn last_weights(&self) -> &[f64] {
        self.weights.last()
    }

    /// Sets the weight of a term, of a scheduled one the last weight, from the next step on; nothing is compiled anew. A term that does
    /// not exist is left out.
    pub fn set_weight(&mut self, term: usize, weight: f64) {
        self.weights.set(&self.engine.task, term, weight);
    }

    /// Sets a parameter that the task declares `per episode`, in SI units, from the next reset on.
    ///
    /// # Errors
    /// No such parameter, one that is a constant of the compiled task, or a value outside of its range.
    pub fn set_parameter(&mut self, name: &str, value: f64) -> Result<(), ParameterError> {
        self.engine.task.set_parameter(&mut self.parameters, name, value)
    }

    /// The parameters of the episodes to come, in SI units and the task's order.
    pub fn parameters(&self) -> Vec<f64> {
        self.engine.task.complete_parameters(&self.parameters)
    }

    /// The share of a training that has passed, 0 to 1: 1 unless it is set.
    pub fn progress(&self) -> f64 {
        self.weights.progress()
    }

    /// Gives every scheduled weight the value that it has at a share of the training, 0 to 1, from the next step on.
    ///
    /// # Errors
    /// What is no number from 0 to 1.
    pub fn set_progress(&mut self, progress: f64) -> Result<(), EpisodeError> {
        self.weights.set_progress(&self.engine.task, progress)
    }

    /// How the episode has ended, if it has.
    pub fn ending(&self) -> Option<&Ending> {
        self.episode.ending.as_ref()
    }

    /// Whether the task's success holds at the last step. An episode that ended in a fault has not succeeded.
    pub fn success(&self) -> bool {
        self.episode.report.success
    }

    /// Where the task's markers are now: names and world positions, m.
    pub fn markers(&self) -> Vec<(String, [f64; 3])> {
        let place = |index: usize| self.engine.task.marker(index, &self.episode.frame, &self.episode.task);
        let names = self.engine.task.markers.iter().enumerate();
        names.filter_map(|(index, name)| Some((name.clone(), place(index)?))).collect()
    }

    /// What a policy may look at.
    pub fn context(&self) -> PolicyContext<'_> {
        self.engine.context(&self.episode, self.weights.in_force(), &self.scratch)
    }
}

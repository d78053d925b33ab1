//! What episodes of a task are played with: everything that does not change while they are, and the scratch of a worker.

use super::{Episode, EpisodeError, EpisodeKey, Player, variation};
use crate::action::{Action, ActionBuffer, ActionState, ActsOn, ControlMemory};
use crate::body::{Body, sensors};
use crate::condition::Fatigue;
use crate::perturbation::Perturbation;
use crate::policy::PolicyContext;
use msk_physics::model::Model;
use msk_physics::{self as physics, Parts, Plan, State, Workspace};
use msk_program::action::ActionTarget;
use msk_program::frame::Sensor;
use msk_program::task::{CompiledTask, StepReport, TaskState};
use std::sync::Arc;

/// A task on a body: immutable, shared by all episodes and all workers.
#[derive(Clone)]
pub struct Engine {
    pub(super) model: Arc<Model>,
    /// What follows from the model: shared by all scratch.
    pub(super) plan: Plan,
    pub(super) body: Arc<Body>,
    pub(super) task: Arc<CompiledTask>,
    /// Physics steps per control step.
    pub(super) substeps: u32,
    /// Of a forward pass, what a step reads when all that anyone sees of it is the record, the observation and the report.
    pub(super) parts: Parts,
    pub(super) fatigue: Option<Fatigue>,
    pub(super) perturbation: Perturbation,
    /// Whether steps that a script shows end with the whole forward pass; else with what of it knows no forces.
    pub(super) forces: bool,
    /// Whether steps write the observation.
    pub(super) observes: bool,
}

/// The memory of one worker: the forward pass of the episode that it played last.
///
/// It decides nothing. An episode that comes to another worker, or after another episode, is passed forward anew and goes on
/// with the same bits.
#[derive(Debug, Clone)]
pub struct Scratch {
    /// Of the engines that it can serve.
    model: Arc<Model>,
    body: Arc<Body>,
    pub(super) workspace: Workspace<f64>,
    /// The state whose whole forward pass `workspace` holds.
    passed: State<f64>,
    holds: bool,
    /// Whether the lane of its group holds the same.
    pub(super) in_lane: bool,
    pub(super) control: ControlMemory,
}

impl Scratch {
    /// Whether the forward pass is that of `state`.
    pub(super) fn is_of(&self, state: &State<f64>) -> bool {
        self.holds && self.passed == *state
    }

    /// Notes that the forward pass is that of `state`.
    pub(super) fn note(&mut self, state: &State<f64>) {
        self.passed.copy_from(state);
        self.holds = true;
        self.in_lane = false;
    }

    /// Notes that the forward pass is of no state that an episode goes on from.
    pub(super) fn forget(&mut self) {
        self.holds = false;
        self.in_lane = false;
    }

    /// Passes forward, unless that has been done.
    ///
    /// # Errors
    /// Those of the physics.
    pub(super) fn pass(&mut self, model: &Model, state: &State<f64>) -> Result<(), physics::Fault> {
        if !self.is_of(state) {
            self.forget();
            physics::forward(model, state, &mut self.workspace)?;
            self.note(state);
        }
        Ok(())
    }
}

impl Engine {
    /// The task on its body.
    ///
    /// # Errors
    /// A task for another body, or a control step that is not a whole number of physics steps.
    pub fn new(model: Arc<Model>, body: Arc<Body>, task: Arc<CompiledTask>) -> Result<Self, EpisodeError> {
        let plan = Plan::new(&model);
        Self::of(model, body, task, plan)
    }

    fn of(model: Arc<Model>, body: Arc<Body>, task: Arc<CompiledTask>, plan: Plan) -> Result<Self, EpisodeError> {
        if task.body.name != body.name {
            let (expected, found) = (task.body.name.clone(), body.name.clone());
            return Err(EpisodeError::Body { task: task.name.clone(), expected, found });
        }
        let substeps = substeps(&task, model.options.timestep)?;
        variation::check(&model, &body, &task.init)?;
        let perturbation = Perturbation::default();
        let parts = parts(&model, &body, &task);
        Ok(Self { plan, substeps, parts, fatigue: None, perturbation, forces: true, observes: true, model, body, task })
    }

    /// Another task on the same model and body: what follows from the model is shared.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn beside(&self, task: Arc<CompiledTask>) -> Result<Self, EpisodeError> {
        let Self { model, body, plan, .. } = self;
        Self::of(Arc::clone(model), Arc::clone(body), task, plan.clone())
    }

    /// The same with muscles that tire.
    pub fn with_fatigue(self, fatigue: Option<Fatigue>) -> Self {
        Self { fatigue, ..self }
    }

    /// The same with perturbed episodes. What is out of its bounds is for [`Perturbation::check`].
    pub fn with_perturbation(self, perturbation: Perturbation) -> Self {
        Self { perturbation, ..self }
    }

    /// The same for scripts alone: where the task's frame has no sensor of a force, steps that a script shows leave out what
    /// only forces need, and their numbers stay the same. Physics must not take over.
    pub fn for_scripts(self) -> Self {
        let forces = self.task.frame.entries().iter().any(|(sensor, _)| sensor.needs_forces());
        Self { forces, ..self }
    }

    /// Memory for a worker.
    pub fn scratch(&self) -> Scratch {
        Scratch {
            model: Arc::clone(&self.model),
            body: Arc::clone(&self.body),
            workspace: Workspace::of(&self.model, &self.plan),
            passed: State::new(&self.model),
            holds: false,
            in_lane: false,
            control: ControlMemory::default(),
        }
    }

    /// Memory for an episode, which must be [`reset`](Self::reset) before it is played.
    pub fn episode(&self) -> Episode {
        Episode {
            key: EpisodeKey::default(),
            identity: None,
            state: State::new(&self.model),
            disturbances: Vec::new(),
            pushes: Vec::new(),
            task: TaskState::default(),
            streams: super::Streams::default(),
            memory: sensors::Memory::default(),
            compartments: None,
            action: ActionState::new(&self.task.action, self.body.muscles.len()),
            late: std::collections::VecDeque::new(),
            frame: vec![0.0; self.task.frame.size()],
            observation: vec![0.0; self.task.observation_size()],
            critic: vec![0.0; self.task.critic_size()],
            report: StepReport::default(),
            total: 0.0,
            totals: vec![0.0; self.task.terms.len()],
            ending: None,
        }
    }

    /// Begins the episode `key`. An initial state from which the physics cannot start ends it at once, with a fault.
    /// An episode or scratch of another engine becomes one of this engine.
    pub fn reset(&self, key: EpisodeKey, episode: &mut Episode, scratch: &mut Scratch) {
        self.reset_with(key, &[], episode, scratch);
    }

    /// The same with the values of all parameters, in SI units and the task's order, each as [`CompiledTask::check_parameter`] has it;
    /// with none of them those of the task. Values that the task does not accept end the episode at once, with a fault.
    pub fn reset_with(&self, key: EpisodeKey, parameters: &[f64], episode: &mut Episode, scratch: &mut Scratch) {
        if !self.made(episode) {
            *episode = self.episode();
        }
        if !self.serves(scratch) {
            *scratch = self.scratch();
        }
        episode.task.parameters = parameters.to_vec();
        self.player(episode, &[], scratch).reset(key, &[]);
    }

    /// Takes one control step with `action`, rewarded by `weights`, one per term. A slice is an action of the task's own space.
    ///
    /// # Errors
    /// An action or weights of the wrong length, an episode that has ended, or an episode or scratch of another engine.
    pub fn step<'a>(
        &self,
        episode: &mut Episode,
        action: impl Into<Action<'a>>,
        weights: &[f64],
        scratch: &mut Scratch,
    ) -> Result<(), EpisodeError> {
        let (expected, found) = (self.task.terms.len(), weights.len());
        if expected != found {
            return Err(EpisodeError::Weights { expected, found });
        }
        if !self.made(episode) {
            return Err(EpisodeError::Foreign { what: "episode", remedy: "reset it, or restore one of this engine's" });
        }
        if !self.serves(scratch) {
            return Err(EpisodeError::Foreign { what: "scratch", remedy: "use one that `Engine::scratch` made" });
        }
        self.player(episode, weights, scratch).step(action.into())
    }

    /// Whether the episode was begun here, or by an engine of the same task on a body of the same size.
    pub(super) fn made(&self, episode: &Episode) -> bool {
        episode.identity.as_ref() == Some(&self.task.hash) && episode.state.fits(&self.model)
    }

    /// Whether an episode that came from outside was begun here, or by an engine of the same task on a body of the same size, and
    /// has the shape of one: only then it may be restored.
    pub fn accepts(&self, episode: &Episode) -> bool {
        let Episode { disturbances, task, streams, compartments, action, frame, observation, critic, report, totals, .. } =
            episode;
        let counted = |part: usize, whole: usize| part == 0 || part == whole;
        let muscles = self.body.muscles.len();
        self.made(episode)
            && self.task.accepts(task)
            && streams.len() == self.task.randoms.len()
            && compartments.as_ref().is_none_or(|compartments| compartments.len() == muscles)
            && counted(disturbances.len(), self.task.disturbances.len())
            && action.fits(&ActionState::new(&self.task.action, self.body.muscles.len()))
            && [frame.len(), observation.len()] == [self.task.frame.size(), self.task.observation_size()]
            && critic.len() == self.task.critic_size()
            && counted(report.terms.len(), self.task.terms.len())
            && totals.len() == self.task.terms.len()
    }

    pub(super) fn serves(&self, scratch: &Scratch) -> bool {
        Arc::ptr_eq(&scratch.model, &self.model) && Arc::ptr_eq(&scratch.body, &self.body)
    }

    pub(super) fn player<'a>(&'a self, episode: &'a mut Episode, weights: &'a [f64], scratch: &'a mut Scratch) -> Player<'a> {
        Player { engine: self, episode, weights, scratch }
    }

    /// What a policy may look at in an episode that `weights` reward, one per term, and whose forward pass is in `scratch`.
    pub fn context<'a>(&'a self, episode: &'a Episode, weights: &'a [f64], scratch: &'a Scratch) -> PolicyContext<'a> {
        PolicyContext {
            engine: self,
            episode,
            weights,
            task: &self.task,
            body: &self.body,
            model: &self.model,
            key: episode.key,
            step: episode.steps(),
            substeps: self.substeps,
            progress: &episode.task,
            observation: &episode.observation,
            state: &episode.state,
            workspace: &scratch.workspace,
        }
    }

    /// Whether it is the same, so that memory of one serves the other.
    pub fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.model, &other.model)
            && Arc::ptr_eq(&self.task, &other.task)
            && self.fatigue == other.fatigue
            && self.perturbation == other.perturbation
    }

    /// Number of entries of an action in the task's own space.
    pub fn action_size(&self) -> usize {
        ActsOn::Task.size(&self.task, &self.body)
    }

    /// The action that asks for nothing.
    pub fn action(&self, acts_on: ActsOn) -> ActionBuffer {
        ActionBuffer::new(acts_on, &self.task, &self.body)
    }

    /// The task.
    pub fn task(&self) -> &Arc<CompiledTask> {
        &self.task
    }

    /// The body.
    pub fn body(&self) -> &Arc<Body> {
        &self.body
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Length of a control step, s.
    pub fn control_period(&self) -> f64 {
        1.0 / self.task.control_frequency
    }
}

/// Which parts of a forward pass a step of the task reads itself.
fn parts(model: &Model, body: &Body, task: &CompiledTask) -> Parts {
    // The next step begins with the pass where a controller looks at it, or where forces change in it.
    let begins = ActionState::new(&task.action, body.muscles.len()).looks_at_state()
        || matches!(task.action.target, ActionTarget::Torque { .. })
        || !task.disturbances.is_empty()
        || !task.driven.is_empty()
        || !model.actuators.act_by_activation();
    let reads = |needs: fn(Sensor) -> bool| task.frame.entries().iter().any(|(sensor, _)| needs(*sensor));
    let own = Parts { inertia: reads(Sensor::needs_inertia), tendons: reads(Sensor::needs_tendons) };
    if begins { Parts::ALL } else { own }
}

/// Physics steps per control step.
pub(super) fn substeps(task: &CompiledTask, timestep: f64) -> Result<u32, EpisodeError> {
    let substeps = 1.0 / (task.control_frequency * timestep);
    let whole = substeps.round();
    if (1.0..=1e6).contains(&whole) && (substeps - whole).abs() <= 1e-9 * whole {
        return Ok(whole as u32);
    }
    let (task, frequency) = (task.name.clone(), task.control_frequency);
    Err(EpisodeError::Substeps { task, frequency, timestep, substeps })
}

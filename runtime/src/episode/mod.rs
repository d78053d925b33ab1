//! Episodes: a task on a body, from reset to its end.
//!
//! One control step follows the synchronous rule of the language:
//!
//! 1. the action becomes excitations, held while the physics takes its substeps;
//! 2. a forward pass of the new state gives one snapshot, from which the sensors fill the task's frame;
//! 3. the task advances its operators and evaluates terms, terminations and success;
//! 4. the end is decided, then the policy's observation is written.
//!
//! An [`Engine`] is what does not change (model, body, task) and is shared; an [`Episode`] is plain data of a few kilobytes, which
//! can be cloned, kept, moved between threads, and goes on bit for bit; [`Scratch`] is the memory of a worker, whichever episode it
//! plays, and [`GroupScratch`] that of one which plays eight at once. An [`Environment`] is one episode, a [`VectorEnvironment`]
//! many on a few workers. What goes wrong inside an episode (diverging physics, a term that is not finite) is a [`Fault`] of that
//! episode alone.

mod controlling;
mod ending;
mod engine;
mod environment;
mod imagination;
mod initial_state;
mod passing;
mod perturbing;
mod player;
mod playing;
mod pushes;
mod start;
mod streams;
mod together;
mod variation;
mod vector;
mod weights;

pub use crate::action::{REST, excitation};
pub use controlling::Controlled;
pub use ending::{Ending, EpisodeError, Fault};
pub use engine::{Engine, Scratch};
pub use environment::{Environment, Reward, TermReward};
pub use passing::PassGroup;
pub use start::{Penetration, Residual, StartReport};
pub use streams::{EpisodeKey, Stream};
pub use together::{GroupScratch, Member};
pub use vector::{AutoresetMode, EpisodeEnd, MixError, VectorEnvironment, VectorStep, single_precision};

use crate::action::ActionState;
use crate::body::sensors;
use crate::condition::Compartments;
use msk_physics::State;
use msk_program::task::{Disturbance, StepReport, TaskState};
use player::Player;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use streams::Streams;
use weights::Weights;

/// Everything that changes over an episode: plain data, from which it continues bit for bit. One that was read by serde is checked by
/// [`Engine::accepts`] before it is played.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Episode {
    key: EpisodeKey,
    /// The hash of its task; none before it is reset.
    identity: Option<String>,
    /// With the solver's warm start.
    state: State<f64>,
    /// Those of the task, with what was drawn for them.
    disturbances: Vec<Disturbance>,
    /// Pushes that were added to them.
    pushes: Vec<Disturbance>,
    /// With the states, clocks and operators of the task.
    task: TaskState,
    /// Where each random of the task draws from.
    streams: Streams,
    /// With the velocities of the previous step.
    memory: sensors::Memory,
    /// Of muscles that tire.
    compartments: Option<Compartments>,
    action: ActionState,
    /// Actions that have not taken effect yet, where an evaluation delays them.
    #[serde(default)]
    late: VecDeque<Vec<f64>>,
    frame: Vec<f64>,
    observation: Vec<f64>,
    /// What only a critic sees.
    critic: Vec<f64>,
    report: StepReport,
    /// Sum of the rewards since reset.
    total: f64,
    /// Sum of weight times value since reset, by term.
    totals: Vec<f64>,
    ending: Option<Ending>,
}

impl Episode {
    /// Which episode of which seed.
    pub fn key(&self) -> EpisodeKey {
        self.key
    }

    /// Whether the controller of the task's action space goes along with it. Such an episode can be cloned; what serde writes of it
    /// has no controller, so [`Engine::accepts`] refuses it.
    pub fn has_controller(&self) -> bool {
        self.action.looks_at_state()
    }

    /// Control steps since reset.
    pub fn steps(&self) -> u32 {
        self.task.step
    }

    /// The physical state.
    pub fn state(&self) -> &State<f64> {
        &self.state
    }

    /// The values of the task's parameters in this episode, in SI units and the task's order; none if they are those of the task.
    pub fn parameters(&self) -> &[f64] {
        &self.task.parameters
    }

    /// The present observation, in the order and units of the task's channels.
    pub fn observation(&self) -> &[f64] {
        &self.observation
    }

    /// What only a critic sees at present, beside the observation, in the order and units of [`CompiledTask::critic`].
    ///
    /// [`CompiledTask::critic`]: msk_program::task::CompiledTask::critic
    pub fn critic_observation(&self) -> &[f64] {
        &self.critic
    }

    /// The last action in the task's own space, entries clipped to [-1, 1]; its rest before the first one, and after one of a policy
    /// that acts on the muscles beside that space.
    pub fn action(&self) -> &[f64] {
        // A space of one entry per muscle keeps no entries of its own.
        if self.action.entries.is_empty() { &self.action.muscles } else { &self.action.entries }
    }

    /// What the task reports of the last step.
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// The return so far: the sum of the rewards since reset, without discount.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// What each term has added to the return so far, in the task's order: weight times value, summed up.
    pub fn totals(&self) -> &[f64] {
        &self.totals
    }

    /// How the episode has ended, if it has.
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }
}

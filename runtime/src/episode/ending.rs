//! How an episode ends, and what can go wrong within one.

use crate::body::OutOfReach;
use crate::cmc::ControlError;
use msk_physics as physics;
use msk_program::numbers::{exact, for_people};
use msk_program::task::{CompiledTask, NonFiniteTerm, NotDrawn, ParameterError, TaskFault};
use serde::{Deserialize, Serialize};

/// The end of an episode. A failure of the task, the horizon and a fault of the computation are three different things.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Ending {
    /// The task's own reasons for failure that held at the last step, as indices into its `terminations`; several may.
    /// Reasons to finish that held as well stand in the report of that step.
    Terminated(Vec<usize>),
    /// The task's reasons to finish that held at the last step, as indices into its `finishes`; none of them is a failure.
    Finished(Vec<usize>),
    /// The horizon was reached and nothing else ended the episode.
    Truncated,
    /// The computation could not go on.
    Fault(Fault),
}

impl Ending {
    /// Whether the task ended it, and neither time nor a fault.
    pub fn is_of_task(&self) -> bool {
        matches!(self, Self::Terminated(_) | Self::Finished(_))
    }

    /// Whether a learner values what would have followed by the last observation (it bootstraps): at the horizon, after a fault, and
    /// after reasons to finish beside all of which the task says `bootstrap`; never after a failure.
    pub fn bootstraps(&self, task: &CompiledTask) -> bool {
        match self {
            Self::Terminated(_) => false,
            Self::Finished(holding) => holding.iter().all(|&index| task.bootstraps.get(index) == Some(&true)),
            Self::Truncated | Self::Fault(_) => true,
        }
    }

    /// The names of the conditions of `task` that ended it, joined by `and`; empty if the task did not end it.
    pub fn conditions(&self, task: &CompiledTask) -> String {
        let (holding, all) = match self {
            Self::Terminated(holding) => (holding, &task.terminations),
            Self::Finished(holding) => (holding, &task.finishes),
            Self::Truncated | Self::Fault(_) => return String::new(),
        };
        let names: Vec<&str> = holding.iter().filter_map(|&index| all.get(index)).map(String::as_str).collect();
        names.join(" and ")
    }
}

/// An event that ends one episode and leaves all others alone. Nothing is repaired and nothing is teleported.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
pub enum Fault {
    /// The physics could not step: where and when, by names.
    #[error(transparent)]
    Physics(#[from] physics::Fault),
    /// A reward term was not a finite number.
    #[error(transparent)]
    Term(#[from] NonFiniteTerm),
    /// The sum of rewards left the range of numbers.
    #[error(
        "the return is {value} after the reward {} of step {step}; its sum has to stay finite, so the weights are too large",
        for_people(*.reward)
    )]
    Return {
        /// The sum, which is not finite.
        value: f64,
        /// The reward of the step.
        reward: f64,
        /// Control step.
        step: u32,
    },
    /// A channel of the observation was not a finite number.
    #[error("the channel `{channel}` of the observation is {value} at step {step}")]
    Observation {
        /// Its name.
        channel: String,
        /// The value.
        value: f64,
        /// Control step.
        step: u32,
    },
    /// A random none of whose draws fulfilled its condition.
    #[error(transparent)]
    Draw(#[from] NotDrawn),
    /// A parameter has a value that the task does not accept.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// What was drawn makes a body or scene that cannot be.
    #[error("{what} of this episode is {}; expected {expected}", exact(*.value))]
    Variation {
        /// Which number, and of what.
        what: String,
        /// What was drawn.
        value: f64,
        /// What it may be.
        expected: String,
    },
    /// Joints that are to bring a landmark to its place do not reach it.
    #[error(transparent)]
    Reach(#[from] OutOfReach),
    /// The policy gave an action that is not a number.
    #[error("the action for `{entry}` is {value} at step {step}")]
    Action {
        /// Name of the entry: a muscle, or what the action space of the task has.
        entry: String,
        /// What was given.
        value: f64,
        /// Control step.
        step: u32,
    },
    /// The controller of the task's action space does not support the body or the task.
    #[error("the action space of the task cannot be used: {0}")]
    Control(#[from] ControlError),
}

impl From<TaskFault> for Fault {
    fn from(fault: TaskFault) -> Self {
        match fault {
            TaskFault::Term(term) => Self::Term(term),
            TaskFault::Draw(draw) => Self::Draw(draw),
            TaskFault::Parameter(parameter) => Self::Parameter(parameter),
        }
    }
}

/// A wrong use of an episode.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EpisodeError {
    /// The task is for another body.
    #[error("task `{task}` is for the body `{expected}`, not for `{found}`")]
    Body {
        /// The task.
        task: String,
        /// The body it names.
        expected: String,
        /// The body given.
        found: String,
    },
    /// A control step is not a whole number of physics steps.
    #[error(
        "task `{task}` is controlled at {} Hz, which is {} physics steps of {} s: not a whole number",
        exact(*.frequency), exact(*.substeps), exact(*.timestep)
    )]
    Substeps {
        /// The task.
        task: String,
        /// Control steps per second.
        frequency: f64,
        /// Physics step, s.
        timestep: f64,
        /// Physics steps per control step.
        substeps: f64,
    },
    /// The initial state scales a parameter that the body does not have.
    #[error(
        "`{what}` of `{joint}` is zero, so a factor has no effect: give the joint one, `body human with {joint}.{what} = ...`"
    )]
    NothingToScale {
        /// Damping or stiffness.
        what: &'static str,
        /// The first of the joints.
        joint: String,
    },
    /// The action has the wrong length.
    #[error("the action has {found} entries, expected {expected}")]
    ActionSize {
        /// Entries of an action in the task's action space.
        expected: usize,
        /// Entries given.
        found: usize,
    },
    /// The weights have the wrong length.
    #[error("there are {found} weights; the task has {expected} reward terms")]
    Weights {
        /// Number of reward terms.
        expected: usize,
        /// Weights given.
        found: usize,
    },
    /// The progress of a training is no share of it.
    #[error("the progress of a training is a number from 0 to 1, found {found}")]
    Progress {
        /// What was given.
        found: f64,
    },
    /// The episode was not begun by this engine, or the scratch is not of its making: their numbers mean other things here.
    #[error("the {what} does not belong to this engine: {remedy}")]
    Foreign {
        /// The episode or the scratch.
        what: &'static str,
        /// What makes it one's own.
        remedy: &'static str,
    },
    /// The episode has ended; only a reset or a restored snapshot leads on.
    #[error("the episode has ended: reset it or restore a snapshot")]
    Ended,
}

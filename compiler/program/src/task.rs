//! A compiled task: what the compiler hands to the runtime.
//!
//! A [`CompiledTask`] is immutable and shared between episodes and threads; what changes over an episode is in a
//! [`TaskState`], plain data that can be snapshot and restored bit for bit.

mod parameters;
mod phase;
mod tested;

pub use parameters::ParameterError;
pub use phase::{Phase, PhaseParts};
pub use tested::TaskTests;

use crate::action::ActionSpace;
use crate::body::BodyDescription;
use crate::frame::FrameLayout;
use crate::init::Start;
use crate::motion::Motion;
use crate::numbers::for_people;
use crate::scene::SceneDescription;
use crate::schedule::Schedule;
use crate::source::Places;
use crate::vocabulary::Vocabulary;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

pub use crate::init::{Disturbance, DisturbanceSetting, Init, ObjectStart, RootPlacement, Setting, Settle, Spread};

/// A task ready to run: closures over a flat frame and a flat state record. A copy shares the program.
#[derive(Clone)]
pub struct CompiledTask {
    /// Name of the task.
    pub name: String,
    /// Family it belongs to.
    pub family: String,
    /// First paragraph of the task's documentation.
    pub summary: String,
    /// The body.
    pub body: Arc<BodyDescription>,
    /// What the task may name, in the order of the numbers that sensors and initial states use: parts of the body, then of the
    /// scene.
    pub vocabulary: Arc<Vocabulary>,
    /// Control steps per second, Hz.
    pub control_frequency: f64,
    /// Episode length, control steps.
    pub horizon: u32,
    /// What the entries of a policy's action ask for.
    pub action: ActionSpace,
    /// Whether mirroring left and right must not change the reward.
    pub symmetric: bool,
    /// What surrounds the body.
    pub scene: SceneDescription,
    /// How an episode begins.
    pub init: Init,
    /// Forces that disturb it.
    pub disturbances: Vec<Disturbance>,
    /// Numbers of these that are drawn: of which disturbance, and the place of the value among those of [`CompiledTask::drawn`].
    pub drawn_disturbances: Vec<(usize, DisturbanceSetting, usize)>,
    /// Connections that let go, by their place in the scene: in the order of [`StepReport::released`].
    pub releases: Vec<usize>,
    /// Names of places that are shown and never touched: [`CompiledTask::marker`] tells where each is.
    pub markers: Vec<String>,
    /// Objects that formulas of time move, by their place in the scene: in the order of [`CompiledTask::drive`].
    pub driven: Vec<usize>,
    /// Channels of the observation, in order.
    pub channels: Vec<Channel>,
    /// Channels that only a critic sees, beside the observation, in order; their offsets begin at 0.
    pub critic: Vec<Channel>,
    /// Reward terms, in order.
    pub terms: Vec<Term>,
    /// Reasons that end an episode as a failure, in order.
    pub terminations: Vec<String>,
    /// Reasons that end an episode without being failures, in order.
    pub finishes: Vec<String>,
    /// After which of these a learner values what would have followed, one for each.
    pub bootstraps: Vec<bool>,
    /// What is logged and never rewarded: parts of [`StepReport::metrics`].
    pub metrics: Vec<Channel>,
    /// What chance decides: each has a stream of its own.
    pub randoms: Vec<RandomValue>,
    /// Numbers that were open when the task was compiled, with the values that it was compiled for, or that episodes have unless others
    /// are given.
    pub parameters: Vec<Parameter>,
    /// Motions that its references follow.
    pub motions: Vec<FollowedMotion>,
    /// Sensors to fill before every evaluation.
    pub frame: FrameLayout,
    /// Hash of the task's meaning: the same text layout or comments aside.
    pub hash: String,
    /// Its tests, if it has any: no part of its meaning.
    pub tests: Option<Arc<TaskTests>>,
    /// Where it stands in the texts: no part of its meaning.
    pub places: Places,
    /// One for a task, several for a sequence; never none.
    pub phases: Arc<[Phase]>,
}

/// A value that chance decides, as the report of a task has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RandomValue {
    /// Its name, which its stream has too.
    pub name: String,
    /// What is drawn, as written.
    pub source: String,
    /// The condition that a draw must fulfil, as written; empty if there is none.
    pub accept: String,
    /// When it is drawn anew, as written; empty if never.
    pub redraw: String,
    /// The parameter, by its place in the task, that a caller sets for every episode and that is never drawn.
    #[serde(skip)]
    pub parameter: Option<usize>,
}

/// A motion that a `reference` follows.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowedMotion {
    /// The reference's name.
    pub name: String,
    /// Its table.
    pub motion: Arc<Motion>,
    /// Where an episode enters it.
    pub start: Start,
    /// In which phase of a sequence it is followed.
    pub phase: usize,
}

/// A number that may be set from outside, where the task is compiled or for every episode, as the report of a task has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// The value in force, in SI units.
    pub value: f64,
    /// The value in the source.
    pub default: f64,
    /// What it may be set to.
    pub range: Option<[f64; 2]>,
    /// Unit, as printed; empty for plain numbers.
    pub unit: String,
    /// Whether a caller may set it for every episode; else it is a constant of the compiled task.
    pub per_episode: bool,
    /// In SI units, what 1 is of the unit in which it is written.
    #[serde(skip)]
    pub scale: f64,
    /// Whether it is a whole number.
    #[serde(skip)]
    pub whole: bool,
}

impl CompiledTask {
    /// The phase of a sequence and the condition for which it waits, in words: "`walk` until `arrived`"; `None` for the last phase,
    /// and for a task by itself.
    pub fn awaited(&self, phase: u32) -> Option<String> {
        let phase = self.phases.get(phase as usize)?;
        let until = phase.debug.until.as_ref()?;
        Some(format!("`{}` until `{}`", phase.name, until.source))
    }
}

/// A named part of the observation.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Label.
    pub name: String,
    /// First index in the observation.
    pub offset: usize,
    /// Number of values.
    pub size: usize,
    /// Unit, as printed (`rad/s`), empty for plain numbers.
    pub unit: String,
}

/// A named reward term.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Label.
    pub name: String,
    /// Weight in force; of a scheduled one that of the end of a training.
    pub weight: f64,
    /// How the weight changes during a training.
    pub schedule: Option<Schedule>,
    /// Weight in the source.
    pub written: f64,
    /// Where the weight in force comes from.
    pub origin: Origin,
    /// Range a tuner may choose from, if given.
    pub weight_range: Option<[f64; 2]>,
    /// Whether the weight is fixed.
    pub fixed: bool,
    /// The formula as written.
    pub source: String,
}

/// Where a weight comes from; a later one wins over an earlier.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Origin {
    /// The text of the task.
    #[default]
    Source,
    /// A weights file, by its path.
    Overlay(String),
    /// The command line.
    CommandLine,
}

impl std::fmt::Display for Origin {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::Source => "the source",
            Self::Overlay(path) => path,
            Self::CommandLine => "the command line",
        })
    }
}

/// What a task reports of one control step. Allocated once per episode, overwritten every step.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    /// Which phase of a sequence is reported; in the step in which the next one begins, still the one before.
    pub phase: u32,
    /// Unweighted value of every reward term.
    pub terms: Vec<f64>,
    /// Sum of weight times value.
    pub reward: f64,
    /// Which terminations hold, in the task's order.
    pub terminations: Vec<bool>,
    /// Which reasons to finish hold, in the task's order.
    pub finishes: Vec<bool>,
    /// Whether the horizon is reached and nothing else ends the episode.
    pub truncated: bool,
    /// Whether the next phase of a sequence begins in this snapshot.
    pub entered: bool,
    /// Values of all metrics, laid out by [`CompiledTask::metrics`].
    pub metrics: Vec<f64>,
    /// Whether the success expression holds at this step.
    pub success: bool,
    /// Which connections shall let go, in the order of [`CompiledTask::releases`].
    pub released: Vec<bool>,
}

/// The task's own state over one episode: plain data.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TaskState {
    /// Control steps since reset.
    pub step: u32,
    /// Which phase of a sequence is present.
    pub phase: u32,
    /// At which step it began.
    pub began: u32,
    /// The values of all parameters for this episode, in SI units and the task's order; those of the task where it is empty.
    pub parameters: Vec<f64>,
    /// Whether the phases before it had succeeded when they ended.
    pub successes: Vec<bool>,
    /// Constants, cells of operators, states and randoms, and what this step's formulas share.
    pub record: Vec<f64>,
}

/// A term whose value is not a finite number: an error of this episode, never a silent zero.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[error("term `{term}` is {} at step {step}: {formula}", for_people(*.value))]
pub struct NonFiniteTerm {
    /// Label of the term.
    pub term: String,
    /// The value.
    pub value: f64,
    /// Control step.
    pub step: u32,
    /// The formula as written.
    pub formula: String,
}

/// A random none of whose tries fulfilled its condition: an error of this episode.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[error("none of {tries} draws of `{random}` at step {step} satisfies `{wanted}`; the last was {last}")]
pub struct NotDrawn {
    /// Its name.
    pub random: String,
    /// How often it was tried.
    pub tries: u32,
    /// The last try, in SI units.
    pub last: String,
    /// Control step.
    pub step: u32,
    /// The condition as written.
    pub wanted: String,
}

/// Why a task could not be evaluated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TaskFault {
    /// A term was not finite.
    #[error(transparent)]
    Term(#[from] NonFiniteTerm),
    /// A random could not be drawn.
    #[error(transparent)]
    Draw(#[from] NotDrawn),
    /// A parameter has a value that the task does not accept.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

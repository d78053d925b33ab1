//! What the compiler hands to the runtime.
//!
//! A [`CompiledTask`] is immutable and shared between episodes and threads; what changes over an episode is in a
//! [`TaskState`], plain data that can be snapshot and restored bit for bit.

use crate::body::BodyDescription;
use crate::check::Compared;
use crate::diagnostics::{Allowance, FileId, Span};
use crate::frame::FrameLayout;
use crate::graph::Graph;
use crate::graph::interval::Bounds;
use crate::lower::{Outputs, Plan, Program};
use crate::motion::{Motion, Start};
use crate::numbers::for_people;
use crate::scene::SceneDescription;
use crate::syntax::tree::Expr;
use crate::testing::TaskTests;
use crate::vocabulary::Vocabulary;
use std::ops::Range;
use std::sync::Arc;

pub use crate::beginning::{Disturbance, Init, ObjectStart, RootPlacement, Setting, Settle, Spread};

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
    /// What the task may name, in the order of the numbers that sensors and beginnings use: parts of the body, then of the
    /// scene.
    pub vocabulary: Arc<Vocabulary>,
    /// Control steps per second, Hz.
    pub control_frequency: f64,
    /// Episode length, control steps.
    pub horizon: u32,
    /// Whether mirroring left and right must not change the pay.
    pub symmetric: bool,
    /// What surrounds the body.
    pub scene: SceneDescription,
    /// How an episode begins.
    pub init: Init,
    /// Forces that disturb it.
    pub disturbances: Vec<Disturbance>,
    /// Connections that let go, by their place in the scene: in the order of [`StepReport::released`].
    pub releases: Vec<usize>,
    /// Names of places that are shown and never touched: [`CompiledTask::marker`] tells where each is.
    pub markers: Vec<String>,
    /// Channels of the observation, in order.
    pub channels: Vec<Channel>,
    /// Reward terms, in order.
    pub terms: Vec<Term>,
    /// Reasons that end an episode as a failure, in order.
    pub terminations: Vec<String>,
    /// Reasons that end an episode without being failures, in order.
    pub finishes: Vec<String>,
    /// What is logged and never paid: parts of [`StepReport::metrics`].
    pub metrics: Vec<Channel>,
    /// What chance decides: each has a stream of its own.
    pub randoms: Vec<RandomValue>,
    /// Numbers that were open when the task was compiled, with the values that it was compiled for.
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
    pub(crate) phases: Arc<[Phase]>,
}

/// Where the parts of a task stand in the texts, for what is told of it once its model is at hand.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Places {
    /// The word `init`.
    pub init: (FileId, Span),
    /// The condition of success.
    pub success: (FileId, Span),
    /// The conditions of the reasons that end an episode as a failure, in order.
    pub terminations: Vec<(FileId, Span)>,
    /// The conditions of the reasons that end an episode without being failures, in order.
    pub finishes: Vec<(FileId, Span)>,
    /// The formulas of the terms, in order.
    pub terms: Vec<(FileId, Span)>,
    /// Every `allow` of the task, and whether it covers what the compiler warns of.
    pub allowances: Vec<Allowance>,
}

/// A task of a sequence; a task that is no sequence has one.
pub(crate) struct Phase {
    /// The task's name.
    pub name: String,
    /// Its length, control steps.
    pub horizon: u32,
    pub program: Program,
    /// Which of the whole's terms are its own.
    pub terms: Range<usize>,
    pub terminations: Range<usize>,
    pub finishes: Range<usize>,
    pub metrics: Range<usize>,
    /// How many values all metrics of the whole have, and which are its own.
    pub measured: (usize, Range<usize>),
    /// For each channel of the whole: its place among the phase's own.
    pub channels: Vec<Option<usize>>,
    /// What is observed while it lasts: all channels of the whole, zero where it has none.
    pub observation: Plan,
    /// For each of its draws: which random of the whole.
    pub streams: Vec<usize>,
    pub meaning: Meaning,
}

/// A value that chance decides.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomValue {
    /// Its name, which its stream has too.
    pub name: String,
    /// What is drawn, as written.
    pub source: String,
    /// The condition that a draw must fulfil, as written; empty if there is none.
    pub accept: String,
    /// When it is drawn anew, as written; empty if never.
    pub redraw: String,
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

/// A number that may be set from outside, where the task is compiled.
#[derive(Debug, Clone, PartialEq)]
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
}

impl CompiledTask {
    /// The phase of a sequence and the condition for which it waits, in words: "`walk` until `arrived`"; `None` for the last phase,
    /// and for a task by itself.
    pub fn awaited(&self, phase: u32) -> Option<String> {
        let phase = self.phases.get(phase as usize)?;
        let until = phase.meaning.until.as_ref()?;
        Some(format!("`{}` until `{}`", phase.name, until.source))
    }
}

/// What explanations and snapshots need beyond what runs.
pub(crate) struct Meaning {
    pub graph: Graph,
    pub outputs: Outputs,
    /// Per term.
    pub terms: Vec<TermMeaning>,
    /// Per reason of `terminate`.
    pub terminations: Vec<ConditionMeaning>,
    /// Per reason of `finish`.
    pub finishes: Vec<ConditionMeaning>,
    /// Per channel of the phase's own.
    pub channels: Vec<ChannelMeaning>,
    /// Per metric.
    pub metrics: Vec<ChannelMeaning>,
    /// When the next phase begins.
    pub until: Option<ConditionMeaning>,
    pub success: Option<ConditionMeaning>,
    /// Comparisons in formulas.
    pub comparisons: Vec<Compared>,
    /// Between which values each term stays.
    pub term_bounds: Vec<Bounds>,
    /// Names of the declared states.
    pub states: Vec<String>,
    /// What formulas name and the task or its libraries declare; what is read stands before its readers.
    pub definitions: Vec<Definition>,
}

/// What is told of a term.
pub(crate) struct TermMeaning {
    pub formula: Expr,
    pub docs: String,
    /// Signals and declared names in it.
    pub reads: Vec<String>,
    /// Whether the formula is a condition, which counts 0 or 1.
    pub condition: bool,
    /// Whether it is paid per second, so that it is multiplied by the control step.
    pub per_second: bool,
}

/// What is told of a condition.
#[derive(Clone)]
pub(crate) struct ConditionMeaning {
    /// As written.
    pub source: String,
    pub formula: Expr,
    pub docs: String,
    /// The time from reset before which it does not count, as written; empty if it always does.
    pub after: String,
}

/// What is told of a channel or a metric.
pub(crate) struct ChannelMeaning {
    pub formula: Expr,
    pub docs: String,
    /// The block of a library that it comes from; empty if it is the task's own.
    pub block: String,
}

/// A declaration that formulas name.
#[derive(Clone)]
pub(crate) struct Definition {
    /// `let`, `const`, `fn`, `state`, `clock`, `random`, `params`, `reference`.
    pub kind: &'static str,
    pub name: String,
    /// Of a function.
    pub parameters: Vec<String>,
    /// Its formula, or several with a word before each: `becomes`, `where`.
    pub parts: Vec<(&'static str, Expr)>,
    pub docs: String,
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
    /// Weight in force.
    pub weight: f64,
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
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StepReport {
    /// Which phase of a sequence is told of; in the step in which the next one begins, still the one before.
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
    /// Values of all metrics, laid out as [`CompiledTask::metrics`] says.
    pub metrics: Vec<f64>,
    /// Whether the success expression holds at this step.
    pub success: bool,
    /// Which connections shall let go, in the order of [`CompiledTask::releases`].
    pub released: Vec<bool>,
}

/// The task's own state over one episode: plain data.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TaskState {
    /// Control steps since reset.
    pub step: u32,
    /// Which phase of a sequence is present.
    pub phase: u32,
    /// At which step it began.
    pub began: u32,
    /// Whether the phases before it had succeeded when they ended.
    pub successes: Vec<bool>,
    /// Constants, cells of operators, states and randoms, and what this step's formulas share.
    pub record: Vec<f64>,
}

/// A term whose value is not a finite number: an error of this episode, never a silent zero.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
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
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("none of {tries} draws of `{random}` at step {step} fulfils `{wanted}`; the last was {last}")]
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
}

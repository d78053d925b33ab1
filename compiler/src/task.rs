//! What the compiler hands to the runtime.
//!
//! A [`CompiledTask`] is immutable and shared between episodes and threads; what changes over an episode is in a
//! [`TaskState`], plain data that can be snapshot and restored bit for bit.

use crate::body::BodyDescription;
use crate::frame::FrameLayout;
use crate::graph::Graph;
use crate::graph::interval::Bounds;
use crate::lower::{Outputs, Program};
use crate::scene::SceneDescription;
use std::borrow::Cow;
use std::sync::Arc;

pub use crate::beginning::{Disturbance, Init, ObjectStart, RootPlacement, Setting, Settle, Spread};

/// A task ready to run: a program over a flat frame and a flat state record.
pub struct CompiledTask {
    /// Name of the task.
    pub name: String,
    /// Family it belongs to.
    pub family: String,
    /// First paragraph of the task's documentation.
    pub summary: String,
    /// The body.
    pub body: Arc<BodyDescription>,
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
    /// Sensors to fill before every evaluation.
    pub frame: FrameLayout,
    /// Hash of the task's meaning: the same text layout or comments aside.
    pub hash: String,
    pub(crate) program: Program,
    pub(crate) meaning: Meaning,
}

/// What explanations and snapshots need beyond what runs.
pub(crate) struct Meaning {
    pub graph: Graph,
    pub outputs: Outputs,
    /// Per term.
    pub terms: Vec<TermMeaning>,
    /// Conditions of the terminations as written.
    pub terminations: Vec<String>,
    pub success: String,
    /// Between which values each term stays.
    pub term_bounds: Vec<Bounds>,
}

/// What is told of a term.
pub(crate) struct TermMeaning {
    /// The formula as mathematics.
    pub mathematics: String,
    /// Signals and declared names in it.
    pub reads: Vec<String>,
    /// Whether the formula is a condition, which counts 0 or 1.
    pub condition: bool,
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
    /// Weight in the source.
    pub weight: f64,
    /// Range a tuner may choose from, if given.
    pub weight_range: Option<[f64; 2]>,
    /// Whether the weight is fixed.
    pub fixed: bool,
    /// The formula as written.
    pub source: String,
}

/// What a task reports of one control step. Allocated once per episode, overwritten every step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StepReport {
    /// Unweighted value of every reward term.
    pub terms: Vec<f64>,
    /// Sum of weight times value.
    pub reward: f64,
    /// Which terminations hold, in the task's order.
    pub terminations: Vec<bool>,
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
    /// Cells of operators and states.
    pub cells: Vec<f64>,
    /// Everything computed at this step, read by observations.
    pub values: Vec<f64>,
}

/// A term whose value is not a finite number: an error of this episode, never a silent zero.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("term `{term}` is {value} at step {step}: {formula}")]
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

impl CompiledTask {
    /// How this episode begins: what was drawn stands in `state`.
    pub fn beginning(&self, state: &TaskState) -> Cow<'_, Init> {
        if self.init.drawn.is_empty() {
            return Cow::Borrowed(&self.init);
        }
        let mut init = self.init.clone();
        for &(setting, index) in &self.init.drawn {
            init.set(setting, self.drawn(index, state));
        }
        Cow::Owned(init)
    }

    /// A value that the beginning takes from what was drawn for this episode.
    pub fn drawn(&self, index: usize, state: &TaskState) -> f64 {
        let operand = self.program.beginning.get(index);
        operand.and_then(|&operand| self.program.read(operand, &[], &state.values).first().copied()).unwrap_or(0.0)
    }

    /// Where a marker is, in the snapshot of `frame`.
    pub fn marker(&self, index: usize, frame: &[f64], state: &TaskState) -> Option<[f64; 3]> {
        let operand = *self.program.markers.get(index)?;
        self.program.read(operand, frame, &state.values).try_into().ok()
    }

    /// Starts the task's state from the reset snapshot. `frame` has `self.frame.size()` values.
    pub fn reset(&self, frame: &[f64], state: &mut TaskState) {
        state.step = 0;
        self.program.reset(frame, &mut state.cells, &mut state.values);
    }

    /// Advances every operator by one control step and evaluates terms, terminations and success. `weights` has one entry
    /// per term.
    ///
    /// # Errors
    /// A term that is not finite; the report is filled all the same.
    pub fn step(
        &self,
        frame: &[f64],
        weights: &[f64],
        state: &mut TaskState,
        report: &mut StepReport,
    ) -> Result<(), NonFiniteTerm> {
        state.step += 1;
        self.program.step(state.step, frame, &mut state.cells, &mut state.values);
        self.report(frame, weights, state, report);
        match report.terms.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(index) => Err(NonFiniteTerm {
                term: self.terms[index].name.clone(),
                value: report.terms[index],
                step: state.step,
                formula: self.terms[index].source.clone(),
            }),
        }
    }

    /// Terms, terminations and success at the present snapshot, which may be that of the reset; nothing advances.
    pub fn report(&self, frame: &[f64], weights: &[f64], state: &TaskState, report: &mut StepReport) {
        let lane = |operand| self.program.read(operand, frame, &state.values).first().copied().unwrap_or(0.0);
        report.terms.clear();
        report.terms.extend(self.program.terms.iter().map(|&operand| lane(operand)));
        report.terminations.clear();
        report.terminations.extend(self.program.terminations.iter().map(|&operand| lane(operand) != 0.0));
        report.released.clear();
        report.released.extend(self.program.releases.iter().map(|&operand| lane(operand) != 0.0));
        report.success = self.program.success.is_some_and(|operand| lane(operand) != 0.0);
        report.reward = report.terms.iter().zip(weights).map(|(value, weight)| value * weight).sum();
    }

    /// Writes the observation; `out` has `self.observation_size()` values, `frame` is that of the last `reset` or `step`.
    pub fn observe(&self, frame: &[f64], state: &TaskState, out: &mut [f64]) {
        for (channel, &operand) in self.channels.iter().zip(&self.program.channels) {
            let values = self.program.read(operand, frame, &state.values);
            out[channel.offset..channel.offset + channel.size].copy_from_slice(values);
        }
    }

    /// Number of values of the observation.
    pub fn observation_size(&self) -> usize {
        self.channels.iter().map(|channel| channel.size).sum()
    }

    /// The weights as written in the source.
    pub fn weights(&self) -> Vec<f64> {
        self.terms.iter().map(|term| term.weight).collect()
    }
}

//! A whole task, computed by the interpreter.

use crate::frame::FrameLayout;
use crate::graph::NodeId;
use crate::lower::{Interpreter, Moment, Outputs};
use crate::task::CompiledTask;
use std::collections::BTreeMap;

/// A task computed by the interpreter: no sequences, and nothing that chance decides.
pub struct PlainTask<'a> {
    layout: &'a FrameLayout,
    outputs: &'a Outputs,
    interpreter: Interpreter<'a>,
    step: u32,
}

/// What a task gives at one step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Snapshot {
    /// Values of the terms.
    pub terms: Vec<f64>,
    /// Which reasons of `terminate` and `finish` hold.
    pub ends: Vec<bool>,
    /// Whether `success` holds.
    pub success: bool,
    /// Metrics, one after the other.
    pub metrics: Vec<f64>,
    /// The observation.
    pub channels: Vec<f64>,
}

impl<'a> PlainTask<'a> {
    /// A task, if the interpreter can compute it.
    pub fn of(task: &'a CompiledTask) -> Option<Self> {
        let [only] = &*task.phases else { return None };
        let (graph, outputs) = (&only.graph, &only.outputs);
        if !outputs.draws.is_empty() {
            return None;
        }
        // The first reader of a state sets its initial value; a state without readers does not matter.
        let states = vec![Vec::new(); outputs.updates.len()];
        let interpreter = Interpreter { graph, memories: BTreeMap::new(), states };
        Some(Self { layout: &task.frame, outputs, interpreter, step: 0 })
    }

    /// The next step, the first of which is the reset: `frame` has as many values as the task's.
    pub fn next(&mut self, frame: &[f64]) -> Snapshot {
        let before = self.interpreter.states.clone();
        let mut moment = Moment { step: self.step, layout: self.layout, frame, values: BTreeMap::new(), before };
        let interpreter = &mut self.interpreter;
        // At the reset nothing is updated; later the new values are known before anything reads them.
        let updated: Vec<Vec<f64>> = self.outputs.updates.iter().map(|&node| interpreter.value(node, &mut moment)).collect();
        if self.step > 0 {
            interpreter.states = updated;
        }
        let mut lanes =
            |nodes: &[NodeId]| -> Vec<f64> { nodes.iter().flat_map(|&node| interpreter.value(node, &mut moment)).collect() };
        let (terms, metrics) = (lanes(&self.outputs.terms), lanes(&self.outputs.metrics));
        let mut ends = lanes(&self.outputs.terminations);
        ends.extend(lanes(&self.outputs.finishes));
        let success = self.outputs.success.is_some_and(|node| lanes(&[node]).first().is_some_and(|value| *value != 0.0));
        let channels = lanes(&self.outputs.channels);
        self.step += 1;
        Snapshot { terms, ends: ends.into_iter().map(|value| value != 0.0).collect(), success, metrics, channels }
    }
}

//! The graph as canonical text: the same for the same meaning, whatever the order, layout and local names of the source.
//!
//! Nodes are numbered in the order in which the roots need them, and so are declared states; sensors, queries and randoms are
//! written with their own names. Nothing depends on the order in which the checker came across things.

use super::operation::Operation;
use super::{Graph, NodeId};
use crate::frame::Sensor;
use std::collections::HashMap;
use std::fmt::Write;

/// What numbers in a graph stand for.
pub trait Labels {
    /// Sensor blocks side by side.
    fn sensors(&self, sensors: &[Sensor]) -> String;
    /// A random of the phase, by its number.
    fn random(&self, index: usize) -> String;
    /// A phase of the sequence, by its number.
    fn phase(&self, index: usize) -> String;
}

/// Writes nodes with numbers given in the order in which the roots need them.
pub struct Writer<'a> {
    graph: &'a Graph,
    labels: &'a dyn Labels,
    /// New value of each declared state.
    updates: &'a [NodeId],
    numbers: HashMap<NodeId, usize>,
    /// Numbers of states in the graph, in the order in which they were met.
    states: Vec<usize>,
    lines: Vec<String>,
}

impl<'a> Writer<'a> {
    /// Writes nodes of `graph`; `updates` are the new values of its states.
    pub fn new(graph: &'a Graph, labels: &'a dyn Labels, updates: &'a [NodeId]) -> Self {
        Self { graph, labels, updates, numbers: HashMap::new(), states: Vec::new(), lines: Vec::new() }
    }

    /// The canonical number of `root`, after writing whatever it needs that is not written yet.
    pub fn number(&mut self, root: NodeId) -> usize {
        // Depth first with an explicit stack: a formula may be deep.
        let mut stack = vec![(root, false)];
        while let Some((id, inputs_written)) = stack.pop() {
            if self.numbers.contains_key(&id) {
                continue;
            }
            if inputs_written {
                self.write(id);
            } else {
                stack.push((id, true));
                stack.extend(self.graph.node(id).inputs.iter().rev().map(|&input| (input, false)));
            }
        }
        self.numbers[&root]
    }

    fn write(&mut self, id: NodeId) {
        let node = self.graph.node(id);
        let operation = match &node.operation {
            Operation::StateBefore(index) => format!("state s{} before", self.state(*index as usize)),
            Operation::StateAfter(index) => format!("state s{} after", self.state(*index as usize)),
            operation => describe(operation, self.labels),
        };
        let number = self.numbers.len();
        let inputs: String = node.inputs.iter().map(|input| format!(" %{}", self.numbers[input])).collect();
        self.lines.push(format!("%{number} = {operation}{inputs}"));
        self.numbers.insert(id, number);
    }

    fn state(&mut self, index: usize) -> usize {
        self.states.iter().position(|known| *known == index).unwrap_or_else(|| {
            self.states.push(index);
            self.states.len() - 1
        })
    }

    /// Everything written, and after it how the states change that were met.
    pub fn finish(mut self) -> Vec<String> {
        let mut next = 0;
        // An update may read further states, whose updates then follow.
        while let Some(&state) = self.states.get(next) {
            if let Some(&update) = self.updates.get(state) {
                let number = self.number(update);
                self.lines.push(format!("s{next} becomes %{number}"));
            }
            next += 1;
        }
        self.lines
    }
}

/// The operation with its fixed parts.
fn describe(operation: &Operation, labels: &dyn Labels) -> String {
    let random = |index: &u32| labels.random(*index as usize);
    match operation {
        Operation::Constant(lanes) => format!("constant {}", values(lanes.iter().map(|lane| lane.value()))),
        Operation::Sensors(sensors) => format!("sensors {}", labels.sensors(sensors)),
        Operation::Step => "step".to_owned(),
        Operation::Unary(function) => function.word().to_owned(),
        Operation::Binary(function) => function.word().to_owned(),
        Operation::Choose => "choose".to_owned(),
        Operation::Select(lanes) => format!("select {}", lane_numbers(lanes)),
        Operation::Join => "join".to_owned(),
        Operation::Reduce(reduction, group) => format!("reduce {} by {group}", reduction.word()),
        Operation::Quaternion => "quaternion".to_owned(),
        Operation::Memory(memory) => format!("memory {}", memory.words()),
        Operation::StateBefore(index) => format!("state {index} before"),
        Operation::StateAfter(index) => format!("state {index} after"),
        Operation::Noise(index, chance, lanes) => format!("noise {} {} x{lanes}", random(index), chance.word()),
        Operation::Drawn(index) => format!("random {} before", random(index)),
        Operation::DrawnAfter(index) => format!("random {} after", random(index)),
        Operation::Pick(lanes) => format!("pick {lanes}"),
        Operation::PhaseSuccess(index) => format!("success of {}", labels.phase(*index as usize)),
        Operation::Follow(track) => {
            let what = if track.rates { "rates" } else { "values" };
            let columns: Vec<_> = track
                .columns
                .iter()
                .filter_map(|&column| track.motion.columns.get(column))
                .map(|column| column.target.name())
                .collect();
            format!("follow {} {what} of {}", track.motion.digest(), columns.join(", "))
        }
    }
}

/// Numbers to the last bit, neighbouring equal ones counted together: `0.0 x4 1.5`.
pub fn values(values: impl Iterator<Item = f64>) -> String {
    let mut counted: Vec<(f64, usize)> = Vec::new();
    for value in values {
        match counted.last_mut() {
            Some((last, count)) if last.to_bits() == value.to_bits() => *count += 1,
            _ => counted.push((value, 1)),
        }
    }
    let texts = counted.into_iter().map(|(value, count)| match count {
        1 => format!("{value:?}"),
        _ => format!("{value:?} x{count}"),
    });
    texts.collect::<Vec<_>>().join(" ")
}

/// Lane numbers, consecutive ones joined: `0..3 7`.
fn lane_numbers(lanes: &[u32]) -> String {
    let mut text = String::new();
    for run in lanes.chunk_by(|a, b| *b == a.wrapping_add(1)) {
        let separator = if text.is_empty() { "" } else { " " };
        // Writing to a string cannot fail.
        let _ = match run {
            [only] => write!(text, "{separator}{only}"),
            [first, .., last] => write!(text, "{separator}{first}..{}", u64::from(*last) + 1),
            [] => Ok(()),
        };
    }
    text
}

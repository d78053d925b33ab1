//! The graph as canonical text: the same for the same meaning, whatever the order, layout and local names of the source.

use super::operation::Operation;
use super::{Graph, NodeId};
use crate::frame::Sensor;
use std::collections::HashMap;
use std::fmt::Write;

/// Writes nodes with numbers given in the order in which the roots need them.
#[derive(Debug, Default)]
pub struct Writer {
    numbers: HashMap<NodeId, usize>,
    lines: String,
}

impl Writer {
    /// The canonical number of `root`, after writing whatever it needs that is not written yet.
    pub fn number(&mut self, graph: &Graph, root: NodeId) -> usize {
        // Depth first with an explicit stack: a formula may be deep.
        let mut stack = vec![(root, false)];
        while let Some((id, inputs_written)) = stack.pop() {
            if self.numbers.contains_key(&id) {
                continue;
            }
            if inputs_written {
                self.write(graph, id);
            } else {
                stack.push((id, true));
                stack.extend(graph.node(id).inputs.iter().rev().map(|&input| (input, false)));
            }
        }
        self.numbers[&root]
    }

    fn write(&mut self, graph: &Graph, id: NodeId) {
        let node = graph.node(id);
        let number = self.numbers.len();
        let inputs: String = node.inputs.iter().map(|input| format!(" %{}", self.numbers[input])).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(self.lines, "%{number} = {}{inputs}", describe(&node.operation));
        self.numbers.insert(id, number);
    }

    /// Everything written.
    pub fn lines(&self) -> &str {
        &self.lines
    }
}

/// The operation with its fixed parts.
pub fn describe(operation: &Operation) -> String {
    match operation {
        Operation::Constant(lanes) => format!("constant {}", values(lanes.iter().map(|lane| lane.value()))),
        Operation::Sensors(sensors) => format!("sensors {}", blocks(sensors)),
        Operation::Step => "step".to_owned(),
        Operation::Unary(function) => format!("{function:?}"),
        Operation::Binary(function) => format!("{function:?}"),
        Operation::Choose => "choose".to_owned(),
        Operation::Select(lanes) => format!("select {lanes:?}"),
        Operation::Join => "join".to_owned(),
        Operation::Reduce(reduction, group) => format!("reduce {reduction:?} by {group}"),
        Operation::Quaternion => "quaternion".to_owned(),
        Operation::Memory(memory) => format!("memory {memory:?}"),
        Operation::StateBefore(index) => format!("state {index} before"),
        Operation::StateAfter(index) => format!("state {index} after"),
        Operation::Noise(index, chance, lanes) => format!("noise {index} {chance:?} x{lanes}"),
        Operation::Drawn(index) => format!("random {index} before"),
        Operation::DrawnAfter(index) => format!("random {index} after"),
        Operation::Pick(lanes) => format!("pick {lanes}"),
        Operation::PhaseSuccess(index) => format!("success of phase {index}"),
        Operation::Follow(track) => {
            let what = if track.rates { "rates" } else { "values" };
            format!("follow {} {what} {:?}", track.motion.digest(), track.columns)
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

/// Sensor blocks, neighbouring indices joined: `JointPosition 0..3 28..30`.
fn blocks(sensors: &[Sensor]) -> String {
    let mut text = String::new();
    let mut open: Option<(String, usize, usize)> = None;
    let close = |text: &mut String, open: Option<(String, usize, usize)>, kind: &str| {
        if let Some((own, first, last)) = open {
            let _ = if first == last { write!(text, " {first}") } else { write!(text, " {first}..{}", last + 1) };
            return own == kind;
        }
        false
    };
    for sensor in sensors {
        let written = format!("{sensor:?}");
        let (kind, index) = written.split_once('(').unwrap_or((&written, ""));
        let index = index.trim_end_matches(')').parse::<usize>().ok();
        match (&mut open, index) {
            (Some((own, _, last)), Some(index)) if own == kind && index == *last + 1 => *last = index,
            _ => {
                let same_kind = close(&mut text, open.take(), kind);
                if !same_kind {
                    let _ = write!(text, "{}{kind}", if text.is_empty() { "" } else { " " });
                }
                open = index.map(|index| (kind.to_owned(), index, index));
            }
        }
    }
    close(&mut text, open, "");
    text
}

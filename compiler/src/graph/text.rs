//! The graph as canonical text: the same for the same meaning, whatever the order, layout and local names of the source.

use super::operation::Operation;
use super::{Graph, NodeId};
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
        let inputs: Vec<String> = node.inputs.iter().map(|input| format!("%{}", self.numbers[input])).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(self.lines, "%{number} = {} {}", describe(&node.operation), inputs.join(" "));
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
        Operation::Constant(lanes) => {
            let mut text = String::from("constant");
            for (value, count) in runs(&lanes.iter().map(|lane| lane.value()).collect::<Vec<_>>()) {
                let _ = write!(text, " {value:?}");
                if count > 1 {
                    let _ = write!(text, " x{count}");
                }
            }
            text
        }
        Operation::Sensors(sensors) => {
            let names: Vec<String> = sensors.iter().map(|sensor| format!("{sensor:?}")).collect();
            format!("sensors {}", names.join(" "))
        }
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
    }
}

/// Neighbouring equal numbers counted together.
fn runs(values: &[f64]) -> Vec<(f64, usize)> {
    let mut counted: Vec<(f64, usize)> = Vec::new();
    for &value in values {
        match counted.last_mut() {
            Some((last, count)) if last.to_bits() == value.to_bits() => *count += 1,
            _ => counted.push((value, 1)),
        }
    }
    counted
}

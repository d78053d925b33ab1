//! The verifier: every node takes inputs of widths that its operation can meet, and is as wide as what it stands for.
//!
//! It runs on every node that is added, before and after folding, and on every value that the checker gives a type. What it
//! finds is a mistake of the compiler, never of a text: tests and debug builds stop at once, others keep the first finding,
//! which the checker reports as an internal error.

use super::operation::{Memory, Operation};
use super::{Graph, NodeId};

impl Graph {
    /// Whether `operation` can meet these inputs; what is wrong otherwise.
    pub(super) fn verify_inputs(&self, operation: &Operation, inputs: &[NodeId]) -> Result<(), String> {
        let width = |place: usize| inputs.get(place).map_or(0, |&input| self.width(input));
        let wrong = |what: &str| {
            let widths: Vec<usize> = (0..inputs.len()).map(width).collect();
            Err(format!("{what}: {} of inputs as wide as {widths:?}", operation.name()))
        };
        let (least, most) = operation.arity();
        if inputs.len() < least || inputs.len() > most {
            return wrong("wrong number of inputs");
        }
        let fits = match operation {
            Operation::Binary(_) | Operation::Choose | Operation::Memory(_) => {
                let widest = (0..inputs.len()).map(width).max().unwrap_or(1);
                (0..inputs.len()).map(width).all(|width| width == 1 || width == widest)
            }
            Operation::Select(lanes) => lanes.iter().all(|&lane| (lane as usize) < width(0)),
            Operation::Reduce(_, group) => *group > 0 && width(0).is_multiple_of(*group as usize),
            Operation::Quaternion => width(0) == 9,
            Operation::Drawn(_) | Operation::DrawnAfter(_) => inputs.len() == 1 || width(1) == 1,
            Operation::Pick(lanes) => *lanes > 0 && width(0).is_multiple_of(*lanes as usize) && width(1) == 1,
            Operation::Follow(_) => width(0) == 1,
            Operation::Constant(_)
            | Operation::Sensors(_)
            | Operation::Step
            | Operation::Unary(_)
            | Operation::Join
            | Operation::StateBefore(_)
            | Operation::StateAfter(_)
            | Operation::Noise(..)
            | Operation::PhaseSuccess(_) => true,
        };
        if fits { Ok(()) } else { wrong("widths that do not match") }
    }

    /// Looks whether a node is as wide as it must be.
    pub fn verify_width(&mut self, id: NodeId, expected: usize) {
        let width = self.width(id);
        if width != expected {
            let name = self.node(id).operation.name();
            self.found(format!("a value of {expected} lanes at a node of width {width} ({name})"));
        }
    }

    /// Keeps the first finding of the verifier.
    pub(super) fn found(&mut self, finding: String) {
        debug_assert!(false, "the graph is inconsistent: {finding}");
        self.finding.get_or_insert(finding);
    }

    /// The first finding of the verifier, which is then forgotten.
    pub fn take_finding(&mut self) -> Option<String> {
        self.finding.take()
    }
}

impl Operation {
    /// The least and the greatest number of inputs.
    fn arity(&self) -> (usize, usize) {
        match self {
            Self::Constant(_) | Self::Sensors(_) | Self::Step | Self::Noise(..) | Self::PhaseSuccess(_) => (0, 0),
            Self::Unary(_) | Self::Select(_) | Self::Reduce(..) | Self::Quaternion | Self::Follow(_) => (1, 1),
            Self::StateBefore(_) | Self::StateAfter(_) => (1, 1),
            Self::Binary(_) | Self::Pick(_) => (2, 2),
            Self::Choose => (3, 3),
            Self::Join => (1, usize::MAX),
            Self::Drawn(_) | Self::DrawnAfter(_) => (1, 2),
            Self::Memory(Memory::Hysteresis) => (3, 3),
            Self::Memory(Memory::Smooth | Memory::SmoothAngle | Memory::Sampled) => (2, 2),
            Self::Memory(_) => (1, 1),
        }
    }

    /// What a finding calls it.
    fn name(&self) -> String {
        match self {
            Self::Constant(lanes) => format!("{} constants", lanes.len()),
            Self::Sensors(sensors) => format!("{} sensors", sensors.len()),
            Self::Select(lanes) => format!("a selection of {} lanes", lanes.len()),
            Self::Follow(track) => format!("{} columns of a motion", track.columns.len()),
            other => format!("{other:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::operation::{Binary, Reduction, Unary};
    use super::*;
    use crate::frame::Sensor;

    fn finding(operation: &Operation, widths: &[usize]) -> Option<String> {
        let mut graph = Graph::default();
        let inputs: Vec<NodeId> = widths.iter().map(|&width| graph.constants(&vec![0.5; width])).collect();
        graph.verify_inputs(operation, &inputs).err()
    }

    #[test]
    fn widths_that_cannot_meet_are_found() {
        let sum = Operation::Reduce(Reduction::Sum, 3);
        let cases: &[(Operation, &[usize], &[usize])] = &[
            (Operation::Unary(Unary::Sine), &[5], &[1, 1]),
            (Operation::Binary(Binary::Add), &[1, 4], &[2, 3]),
            (Operation::Choose, &[1, 4, 4], &[2, 3, 3]),
            (Operation::Select(vec![0, 2]), &[3], &[2]),
            (sum, &[6], &[4]),
            (Operation::Quaternion, &[9], &[3]),
            (Operation::Memory(Memory::Delay(2)), &[3], &[3, 3]),
            (Operation::Memory(Memory::Hysteresis), &[2, 1, 2], &[2, 3, 1]),
            (Operation::Memory(Memory::Smooth), &[2, 1], &[2]),
            (Operation::Drawn(0), &[3, 1], &[3, 3]),
            (Operation::Pick(3), &[6, 1], &[6, 2]),
            (Operation::Join, &[1, 2, 3], &[]),
            (Operation::Step, &[], &[1]),
        ];
        for (operation, right, wrong) in cases {
            assert_eq!(finding(operation, right), None);
            assert!(finding(operation, wrong).is_some(), "{operation:?} of {wrong:?}");
        }
    }

    #[test]
    #[should_panic(expected = "the graph is inconsistent")]
    fn lists_of_different_length_never_meet_in_a_graph() {
        let mut graph = Graph::default();
        let (two, three) = (graph.sensors(vec![Sensor::Time; 2]), graph.constants(&[1.0, 2.0, 3.0]));
        graph.binary(Binary::Power, two, three);
    }

    #[test]
    #[should_panic(expected = "a value of 3 lanes at a node of width 1")]
    fn a_value_is_as_wide_as_its_node() {
        let mut graph = Graph::default();
        let one = graph.constant(1.0);
        graph.verify_width(one, 3);
    }
}

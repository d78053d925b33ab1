//! A plain interpreter of graphs: no slots, no views, no order of instructions. The program must compute the same bits.
//!
//! It is there for tests and for fuzzing (feature `interpreter`), and is as slow as it is plain.

use crate::frame::{FrameLayout, Sensor};
use crate::graph::fold::evaluate;
use crate::graph::operation::{Memory, Operation};
use crate::graph::{Graph, NodeId};
use std::collections::BTreeMap;

#[cfg(test)]
mod tests;

/// A graph with what it remembers.
pub struct Interpreter<'a> {
    /// The graph.
    pub graph: &'a Graph,
    /// Cells of its stateful operators.
    pub memories: BTreeMap<NodeId, Vec<f64>>,
    /// Values of its declared states.
    pub states: Vec<Vec<f64>>,
}

/// What is known of one step while it is computed.
pub struct Moment<'a> {
    /// Number of the control step.
    pub step: u32,
    /// Where sensors stand in the frame.
    pub layout: &'a FrameLayout,
    /// The frame of sensors.
    pub frame: &'a [f64],
    /// Values of nodes that are known already.
    pub values: BTreeMap<NodeId, Vec<f64>>,
    /// States before and after their update.
    pub before: Vec<Vec<f64>>,
}

impl Interpreter<'_> {
    /// The value of a node.
    pub fn value(&mut self, id: NodeId, moment: &mut Moment<'_>) -> Vec<f64> {
        if let Some(known) = moment.values.get(&id) {
            return known.clone();
        }
        let node = self.graph.node(id);
        let inputs: Vec<Vec<f64>> = node.inputs.iter().map(|&input| self.value(input, moment)).collect();
        let mut lanes = vec![0.0; node.width];
        match &node.operation {
            Operation::Constant(values) => lanes = values.iter().map(|value| value.value()).collect(),
            Operation::Sensors(sensors) => lanes = sensors.iter().flat_map(|&sensor| measured(moment, sensor)).collect(),
            Operation::Step => lanes[0] = f64::from(moment.step),
            Operation::Memory(memory) => self.remember(id, *memory, &inputs, moment.step, &mut lanes),
            Operation::StateBefore(index) | Operation::StateAfter(index) if moment.step == 0 => {
                lanes.clone_from(&inputs[0]);
                self.states[*index as usize].clone_from(&lanes);
            }
            Operation::StateBefore(index) => lanes.clone_from(&moment.before[*index as usize]),
            Operation::StateAfter(index) => lanes.clone_from(&self.states[*index as usize]),
            operation => evaluate(operation, &inputs.iter().map(Vec::as_slice).collect::<Vec<_>>(), &mut lanes),
        }
        debug_assert_eq!(lanes.len(), node.width, "lanes of {node:?}");
        moment.values.insert(id, lanes.clone());
        lanes
    }

    fn remember(&mut self, id: NodeId, memory: Memory, inputs: &[Vec<f64>], step: u32, lanes: &mut [f64]) {
        let size = memory.cells();
        let cells = self.memories.entry(id).or_insert_with(|| vec![0.0; size * lanes.len()]);
        for (index, value) in lanes.iter_mut().enumerate() {
            let input = |place: usize| match inputs.get(place).map(Vec::as_slice) {
                None => 0.0,
                Some([only]) => *only,
                Some(several) => several[index],
            };
            let inputs = [input(0), input(1), input(2)];
            let cells = &mut cells[index * size..(index + 1) * size];
            *value = if step == 0 { memory.start(cells, inputs) } else { memory.advance(cells, step, inputs) };
        }
    }
}

fn measured(moment: &Moment<'_>, sensor: Sensor) -> Vec<f64> {
    let found = moment.layout.entries().iter().find(|(known, _)| *known == sensor);
    // Every sensor of a task's graph that is wanted has a place in its frame.
    let offset = found.map_or(0, |(_, offset)| *offset);
    moment.frame[offset..offset + sensor.size()].to_vec()
}

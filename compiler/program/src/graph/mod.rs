//! The dataflow graph of one task.
//!
//! 1. The checker adds nodes ([`Graph::add`]); equal nodes are one node, so that reward, observation, termination and success
//!    share whatever they have in common, and constants fold on the way in (`fold`).
//! 2. `verify` looks at every node and every typed value: widths always fit.
//! 3. [`interval`] bounds every lane from the ranges of sensors.
//! 4. [`text`] writes the graph canonically; its hash identifies the task whatever its layout, comments and local names.
//! 5. `lower` turns the graph into a program; a second back end would start here too.

pub mod events;
pub mod fold;
pub mod interval;
pub mod operation;
pub mod text;
pub mod track;
mod verify;
mod words;

use crate::frame::Sensor;
use hashbrown::DefaultHashBuilder;
use hashbrown::hash_table::{Entry, HashTable};
use operation::{Binary, Bits, Memory, Operation, Reduction, Unary};
use std::hash::BuildHasher;

/// A node of a [`Graph`]; inputs have smaller numbers than their readers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(u32);

impl NodeId {
    /// Place in [`Graph::nodes`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// An operation on other nodes.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Node {
    /// What it computes.
    pub operation: Operation,
    /// From what.
    pub inputs: Vec<NodeId>,
    /// Number of lanes.
    pub width: usize,
}

impl Node {
    /// Numbers that it takes room for: its lanes, or all that it remembers of them.
    fn held(&self) -> usize {
        match self.operation {
            Operation::Memory(memory) => self.width.saturating_mul(memory.cells()),
            _ => self.width,
        }
    }
}

/// One dataflow graph: nodes in an order in which every input stands before its readers.
#[derive(Debug, Clone, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    /// All nodes, by what they are.
    known: HashTable<NodeId>,
    hasher: DefaultHashBuilder,
    lanes: usize,
    /// What the verifier found first.
    finding: Option<String>,
}

impl Graph {
    /// Lanes of all nodes together, and what delays keep: what the graph takes of memory and time.
    pub fn lanes(&self) -> usize {
        self.lanes
    }

    /// All nodes; a [`NodeId`] is a place in them.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// One node.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// Number of lanes of a node.
    pub fn width(&self, id: NodeId) -> usize {
        self.node(id).width
    }

    /// The lanes of a constant node.
    pub fn constant_lanes(&self, id: NodeId) -> Option<Vec<f64>> {
        match &self.node(id).operation {
            Operation::Constant(lanes) => Some(lanes.iter().map(|lane| lane.value()).collect()),
            _ => None,
        }
    }

    /// The value of a constant node of one lane.
    pub fn constant_value(&self, id: NodeId) -> Option<f64> {
        match self.constant_lanes(id)?.as_slice() {
            [value] => Some(*value),
            _ => None,
        }
    }

    /// Adds a node, or finds the equal one; folds what is constant.
    pub fn add(&mut self, operation: Operation, inputs: &[NodeId]) -> NodeId {
        let width = self.width_of(&operation, inputs);
        if let Err(finding) = self.verify_inputs(&operation, inputs) {
            self.found(finding);
            // Zeros of its width, so that nothing behind it is out of bounds; the finding is reported.
            return self.intern(Node { operation: Operation::Constant(vec![Bits::of(0.0); width]), inputs: Vec::new(), width });
        }
        if let Some(simpler) = fold::simplify(self, &operation, inputs, width) {
            self.verify_width(simpler, width);
            return simpler;
        }
        self.intern(Node { operation, inputs: inputs.to_vec(), width })
    }

    fn intern(&mut self, node: Node) -> NodeId {
        let Self { nodes, known, hasher, lanes, .. } = self;
        let (hash, equal) = (hasher.hash_one(&node), |id: &NodeId| nodes[id.index()] == node);
        match known.entry(hash, equal, |id| hasher.hash_one(&nodes[id.index()])) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                let id = NodeId(u32::try_from(nodes.len()).unwrap_or(u32::MAX));
                new.insert(id);
                *lanes += node.held();
                nodes.push(node);
                id
            }
        }
    }

    fn width_of(&self, operation: &Operation, inputs: &[NodeId]) -> usize {
        let widest = || inputs.iter().map(|&input| self.width(input)).max().unwrap_or(1);
        match operation {
            Operation::Constant(lanes) => lanes.len(),
            Operation::Sensors(sensors) => sensors.iter().map(|sensor| sensor.size()).sum(),
            Operation::Step => 1,
            Operation::Select(lanes) => lanes.len(),
            Operation::Join => inputs.iter().map(|&input| self.width(input)).sum(),
            Operation::Reduce(_, group) => widest() / (*group as usize).max(1),
            Operation::Quaternion => 4,
            Operation::Noise(_, _, lanes) => *lanes as usize,
            Operation::Drawn(_) | Operation::DrawnAfter(_) => inputs.first().map_or(1, |&input| self.width(input)),
            Operation::Pick(lanes) => *lanes as usize,
            Operation::PhaseSuccess(_) => 1,
            Operation::Follow(track) => track.columns.len(),
            _ => widest(),
        }
    }

    /// A constant of one lane.
    pub fn constant(&mut self, value: f64) -> NodeId {
        self.constants(&[value])
    }

    /// A constant of several lanes.
    pub fn constants(&mut self, values: &[f64]) -> NodeId {
        self.add(Operation::Constant(values.iter().map(|&value| Bits::of(value)).collect()), &[])
    }

    /// Sensor blocks side by side.
    pub fn sensors(&mut self, sensors: Vec<Sensor>) -> NodeId {
        self.add(Operation::Sensors(sensors), &[])
    }

    /// A function of one number, lane by lane.
    pub fn unary(&mut self, function: Unary, input: NodeId) -> NodeId {
        self.add(Operation::Unary(function), &[input])
    }

    /// A function of two numbers, lane by lane; one lane meets every lane of the other.
    pub fn binary(&mut self, function: Binary, left: NodeId, right: NodeId) -> NodeId {
        self.add(Operation::Binary(function), &[left, right])
    }

    /// Every group of `group` lanes reduced to one.
    pub fn reduce(&mut self, reduction: Reduction, group: usize, input: NodeId) -> NodeId {
        self.add(Operation::Reduce(reduction, u32::try_from(group).unwrap_or(u32::MAX)), &[input])
    }

    /// Lanes of `input`.
    pub fn select(&mut self, lanes: impl IntoIterator<Item = usize>, input: NodeId) -> NodeId {
        let lanes = lanes.into_iter().map(|lane| u32::try_from(lane).unwrap_or(u32::MAX)).collect();
        self.add(Operation::Select(lanes), &[input])
    }

    /// Inputs side by side.
    pub fn join(&mut self, inputs: &[NodeId]) -> NodeId {
        self.add(Operation::Join, inputs)
    }

    /// A cell that remembers.
    pub fn memory(&mut self, memory: Memory, inputs: &[NodeId]) -> NodeId {
        self.add(Operation::Memory(memory), inputs)
    }

    /// Whether the value of a node is settled by what is drawn before the initial state: it reads no signal, no time, no memory.
    pub fn is_drawn_first(&self, id: NodeId) -> bool {
        let settled = |id: &NodeId| {
            !matches!(
                self.node(*id).operation,
                Operation::Sensors(_)
                    | Operation::Step
                    | Operation::Memory(_)
                    | Operation::StateBefore(_)
                    | Operation::StateAfter(_)
                    | Operation::DrawnAfter(_)
                    | Operation::PhaseSuccess(_)
            )
        };
        self.reachable([id]).iter().all(settled)
    }

    /// The nodes that `roots` need, themselves included, in ascending order.
    pub fn reachable(&self, roots: impl IntoIterator<Item = NodeId>) -> Vec<NodeId> {
        let mut needed = vec![false; self.nodes.len()];
        let mut pending: Vec<NodeId> = roots.into_iter().collect();
        while let Some(id) = pending.pop() {
            if !std::mem::replace(&mut needed[id.index()], true) {
                pending.extend(&self.node(id).inputs);
            }
        }
        (0..self.nodes.len()).filter(|&index| needed[index]).map(|index| NodeId(index as u32)).collect()
    }
}

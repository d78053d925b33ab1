//! Folding: what is known while compiling is computed once, by the same functions that run later.
//!
//! Only rewrites that keep every bit of every result are made, so that folding can never be noticed.

use super::operation::{Binary, Memory, Operation, Reduction, Unary};
use super::{Graph, NodeId};
use crate::extremes::maximum;

/// A node that gives the same bits as the operation would, if there is a simpler one.
pub(super) fn simplify(graph: &mut Graph, operation: &Operation, inputs: &[NodeId], width: usize) -> Option<NodeId> {
    if let Some(lanes) = evaluate_constant(graph, operation, inputs, width) {
        return Some(graph.constants(&lanes));
    }
    match (operation, inputs) {
        (Operation::Binary(function), &[left, right]) => simplify_binary(graph, *function, left, right, width),
        (Operation::Select(lanes), &[input]) => simplify_select(graph, lanes, input),
        (Operation::Join, &[input]) => Some(input),
        (Operation::Reduce(reduction, 1), &[input]) => match reduction {
            Reduction::Norm => Some(graph.unary(Unary::Absolute, input)),
            Reduction::ArgMinimum | Reduction::ArgMaximum => None,
            _ => Some(input),
        },
        (Operation::Unary(Unary::Negate), &[input]) => match graph.node(input).operation {
            Operation::Unary(Unary::Negate) => Some(graph.node(input).inputs[0]),
            _ => None,
        },
        // What never changes is what it was.
        (Operation::Memory(Memory::Initial | Memory::Highest | Memory::Lowest | Memory::Delay(_)), &[input]) => {
            graph.constant_lanes(input).map(|_| input)
        }
        _ => None,
    }
}

/// The lanes of a pure operation on constants.
fn evaluate_constant(graph: &Graph, operation: &Operation, inputs: &[NodeId], width: usize) -> Option<Vec<f64>> {
    if inputs.is_empty() || operation.remembers() {
        return None;
    }
    let values: Vec<Vec<f64>> = inputs.iter().map(|&input| graph.constant_lanes(input)).collect::<Option<_>>()?;
    let mut lanes = vec![0.0; width];
    let views: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
    evaluate(operation, &views, &mut lanes);
    Some(lanes)
}

/// Computes a pure operation; the plain definition that the closures are checked against.
pub fn evaluate(operation: &Operation, inputs: &[&[f64]], out: &mut [f64]) {
    let lane = |input: usize, index: usize| match inputs[input] {
        [only] => *only,
        lanes => lanes[index],
    };
    match operation {
        Operation::Unary(function) => {
            for (index, value) in out.iter_mut().enumerate() {
                *value = function.apply(lane(0, index));
            }
        }
        Operation::Binary(function) => {
            for (index, value) in out.iter_mut().enumerate() {
                *value = function.apply(lane(0, index), lane(1, index));
            }
        }
        Operation::Choose => {
            for (index, value) in out.iter_mut().enumerate() {
                *value = if lane(0, index) != 0.0 { lane(1, index) } else { lane(2, index) };
            }
        }
        Operation::Select(lanes) => {
            for (value, &from) in out.iter_mut().zip(lanes) {
                *value = inputs[0][from as usize];
            }
        }
        Operation::Join => {
            for (value, &from) in out.iter_mut().zip(inputs.iter().copied().flatten()) {
                *value = from;
            }
        }
        Operation::Reduce(reduction, group) => {
            for (value, lanes) in out.iter_mut().zip(inputs[0].chunks_exact(*group as usize)) {
                *value = reduction.apply(lanes);
            }
        }
        Operation::Quaternion => {
            if let Ok(axes) = <[f64; 9]>::try_from(inputs[0]) {
                out.copy_from_slice(&super::operation::quaternion(axes));
            }
        }
        Operation::Pick(lanes) => {
            let width = *lanes as usize;
            // The checker has proven that the index lies within; a number that is none picks the first element.
            let count = inputs[0].len() / width.max(1);
            let place = (maximum(lane(1, 0), 0.0) as usize).min(count.saturating_sub(1));
            out.copy_from_slice(&inputs[0][place * width..(place + 1) * width]);
        }
        Operation::Follow(track) => track.read(lane(0, 0), out),
        // Leaves and memories are the caller's: they depend on more than their inputs.
        Operation::Constant(_)
        | Operation::Sensors(_)
        | Operation::Step
        | Operation::Memory(_)
        | Operation::StateBefore(_)
        | Operation::StateAfter(_)
        | Operation::Noise(..)
        | Operation::Drawn(_)
        | Operation::DrawnAfter(_)
        | Operation::PhaseSuccess(_) => {}
    }
}

fn simplify_binary(graph: &mut Graph, function: Binary, left: NodeId, right: NodeId, width: usize) -> Option<NodeId> {
    let (a, b) = (graph.constant_value(left), graph.constant_value(right));
    let keeps_width = |graph: &Graph, id: NodeId| graph.width(id) == width;
    match (function, a, b) {
        (Binary::Multiply | Binary::Divide | Binary::Power, _, Some(1.0)) if keeps_width(graph, left) => Some(left),
        (Binary::Multiply, Some(1.0), _) if keeps_width(graph, right) => Some(right),
        (Binary::Multiply, _, Some(-1.0)) if keeps_width(graph, left) => Some(graph.unary(Unary::Negate, left)),
        (Binary::Multiply, Some(-1.0), _) if keeps_width(graph, right) => Some(graph.unary(Unary::Negate, right)),
        // The power itself squares so. It takes no root so: of -0 it gives 0, of minus infinity infinity.
        (Binary::Power, _, Some(2.0)) => Some(graph.binary(Binary::Multiply, left, left)),
        _ => None,
    }
}

fn simplify_select(graph: &mut Graph, lanes: &[u32], input: NodeId) -> Option<NodeId> {
    let everything = lanes.len() == graph.width(input) && lanes.iter().enumerate().all(|(place, &lane)| place == lane as usize);
    if everything {
        return Some(input);
    }
    // A selection from a selection is one selection.
    if let Operation::Select(inner) = &graph.node(input).operation {
        let composed: Vec<usize> = lanes.iter().map(|&lane| inner[lane as usize] as usize).collect();
        let origin = graph.node(input).inputs[0];
        return Some(graph.select(composed, origin));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Sensor;

    #[test]
    fn equal_expressions_are_one_node_and_constants_fold() {
        let mut graph = Graph::default();
        let speed = graph.sensors(vec![Sensor::ComVelocity]);
        let first = graph.reduce(Reduction::Norm, 3, speed);
        let again = graph.sensors(vec![Sensor::ComVelocity]);
        assert_eq!(graph.reduce(Reduction::Norm, 3, again), first);

        let two = graph.constant(2.0);
        let three = graph.constant(3.0);
        let sum = graph.binary(Binary::Add, two, three);
        assert_eq!(graph.constant_value(sum), Some(5.0));
        let one = graph.constant(1.0);
        assert_eq!(graph.binary(Binary::Divide, first, one), first);
    }

    #[test]
    fn selections_compose() {
        let mut graph = Graph::default();
        let axes = graph.sensors(vec![Sensor::LandmarkAxes(0)]);
        let up = graph.select(6..9, axes);
        let up_z = graph.select([2], up);
        assert_eq!(graph.node(up_z).operation, Operation::Select(vec![8]));
        assert_eq!(graph.select(0..9, axes), axes);
    }
}

//! How far a condition is from holding and from failing, and a number from being anything but 0: of a comparison the gap between its sides; of several conditions that must
//! all hold the sum, of those of which one is enough the least. (Known as the robustness of a formula in temporal logics.)

use crate::extremes::{maximum, minimum};
use crate::graph::interval::Bounds;
use crate::graph::operation::{Binary, Operation, Reduction, Unary};
use crate::graph::{Graph, NodeId};
use std::collections::{BTreeMap, BTreeSet};

/// What is missing, 0 or more; the units of comparisons are not distinguished.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lack {
    pub to_hold: f64,
    pub to_fail: f64,
}

impl Lack {
    fn not(self) -> Self {
        Self { to_hold: self.to_fail, to_fail: self.to_hold }
    }

    fn and(self, other: Self) -> Self {
        Self { to_hold: self.to_hold + other.to_hold, to_fail: minimum(self.to_fail, other.to_fail) }
    }

    fn or(self, other: Self) -> Self {
        self.not().and(other.not()).not()
    }

    /// Of a condition of which only its bounds are known.
    fn of_bounds(bounds: Bounds) -> Self {
        let away = if bounds.contains(0.0) { 0.0 } else { 1.0 };
        Self { to_hold: if bounds.single() == Some(0.0) { 1.0 } else { 0.0 }, to_fail: away }
    }
}

/// The nodes of conditions that a condition is made of, itself included, ascending.
pub(super) fn logic(graph: &Graph, root: NodeId) -> Vec<NodeId> {
    let mut found = BTreeSet::new();
    let mut pending = vec![root];
    while let Some(id) = pending.pop() {
        if !found.insert(id) {
            continue;
        }
        let node = graph.node(id);
        match &node.operation {
            Operation::Binary(
                Binary::And | Binary::Or | Binary::Multiply | Binary::Divide | Binary::Maximum | Binary::Minimum,
            )
            | Operation::Unary(Unary::Not | Unary::Negate)
            | Operation::Reduce(Reduction::Maximum | Reduction::Minimum | Reduction::Product, _)
            | Operation::Choose
            | Operation::Select(_)
            | Operation::Join => pending.extend(&node.inputs),
            _ => {}
        }
    }
    found.into_iter().collect()
}

/// What the lanes of a node lack, from the bounds of its inputs and from what those lack that are conditions.
pub(super) fn of(graph: &Graph, id: NodeId, bounds: &[Vec<Bounds>], known: &BTreeMap<NodeId, Vec<Lack>>) -> Vec<Lack> {
    let node = graph.node(id);
    let bound = |input: usize, lane: usize| match bounds[node.inputs[input].index()].as_slice() {
        [only] => *only,
        lanes => lanes.get(lane).copied().unwrap_or(Bounds::ANY),
    };
    let lanes_of = |input: usize| -> Vec<Lack> {
        let input = node.inputs[input];
        known.get(&input).cloned().unwrap_or_else(|| bounds[input.index()].iter().copied().map(Lack::of_bounds).collect())
    };
    let pair = |join: fn(Lack, Lack) -> Lack| {
        let (left, right) = (lanes_of(0), lanes_of(1));
        let lane = |lanes: &[Lack], index: usize| if lanes.len() == 1 { lanes[0] } else { lanes[index] };
        (0..node.width).map(|index| join(lane(&left, index), lane(&right, index))).collect()
    };
    match &node.operation {
        Operation::Binary(Binary::Less | Binary::LessEqual) => (0..node.width)
            .map(|lane| {
                let (a, b) = (bound(0, lane), bound(1, lane));
                Lack { to_hold: maximum(a.low - b.high, 0.0), to_fail: maximum(b.low - a.high, 0.0) }
            })
            .collect(),
        Operation::Binary(Binary::And | Binary::Multiply) => pair(Lack::and),
        Operation::Binary(Binary::Divide) | Operation::Unary(Unary::Negate) => {
            let lanes = lanes_of(0);
            (0..node.width).map(|index| if lanes.len() == 1 { lanes[0] } else { lanes[index] }).collect()
        }
        // Of `max(0, x)` and `clip(x, 0, 1)`: how far x is below 0.
        Operation::Binary(kind @ (Binary::Maximum | Binary::Minimum)) => {
            let sides = [lanes_of(0), lanes_of(1)];
            let missing = |input: usize, lane: usize| {
                let lanes = &sides[input];
                let lack = if lanes.len() == 1 { lanes[0] } else { lanes[lane] };
                if lack.to_hold > 0.0 { lack.to_hold } else { maximum(-bound(input, lane).high, 0.0) }
            };
            let is_free = |input: &usize| graph.constant_lanes(node.inputs[*input]).is_none();
            let lane = |index: usize| {
                let whole = Lack::of_bounds(bounds[id.index()].get(index).copied().unwrap_or(Bounds::ANY));
                let each = [0, 1].into_iter().filter(is_free).map(|input| missing(input, index));
                let least = if *kind == Binary::Maximum { each.reduce(minimum) } else { each.reduce(maximum) };
                Lack { to_hold: if whole.to_hold > 0.0 { least.unwrap_or(1.0) } else { 0.0 }, ..whole }
            };
            (0..node.width).map(lane).collect()
        }
        Operation::Choose => {
            let [condition, yes, no] = [0, 1, 2].map(lanes_of);
            let lane = |lanes: &[Lack], index: usize| if lanes.len() == 1 { lanes[0] } else { lanes[index] };
            let choice = |index: usize| {
                let condition = lane(&condition, index);
                condition.and(lane(&yes, index)).or(condition.not().and(lane(&no, index)))
            };
            (0..node.width).map(choice).collect()
        }
        Operation::Reduce(Reduction::Product, group) => {
            lanes_of(0).chunks_exact(*group as usize).filter_map(|lanes| lanes.iter().copied().reduce(Lack::and)).collect()
        }
        Operation::Binary(Binary::Or) => pair(Lack::or),
        Operation::Unary(Unary::Not) => lanes_of(0).into_iter().map(Lack::not).collect(),
        Operation::Reduce(kind @ (Reduction::Maximum | Reduction::Minimum), group) if lanes_of(0).iter().all(is_truth) => {
            let join = if *kind == Reduction::Maximum { Lack::or } else { Lack::and };
            lanes_of(0).chunks_exact(*group as usize).filter_map(|lanes| lanes.iter().copied().reduce(join)).collect()
        }
        Operation::Select(lanes) => {
            let input = lanes_of(0);
            lanes.iter().map(|&lane| input[lane as usize]).collect()
        }
        Operation::Join => (0..node.inputs.len()).flat_map(lanes_of).collect(),
        _ => bounds[id.index()].iter().copied().map(Lack::of_bounds).collect(),
    }
}

/// Numbers are no conditions, and neither is the largest of them.
fn is_truth(lack: &Lack) -> bool {
    lack.to_hold == 0.0 || lack.to_fail == 0.0
}

//! From nodes of the graph to single numbers and what is done with them.

use super::lane::{Act, Bank, Code, Computation, Effect, Lane, Lanes, NARROW, Pairing, Run, STEP, Time, ZERO, lane};
use super::outputs::{Outputs, places};
use crate::frame::FrameLayout;
use crate::graph::operation::{Binary, Chance, Memory, Operation, Reduction};
use crate::graph::{Graph, NodeId};
use std::ops::Range;

/// A graph as single numbers.
pub(super) struct Sheet {
    /// The lanes of every node that is wanted.
    nodes: Vec<Lanes>,
    pub computations: Vec<Computation>,
    pub acts: Vec<(Act, Time)>,
    /// The record as an episode finds it.
    pub record: Vec<f64>,
    /// First cell of each state.
    pub states: Vec<usize>,
    pub draws: Vec<Drawing>,
    /// Phase and cell of the successes of earlier phases that are read.
    pub successes: Vec<(usize, usize)>,
}

/// Where a random stands.
pub(super) struct Drawing {
    pub chance: Chance,
    /// What chance gives.
    pub noise: Range<usize>,
    pub cell: usize,
}

impl Sheet {
    /// The numbers of a node.
    pub(super) fn lanes(&self, node: NodeId) -> &[Lane] {
        &self.nodes[node.index()]
    }

    /// Room for so many numbers in the record.
    pub(super) fn reserve(&mut self, width: usize) -> usize {
        let at = self.record.len();
        self.record.resize(at + width, 0.0);
        at
    }
}

/// Spreads what `outputs` need over a frame of that layout.
pub(super) fn spread(graph: &Graph, outputs: &Outputs, layout: &FrameLayout) -> Sheet {
    let live = graph.reachable(outputs.roots());
    let times = Times::of(graph, outputs, &live);
    let mut sheet = Sheet {
        nodes: vec![Lanes::default(); graph.nodes().len()],
        computations: Vec::new(),
        acts: Vec::new(),
        record: vec![0.0; ZERO + 1],
        states: Vec::new(),
        draws: Vec::new(),
        successes: Vec::new(),
    };
    for update in &outputs.updates {
        let cell = sheet.reserve(graph.width(*update));
        sheet.states.push(cell);
    }
    for draw in &outputs.draws {
        let cell = sheet.reserve(graph.width(draw.value));
        sheet.draws.push(Drawing { chance: Chance::Uniform, noise: 0..0, cell });
    }
    let paired = paired(graph, outputs, &live);
    let mut spreader = Spreader { graph, layout, paired, time: Time::After, sheet };
    for late in [false, true] {
        for &id in live.iter().filter(|id| times.late[id.index()] == late) {
            spreader.time = times.of_node(id);
            spreader.node(id);
        }
    }
    spreader.sheet
}

/// When nodes are computed.
struct Times {
    /// Whether a node needs a state or a random after its update.
    late: Vec<bool>,
    /// The draw that a node belongs to, if it depends on what chance gives at a try.
    tried: Vec<Option<usize>>,
    /// Whether a node is computed before the initial state.
    first: Vec<bool>,
}

impl Times {
    fn of(graph: &Graph, outputs: &Outputs, live: &[NodeId]) -> Self {
        let count = graph.nodes().len();
        let mut times = Self { late: vec![false; count], tried: vec![None; count], first: vec![false; count] };
        for &id in live {
            let node = graph.node(id);
            let after = matches!(node.operation, Operation::StateAfter(_) | Operation::DrawnAfter(_));
            times.late[id.index()] = after || node.inputs.iter().any(|input| times.late[input.index()]);
            times.tried[id.index()] = match node.operation {
                Operation::Noise(draw, ..) => Some(draw as usize),
                Operation::Drawn(_) | Operation::DrawnAfter(_) => None,
                _ => node.inputs.iter().find_map(|input| times.tried[input.index()]),
            };
        }
        let drawn_first = outputs.draws.iter().map(|draw| draw.value).filter(|value| graph.is_drawn_first(*value));
        for id in graph.reachable(outputs.initial_values.iter().copied().chain(drawn_first)) {
            times.first[id.index()] = true;
        }
        times
    }

    fn of_node(&self, id: NodeId) -> Time {
        match self.tried[id.index()] {
            Some(draw) => Time::Try(draw),
            None if self.late[id.index()] => Time::After,
            None => Time::Before { first: self.first[id.index()] },
        }
    }
}

/// For each node that only a reduction reads, together with which it is computed at once: how.
fn paired(graph: &Graph, outputs: &Outputs, live: &[NodeId]) -> Vec<Option<Pairing>> {
    let mut readers = vec![0_u32; graph.nodes().len()];
    let inputs = live.iter().flat_map(|&id| graph.node(id).inputs.iter().copied());
    outputs.roots().chain(inputs).for_each(|id| readers[id.index()] += 1);
    let mut paired = vec![None; graph.nodes().len()];
    for &id in live {
        let node = graph.node(id);
        let (Operation::Reduce(reduction, _), [input]) = (&node.operation, node.inputs.as_slice()) else { continue };
        if readers[input.index()] == 1 && graph.width(id) <= NARROW {
            paired[input.index()] = match (reduction, &graph.node(*input).operation) {
                (Reduction::Sum, Operation::Binary(Binary::Multiply)) => Some(Pairing::SumOfProducts),
                (Reduction::Norm, Operation::Binary(Binary::Subtract)) => Some(Pairing::NormOfDifferences),
                _ => None,
            };
        }
    }
    paired
}

struct Spreader<'a> {
    graph: &'a Graph,
    layout: &'a FrameLayout,
    paired: Vec<Option<Pairing>>,
    /// When the present node is computed.
    time: Time,
    sheet: Sheet,
}

impl Spreader<'_> {
    fn node(&mut self, id: NodeId) {
        if self.paired[id.index()].is_none() {
            let lanes = self.lanes(id);
            debug_assert_eq!(lanes.len(), self.graph.width(id), "lanes of {:?}", self.graph.node(id));
            self.sheet.nodes[id.index()] = lanes;
        }
    }

    fn inputs(&self, id: NodeId) -> Vec<Lanes> {
        self.graph.node(id).inputs.iter().map(|input| self.sheet.nodes[input.index()].clone()).collect()
    }

    fn lanes(&mut self, id: NodeId) -> Lanes {
        let (graph, inputs) = (self.graph, self.inputs(id));
        let width = graph.width(id);
        let each = |make: &dyn Fn(usize) -> Computation, spreader: &mut Self| -> Lanes {
            (0..width).map(|index| spreader.compute(make(index))).collect()
        };
        match &graph.node(id).operation {
            Operation::Constant(values) => {
                let at = self.sheet.record.len();
                self.sheet.record.extend(values.iter().map(|value| value.value()));
                (at..at + width).map(Lane::Constant).collect()
            }
            Operation::Sensors(sensors) => places(self.layout, sensors).into_iter().map(Lane::Frame).collect(),
            Operation::Step => [Lane::Record(STEP)].into(),
            Operation::Select(chosen) => chosen.iter().map(|&index| inputs[0][index as usize]).collect(),
            Operation::Join => inputs.iter().flat_map(|lanes| lanes.iter().copied()).collect(),
            Operation::Unary(function) if width <= NARROW => {
                each(&|index| Computation::Unary(*function, lane(&inputs[0], index)), self)
            }
            Operation::Binary(function) if width <= NARROW => {
                each(&|index| Computation::Binary(*function, lane(&inputs[0], index), lane(&inputs[1], index)), self)
            }
            Operation::Choose if width <= NARROW => {
                each(&|index| Computation::Choose([0, 1, 2].map(|place: usize| lane(&inputs[place], index))), self)
            }
            Operation::Reduce(reduction, group) => self.reduce(id, *reduction, *group as usize, &inputs),
            Operation::Unary(function) => self.block(Code::Unary(*function), &inputs, width),
            Operation::Binary(function) => self.block(Code::Binary(*function), &inputs, width),
            Operation::Choose => self.block(Code::Choose, &inputs, width),
            Operation::Quaternion => self.block(Code::Quaternion, &inputs, width),
            Operation::Memory(memory) => self.remember(*memory, &inputs, width),
            Operation::StateBefore(index) => {
                let cell = self.sheet.states[*index as usize];
                self.act(Effect::Begin { cell, lanes: inputs[0].clone() });
                let at = self.sheet.reserve(width);
                self.act(Effect::Put { at, lanes: record(cell, width) });
                record(at, width)
            }
            Operation::StateAfter(index) => {
                let cell = self.sheet.states[*index as usize];
                self.act(Effect::Begin { cell, lanes: inputs[0].clone() });
                record(cell, width)
            }
            Operation::Noise(draw, chance, _) => {
                let at = self.sheet.reserve(width);
                let drawing = &mut self.sheet.draws[*draw as usize];
                (drawing.noise, drawing.chance) = (at..at + width, *chance);
                record(at, width)
            }
            Operation::Drawn(draw) => {
                let at = self.sheet.reserve(width);
                self.act(Effect::Draw { draw: *draw as usize, at });
                record(at, width)
            }
            Operation::DrawnAfter(draw) => record(self.sheet.draws[*draw as usize].cell, width),
            Operation::Pick(_) => {
                let (list, at) = (self.side_by_side(&inputs[0]), self.sheet.reserve(width));
                self.act(Effect::Pick { list, place: lane(&inputs[1], 0), at, width });
                record(at, width)
            }
            Operation::PhaseSuccess(phase) => {
                let cell = self.sheet.reserve(1);
                self.sheet.successes.push((*phase as usize, cell));
                record(cell, 1)
            }
            Operation::Follow(track) => {
                let at = self.sheet.reserve(width);
                self.act(Effect::Follow { track: track.clone(), time: lane(&inputs[0], 0), at });
                record(at, width)
            }
        }
    }

    fn act(&mut self, effect: Effect) {
        self.sheet.acts.push((Act::Do(effect), self.time));
    }

    fn compute(&mut self, computation: Computation) -> Lane {
        let number = self.sheet.computations.len();
        self.sheet.computations.push(computation);
        self.sheet.acts.push((Act::Compute(number), self.time));
        Lane::Computed(number)
    }

    /// Lanes side by side, if need be in a place of their own.
    fn side_by_side(&mut self, lanes: &Lanes) -> Run {
        Run::of(lanes).unwrap_or_else(|| {
            let (at, length) = (self.sheet.reserve(lanes.len()), lanes.len());
            self.act(Effect::Put { at, lanes: lanes.clone() });
            Run { bank: Bank::Record, from: at, length }
        })
    }

    /// The lanes of a node; side by side if they would stand in both banks.
    fn in_one_bank(&mut self, node: NodeId) -> Lanes {
        let lanes = self.sheet.nodes[node.index()].clone();
        let measured = lanes.iter().filter(|lane| matches!(lane, Lane::Frame(_))).count();
        if measured == 0 || measured == lanes.len() { lanes } else { self.side_by_side(&lanes).lanes() }
    }

    /// Computes a list as a whole. Its inputs stand below its place in the record.
    fn block(&mut self, code: Code, inputs: &[Lanes], width: usize) -> Lanes {
        let inputs = inputs.iter().map(|lanes| self.side_by_side(lanes)).collect();
        let at = self.sheet.reserve(width);
        self.act(Effect::Block { code, inputs, at, width });
        record(at, width)
    }

    fn remember(&mut self, memory: Memory, inputs: &[Lanes], width: usize) -> Lanes {
        let cell = self.sheet.reserve(width * memory.cells());
        // A ring holds what is to come; all others hold what they come to.
        let at = matches!(memory, Memory::Delay(_)).then(|| self.sheet.reserve(width));
        let input = |place: usize, index: usize| inputs.get(place).map_or(Lane::Constant(ZERO), |lanes| lane(lanes, index));
        let lanes = (0..width).map(|index| [0, 1, 2].map(|place| input(place, index))).collect();
        self.act(Effect::Remember { memory, cell, lanes, at });
        record(at.unwrap_or(cell), width)
    }

    fn reduce(&mut self, id: NodeId, reduction: Reduction, group: usize, inputs: &[Lanes]) -> Lanes {
        let (graph, width) = (self.graph, self.graph.width(id));
        if let [input] = graph.node(id).inputs.as_slice()
            && let Some(pairing) = self.paired[input.index()]
        {
            let lists = [0, 1].map(|list: usize| self.in_one_bank(self.graph.node(*input).inputs[list]));
            let lanes = |list: usize, from: usize| (from..from + group).map(|index| lane(&lists[list], index)).collect();
            let pairs = |number| Computation::Pairs(pairing, [0, 1].map(|list| lanes(list, number * group)));
            return (0..width).map(|number| self.compute(pairs(number))).collect();
        }
        let lanes = &inputs[0];
        if width > NARROW || (group > NARROW && Run::of(lanes).is_none()) {
            return self.block(Code::Reduce(reduction, group), inputs, width);
        }
        lanes.chunks_exact(group).map(|lanes| self.reduce_group(reduction, lanes)).collect()
    }

    fn reduce_group(&mut self, reduction: Reduction, lanes: &[Lane]) -> Lane {
        // Of two numbers, these are what a function of two gives.
        let function = match reduction {
            Reduction::Sum => Some(Binary::Add),
            Reduction::Product => Some(Binary::Multiply),
            Reduction::Minimum => Some(Binary::Minimum),
            Reduction::Maximum => Some(Binary::Maximum),
            Reduction::Norm | Reduction::ArgMinimum | Reduction::ArgMaximum => None,
        };
        self.compute(match (function, lanes) {
            (Some(function), &[left, right]) => Computation::Binary(function, left, right),
            _ => Computation::Reduce(reduction, lanes.into()),
        })
    }
}

/// Numbers side by side in the record.
fn record(at: usize, width: usize) -> Lanes {
    (at..at + width).map(Lane::Record).collect()
}

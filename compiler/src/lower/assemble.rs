//! From the graph to the list of instructions.

use super::program::{Bank, Code, Instruction, Operand, Program};
use crate::frame::{FrameLayout, Query, Sensor};
use crate::graph::operation::Operation;
use crate::graph::{Graph, NodeId};
use std::collections::{BTreeSet, HashMap};

/// What a task wants computed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Outputs {
    pub terms: Vec<NodeId>,
    pub terminations: Vec<NodeId>,
    pub success: Option<NodeId>,
    pub channels: Vec<NodeId>,
    /// New value of each declared state.
    pub updates: Vec<NodeId>,
    /// Numbers that the beginning takes from what is drawn.
    pub beginning: Vec<NodeId>,
    /// When connections let go.
    pub releases: Vec<NodeId>,
    /// Places that are shown.
    pub markers: Vec<NodeId>,
}

impl Outputs {
    /// Every node that is wanted, in the task's order.
    pub(crate) fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        let ends = [&self.terms, &self.terminations, &self.channels, &self.updates];
        let scene = [&self.beginning, &self.releases, &self.markers];
        let lists = ends.into_iter().chain(scene);
        lists.flatten().copied().chain(self.success)
    }
}

/// Lowers what `outputs` need.
pub(crate) fn assemble(graph: &Graph, outputs: &Outputs, queries: &[Query]) -> (Program, FrameLayout) {
    let live = graph.reachable(outputs.roots());
    let mut assembler = Assembler::new(graph, &live, queries);
    assembler.reserve_states(outputs);
    let mut late = vec![false; graph.nodes().len()];
    for &id in &live {
        let node = graph.node(id);
        late[id.index()] = matches!(node.operation, Operation::StateAfter(_)) || node.inputs.iter().any(|i| late[i.index()]);
    }
    for wanted_late in [false, true] {
        for &id in live.iter().filter(|id| late[id.index()] == wanted_late) {
            assembler.place(id, wanted_late);
        }
    }
    let list = |nodes: &[NodeId]| nodes.iter().map(|node| assembler.places[node]).collect::<Vec<_>>();
    let terms = list(&outputs.terms);
    let terminations = list(&outputs.terminations);
    let channels = list(&outputs.channels);
    let (beginning, releases, markers) = (list(&outputs.beginning), list(&outputs.releases), list(&outputs.markers));
    let success = outputs.success.map(|node| assembler.places[&node]);
    let updates = assembler.state_cells.iter().copied().zip(list(&outputs.updates)).collect();
    let program = Program { terms, terminations, success, channels, updates, beginning, releases, markers, ..assembler.program };
    (program, assembler.layout)
}

struct Assembler<'a> {
    graph: &'a Graph,
    layout: FrameLayout,
    offsets: HashMap<Sensor, usize>,
    places: HashMap<NodeId, Operand>,
    state_cells: Vec<usize>,
    program: Program,
}

impl<'a> Assembler<'a> {
    fn new(graph: &'a Graph, live: &[NodeId], queries: &[Query]) -> Self {
        let mut wanted = BTreeSet::new();
        for &id in live {
            if let Operation::Sensors(sensors) = &graph.node(id).operation {
                wanted.extend(sensors.iter().copied());
            }
        }
        let mut layout = FrameLayout::with_queries(queries.to_vec());
        let offsets = wanted.into_iter().map(|sensor| (sensor, layout.append(sensor))).collect();
        Self { graph, layout, offsets, places: HashMap::new(), state_cells: Vec::new(), program: Program::default() }
    }

    fn reserve_states(&mut self, outputs: &Outputs) {
        for update in &outputs.updates {
            self.state_cells.push(self.program.cells);
            self.program.cells += self.graph.width(*update);
        }
    }

    /// Gives a node its place: a view where possible, else an instruction.
    fn place(&mut self, id: NodeId, late: bool) {
        let node = self.graph.node(id);
        let inputs: Vec<Operand> = node.inputs.iter().map(|input| self.places[input]).collect();
        let operand = match &node.operation {
            Operation::Constant(lanes) => {
                let offset = self.program.constants.len();
                self.program.constants.extend(lanes.iter().map(|lane| lane.value()));
                Operand { bank: Bank::Constant, offset, width: lanes.len() }
            }
            Operation::Sensors(sensors) => self.place_sensors(sensors, late),
            Operation::Select(lanes) if contiguous(lanes) => {
                let start = lanes.first().map_or(0, |&lane| lane as usize);
                Operand { offset: inputs[0].offset + start, width: lanes.len(), ..inputs[0] }
            }
            Operation::Join => self.place_join(&inputs, node.width, late),
            operation => {
                let code = self.code(operation, node.width);
                self.emit(code, &inputs, node.width, late)
            }
        };
        self.places.insert(id, operand);
    }

    fn code(&mut self, operation: &Operation, width: usize) -> Code {
        match operation {
            Operation::Unary(function) => Code::Unary(*function),
            Operation::Binary(function) => Code::Binary(*function),
            Operation::Choose => Code::Choose,
            Operation::Select(lanes) => Code::Gather(lanes.clone().into_boxed_slice()),
            Operation::Reduce(reduction, group) => Code::Reduce(*reduction, *group as usize),
            Operation::Quaternion => Code::Quaternion,
            Operation::StateBefore(index) => Code::StateBefore(self.state_cells[*index as usize]),
            Operation::StateAfter(index) => Code::StateAfter(self.state_cells[*index as usize]),
            Operation::Memory(memory) => {
                let first = self.program.cells;
                self.program.cells += width * memory.cells();
                Code::Memory(*memory, first)
            }
            // These three are placed without an instruction of their own kind.
            Operation::Step | Operation::Constant(_) | Operation::Sensors(_) | Operation::Join => Code::Step,
        }
    }

    fn place_sensors(&mut self, sensors: &[Sensor], late: bool) -> Operand {
        let lanes: Vec<u32> =
            sensors.iter().flat_map(|sensor| (0..sensor.size()).map(|lane| (self.offsets[sensor] + lane) as u32)).collect();
        let whole = Operand { bank: Bank::Frame, offset: 0, width: self.layout.size() };
        if contiguous(&lanes) {
            return Operand { offset: lanes.first().map_or(0, |&lane| lane as usize), width: lanes.len(), ..whole };
        }
        let width = lanes.len();
        self.emit(Code::Gather(lanes.into_boxed_slice()), &[whole], width, late)
    }

    fn place_join(&mut self, inputs: &[Operand], width: usize, late: bool) -> Operand {
        let offset = self.program.registers;
        for input in inputs {
            self.emit(Code::Copy, &[*input], input.width, late);
        }
        Operand { bank: Bank::Register, offset, width }
    }

    fn emit(&mut self, code: Code, inputs: &[Operand], width: usize, late: bool) -> Operand {
        let mut places = [Operand::EMPTY; 3];
        places.iter_mut().zip(inputs).for_each(|(place, input)| *place = *input);
        let output = self.program.registers;
        self.program.registers += width;
        let instruction = Instruction { code, inputs: places, output, width };
        if late {
            self.program.after.push(instruction)
        } else {
            self.program.before.push(instruction)
        }
        Operand { bank: Bank::Register, offset: output, width }
    }
}

fn contiguous(lanes: &[u32]) -> bool {
    lanes.windows(2).all(|pair| pair[1] == pair[0] + 1)
}

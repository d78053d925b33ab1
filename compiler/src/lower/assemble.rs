//! From the graph to the list of instructions.

use super::program::{Bank, Code, Draw, Instruction, Operand, Program};
use crate::frame::{FrameLayout, Query, Sensor};
use crate::graph::operation::{Chance, Operation};
use crate::graph::{Graph, NodeId};
use std::collections::{BTreeSet, HashMap};

/// What a task wants computed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Outputs {
    pub terms: Vec<NodeId>,
    pub terminations: Vec<NodeId>,
    pub finishes: Vec<NodeId>,
    pub metrics: Vec<NodeId>,
    pub success: Option<NodeId>,
    pub channels: Vec<NodeId>,
    /// New value of each declared state.
    pub updates: Vec<NodeId>,
    /// In the order of their numbers.
    pub draws: Vec<DrawOutput>,
    /// Numbers that the beginning takes from what is drawn.
    pub beginning: Vec<NodeId>,
    /// When connections let go.
    pub releases: Vec<NodeId>,
    /// Places that are shown.
    pub markers: Vec<NodeId>,
    /// When the next phase begins.
    pub until: Option<NodeId>,
    /// Whether this phase has succeeded, for those after it.
    pub succeeded: Option<NodeId>,
}

/// A random.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct DrawOutput {
    /// The random before its redraw: its inputs say how it is drawn.
    pub value: NodeId,
    /// When it is drawn anew.
    pub redraw: Option<NodeId>,
}

impl Outputs {
    /// Every node that is wanted, in the task's order.
    pub(crate) fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        let ends = [&self.terms, &self.terminations, &self.finishes, &self.metrics, &self.channels, &self.updates];
        let scene = [&self.beginning, &self.releases, &self.markers];
        let lists = ends.into_iter().chain(scene);
        let draws = self.draws.iter().flat_map(|draw| std::iter::once(draw.value).chain(draw.redraw));
        let single = [self.success, self.until, self.succeeded];
        lists.flatten().copied().chain(draws).chain(single.into_iter().flatten())
    }
}

/// The sensors that `outputs` read, and the queries of the terrain.
pub(crate) fn layout<'a>(graphs: impl Iterator<Item = (&'a Graph, &'a Outputs)>, queries: &[Query]) -> FrameLayout {
    let mut wanted = BTreeSet::new();
    for (graph, outputs) in graphs {
        for id in graph.reachable(outputs.roots()) {
            if let Operation::Sensors(sensors) = &graph.node(id).operation {
                wanted.extend(sensors.iter().copied());
            }
        }
    }
    let mut layout = FrameLayout::with_queries(queries.to_vec());
    for sensor in wanted {
        layout.append(sensor);
    }
    layout
}

/// Lowers what `outputs` need over a frame of that layout.
pub(crate) fn assemble(graph: &Graph, outputs: &Outputs, layout: &FrameLayout) -> Program {
    let live = graph.reachable(outputs.roots());
    let mut assembler = Assembler::new(graph, layout, outputs, &live);
    let mut late = vec![false; graph.nodes().len()];
    for &id in &live {
        let node = graph.node(id);
        let after = matches!(node.operation, Operation::StateAfter(_) | Operation::DrawnAfter(_));
        late[id.index()] = after || node.inputs.iter().any(|i| late[i.index()]);
    }
    for wanted_late in [false, true] {
        for &id in live.iter().filter(|id| late[id.index()] == wanted_late) {
            assembler.place(id, wanted_late);
        }
    }
    assembler.finish_draws(outputs);
    let list = |nodes: &[NodeId]| nodes.iter().map(|node| assembler.places[node]).collect::<Vec<_>>();
    let single = |node: Option<NodeId>| node.map(|node| assembler.places[&node]);
    Program {
        terms: list(&outputs.terms),
        terminations: list(&outputs.terminations),
        finishes: list(&outputs.finishes),
        metrics: list(&outputs.metrics),
        channels: list(&outputs.channels),
        beginning: list(&outputs.beginning),
        releases: list(&outputs.releases),
        markers: list(&outputs.markers),
        success: single(outputs.success),
        until: single(outputs.until),
        succeeded: single(outputs.succeeded),
        updates: assembler.state_cells.iter().copied().zip(list(&outputs.updates)).collect(),
        ..assembler.program
    }
}

struct Assembler<'a> {
    graph: &'a Graph,
    layout: &'a FrameLayout,
    offsets: HashMap<Sensor, usize>,
    places: HashMap<NodeId, Operand>,
    state_cells: Vec<usize>,
    /// For each node: the draw that it belongs to, if it depends on what chance gives at a try.
    tried: Vec<Option<usize>>,
    /// Whether a node is computed before the beginning.
    first: Vec<bool>,
    program: Program,
}

impl<'a> Assembler<'a> {
    fn new(graph: &'a Graph, layout: &'a FrameLayout, outputs: &Outputs, live: &[NodeId]) -> Self {
        let offsets = layout.entries().iter().copied().collect();
        let mut tried: Vec<Option<usize>> = vec![None; graph.nodes().len()];
        for &id in live {
            let node = graph.node(id);
            tried[id.index()] = match node.operation {
                Operation::Noise(draw, ..) => Some(draw as usize),
                Operation::Drawn(_) | Operation::DrawnAfter(_) => None,
                _ => node.inputs.iter().find_map(|input| tried[input.index()]),
            };
        }
        let drawn_first = outputs.draws.iter().map(|draw| draw.value).filter(|value| graph.is_drawn_first(*value));
        let mut first = vec![false; graph.nodes().len()];
        for id in graph.reachable(outputs.beginning.iter().copied().chain(drawn_first)) {
            first[id.index()] = true;
        }
        let mut assembler = Self {
            graph,
            layout,
            offsets,
            places: HashMap::new(),
            state_cells: Vec::new(),
            tried,
            first,
            program: Program::default(),
        };
        assembler.reserve_cells(outputs);
        assembler
    }

    fn reserve_cells(&mut self, outputs: &Outputs) {
        for update in &outputs.updates {
            self.state_cells.push(self.program.cells);
            self.program.cells += self.graph.width(*update);
        }
        for draw in &outputs.draws {
            let first = self.graph.is_drawn_first(draw.value);
            let cell = self.program.cells;
            self.program.cells += self.graph.width(draw.value);
            let (noise, candidate) = (Operand::EMPTY, Operand::EMPTY);
            let chance = Chance::Uniform;
            self.program.draws.push(Draw {
                chance,
                noise,
                tries: Vec::new(),
                candidate,
                accept: None,
                first,
                redraw: None,
                cell,
            });
        }
    }

    /// Gives the draws the places of what they need.
    fn finish_draws(&mut self, outputs: &Outputs) {
        for (index, output) in outputs.draws.iter().enumerate() {
            let inputs = &self.graph.node(output.value).inputs;
            let place = |node: &NodeId| self.places.get(node).copied();
            let draw = &mut self.program.draws[index];
            draw.candidate = inputs.first().and_then(place).unwrap_or(Operand::EMPTY);
            draw.accept = inputs.get(1).and_then(place);
            draw.redraw = output.redraw.as_ref().and_then(place);
        }
    }

    /// Gives a node its place: a view where possible, else an instruction.
    fn place(&mut self, id: NodeId, late: bool) {
        let node = self.graph.node(id);
        let inputs: Vec<Operand> = node.inputs.iter().map(|input| self.places[input]).collect();
        let home = match self.tried[id.index()] {
            Some(draw) => Home::Try(draw),
            None if late => Home::After,
            None => Home::Before { first: self.first[id.index()] },
        };
        let operand = match &node.operation {
            Operation::Constant(lanes) => {
                let offset = self.program.constants.len();
                self.program.constants.extend(lanes.iter().map(|lane| lane.value()));
                Operand { bank: Bank::Constant, offset, width: lanes.len() }
            }
            Operation::Sensors(sensors) => self.place_sensors(sensors, home),
            Operation::Select(lanes) if contiguous(lanes) => {
                let start = lanes.first().map_or(0, |&lane| lane as usize);
                Operand { offset: inputs[0].offset + start, width: lanes.len(), ..inputs[0] }
            }
            Operation::Join => self.place_join(&inputs, node.width, home),
            Operation::Noise(draw, chance, _) => {
                let noise = Operand { bank: Bank::Register, offset: self.program.registers, width: node.width };
                self.program.registers += node.width;
                let draw = &mut self.program.draws[*draw as usize];
                (draw.noise, draw.chance) = (noise, *chance);
                noise
            }
            operation => {
                let code = self.code(operation, node.width);
                // How a random is drawn is the draw's business; to be read it needs its cells only.
                let inputs = if matches!(code, Code::Drawn(_) | Code::DrawnAfter(_)) { &[][..] } else { &inputs };
                self.emit(code, inputs, node.width, home)
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
            Operation::Drawn(index) => Code::Drawn(*index as usize),
            Operation::DrawnAfter(index) => Code::DrawnAfter(*index as usize),
            Operation::Pick(_) => Code::Pick,
            Operation::PhaseSuccess(phase) => {
                let cell = self.program.cells;
                self.program.cells += 1;
                self.program.successes.push((*phase as usize, cell));
                Code::PhaseSuccess(cell)
            }
            Operation::Follow(track) => Code::Follow(Box::new(track.clone())),
            Operation::Memory(memory) => {
                let first = self.program.cells;
                self.program.cells += width * memory.cells();
                Code::Memory(*memory, first)
            }
            // All but the first are placed without an instruction of their own kind.
            Operation::Step | Operation::Constant(_) | Operation::Sensors(_) | Operation::Join | Operation::Noise(..) => {
                Code::Step
            }
        }
    }

    fn place_sensors(&mut self, sensors: &[Sensor], home: Home) -> Operand {
        let lanes: Vec<u32> =
            sensors.iter().flat_map(|sensor| (0..sensor.size()).map(|lane| (self.offsets[sensor] + lane) as u32)).collect();
        let whole = Operand { bank: Bank::Frame, offset: 0, width: self.layout.size() };
        if contiguous(&lanes) {
            return Operand { offset: lanes.first().map_or(0, |&lane| lane as usize), width: lanes.len(), ..whole };
        }
        let width = lanes.len();
        self.emit(Code::Gather(lanes.into_boxed_slice()), &[whole], width, home)
    }

    fn place_join(&mut self, inputs: &[Operand], width: usize, home: Home) -> Operand {
        let offset = self.program.registers;
        for input in inputs {
            self.emit(Code::Copy, &[*input], input.width, home);
        }
        Operand { bank: Bank::Register, offset, width }
    }

    fn emit(&mut self, code: Code, inputs: &[Operand], width: usize, home: Home) -> Operand {
        let mut places = [Operand::EMPTY; 3];
        places.iter_mut().zip(inputs).for_each(|(place, input)| *place = *input);
        let output = self.program.registers;
        self.program.registers += width;
        let instruction = Instruction { code, inputs: places, output, width };
        match home {
            Home::Try(draw) => self.program.draws[draw].tries.push(instruction),
            Home::After => self.program.after.push(instruction),
            Home::Before { first } => {
                if first {
                    self.program.first.push(instruction.clone());
                }
                self.program.before.push(instruction);
            }
        }
        Operand { bank: Bank::Register, offset: output, width }
    }
}

/// Which list an instruction belongs to.
#[derive(Clone, Copy)]
enum Home {
    /// Before the states are updated; `first` before the episode begins as well.
    Before {
        first: bool,
    },
    After,
    /// At each try of a draw.
    Try(usize),
}

fn contiguous(lanes: &[u32]) -> bool {
    lanes.windows(2).all(|pair| pair[1] == pair[0] + 1)
}

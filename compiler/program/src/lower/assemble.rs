//! From single numbers to statements and formulas.

use super::block::Block;
use super::formula::{Formula, Scalar, binary, choose, clip, reduce_each, reduce_run, unary};
use super::lane::{Act, Computation, Effect, Lane, NARROW, Pairing, Run, Time, ZERO};
use super::outputs::Outputs;
use super::pairs::{Dot, List, pairs};
use super::plan::Plan;
use super::program::{Deed, Draw, Program, Statement};
use super::sharing::{Fate, fates};
use super::spread::{Sheet, spread};
use crate::frame::FrameLayout;
use crate::graph::operation::Binary;
use crate::graph::{Graph, NodeId};

/// Lowers what `outputs` need over a frame of that layout.
pub(crate) fn assemble(graph: &Graph, outputs: &Outputs, layout: &FrameLayout) -> Program {
    let mut sheet = spread(graph, outputs, layout);
    let drawn = outputs.draws.iter().flat_map(|draw| graph.node(draw.value).inputs.iter().copied());
    let wanted = outputs.roots().chain(drawn).flat_map(|node| sheet.lanes(node).to_vec());
    let roots: Vec<Lane> = wanted.collect();
    let fates = fates(&mut sheet, &roots);
    let assembler = Assembler { graph, sheet, fates };
    let mut program = assembler.program(outputs);
    assembler.statements(&mut program);
    Program { record: assembler.sheet.record, ..program }
}

struct Assembler<'a> {
    graph: &'a Graph,
    sheet: Sheet,
    fates: Vec<Fate>,
}

impl Assembler<'_> {
    /// All but the statements.
    fn program(&self, outputs: &Outputs) -> Program {
        let scalars = |nodes: &[NodeId]| nodes.iter().map(|&node| self.single(node)).collect();
        let plans = |nodes: &[NodeId]| nodes.iter().map(|&node| self.plan(self.sheet.lanes(node))).collect();
        let metrics: Vec<Lane> = outputs.metrics.iter().flat_map(|&node| self.sheet.lanes(node)).copied().collect();
        let updates = outputs.updates.iter().zip(&self.sheet.states);
        Program {
            updates: updates.map(|(&node, &at)| Deed::Put { at, plan: self.plan(self.sheet.lanes(node)) }).collect(),
            draws: (0..outputs.draws.len()).map(|index| self.draw(outputs, index)).collect(),
            successes: self.sheet.successes.clone(),
            terms: scalars(&outputs.terms),
            terminations: scalars(&outputs.terminations),
            finishes: scalars(&outputs.finishes),
            metrics: self.plan(&metrics),
            success: outputs.success.map(|node| self.single(node)),
            channels: plans(&outputs.channels),
            initial_values: scalars(&outputs.initial_values),
            releases: scalars(&outputs.releases),
            markers: plans(&outputs.markers),
            drives: plans(&outputs.drives),
            until: outputs.until.map(|node| self.single(node)),
            succeeded: outputs.succeeded.map(|node| self.single(node)),
            ..Program::default()
        }
    }

    fn draw(&self, outputs: &Outputs, index: usize) -> Draw {
        let (drawing, output) = (&self.sheet.draws[index], &outputs.draws[index]);
        let inputs = &self.graph.node(output.value).inputs;
        Draw {
            chance: drawing.chance,
            noise: drawing.noise.clone(),
            tries: Vec::new(),
            candidate: inputs.first().map_or_else(Plan::default, |&node| self.plan(self.sheet.lanes(node))),
            accept: inputs.get(1).map(|&node| self.single(node)),
            first: self.graph.is_drawn_first(output.value),
            redraw: output.redraw.map(|node| self.single(node)),
            cell: drawing.cell,
        }
    }

    fn statements(&self, program: &mut Program) {
        for (act, time) in &self.sheet.acts {
            let statement = match act {
                Act::Do(effect) => self.effect(effect),
                Act::Compute(number) => match self.fates[*number] {
                    Fate::At(at) => Statement::Store { at, formula: self.formula(*number) },
                    Fate::Within => {
                        program.operations += 1;
                        continue;
                    }
                    Fate::Unread => continue,
                },
            };
            program.operations += 1;
            match *time {
                Time::Try(draw) => program.draws[draw].tries.push(statement),
                Time::After => program.after.push(statement),
                Time::Before { first } => {
                    program.first.extend(first.then_some(program.before.len()));
                    program.before.push(statement);
                }
            }
        }
    }

    fn effect(&self, effect: &Effect) -> Statement {
        let deed = match effect {
            Effect::Put { at, lanes } => Deed::Put { at: *at, plan: self.plan(lanes) },
            Effect::Begin { cell, lanes } => Deed::Begin { at: *cell, plan: self.plan(lanes) },
            Effect::Draw { draw, at } => Deed::Draw { draw: *draw, at: *at },
            Effect::Remember { memory, cell, lanes, at } => {
                if let ([[input, rest @ ..]], 1) = (lanes.as_slice(), memory.cells())
                    && rest == &[Lane::Constant(ZERO); 2]
                    && at.is_none()
                {
                    return Statement::Remember { memory: *memory, cell: *cell, input: self.scalar(*input) };
                }
                let lanes = lanes.iter().map(|inputs| inputs.map(|lane| self.scalar(lane))).collect();
                Deed::Remember { memory: *memory, cell: *cell, lanes, at: *at }
            }
            Effect::Block { code, inputs, at, width } => {
                Deed::Block(Block { code: *code, inputs: inputs.clone(), at: *at, width: *width })
            }
            Effect::Pick { list, place, at, width } => {
                Deed::Pick { list: *list, place: self.scalar(*place), at: *at, width: *width }
            }
            Effect::Follow { track, time, at } => Deed::Follow { track: track.clone(), time: self.scalar(*time), at: *at },
        };
        Statement::Deed(Box::new(deed))
    }

    /// The one number of a node.
    fn single(&self, node: NodeId) -> Scalar {
        self.scalar(super::lane::lane(self.sheet.lanes(node), 0))
    }

    fn plan(&self, lanes: &[Lane]) -> Plan {
        let mut plan = Plan::default();
        let mut rest = lanes;
        while let Some(&lane) = rest.first() {
            let lane = self.settled(lane);
            let next = |index: &usize| match (lane.place(), self.settled(rest[*index]).place()) {
                (Some((bank, from)), Some(place)) => (bank, from + index) == place,
                _ => false,
            };
            let length = 1 + (1..rest.len()).take_while(next).count();
            match (lane.place(), self.dot(lane)) {
                (Some((bank, from)), _) => plan.copy(Run { bank, from, length }),
                (None, Some(dot)) => plan.dot(dot),
                (None, None) => plan.push(self.scalar(lane)),
            }
            rest = &rest[length..];
        }
        plan
    }

    /// What a lane comes to, if that is the dot product of two vectors and written down nowhere.
    fn dot(&self, lane: Lane) -> Option<Dot> {
        let Lane::Computed(number) = lane else { return None };
        match &self.sheet.computations[number] {
            Computation::Pairs(Pairing::SumOfProducts, lists) => Dot::of(lists.each_ref().map(|lanes| self.list(lanes))),
            _ => None,
        }
    }

    /// A list that stands in one bank.
    fn list(&self, lanes: &[Lane]) -> List {
        let lanes: Vec<Lane> = lanes.iter().map(|lane| self.settled(*lane)).collect();
        List::of(&lanes)
    }

    /// A lane, by its place if it has one.
    fn settled(&self, lane: Lane) -> Lane {
        match lane {
            Lane::Computed(number) => match self.fates[number] {
                Fate::At(at) => Lane::Record(at),
                Fate::Within | Fate::Unread => lane,
            },
            standing => standing,
        }
    }

    fn scalar(&self, lane: Lane) -> Scalar {
        match self.settled(lane) {
            Lane::Frame(place) => Scalar::Frame(place),
            Lane::Record(place) => Scalar::Record(place),
            Lane::Constant(place) => Scalar::Constant(self.sheet.record[place]),
            Lane::Computed(number) => Scalar::Formula(self.formula(number)),
        }
    }

    /// What is kept between which two constants, if a function does that.
    fn clipped(&self, function: Binary, within: Lane, high: Lane) -> Option<(Lane, f64, f64)> {
        let (Binary::Minimum, Lane::Computed(number)) = (function, self.settled(within)) else { return None };
        let Computation::Binary(Binary::Maximum, input, low) = self.sheet.computations[number] else { return None };
        match (low, high) {
            (Lane::Constant(low), Lane::Constant(high)) => Some((input, self.sheet.record[low], self.sheet.record[high])),
            _ => None,
        }
    }

    fn formula(&self, number: usize) -> Formula {
        match &self.sheet.computations[number] {
            Computation::Unary(function, input) => unary(*function, self.scalar(*input)),
            Computation::Binary(function, left, right) => match self.clipped(*function, *left, *right) {
                Some((input, low, high)) => clip(self.scalar(input), low, high),
                None => binary(*function, self.scalar(*left), self.scalar(*right)),
            },
            Computation::Choose([condition, yes, no]) => choose(self.scalar(*condition), self.scalar(*yes), self.scalar(*no)),
            Computation::Reduce(reduction, lanes) => {
                let lanes: Vec<Lane> = lanes.iter().map(|lane| self.settled(*lane)).collect();
                match Run::of(&lanes) {
                    Some(run) => reduce_run(*reduction, run),
                    None => reduce_each::<NARROW>(*reduction, lanes.iter().map(|lane| self.scalar(*lane)).collect()),
                }
            }
            Computation::Pairs(pairing, lists) => {
                let [left, right] = lists.each_ref().map(|lanes| self.list(lanes));
                pairs(*pairing, left, right)
            }
        }
    }
}

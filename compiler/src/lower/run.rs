//! Executing a program.

use super::program::{Bank, Code, Instruction, Operand, Program};
use crate::graph::operation::{Binary, Chance, Reduction, Unary, quaternion};

/// Which moment of the episode is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moment {
    /// Before the beginning: only what is drawn first.
    First,
    /// The reset snapshot, step 0.
    Reset,
    /// A control step with its number.
    Step(u32),
}

/// How often a random is tried before that is an error.
const TRIES: u32 = 64;

/// A draw none of whose tries was taken.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NoneTaken {
    pub draw: usize,
    pub tries: u32,
    pub last: Vec<f64>,
}

/// Gives the next number of a draw.
type Source<'a> = &'a mut dyn FnMut(usize, Chance) -> f64;

impl Program {
    /// Makes room, everything zero, and writes which of the earlier phases succeeded.
    pub(crate) fn prepare(&self, successes: &[bool], cells: &mut Vec<f64>, registers: &mut Vec<f64>) {
        cells.clear();
        cells.resize(self.cells, 0.0);
        registers.clear();
        registers.resize(self.registers, 0.0);
        for &(phase, cell) in &self.successes {
            cells[cell] = f64::from(u8::from(successes.get(phase) == Some(&true)));
        }
    }

    /// Gives a draw a value that it shall keep.
    pub(crate) fn keep(&self, draw: usize, value: &[f64], cells: &mut [f64]) {
        let cell = self.draws[draw].cell;
        cells[cell..cell + value.len()].copy_from_slice(value);
    }

    /// The present value of a draw.
    pub(crate) fn value_of_draw<'a>(&self, draw: usize, cells: &'a [f64]) -> &'a [f64] {
        let draw = &self.draws[draw];
        &cells[draw.cell..draw.cell + draw.candidate.width]
    }

    /// Draws what is drawn before the beginning and computes what that settles.
    pub(crate) fn first(
        &self,
        cells: &mut [f64],
        registers: &mut [f64],
        kept: &dyn Fn(usize) -> bool,
        source: Source<'_>,
    ) -> Result<(), NoneTaken> {
        self.drawing(&self.first, Moment::First, &[], cells, registers, kept, source)
    }

    /// Computes the reset snapshot: every memory starts, every state takes its first value, the other randoms are drawn.
    pub(crate) fn reset(
        &self,
        frame: &[f64],
        cells: &mut [f64],
        registers: &mut [f64],
        kept: &dyn Fn(usize) -> bool,
        source: Source<'_>,
    ) -> Result<(), NoneTaken> {
        self.drawing(&self.before, Moment::Reset, frame, cells, registers, kept, source)?;
        for instruction in &self.after {
            self.execute(instruction, Moment::Reset, frame, cells, registers);
        }
        Ok(())
    }

    /// Executes a list; a random is drawn where it is first read.
    #[allow(clippy::too_many_arguments, reason = "the parts of a state, which no struct holds together")]
    fn drawing(
        &self,
        list: &[Instruction],
        moment: Moment,
        frame: &[f64],
        cells: &mut [f64],
        registers: &mut [f64],
        kept: &dyn Fn(usize) -> bool,
        source: Source<'_>,
    ) -> Result<(), NoneTaken> {
        for instruction in list {
            if let Code::Drawn(index) = instruction.code
                && self.draws[index].first == (moment == Moment::First)
                && !kept(index)
            {
                self.draw(index, moment, frame, cells, registers, source)?;
            }
            self.execute(instruction, moment, frame, cells, registers);
        }
        Ok(())
    }

    /// Tries until a candidate is taken.
    fn draw(
        &self,
        index: usize,
        moment: Moment,
        frame: &[f64],
        cells: &mut [f64],
        registers: &mut [f64],
        source: Source<'_>,
    ) -> Result<(), NoneTaken> {
        let draw = &self.draws[index];
        for _ in 0..TRIES {
            for number in &mut registers[draw.noise.offset..draw.noise.offset + draw.noise.width] {
                *number = source(index, draw.chance);
            }
            for instruction in &draw.tries {
                self.execute(instruction, moment, frame, cells, registers);
            }
            let taken = draw.accept.is_none_or(|accept| view(accept, &self.constants, frame, registers) != [0.0]);
            if taken {
                let candidate = view(draw.candidate, &self.constants, frame, registers);
                cells[draw.cell..draw.cell + candidate.len()].copy_from_slice(candidate);
                return Ok(());
            }
        }
        let last = view(draw.candidate, &self.constants, frame, registers).to_vec();
        Err(NoneTaken { draw: index, tries: TRIES, last })
    }

    /// Computes control step number `step`: memories advance, formulas see states before their update, observations after.
    pub(crate) fn step(
        &self,
        step: u32,
        frame: &[f64],
        cells: &mut [f64],
        registers: &mut [f64],
        source: Source<'_>,
    ) -> Result<(), NoneTaken> {
        for instruction in &self.before {
            self.execute(instruction, Moment::Step(step), frame, cells, registers);
        }
        for (cell, value) in &self.updates {
            let lanes = view(*value, &self.constants, frame, registers);
            cells[*cell..*cell + lanes.len()].copy_from_slice(lanes);
        }
        let mut drawn = Ok(());
        for (index, draw) in self.draws.iter().enumerate() {
            let wanted = draw.redraw.is_some_and(|redraw| view(redraw, &self.constants, frame, registers) != [0.0]);
            if wanted && drawn.is_ok() {
                drawn = self.draw(index, Moment::Step(step), frame, cells, registers, source);
            }
        }
        for instruction in &self.after {
            self.execute(instruction, Moment::Step(step), frame, cells, registers);
        }
        drawn
    }

    /// The lanes of an output.
    pub(crate) fn read<'a>(&'a self, operand: Operand, frame: &'a [f64], registers: &'a [f64]) -> &'a [f64] {
        view(operand, &self.constants, frame, registers)
    }

    fn execute(&self, instruction: &Instruction, moment: Moment, frame: &[f64], cells: &mut [f64], registers: &mut [f64]) {
        let (below, above) = registers.split_at_mut(instruction.output);
        let out = &mut above[..instruction.width];
        let input = |place: usize| view(instruction.inputs[place], &self.constants, frame, below);
        match &instruction.code {
            Code::Step => out.fill(match moment {
                Moment::First | Moment::Reset => 0.0,
                Moment::Step(step) => f64::from(step),
            }),
            Code::Unary(function) => map(*function, input(0), out),
            Code::Binary(function) => zip(*function, input(0), input(1), out),
            Code::Choose => choose(input(0), input(1), input(2), out),
            Code::Gather(lanes) => {
                let from = input(0);
                for (value, &lane) in out.iter_mut().zip(lanes) {
                    *value = from[lane as usize];
                }
            }
            Code::Copy => out.copy_from_slice(input(0)),
            Code::Reduce(reduction, group) => reduce(*reduction, *group, input(0), out),
            Code::Quaternion => {
                if let Ok(axes) = <[f64; 9]>::try_from(input(0)) {
                    out.copy_from_slice(&quaternion(axes));
                }
            }
            Code::Memory(memory, first) => {
                let per_lane = memory.cells();
                for (index, value) in out.iter_mut().enumerate() {
                    let inputs = [0, 1, 2].map(|place| lane(input(place), index));
                    let cells = &mut cells[first + index * per_lane..][..per_lane];
                    *value = match moment {
                        Moment::First | Moment::Reset => memory.start(cells, inputs),
                        Moment::Step(step) => memory.advance(cells, step, inputs),
                    };
                }
            }
            Code::Drawn(draw) | Code::DrawnAfter(draw) => {
                let cell = self.draws[*draw].cell;
                out.copy_from_slice(&cells[cell..cell + out.len()]);
            }
            Code::Pick => {
                let (list, width) = (input(0), out.len().max(1));
                // Proven to lie within while compiling; a number that is none picks the first element.
                let place = (lane(input(1), 0).max(0.0) as usize).min((list.len() / width).saturating_sub(1));
                out.copy_from_slice(&list[place * width..][..width]);
            }
            Code::PhaseSuccess(cell) => out.fill(cells[*cell]),
            Code::Follow(track) => track.read(lane(input(0), 0), out),
            // Whichever of the two comes first at reset gives the state its first value.
            Code::StateBefore(first) | Code::StateAfter(first) => {
                let cells = &mut cells[*first..first + out.len()];
                if moment == Moment::Reset {
                    cells.copy_from_slice(input(0));
                }
                out.copy_from_slice(cells);
            }
        }
    }
}

fn view<'a>(operand: Operand, constants: &'a [f64], frame: &'a [f64], registers: &'a [f64]) -> &'a [f64] {
    let bank = match operand.bank {
        Bank::Constant => constants,
        Bank::Frame => frame,
        Bank::Register => registers,
    };
    &bank[operand.offset..operand.offset + operand.width]
}

/// The lane at `index` of an input that may have one lane for all, or none.
fn lane(lanes: &[f64], index: usize) -> f64 {
    match lanes {
        [] => 0.0,
        [only] => *only,
        several => several[index],
    }
}

// The frequent functions are chosen once per list, not once per lane, so that the loops vectorise.

fn map(function: Unary, input: &[f64], out: &mut [f64]) {
    let each = |out: &mut [f64], f: &dyn Fn(f64) -> f64| out.iter_mut().zip(input).for_each(|(value, &x)| *value = f(x));
    match function {
        Unary::Negate => out.iter_mut().zip(input).for_each(|(value, &x)| *value = -x),
        Unary::Absolute => out.iter_mut().zip(input).for_each(|(value, &x)| *value = x.abs()),
        other => each(out, &|x| other.apply(x)),
    }
}

fn zip(function: Binary, left: &[f64], right: &[f64], out: &mut [f64]) {
    match function {
        Binary::Add => zip_with(left, right, out, |a, b| a + b),
        Binary::Subtract => zip_with(left, right, out, |a, b| a - b),
        Binary::Multiply => zip_with(left, right, out, |a, b| a * b),
        Binary::Divide => zip_with(left, right, out, |a, b| a / b),
        other => zip_with(left, right, out, |a, b| other.apply(a, b)),
    }
}

fn zip_with(left: &[f64], right: &[f64], out: &mut [f64], f: impl Fn(f64, f64) -> f64) {
    match (left, right) {
        ([a], [b]) => out.fill(f(*a, *b)),
        ([a], _) => out.iter_mut().zip(right).for_each(|(value, &b)| *value = f(*a, b)),
        (_, [b]) => out.iter_mut().zip(left).for_each(|(value, &a)| *value = f(a, *b)),
        _ => out.iter_mut().zip(left.iter().zip(right)).for_each(|(value, (&a, &b))| *value = f(a, b)),
    }
}

fn choose(condition: &[f64], yes: &[f64], no: &[f64], out: &mut [f64]) {
    for (index, value) in out.iter_mut().enumerate() {
        *value = if lane(condition, index) != 0.0 { lane(yes, index) } else { lane(no, index) };
    }
}

fn reduce(reduction: Reduction, group: usize, input: &[f64], out: &mut [f64]) {
    for (value, lanes) in out.iter_mut().zip(input.chunks_exact(group)) {
        *value = reduction.apply(lanes);
    }
}

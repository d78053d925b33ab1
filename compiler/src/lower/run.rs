//! Executing a program.

use super::program::{Bank, Code, Instruction, Operand, Program};
use crate::graph::operation::{Binary, Reduction, Unary, quaternion};

/// Which moment of the episode is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moment {
    /// The reset snapshot, step 0.
    Reset,
    /// A control step with its number.
    Step(u32),
}

impl Program {
    /// Computes the reset snapshot: every memory starts, every state takes its first value.
    pub(crate) fn reset(&self, frame: &[f64], cells: &mut Vec<f64>, registers: &mut Vec<f64>) {
        cells.clear();
        cells.resize(self.cells, 0.0);
        registers.clear();
        registers.resize(self.registers, 0.0);
        for instruction in self.before.iter().chain(&self.after) {
            self.execute(instruction, Moment::Reset, frame, cells, registers);
        }
    }

    /// Computes control step number `step`: memories advance, formulas see states before their update, observations after.
    pub(crate) fn step(&self, step: u32, frame: &[f64], cells: &mut [f64], registers: &mut [f64]) {
        for instruction in &self.before {
            self.execute(instruction, Moment::Step(step), frame, cells, registers);
        }
        for (cell, value) in &self.updates {
            let lanes = view(*value, &self.constants, frame, registers);
            cells[*cell..*cell + lanes.len()].copy_from_slice(lanes);
        }
        for instruction in &self.after {
            self.execute(instruction, Moment::Step(step), frame, cells, registers);
        }
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
                Moment::Reset => 0.0,
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
                        Moment::Reset => memory.start(cells, inputs),
                        Moment::Step(step) => memory.advance(cells, step, inputs),
                    };
                }
            }
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

//! The lowered form of a task: a list of instructions over flat records.

use crate::graph::operation::{Binary, Chance, Memory, Reduction, Unary};
use crate::graph::track::Track;

/// Where lanes are read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bank {
    Constant,
    Frame,
    Register,
}

/// A range of lanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Operand {
    pub bank: Bank,
    pub offset: usize,
    pub width: usize,
}

impl Operand {
    pub(crate) const EMPTY: Self = Self { bank: Bank::Constant, offset: 0, width: 0 };
}

/// What an instruction does.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Code {
    Step,
    Unary(Unary),
    Binary(Binary),
    Choose,
    /// Copies these lanes of input 0.
    Gather(Box<[u32]>),
    Copy,
    Reduce(Reduction, usize),
    Quaternion,
    /// First cell.
    Memory(Memory, usize),
    /// Reads a state's cells; at reset they take input 0.
    StateBefore(usize),
    /// The same, after the update.
    StateAfter(usize),
    /// Reads the cells of a random; where the episode begins it is drawn first.
    Drawn(usize),
    /// Reads its cells after the redraws.
    DrawnAfter(usize),
    /// The element of input 0 that input 1 says.
    Pick,
    /// Whether an earlier phase succeeded: this cell.
    PhaseSuccess(usize),
    /// What a motion shows at the time in input 0.
    Follow(Box<Track>),
}

/// Reads inputs, writes `width` registers from `output` on. Inputs in registers lie below `output`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Instruction {
    pub code: Code,
    pub inputs: [Operand; 3],
    pub output: usize,
    pub width: usize,
}

/// How a random is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Draw {
    pub chance: Chance,
    /// Registers that take what chance gives.
    pub noise: Operand,
    /// What makes a candidate of it and says whether it is taken.
    pub tries: Vec<Instruction>,
    pub candidate: Operand,
    pub accept: Option<Operand>,
    /// Whether it is drawn before the beginning: it reads no signal.
    pub first: bool,
    /// When it is drawn anew.
    pub redraw: Option<Operand>,
    /// First cell.
    pub cell: usize,
}

/// The whole of it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Program {
    pub constants: Vec<f64>,
    /// Executed before the episode begins: what is settled by draws that read no signal. Part of `before` as well.
    pub first: Vec<Instruction>,
    /// Executed before the states are updated.
    pub before: Vec<Instruction>,
    /// Executed after.
    pub after: Vec<Instruction>,
    /// First cell of each state and its new value.
    pub updates: Vec<(usize, Operand)>,
    pub draws: Vec<Draw>,
    /// Cells of the successes of earlier phases that are read: (phase, cell).
    pub successes: Vec<(usize, usize)>,
    pub registers: usize,
    pub cells: usize,
    pub terms: Vec<Operand>,
    pub terminations: Vec<Operand>,
    pub finishes: Vec<Operand>,
    pub metrics: Vec<Operand>,
    pub success: Option<Operand>,
    pub channels: Vec<Operand>,
    /// Numbers that the beginning takes from what is drawn.
    pub beginning: Vec<Operand>,
    pub releases: Vec<Operand>,
    pub markers: Vec<Operand>,
    /// When the next phase of a sequence begins.
    pub until: Option<Operand>,
    /// Whether this phase has succeeded, for those after it.
    pub succeeded: Option<Operand>,
}

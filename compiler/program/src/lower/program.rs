//! The lowered form of a task: statements and formulas over two flat lists of numbers, the frame of sensors and the task's own
//! record, which holds constants, cells that remember, and what has more than one reader.

use super::block::Block;
use super::formula::{Formula, Scalar};
use super::lane::Run;
use super::plan::Plan;
use crate::graph::operation::{Chance, Memory};
use crate::graph::track::Track;
use std::ops::Range;

/// Something that writes to the record: what most steps consist of, and the rest.
pub(crate) enum Statement {
    /// Writes down what a formula comes to.
    Store {
        at: usize,
        formula: Formula,
    },
    /// Advances the one cell of a number that remembers.
    Remember {
        memory: Memory,
        cell: usize,
        input: Scalar,
    },
    Deed(Box<Deed>),
}

/// What is done to several numbers of the record at once.
pub(crate) enum Deed {
    /// Writes numbers side by side.
    Put { at: usize, plan: Plan },
    /// The same at reset only.
    Begin { at: usize, plan: Plan },
    /// Copies the cells of a random; where the episode begins it is drawn first.
    Draw { draw: usize, at: usize },
    /// Advances cells, so many for each of its lanes.
    Remember { memory: Memory, cell: usize, lanes: Vec<[Scalar; 3]>, at: Option<usize> },
    /// Computes a list as a whole.
    Block(Block),
    /// Copies element number `place` of a list.
    Pick { list: Run, place: Scalar, at: usize, width: usize },
    /// Writes what a motion shows at a time.
    Follow { track: Track, time: Scalar, at: usize },
}

/// How a random is drawn.
pub(crate) struct Draw {
    pub chance: Chance,
    /// Where what chance gives is written.
    pub noise: Range<usize>,
    /// What makes a candidate of it and returns whether it is taken.
    pub tries: Vec<Statement>,
    pub candidate: Plan,
    pub accept: Option<Scalar>,
    /// Whether it is drawn before the initial state: it reads no signal.
    pub first: bool,
    /// When it is drawn anew.
    pub redraw: Option<Scalar>,
    /// First cell.
    pub cell: usize,
}

/// The whole of it.
#[derive(Default)]
pub(crate) struct Program {
    /// The record as an episode finds it.
    pub record: Vec<f64>,
    /// Executed before the states are updated.
    pub before: Vec<Statement>,
    /// Those among them that are executed before the episode begins as well: what is settled by draws that read no signal.
    pub first: Vec<usize>,
    /// Gives states their new values.
    pub updates: Vec<Deed>,
    /// Executed after.
    pub after: Vec<Statement>,
    pub draws: Vec<Draw>,
    /// Cells of the successes of earlier phases that are read: (phase, cell).
    pub successes: Vec<(usize, usize)>,
    /// How many numbers and lists are computed at a step.
    pub operations: usize,
    pub terms: Vec<Scalar>,
    pub terminations: Vec<Scalar>,
    pub finishes: Vec<Scalar>,
    /// All metrics, one after the other.
    pub metrics: Plan,
    pub success: Option<Scalar>,
    pub channels: Vec<Plan>,
    /// Numbers that the initial state takes from what is drawn.
    pub initial_values: Vec<Scalar>,
    pub releases: Vec<Scalar>,
    pub markers: Vec<Plan>,
    pub drives: Vec<Plan>,
    /// When the next phase of a sequence begins.
    pub until: Option<Scalar>,
    /// Whether this phase has succeeded, for those after it.
    pub succeeded: Option<Scalar>,
}
